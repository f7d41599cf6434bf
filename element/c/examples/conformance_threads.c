/* Random states of contacts and random steps of units: 10,000 each.
 *
 * Two of these runs are made one after the other, without tries. Both are made again in two threads that share the element, with
 * states and steps between that are not taken. All forces have to be the same bytes. */
#include "conformance.h"
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 10000 };

typedef struct {
    const RailspringElement *element;
    const RailspringAbout *about;
    uint64_t seed;
    int tries; /* whether states and steps are tried that are not taken */
    RailspringForces *forces;
    RailspringHostForces *host_forces;
    int failed;
} Run;

/* Random states on a contact; every third one is taken. */
static void contact_run(Run *of)
{
    RailspringContact *contact = NULL;
    RailspringForces spare;
    uint64_t seed = of->seed, aside = 1000 + of->seed;
    if (railspring_contact_new(of->element, NAN, &contact)) of->failed++;
    for (int i = 0; i < COUNT && contact; i++) {
        RailspringMotions at = random_motions(&seed, of->about), other = random_motions(&aside, of->about);
        if (of->tries && i % 7 == 0 && railspring_contact_evaluate(contact, &other, &spare)) of->failed++;
        if (railspring_contact_evaluate(contact, &at, &of->forces[i])) of->failed++;
        if (i % 3 == 0 && railspring_contact_commit(contact)) of->failed++;
    }
    railspring_contact_free(contact);
}

/* Steps of 1 to 500 us on a unit. With tries, steps of other lengths and copies come between, and a few of them are refused. */
static void unit_run(Run *of)
{
    RailspringUnit *unit = NULL, *copy = NULL;
    RailspringHostForces spare;
    uint64_t seed = of->seed, aside = 1000 + of->seed;
    double time = 0.0;
    RailspringHost host = swinging_host(time, of->seed, of->about);
    if (railspring_unit_new(of->element, NAN, 9.81, &unit) || railspring_unit_start(unit, &host, 1, &spare)) of->failed++;
    for (int i = 0; i < COUNT && unit; i++) {
        double length = 5e-4 * exp(-6.2 * random_unit(&seed));
        for (int attempt = 0; of->tries && attempt < i % 3; attempt++) {
            double other = 5e-4 * exp(-6.2 * random_unit(&aside));
            host = swinging_host(time + other, of->seed, of->about);
            if (railspring_unit_advance(unit, other, &host, &spare)) of->failed++;
        }
        if (of->tries && i % 50 == 0) {
            host.hub[1] = NAN;
            if (railspring_unit_advance(unit, length, &host, &spare) != RAILSPRING_CODE_INPUT) of->failed++;
            railspring_unit_free(copy);
            copy = NULL;
            if (railspring_unit_clone(unit, &copy) || railspring_unit_restore(unit, copy)) of->failed++;
        }
        host = swinging_host(time + length, of->seed, of->about);
        if (railspring_unit_advance(unit, length, &host, &of->host_forces[i]) || railspring_unit_commit(unit)) of->failed++;
        time += length;
    }
    railspring_unit_free(unit);
    railspring_unit_free(copy);
}

static void *run(void *argument)
{
    contact_run(argument);
    unit_run(argument);
    return NULL;
}

void check_threads(const RailspringElement *element, const RailspringAbout *about)
{
    pthread_t threads[2];
    Run runs[4]; /* alone, and in threads with tries; two seeds each */
    for (int i = 0; i < 4; i++) {
        Run of = {element, about, 100 + (uint64_t)(i % 2), i >= 2, calloc(COUNT, sizeof(RailspringForces)), calloc(COUNT, sizeof(RailspringHostForces)), 0};
        if (!of.forces || !of.host_forces) exit(1);
        runs[i] = of;
    }
    for (int i = 0; i < 2; i++) run(&runs[i]);
    for (int i = 0; i < 2; i++)
        if (pthread_create(&threads[i], NULL, run, &runs[2 + i])) exit(1);
    for (int i = 0; i < 2; i++) pthread_join(threads[i], NULL);
    int states = 0, steps = 0;
    double largest = 0.0;
    for (int i = 0; i < COUNT; i++) {
        states += runs[0].forces[i].rim[1] != 0.0;
        steps += runs[0].host_forces[i].rim[1] != 0.0;
        largest = fmax(largest, -runs[0].host_forces[i].rim[1]);
    }
    for (int i = 0; i < 4; i++) expect(!runs[i].failed, "no evaluation and no step of a run fails");
    for (int i = 0; i < 2; i++) {
        expect(!memcmp(runs[i].forces, runs[2 + i].forces, COUNT * sizeof(RailspringForces)), "contacts in a thread, with tries, give the same bytes as alone");
        expect(!memcmp(runs[i].host_forces, runs[2 + i].host_forces, COUNT * sizeof(RailspringHostForces)), "units in a thread, with tries, give the same bytes as alone");
    }
    printf("two threads of %d states and %d steps each; %d and %d of the first touch; largest P of the steps %.1f kN\n", COUNT, COUNT, states, steps, 1e-3 * largest);
    for (int i = 0; i < 4; i++) free(runs[i].forces), free(runs[i].host_forces);
}
