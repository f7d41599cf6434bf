/* A host program that integrates wheel, rail and vehicle by itself, and calls the contact.
 *
 * The load case is a wheel on a short rail with held ends (S.H. Ju 2016, section 4.1). A constant lateral force acts on the hub, and
 * a vertical force that swings acts on a suspended mass. The wheel stands in the place of the rail that the element file is for.
 *
 * The host has the hub, the suspended mass on spring and damper, the wheel's modes and the rail's modes. It uses Newmark's scheme
 * with average acceleration. Newton's method balances each step with the contact's forces and tangent.
 *
 *   cc -std=c99 -O2 newmark.c -L. -lrailspring_c -lm -Wl,-rpath,'$ORIGIN' -o newmark
 *   ./newmark pair.rse 16 >forces.csv
 *
 * The number is how many steps make half a millisecond. The columns are time (s), P and Q (N). */
#include "railspring.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double ROW = 0.5e-3;       /* s */
static const int ROWS = 550;
static const double SUSPENDED = 6250.0; /* kg */
static const double SPRING = 1.2e6;     /* N/m */
static const double DAMPER = 4e4;       /* N s/m */
static const double SETTLED = 1e-8;     /* last correction of Newton's method, m: about ten newtons in a contact */
static const double PI = 3.14159265358979323846;

static void check(RailspringCode code, const char *what)
{
    if (code != RAILSPRING_CODE_DONE) {
        fprintf(stderr, "%s: code %d: %s\n", what, (int)code, railspring_message());
        exit((int)code);
    }
}

static double *zeros(size_t count)
{
    double *values = calloc(count ? count : 1, sizeof *values);
    if (!values) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return values;
}

/* Solves matrix x = right in place, with row pivots, and overwrites the matrix. Returns 0 where it is singular. */
static int solve(size_t n, double *matrix, double *right)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(matrix[i * n + k]) > fabs(matrix[pivot * n + k])) pivot = i;
        if (matrix[pivot * n + k] == 0.0) return 0;
        if (pivot != k) {
            for (size_t j = k; j < n; j++) {
                double swap = matrix[k * n + j];
                matrix[k * n + j] = matrix[pivot * n + j];
                matrix[pivot * n + j] = swap;
            }
            double swap = right[k];
            right[k] = right[pivot];
            right[pivot] = swap;
        }
        for (size_t i = k + 1; i < n; i++) {
            double factor = matrix[i * n + k] / matrix[k * n + k];
            if (factor == 0.0) continue;
            for (size_t j = k + 1; j < n; j++) matrix[i * n + j] -= factor * matrix[k * n + j];
            right[i] -= factor * right[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++) right[k] -= matrix[k * n + j] * right[j];
        right[k] /= matrix[k * n + k];
    }
    return 1;
}

/* The coordinates are hub y and z, the wheel's modes, the suspended mass, and the rail's modes. The hub does not rotate. */
typedef struct {
    size_t size, suspended;                          /* coordinates, and which is the suspended mass */
    double *mass, *damping, *stiffness, *carried;    /* `carried` has 6 rows: motions of rim and section */
    double rest[9], place;
} Host;

