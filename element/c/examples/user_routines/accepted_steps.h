/* A contact for programs that integrate by themselves, may step back, and do not say which steps they accept.
 *
 * simpack_user_force.c and gensys_user.c include this file; it needs railspring.h alone. It is UNTRIED in Simpack and GENSYS.
 *
 * The time of a call tells what the program does. A later time than that of the last call accepts the last call as the end of a
 * step. The same time is an iteration. An earlier time gives the last step up. The last ACCEPTED_STEPS_KEPT states are
 * kept. The program may therefore also go back behind an accepted step.
 *
 * This suits implicit methods, and methods that evaluate at the ends of steps (Heun's). A method with stages inside a step
 * (Runge-Kutta) makes friction go through the motions of the stages. A program that reports accepted steps should call
 * accepted_steps_accept then. */
#ifndef ACCEPTED_STEPS_H
#define ACCEPTED_STEPS_H
#include "railspring.h"
#include <stdlib.h>

enum { ACCEPTED_STEPS_KEPT = 8 };

typedef struct {
    RailspringContact *contact;                    /* its last step ends at `time` of the newest kept one */
    RailspringContact *kept[ACCEPTED_STEPS_KEPT];  /* a ring of accepted states */
    double time[ACCEPTED_STEPS_KEPT];
    int count, newest;                             /* how many are kept, and where the newest is */
    int tried;                                     /* a good evaluation is waiting to be accepted */
    double tried_time;
    long accepted, given_up;
} AcceptedSteps;

static void accepted_steps_free(AcceptedSteps *steps)
{
    railspring_contact_free(steps->contact);
    for (int i = 0; i < ACCEPTED_STEPS_KEPT; i++) railspring_contact_free(steps->kept[i]);
    AcceptedSteps none = {0};
    *steps = none;
}

/* A coefficient of friction that is not a number is that of the study. */
static RailspringCode accepted_steps_open(AcceptedSteps *steps, const char *path, double coefficient)
{
    RailspringElement *element = NULL;
    AcceptedSteps none = {0};
    *steps = none;
    RailspringCode code = railspring_element_open(path, &element);
    if (!code) code = railspring_contact_new(element, coefficient, &steps->contact);
    for (int i = 0; i < ACCEPTED_STEPS_KEPT && !code; i++) code = railspring_contact_clone(steps->contact, &steps->kept[i]);
    railspring_element_free(element); /* the contacts keep what they need */
    if (code) accepted_steps_free(steps);
    return code;
}

static RailspringCode accepted_steps_keep(AcceptedSteps *steps, double time)
{
    steps->newest = (steps->newest + 1) % ACCEPTED_STEPS_KEPT;
    steps->time[steps->newest] = time;
    if (steps->count < ACCEPTED_STEPS_KEPT) steps->count++;
    return railspring_contact_restore(steps->kept[steps->newest], steps->contact);
}

/* Takes the last evaluation as the end of a step. */
static RailspringCode accepted_steps_accept(AcceptedSteps *steps)
{
    if (!steps->tried) return RAILSPRING_CODE_DONE;
    RailspringCode code = railspring_contact_commit(steps->contact);
    steps->tried = 0;
    steps->accepted++;
    return code ? code : accepted_steps_keep(steps, steps->tried_time);
}

static RailspringCode accepted_steps_evaluate(AcceptedSteps *steps, double time, const RailspringMotions *motions, RailspringForces *forces)
{
    RailspringCode code = RAILSPRING_CODE_DONE;
    if (steps->count == 0 || (steps->count == 1 && !steps->tried && time <= steps->time[steps->newest])) {
        code = railspring_contact_start(steps->contact, motions, forces); /* the program still looks for its start */
        steps->count = 0;
        return code ? code : accepted_steps_keep(steps, time);
    }
    if (steps->tried && time > steps->tried_time) code = accepted_steps_accept(steps);
    if (steps->tried && time < steps->tried_time) steps->tried = 0, steps->given_up++;
    int back = 0;
    while (!code && time <= steps->time[steps->newest] && steps->count > 1) {
        steps->newest = (steps->newest + ACCEPTED_STEPS_KEPT - 1) % ACCEPTED_STEPS_KEPT;
        steps->count--;
        back = 1;
    }
    if (!code && back) code = railspring_contact_restore(steps->contact, steps->kept[steps->newest]);
    if (!code && time < steps->time[steps->newest]) code = RAILSPRING_CODE_NUMERICS; /* farther back than what is kept */
    if (!code) code = railspring_contact_evaluate(steps->contact, motions, forces);
    steps->tried = !code;
    steps->tried_time = time;
    return code;
}
#endif
