/* Calls abaqus_uel.f in place of Abaqus/Standard, in dynamic steps by the method of Hilber, Hughes and Taylor. Some increments are cut
 * back. It is no test of Abaqus itself.
 *
 *   gfortran -O2 -c abaqus_uel.f && cc -std=c99 -O2 abaqus_uel_driver.c abaqus_uel.o -L. -lrailspring_c -lgfortran -lm -o uel_driver
 *   RAILSPRING_ELEMENT=pair.rse ./uel_driver
 *
 * Cut-backs and half-increment residuals have to change nothing. A run with direct calls and a commit after each increment has to
 * give the same bytes. */
#include "mock_host.h"
#include <string.h>

void uel_(double *rhs, double *amatrx, double *svars, double *energy, const int *ndofel, const int *nrhs, const int *nsvars, const double *props, const int *nprops, const double *coords, const int *mcrd,
          const int *nnode, const double *u, const double *du, const double *v, const double *a, const int *jtype, const double *time, const double *dtime, const int *kstep, const int *kinc,
          const int *jelem, const double *params, const int *ndload, const int *jdltyp, const double *adlmag, const double *predef, const int *npredf, const int *lflags, const int *mlvarx,
          const double *ddlmag, const int *mdload, double *pnewdt, const int *jprops, const int *njprop, const double *period);

/* Abaqus's routine that ends a run. */
void xit_(void)
{
    exit(3);
}

static const double ALPHA = -0.05, H = 2e-5;
static int element_number;
static RailspringContact *direct; /* null where the element is called */

typedef struct {
    double x[6], v[6], a[6], svars[20], old[6]; /* `old`: forces of the contact at the end of the increment, for direct calls */
} State;

/* The contact's share of residual and matrix, the latter by columns. `flag` is LFLAGS(3). */
static void element(State *now, int flag, const double u[6], const double du[6], double time, double h, int step, int increment, double svars[20], double residual[6], double matrix[36])
{
    if (direct) {
        RailspringMotions at = motions_of(u);
        RailspringForces forces;
        check(railspring_contact_evaluate(direct, &at, &forces), "evaluate");
        double force[6];
        memcpy(force, forces.rim, sizeof forces.rim);
        memcpy(force + 3, forces.section, sizeof forces.section);
        for (int i = 0; i < 6; i++) {
            residual[i] = (1.0 + ALPHA) * force[i] - ALPHA * now->old[i];
            svars[8 + i] = force[i];
            for (int k = 0; k < 6; k++) matrix[6 * k + i] = -(1.0 + ALPHA) * forces.tangent[6 * i + k];
        }
        return;
    }
    int six = 6, one = 1, twenty = 20, three = 3, two = 2, none = 0, lflags[5] = {11, 1, flag, 0, 0};
    double energy[8] = {0}, props[3] = {PLACE, 0.0, -1.0}, coords[6] = {0}, times[2] = {time, time}, params[3] = {ALPHA, 0.25 * (1.0 - ALPHA) * (1.0 - ALPHA), 0.5 - ALPHA}, shorter = 1.0, zero[6] = {0};
    uel_(residual, matrix, svars, energy, &six, &one, &twenty, props, &three, coords, &three, &two, u, du, zero, zero, &one, times, &h, &step, &increment, &element_number, params, &none, &none,
         zero, zero, &none, lflags, &six, zero, &none, &shorter, &none, &none, &h);
    if (shorter < 1.0) fprintf(stderr, "the element asks for a shorter increment\n"), exit(3);
}

