/* Calls simpack_user_force.c in place of Simpack: with an implicit method that chooses its steps, gives some up and steps back. The
 * Jacobian is found by differences. It is no test of Simpack itself.
 *
 *   cc -std=c99 -O2 simpack_user_force_driver.c simpack_user_force.c -L. -lrailspring_c -lm -o simpack_driver && RAILSPRING_ELEMENT=pair.rse ./simpack_driver
 *
 * A second run calls the library directly and commits accepted steps. It has to give the same bytes. */
#include "mock_host.h"
#include <string.h>

void uforce20_(const int *, const int *, const int *, const int *, const int *, const int *, const int *, const double *, const int *, const int *, const double *, const double *, double *, int *, double *,
               double *, double *, double *, double *, int *);
void marker_motions(int marker, double time, double motions[3]);

typedef enum { BY_ROUTINE, DIRECT, DIRECT_OWN_SECTION } Way; /* the last has the section's own force for the reaction */
static Way way;
static double markers[2][3], rim_p;
static RailspringContact *contact, *before;
static RailspringAbout about;
static long calls;

void marker_motions(int marker, double time, double motions[3])
{
    (void)time;
    memcpy(motions, markers[marker - 1], sizeof markers[0]);
}

static void routine(int task, double time, double force[3], double torque[3], double values[3])
{
    static const double parameters[3] = {0.2775, 0.0, -1.0};
    int three = 3, none = 0, id = 17, from = 1, to = 2, error = 0;
    uforce20_(&task, &three, &none, &none, &none, &three, &id, parameters, &from, &to, &time, NULL, NULL, NULL, NULL, force, torque, values, NULL, &error);
    if (error) exit(error);
}

/* Forces of the element on rim and section as the solver applies them. */
static void contact_forces(double time, const double x[6], double to[6])
{
    double force[3] = {0}, torque[3] = {0}, values[3] = {0};
    calls++;
    if (way == BY_ROUTINE) {
        memcpy(markers[0], x, sizeof markers[0]);
        memcpy(markers[1], x + 3, sizeof markers[1]);
        routine(0, time, force, torque, values);
    } else {
        RailspringMotions at = motions_of(x);
        RailspringForces forces;
        check(railspring_contact_evaluate(contact, &at, &forces), "evaluate");
        force[1] = forces.rim[0], force[2] = forces.rim[1], torque[0] = -forces.section[2];
        values[1] = -forces.rim[1];
        if (way == DIRECT_OWN_SECTION) {
            memcpy(to, forces.rim, sizeof forces.rim);
            memcpy(to + 3, forces.section, sizeof forces.section);
            rim_p = values[1];
            return;
        }
    }
    double y = x[3] - x[0] - about.origin[0], z = x[4] - x[1] - about.origin[1]; /* from rim to section */
    to[0] = force[1], to[1] = force[2], to[2] = torque[0] + y * force[2] - z * force[1];
    to[3] = -force[1], to[4] = -force[2], to[5] = -torque[0];
    rim_p = values[1];
}

/* A step of the trapezoidal rule by Newton's method. The last evaluation is at the end but for a last correction. */
static int step(double time, double h, double x[6], double v[6], double a[6])
{
    double end[6], free_x[6], free_v[6], forces[6], nearby[6], outside[6], matrix[36], off[6];
    for (int i = 0; i < 6; i++) {
        free_x[i] = x[i] + v[i] * h + a[i] * (0.25 * h * h);
        free_v[i] = v[i] + a[i] * (0.5 * h);
        end[i] = x[i] + v[i] * h + a[i] * (0.5 * h * h);
    }
    load(time + h, outside);
    for (int iteration = 0; iteration < 15; iteration++) {
        for (int k = 0; iteration % 4 == 0 && k < 6; k++) {
            double moved[6], by = k % 3 == 2 ? 1e-9 : 1e-10;
            if (k == 0) contact_forces(time + h, end, forces);
            memcpy(moved, end, sizeof moved);
            moved[k] += by;
            contact_forces(time + h, moved, nearby);
            for (int i = 0; i < 6; i++) matrix[6 * i + k] = (i == k ? 4.0 / (h * h) * MASS[i] + 2.0 / h * DAMPING[i] + STIFFNESS[i] : 0.0) - (nearby[i] - forces[i]) / by;
        }
        contact_forces(time + h, end, forces);
        double of[36], change = 0.0;
        for (int i = 0; i < 6; i++) {
            double acceleration = (end[i] - free_x[i]) * (4.0 / (h * h)), velocity = free_v[i] + acceleration * (0.5 * h);
            off[i] = outside[i] + forces[i] - MASS[i] * acceleration - DAMPING[i] * velocity - STIFFNESS[i] * end[i];
        }
        memcpy(of, matrix, sizeof of);
        solve_six(of, off);
        for (int i = 0; i < 6; i++) end[i] += off[i], change = fmax(change, fabs(off[i]));
        if (change < 1e-10) {
            for (int i = 0; i < 6; i++) {
                a[i] = (end[i] - free_x[i]) * (4.0 / (h * h));
                v[i] = free_v[i] + a[i] * (0.5 * h);
                x[i] = end[i];
            }
            return 1;
        }
    }
    return 0;
}

