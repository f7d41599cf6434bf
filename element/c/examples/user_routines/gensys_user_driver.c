/* Calls gensys_user.c in place of GENSYS, with Heun's method. It is no test of GENSYS itself.
 *
 * A step is tried, and made again shorter where predictor and corrector differ too much.
 *
 *   cc -std=c99 -O2 gensys_user_driver.c gensys_user.c -L. -lrailspring_c -lm -o gensys_driver && RAILSPRING_ELEMENT=pair.rse ./gensys_driver
 *
 * A second run calls the library directly and commits accepted steps. It has to give the same bytes. */
#include "mock_host.h"
#include <string.h>

void railspring_user_(const int *number, const int *task, const double *time, const double *motions, const double *friction, double *forces, int *error);

static RailspringContact *direct; /* null where the routine is called */
static long calls;

static void routine(int task, double time, const double motions[7], double forces[6])
{
    static const int number = 1;
    static const double friction = -1.0;
    int error = 0;
    railspring_user_(&number, &task, &time, motions, &friction, forces, &error);
    if (error) exit(error);
}

static double accelerations(double time, const double x[6], const double v[6], double a[6])
{
    double forces[6], outside[6], motions[7];
    calls++;
    if (direct) {
        RailspringMotions at = motions_of(x);
        RailspringForces found;
        check(railspring_contact_evaluate(direct, &at, &found), "evaluate");
        memcpy(forces, found.rim, sizeof found.rim);
        memcpy(forces + 3, found.section, sizeof found.section);
    } else {
        memcpy(motions, x, 6 * sizeof *x);
        motions[6] = PLACE;
        routine(1, time, motions, forces);
    }
    load(time, outside);
    for (int i = 0; i < 6; i++) a[i] = (outside[i] + forces[i] - DAMPING[i] * v[i] - STIFFNESS[i] * x[i]) / MASS[i];
    return -forces[1];
}

typedef struct {
    double x[6], v[6], p;
    int steps, given_up;
} Result;

static Result integrate(const RailspringElement *element)
{
    Result now = {{0}, {0}, 0.0, 0, 0};
    double time = 0.0, h = 1e-5, a[6], b[6];
    if (element) check(railspring_contact_new(element, NAN, &direct), "contact");
    else routine(0, 0.0, NULL, NULL);
    accelerations(0.0, now.x, now.v, a);
    while (time < 0.05) {
        double x[6], v[6], off = 0.0;
        for (int i = 0; i < 6; i++) {
            x[i] = now.x[i] + h * now.v[i];
            v[i] = now.v[i] + h * a[i];
        }
        accelerations(time + h, x, v, b);
        for (int i = 0; i < 6; i++) off = fmax(off, 0.5 * h * fabs(b[i] - a[i]));
        if (off < 2e-3) { /* m/s, rad/s */
            for (int i = 0; i < 6; i++) {
                now.x[i] += 0.5 * h * (now.v[i] + v[i]);
                now.v[i] += 0.5 * h * (a[i] + b[i]);
            }
            time += h;
            now.p = accelerations(time, now.x, now.v, a); /* at the accepted end, where the next step begins */
            if (direct) check(railspring_contact_commit(direct), "commit");
            now.steps++;
            h = fmin(h * (off < 1e-3 ? 1.5 : 1.0), 5e-5);
        } else {
            now.given_up++;
            h *= 0.5;
            if (h < 1e-10) fprintf(stderr, "no step at %g s\n", time), exit(3);
        }
    }
    if (!element) routine(2, time, NULL, NULL);
    railspring_contact_free(direct);
    direct = NULL;
    return now;
}

int main(void)
{
    const char *path = getenv("RAILSPRING_ELEMENT");
    RailspringElement *element = NULL;
    if (!path) return fprintf(stderr, "set RAILSPRING_ELEMENT\n"), 2;
    check(railspring_element_open(path, &element), path);
    Result first = integrate(NULL);
    printf("user routine: %d steps, %d given up, %ld calls; at the end P %.3f N, rim y %.9g m, z %.9g m\n", first.steps, first.given_up, calls, first.p, first.x[0], first.x[1]);
    Result second = integrate(element);
    railspring_element_free(element);
    int same = !memcmp(&first, &second, sizeof first);
    printf("direct calls: %d steps, %d given up; %s\n", second.steps, second.given_up, same ? "the same bytes" : "DIFFERENT");
    return same ? 0 : 1;
}
