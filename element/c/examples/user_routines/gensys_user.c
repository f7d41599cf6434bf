/* A GENSYS user routine of the wheel-rail contact. UNTRIED in GENSYS; gensys_user_driver.c calls it in its place.
 *
 * Build: compile it with the user routines of your version, and link them with the library. For the driver:
 *   cc -std=c99 -O2 gensys_user_driver.c gensys_user.c -L. -lrailspring_c -lm -o gensys_driver
 *
 * No public description of GENSYS's user routines was at hand. Name and argument list are a plain Fortran form: by reference, name
 * with an underscore. Adapt both to your version.
 *
 * GENSYS integrates by itself and may shorten a step that it has tried. A contact suits that, as its forces depend on the motions and
 * on the last accepted step alone. Accepted steps are told from the time (accepted_steps.h). Use a method that evaluates at the ends
 * of steps, such as Heun's. The routine is for one thread. The environment variable RAILSPRING_ELEMENT names the element file.
 *
 *   number    in   which contact, from 1
 *   task      in   0 opens it, 1 forces, 2 frees it
 *   time      in   s
 *   motions   in   rim y, z (m) and rotation about x (rad); rail section y, z, rotation; place of the wheel along the rail (m, or -1 on
 *                  a rail of your own); z is down, all from where the wheel just touches
 *   friction  in   coefficient of friction, less than 0 for the study's
 *   forces    out  on the rim y, z (N) and torque about x (N m), on the section the same; Q and P are minus the first two
 *   error     out  0, or a RailspringCode; after RAILSPRING_CODE_NUMERICS (3) a shorter step may do */
#include "accepted_steps.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CONTACTS = 64 };
static AcceptedSteps contacts[CONTACTS];

void railspring_user_(const int *number, const int *task, const double *time, const double *motions, const double *friction, double *forces, int *error)
{
    *error = RAILSPRING_CODE_INPUT;
    if (*number < 1 || *number > CONTACTS) {
        fprintf(stderr, "contact %d: expected a number from 1 to %d\n", *number, CONTACTS);
        return;
    }
    AcceptedSteps *steps = &contacts[*number - 1];
    if (*task == 2) {
        accepted_steps_free(steps);
        *error = RAILSPRING_CODE_DONE;
    } else if (*task == 0) {
        const char *path = getenv("RAILSPRING_ELEMENT");
        accepted_steps_free(steps);
        if (!path) {
            fprintf(stderr, "contact %d: set RAILSPRING_ELEMENT\n", *number);
            return;
        }
        *error = (int)accepted_steps_open(steps, path, *friction < 0.0 ? NAN : *friction);
    } else if (steps->contact) {
        RailspringMotions at = {{motions[0], motions[1], motions[2]}, {motions[3], motions[4], motions[5]}, motions[6]};
        RailspringForces found;
        *error = (int)accepted_steps_evaluate(steps, *time, &at, &found);
        if (!*error) {
            memcpy(forces, found.rim, sizeof found.rim);
            memcpy(forces + 3, found.section, sizeof found.section);
        }
    }
    if (*error) fprintf(stderr, "contact %d at %g s: code %d: %s\n", *number, *time, *error, railspring_message());
}