typedef struct {
    double x[6], v[6], a[6], p;
    int steps, given_up;
} Result;

/* Each step is tried as one and made again as two halves; their difference decides. */
static Result integrate(Way as)
{
    Result now = {{0}, {0}, {0}, 0.0, 0, 0};
    double time = 0.0, h = 1e-5, spare[3];
    way = as;
    if (as == BY_ROUTINE) routine(5, 0.0, spare, spare, spare);
    RailspringElement *element = NULL;
    check(railspring_element_open(getenv("RAILSPRING_ELEMENT"), &element), "element");
    check(railspring_element_about(element, &about), "about");
    check(railspring_contact_new(element, NAN, &contact), "contact");
    check(railspring_contact_clone(contact, &before), "clone");
    railspring_element_free(element);
    double none[6];
    contact_forces(0.0, now.x, none);
    while (time < 0.05) {
        Result whole = now, half = now;
        int good = step(time, h, whole.x, whole.v, whole.a);
        good = good && step(time, 0.5 * h, half.x, half.v, half.a);
        if (good) {
            if (as != BY_ROUTINE) check(railspring_contact_commit(contact), "commit");
            good = step(time + 0.5 * h, 0.5 * h, half.x, half.v, half.a);
        }
        double off = 0.0;
        for (int i = 0; i < 6; i++) off = fmax(off, fabs(whole.x[i] - half.x[i]));
        if (good && off < 3e-8) {
            if (as != BY_ROUTINE) {
                check(railspring_contact_commit(contact), "commit");
                check(railspring_contact_restore(before, contact), "keep");
            }
            half.steps = now.steps + 1, half.given_up = now.given_up;
            now = half;
            now.p = rim_p;
            time += h;
            h = fmin(h * (off < 1e-8 ? 1.5 : 1.0), 2e-4);
        } else {
            if (as != BY_ROUTINE) check(railspring_contact_restore(contact, before), "back");
            now.given_up++;
            h *= 0.4;
            if (h < 1e-9) fprintf(stderr, "no step at %g s\n", time), exit(3);
        }
    }
    if (as == BY_ROUTINE) routine(6, time, spare, spare, spare);
    railspring_contact_free(contact);
    railspring_contact_free(before);
    contact = before = NULL;
    return now;
}

int main(void)
{
    if (!getenv("RAILSPRING_ELEMENT")) return fprintf(stderr, "set RAILSPRING_ELEMENT\n"), 2;
    Result first = integrate(BY_ROUTINE);
    printf("user routine: %d steps, %d given up, %ld calls; at the end P %.3f N, rim y %.9g m, z %.9g m\n", first.steps, first.given_up, calls, first.p, first.x[0], first.x[1]);
    Result second = integrate(DIRECT), third = integrate(DIRECT_OWN_SECTION);
    int same = !memcmp(&first, &second, sizeof first);
    printf("direct calls: %d steps, %d given up; %s\n", second.steps, second.given_up, same ? "the same bytes" : "DIFFERENT");
    printf("with the section's own force for the reaction: %d steps, %d given up; P %.3f N, rim y %.9g m, z %.9g m\n", third.steps, third.given_up, third.p, third.x[0], third.x[1]);
    return same ? 0 : 1;
}
