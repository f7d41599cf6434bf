/* A Simpack user force element of the wheel-rail contact. UNTRIED in Simpack; simpack_user_force_driver.c calls it in its place.
 *
 * Build: compile it into the user routines of your version, and link them with the library. For the driver:
 *   cc -std=c99 -O2 simpack_user_force_driver.c simpack_user_force.c -L. -lrailspring_c -lm -o simpack_driver
 *
 * The argument list is that of the Fortran template of user force elements of 2016: by reference, name with an underscore.
 * Adapt it to the template of your version, and `marker_motions` to its access functions. The template's setup routines (`_type`,
 * `_setup`) are not here.
 *
 * Simpack integrates the flexible wheelset by itself, with an implicit method that changes and gives up steps. A contact suits that,
 * as its forces depend on the motions and on the last accepted step alone. A unit would suit co-simulation with fixed steps.
 * The state of friction is kept here by accepted steps (accepted_steps.h) and is none of Simpack's states. A run can therefore not
 * go on from a saved state. The routine is for one thread.
 *
 * The from-marker is on the rim, at the origin of the wheel's profile. Its body must not turn with the wheel. The to-marker is on
 * the rail's section, at its line of shear centres. Both have x along the track, y to the field side and z down.
 * Near a held end of the study's rail the section feels less than the rim; Simpack applies the same force to both.
 * The environment variable RAILSPRING_ELEMENT names the element file.
 *
 * Parameters: 1 place of the wheel at time 0 (m from the rail's first end); 2 its speed (m/s); 3 coefficient of friction, less than
 * 0 for the study's. A rail of your own has the place -1 and the speed 0.
 * Output values: 1 Q, 2 P (N; minus the forces on the rim), 3 force on the section in z (N). */
#include "accepted_steps.h"
#include <math.h>
#include <stdio.h>

enum { ELEMENTS = 64, TASK_FORCE = 0, TASK_FIRST_CALL = 5, TASK_LAST_CALL = 6 };

/* Displacements y, z and rotation about x of a marker, in axes of the track. They count from where the wheel just touches.
 * This file only declares the function: write it with the access functions of your version. */
void marker_motions(int marker, double time, double motions[3]);

static struct {
    int id, used;
    AcceptedSteps steps;
} elements[ELEMENTS];

static AcceptedSteps *find(int id, int makes)
{
    for (int i = 0; i < ELEMENTS; i++)
        if (elements[i].used && elements[i].id == id) return &elements[i].steps;
    for (int i = 0; i < ELEMENTS && makes; i++)
        if (!elements[i].used) {
            elements[i].used = 1;
            elements[i].id = id;
            return &elements[i].steps;
        }
    return NULL;
}

static int report(int id, RailspringCode code)
{
    if (code) fprintf(stderr, "contact element %d: code %d: %s\n", id, (int)code, railspring_message());
    return (int)code;
}

void uforce20_(const int *task, const int *par_dim, const int *uin_dim, const int *stdyn_dim, const int *stroot_dim, const int *ov_dim, const int *id, const double *par, const int *mk_from,
               const int *mk_to, const double *time, const double *uin, double *stdyn, int *stroot, double *stdynd, double *force, double *torque, double *ov, double *valroot, int *ierr)
{
    (void)uin_dim, (void)stdyn_dim, (void)stroot_dim, (void)uin, (void)stdyn, (void)stroot, (void)stdynd, (void)valroot;
    *ierr = 0;
    if (*par_dim < 3 || *ov_dim < 3) {
        *ierr = 1;
        return;
    }
    if (*task == TASK_FIRST_CALL) {
        const char *path = getenv("RAILSPRING_ELEMENT");
        AcceptedSteps *steps = find(*id, 1);
        if (!path || !steps) {
            fprintf(stderr, "contact element %d: set RAILSPRING_ELEMENT, and use at most %d elements\n", *id, ELEMENTS);
            *ierr = 1;
            return;
        }
        accepted_steps_free(steps); /* of a run before */
        *ierr = report(*id, accepted_steps_open(steps, path, par[2] < 0.0 ? NAN : par[2]));
    } else if (*task == TASK_LAST_CALL) {
        AcceptedSteps *steps = find(*id, 0);
        if (steps) accepted_steps_free(steps);
        for (int i = 0; i < ELEMENTS; i++)
            if (elements[i].used && elements[i].id == *id) elements[i].used = 0;
    } else if (*task == TASK_FORCE) {
        AcceptedSteps *steps = find(*id, 0);
        RailspringMotions motions;
        RailspringForces forces;
        if (!steps || !steps->contact) {
            *ierr = 1;
            return;
        }
        marker_motions(*mk_from, *time, motions.rim);
        marker_motions(*mk_to, *time, motions.section);
        motions.place = par[0] + par[1] * *time;
        *ierr = report(*id, accepted_steps_evaluate(steps, *time, &motions, &forces));
        if (*ierr) return;
        /* The force acts on the from-marker, and its reaction on the to-marker; the solver adds the lever between them.
         * Turn both into the axes of the from-marker's body where these differ from the track's. */
        force[0] = 0.0, force[1] = forces.rim[0], force[2] = forces.rim[1];
        torque[0] = -forces.section[2], torque[1] = 0.0, torque[2] = 0.0;
        ov[0] = -forces.rim[0], ov[1] = -forces.rim[1], ov[2] = forces.section[1];
    }
}