static Host assemble(const RailspringElement *element, const RailspringAbout *about)
{
    size_t wheel = 3 + about->wheel_modes, count = wheel - 1, modes = about->rail_modes, n = count + 1 + modes;
    Host host = {n, count, zeros(n * n), zeros(n * n), zeros(n * n), zeros(6 * n), {0}, about->place};
    double *mass = zeros(wheel * wheel), *damping = zeros(wheel * wheel), *stiffness = zeros(wheel * wheel);
    double *rim = zeros(3 * wheel), *squares = zeros(modes), *sections = zeros(3 * modes);
    check(railspring_element_superelement(element, mass, damping, stiffness, rim), "superelement");
    check(railspring_element_rail(element, squares, sections, host.rest), "rail");
    for (size_t i = 0; i < count; i++) {
        size_t of_i = i < 2 ? i : i + 1;
        for (size_t k = 0; k < count; k++) {
            size_t of_k = k < 2 ? k : k + 1;
            host.mass[i * n + k] = mass[of_i * wheel + of_k];
            host.damping[i * n + k] = damping[of_i * wheel + of_k];
            host.stiffness[i * n + k] = stiffness[of_i * wheel + of_k];
        }
        for (size_t row = 0; row < 3; row++) host.carried[row * n + i] = rim[row * wheel + of_i];
    }
    host.mass[count * n + count] = SUSPENDED;
    size_t of[2] = {1, count};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            host.stiffness[of[i] * n + of[k]] += i == k ? SPRING : -SPRING;
            host.damping[of[i] * n + of[k]] += i == k ? DAMPER : -DAMPER;
        }
    for (size_t mode = 0; mode < modes; mode++) {
        size_t i = count + 1 + mode;
        host.mass[i * n + i] = 1.0;
        host.stiffness[i * n + i] = squares[mode];
        host.damping[i * n + i] = about->damping[1] * squares[mode];
        for (size_t row = 0; row < 3; row++) host.carried[(3 + row) * n + i] = sections[3 * mode + row];
    }
    free(mass), free(damping), free(stiffness), free(rim), free(squares), free(sections);
    return host;
}

static RailspringMotions motions(const Host *host, const double *x)
{
    RailspringMotions at = {{0}, {0}, host->place};
    for (size_t i = 0; i < host->size; i++)
        for (size_t row = 0; row < 3; row++) {
            at.rim[row] += host->carried[row * host->size + i] * x[i];
            at.section[row] += host->carried[(3 + row) * host->size + i] * x[i];
        }
    return at;
}

/* Writes the forces on all coordinates (N): the contact's, the lateral one on the hub, the vertical one on the suspended mass. */
static void outside(const Host *host, double time, const RailspringForces *forces, double *to)
{
    for (size_t i = 0; i < host->size; i++) {
        to[i] = 0.0;
        for (size_t row = 0; row < 3; row++)
            to[i] += host->carried[row * host->size + i] * forces->rim[row] +
                     host->carried[(3 + row) * host->size + i] * forces->section[row];
    }
    to[0] += 20e3;
    to[host->suspended] += 10e3 + 61.25e3 * sin(2.0 * PI * 10.0 * time);
}

/* Writes the matrix of a Newton step: inertia, damping and stiffness of the host minus the contact's tangent. */
static void newton_matrix(const Host *host, double h, const double *tangent, double *to)
{
    size_t n = host->size;
    for (size_t i = 0; i < n; i++) {
        double carried_tangent[6] = {0};
        for (int row = 0; row < 6; row++)
            for (int k = 0; k < 6; k++) carried_tangent[k] += host->carried[(size_t)row * n + i] * tangent[6 * row + k];
        for (size_t j = 0; j < n; j++) {
            double contact = 0.0;
            for (int k = 0; k < 6; k++) contact += carried_tangent[k] * host->carried[(size_t)k * n + j];
            to[i * n + j] = host->mass[i * n + j] * (4.0 / (h * h)) + host->damping[i * n + j] * (2.0 / h) +
                            host->stiffness[i * n + j] - contact;
        }
    }
}

/* P and Q are minus the forces on the rim: near a held end the section has only its share. */
static void row(double time, const RailspringForces *forces)
{
    printf("%.17g,%.17g,%.17g\n", time, 0.0 - forces->rim[1], 0.0 - forces->rim[0]);
}