/* An increment. `stops` ends it after so many iterations, as if it did not converge. SVARS come out where it converged. */
static void increment(State *now, double time, double h, int step, int number, int stops)
{
    double beta = 0.25 * (1.0 - ALPHA) * (1.0 - ALPHA), gamma = 0.5 - ALPHA, end[6], du[6], before[6], after[6];
    memcpy(end, now->x, sizeof end);
    load(time, before), load(time + h, after);
    for (int iteration = 1; iteration <= 50; iteration++) {
        double residual[6], matrix[36], full[36], off[6], svars[20], a[6], v[6], change = 0.0;
        memcpy(svars, now->svars, sizeof svars); /* as at the start of the increment */
        for (int i = 0; i < 6; i++) du[i] = end[i] - now->x[i];
        element(now, 1, end, du, time + h, h, step, number, svars, residual, matrix);
        for (int i = 0; i < 6; i++) {
            a[i] = (end[i] - now->x[i] - h * now->v[i] - h * h * (0.5 - beta) * now->a[i]) / (beta * h * h);
            v[i] = now->v[i] + h * ((1.0 - gamma) * now->a[i] + gamma * a[i]);
            double own = after[i] - DAMPING[i] * v[i] - STIFFNESS[i] * end[i], own_before = before[i] - DAMPING[i] * now->v[i] - STIFFNESS[i] * now->x[i];
            off[i] = residual[i] + (1.0 + ALPHA) * own - ALPHA * own_before - MASS[i] * a[i];
            for (int k = 0; k < 6; k++)
                full[6 * i + k] = matrix[6 * k + i] + (i == k ? MASS[i] / (beta * h * h) + (1.0 + ALPHA) * (DAMPING[i] * gamma / (beta * h) + STIFFNESS[i]) : 0.0);
        }
        solve_six(full, off);
        for (int i = 0; i < 6; i++) change = fmax(change, fabs(off[i]));
        if (stops && iteration == stops) return;
        if (change < 1e-10) { /* what was evaluated is what is taken */
            memcpy(now->x, end, sizeof end), memcpy(now->v, v, sizeof v), memcpy(now->a, a, sizeof a), memcpy(now->svars, svars, sizeof svars);
            memcpy(now->old, svars + 8, sizeof now->old);
            return;
        }
        for (int i = 0; i < 6; i++) end[i] += off[i];
    }
    fprintf(stderr, "no convergence at %g s\n", time);
    exit(3);
}

typedef enum { PLAIN, CUT_BACK, DIRECT } Way;

/* Two steps of 1250 increments. With `CUT_BACK` each seventh is first tried four times as long, and a half-increment residual
 * follows each fifth. */
static State run(Way way, double *largest)
{
    State now;
    memset(&now, 0, sizeof now);
    element_number = way == PLAIN ? 7 : 8;
    *largest = 0.0;
    for (int step = 1; step <= 2; step++)
        for (int number = 1; number <= 1250; number++) {
            double time = ((step - 1) * 1250 + number - 1) * H;
            State before = now, tried = now;
            if (way == CUT_BACK && number % 7 == 0) increment(&tried, time, 4.0 * H, step, number, 1 + number % 3);
            increment(&now, time, H, step, number, 0);
            if (way == CUT_BACK && number % 5 == 0) {
                double half[6], du[6], svars[20], residual[6], matrix[36];
                for (int i = 0; i < 6; i++) half[i] = 0.5 * (before.x[i] + now.x[i]), du[i] = half[i] - before.x[i];
                memcpy(svars, before.svars, sizeof svars);
                element(&before, 5, half, du, time + 0.5 * H, H, step, number, svars, residual, matrix);
                if (memcmp(svars, before.svars, sizeof svars)) fprintf(stderr, "SVARS of a half increment changed\n"), exit(1);
            }
            if (way == DIRECT) check(railspring_contact_commit(direct), "commit");
            *largest = fmax(*largest, -now.svars[9]);
        }
    return now;
}

int main(void)
{
    double largest;
    State plain = run(PLAIN, &largest), cut = run(CUT_BACK, &largest);
    printf("2500 increments; at the end P %.3f N, rim y %.9g m, z %.9g m; largest P %.1f N\n", -plain.svars[9], plain.x[0], plain.x[1], largest);
    RailspringElement *file = NULL;
    const char *path = getenv("RAILSPRING_ELEMENT");
    check(railspring_element_open(path ? path : "", &file), "RAILSPRING_ELEMENT");
    check(railspring_contact_new(file, NAN, &direct), "contact");
    State by_calls = run(DIRECT, &largest);
    int same = !memcmp(&plain, &cut, sizeof plain), also = !memcmp(plain.x, by_calls.x, sizeof plain.x) && !memcmp(plain.old, by_calls.old, sizeof plain.old);
    printf("with cut-backs and half increments: %s\ndirect calls: %s\n", same ? "the same bytes" : "DIFFERENT", also ? "the same bytes" : "DIFFERENT");
    if (!also) printf("  rim z %.17g and %.17g m\n", plain.x[1], by_calls.x[1]);
    railspring_contact_free(direct);
    railspring_element_free(file);
    return same && also ? 0 : 1;
}