int main(int count, char **arguments)
{
    int steps = count == 3 ? atoi(arguments[2]) : 0;
    if (steps < 1) {
        fprintf(stderr, "usage: newmark FILE STEPS >forces.csv\n");
        return 2;
    }
    RailspringElement *element = NULL;
    RailspringContact *contact = NULL;
    RailspringAbout about;
    RailspringForces forces;
    check(railspring_element_open(arguments[1], &element), arguments[1]);
    check(railspring_element_about(element, &about), "about");
    if (about.rail_modes == 0) {
        fprintf(stderr, "%s has no rail\n", arguments[1]);
        return 2;
    }
    Host host = assemble(element, &about);
    check(railspring_contact_new(element, about.friction, &contact), "contact");
    check(railspring_contact_set_section_rest(contact, host.rest), "rest of the rail");
    railspring_element_free(element);

    size_t n = host.size;
    double h = ROW / steps;
    double *x = zeros(n), *v = zeros(n), *a = zeros(n), *end = zeros(n), *off = zeros(n), *matrix = zeros(n * n);
    double *free_x = zeros(n), *free_v = zeros(n);
    RailspringMotions at = motions(&host, x);
    check(railspring_contact_start(contact, &at, &forces), "start");
    outside(&host, 0.0, &forces, a);
    for (size_t i = 0; i < n * n; i++) matrix[i] = host.mass[i];
    if (!solve(n, matrix, a)) return fprintf(stderr, "a singular mass\n"), 3;
    puts("time_s,p_n,q_n");
    row(0.0, &forces);

    long evaluations = 0;
    clock_t begun = clock(), in_library = 0;
    for (int step = 1; step <= ROWS * steps; step++) {
        double time = step * h, change;
        for (size_t i = 0; i < n; i++) {
            free_x[i] = x[i] + v[i] * h + a[i] * (0.25 * h * h); /* without an acceleration at the end */
            free_v[i] = v[i] + a[i] * (0.5 * h);
            end[i] = x[i] + v[i] * h + a[i] * (0.5 * h * h);
        }
        int iteration = 0;
        do {
            at = motions(&host, end);
            clock_t before = clock();
            check(railspring_contact_evaluate(contact, &at, &forces), "evaluate");
            in_library += clock() - before;
            evaluations++;
            for (size_t i = 0; i < n; i++) {
                a[i] = (end[i] - free_x[i]) * (4.0 / (h * h));
                v[i] = free_v[i] + a[i] * (0.5 * h);
            }
            outside(&host, time, &forces, off);
            for (size_t i = 0; i < n; i++)
                for (size_t k = 0; k < n; k++)
                    off[i] -= host.mass[i * n + k] * a[k] + host.damping[i * n + k] * v[k] + host.stiffness[i * n + k] * end[k];
            newton_matrix(&host, h, forces.tangent, matrix);
            if (!solve(n, matrix, off)) return fprintf(stderr, "a singular step at %g s\n", time), 3;
            change = 0.0;
            for (size_t i = 0; i < n; i++) {
                end[i] += off[i];
                change = fmax(change, fabs(off[i]));
            }
            if (++iteration == 100) return fprintf(stderr, "no balance at %g s: %g m\n", time, change), 3;
        } while (!(change < SETTLED));
        for (size_t i = 0; i < n; i++) {
            a[i] = (end[i] - free_x[i]) * (4.0 / (h * h));
            v[i] = free_v[i] + a[i] * (0.5 * h);
            x[i] = end[i];
        }
        check(railspring_contact_commit(contact), "commit");
        if (step % steps == 0) row(time, &forces);
    }
    double all = (double)(ROWS * steps), second = (double)CLOCKS_PER_SEC;
    fprintf(stderr, "%.2f evaluations and %.1f us a step, %.1f us of it in the library\n", (double)evaluations / all,
            1e6 * (double)(clock() - begun) / second / all, 1e6 * (double)in_library / second / all);
    railspring_contact_free(contact);
    free(host.mass), free(host.damping), free(host.stiffness), free(host.carried);
    free(x), free(v), free(a), free(end), free(off), free(matrix), free(free_x), free(free_v);
    return 0;
}
