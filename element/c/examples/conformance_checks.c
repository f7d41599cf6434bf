/* Copies, and steps that are tried and not taken, have to give the same bytes. Tangents have to be near differences of forces. */
#include "conformance.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TANGENTS = 200 };
static const double STEP = 1e-7, STEP_RAD = 1e-6; /* of the differences, m and rad */

static int same_contact(RailspringContact *one, RailspringContact *other, uint64_t seed, const RailspringAbout *about)
{
    int same = 1;
    for (int i = 0; i < 50; i++) {
        RailspringForces first, second;
        RailspringMotions at = random_motions(&seed, about);
        need(railspring_contact_evaluate(one, &at, &first), "evaluate");
        need(railspring_contact_evaluate(other, &at, &second), "evaluate");
        same &= !memcmp(&first, &second, sizeof first);
    }
    return same;
}

/* Evaluates and takes `count` random states. */
static void wander(RailspringContact *contact, uint64_t seed, int count, const RailspringAbout *about)
{
    RailspringForces forces;
    for (int i = 0; i < count; i++) {
        RailspringMotions at = random_motions(&seed, about);
        need(railspring_contact_evaluate(contact, &at, &forces), "evaluate");
        need(railspring_contact_commit(contact), "commit");
    }
}

static void copies_of_contacts(const RailspringElement *element, const RailspringAbout *about)
{
    RailspringContact *contact = NULL, *clone = NULL, *kept = NULL;
    need(railspring_contact_new(element, NAN, &contact), "contact");
    wander(contact, 11, 20, about);
    need(railspring_contact_clone(contact, &clone), "clone");
    need(railspring_contact_clone(contact, &kept), "clone");
    expect(same_contact(contact, clone, 12, about), "a clone of a contact gives the same bytes");

    /* An evaluation that is not taken does not change the next ones. */
    RailspringForces first, second, spare;
    uint64_t seed = 13;
    RailspringMotions at = random_motions(&seed, about), aside = random_motions(&seed, about);
    need(railspring_contact_evaluate(contact, &at, &first), "evaluate");
    for (int i = 0; i < 20; i++) {
        aside = random_motions(&seed, about);
        need(railspring_contact_evaluate(contact, &aside, &spare), "evaluate");
    }
    need(railspring_contact_evaluate(contact, &at, &second), "evaluate");
    expect(!memcmp(&first, &second, sizeof first), "an evaluation does not depend on those before it");
    need(railspring_contact_commit(contact), "commit");
    need(railspring_contact_evaluate(clone, &at, &spare), "evaluate");
    need(railspring_contact_commit(clone), "commit");
    expect(same_contact(contact, clone, 14, about), "nor does the state that is taken");

    /* A contact goes back to the state that was kept, after steps, evaluations and a start of its own. */
    wander(contact, 15, 10, about);
    need(railspring_contact_restore(contact, kept), "restore");
    expect(same_contact(contact, kept, 16, about), "a restored contact gives the same bytes");
    need(railspring_contact_start(contact, &aside, &first), "start");
    need(railspring_contact_restore(contact, kept), "restore");
    expect(same_contact(contact, kept, 17, about), "also after another start");
    need(railspring_contact_evaluate(kept, &at, &spare), "evaluate");
    need(railspring_contact_restore(contact, kept), "restore");
    expect(same_contact(contact, kept, 18, about), "and from one in which something was only evaluated");
    need(railspring_contact_restore(contact, contact), "restore of itself");
    expect(same_contact(contact, kept, 19, about), "a contact restored from itself");
    railspring_contact_free(contact);
    railspring_contact_free(clone);
    railspring_contact_free(kept);
}

/* Takes steps of 20 us with a host that swings; the forces of the last one go to `last`. */
static void ride(RailspringUnit *unit, int from, int steps, const RailspringAbout *about, RailspringHostForces *last)
{
    for (int i = 1; i <= steps; i++) {
        RailspringHost host = swinging_host((from + i) * 2e-5, 5, about);
        need(railspring_unit_advance(unit, 2e-5, &host, last), "advance");
        need(railspring_unit_commit(unit), "commit");
    }
}

static void copies_of_units(const RailspringElement *element, const RailspringAbout *about)
{
    RailspringUnit *unit = NULL, *clone = NULL, *kept = NULL;
    RailspringHostForces first, second, spare;
    RailspringHost first_host = swinging_host(0.0, 5, about);
    need(railspring_unit_new(element, NAN, 0.0, &unit), "unit");
    need(railspring_unit_start(unit, &first_host, 1, &first), "start");
    ride(unit, 0, 100, about, &first);
    need(railspring_unit_clone(unit, &clone), "clone");
    need(railspring_unit_clone(unit, &kept), "clone");
    for (int i = 0; i < 20; i++) {
        RailspringHost aside = swinging_host((105 + i) * 2e-5, 5, about);
        need(railspring_unit_advance(unit, 1e-6 * (i + 1), &aside, &spare), "advance");
    }
    ride(unit, 100, 100, about, &first);
    ride(clone, 100, 100, about, &second);
    expect(!memcmp(&first, &second, sizeof first), "a unit and its clone, one of which tried other steps, give the same bytes");
    need(railspring_unit_restore(unit, kept), "restore");
    ride(unit, 100, 100, about, &second);
    expect(!memcmp(&first, &second, sizeof first), "a restored unit gives the same bytes");
    railspring_unit_free(unit);
    railspring_unit_free(clone);
    railspring_unit_free(kept);
}

void check_copies(const RailspringElement *element, const RailspringAbout *about)
{
    copies_of_contacts(element, about);
    copies_of_units(element, about);
}


static int ascending(const void *one, const void *other)
{
    double difference = *(const double *)one - *(const double *)other;
    return (difference > 0.0) - (difference < 0.0);
}

/* How far a tangent is off differences of forces. Each of its four blocks of 3 by 3 is compared with its largest value. */
static double off_differences(const double tangent[36], double differences[6][6])
{
    double off = 0.0;
    for (int block = 0; block < 4; block++) {
        double scale = 0.0, most = 0.0;
        for (int i = 0; i < 9; i++) {
            int row = 3 * (block / 2) + i / 3, column = 3 * (block % 2) + i % 3;
            scale = fmax(scale, fabs(differences[column][row]));
            most = fmax(most, fabs(tangent[6 * row + column] - differences[column][row]));
        }
        if (most > 0.0) off = fmax(off, most / scale);
    }
    return off;
}

/* Half of the states and steps have to be within `half` of central differences, and nine of ten within `most`. */
static void within(const char *what, double *off, int count, double half, double most)
{
    qsort(off, (size_t)count, sizeof *off, ascending);
    printf("%s: off differences by at most %.2g %% in half of %d, %.2g %% in nine of ten\n", what, 100.0 * off[count / 2], count, 100.0 * off[count * 9 / 10]);
    expect(off[count / 2] < half && off[count * 9 / 10] < most, what);
}

static void contact_tangents(const RailspringElement *element, const RailspringAbout *about)
{
    RailspringContact *contact = NULL;
    RailspringForces forces, side[2];
    double off[TANGENTS], differences[6][6];
    uint64_t seed = 21;
    int count = 0;
    need(railspring_contact_new(element, NAN, &contact), "contact");
    while (count < TANGENTS) {
        RailspringMotions at = random_motions(&seed, about);
        need(railspring_contact_start(contact, &at, &forces), "start");
        at.rim[0] += 2e-5 * (random_unit(&seed) - 0.5);
        at.rim[1] += 2e-5 * (random_unit(&seed) - 0.5);
        need(railspring_contact_evaluate(contact, &at, &forces), "evaluate");
        if (forces.rim[1] > -1e4) continue; /* less than 10 kN */
        for (int k = 0; k < 6; k++) {
            double by = k % 3 == 2 ? STEP_RAD : STEP;
            for (int s = 0; s < 2; s++) {
                RailspringMotions moved = at;
                *(k < 3 ? &moved.rim[k] : &moved.section[k - 3]) += s ? by : -by;
                need(railspring_contact_evaluate(contact, &moved, &side[s]), "evaluate");
            }
            for (int i = 0; i < 3; i++) {
                differences[k][i] = (side[1].rim[i] - side[0].rim[i]) / (2.0 * by);
                differences[k][3 + i] = (side[1].section[i] - side[0].section[i]) / (2.0 * by);
            }
        }
        off[count++] = off_differences(forces.tangent, differences);
    }
    railspring_contact_free(contact);
    within("tangents of contacts", off, TANGENTS, 0.05, 0.15);
}

/* A unit does not divide steps of 3 us; its tangent is that of the last of its inner steps. */
static void unit_tangents(const RailspringElement *element, const RailspringAbout *about)
{
    RailspringUnit *unit = NULL;
    RailspringHostForces forces, side[2];
    double off[TANGENTS], differences[6][6], tangent[36], length = 3e-6;
    uint64_t seed = 22;
    int count = 0;
    need(railspring_unit_new(element, NAN, 0.0, &unit), "unit");
    while (count < TANGENTS) {
        double time = 10.0 * random_unit(&seed);
        RailspringHost host = swinging_host(time, 6, about);
        need(railspring_unit_start(unit, &host, 1, &forces), "start");
        for (int step = 1; step <= 5; step++) {
            host = swinging_host(time + step * length, 6, about);
            if (step > 1) need(railspring_unit_commit(unit), "commit");
            need(railspring_unit_advance(unit, length, &host, &forces), "advance");
        }
        if (forces.rim[1] > -1e4) continue;
        need(railspring_unit_tangent(unit, tangent), "tangent");
        for (int k = 0; k < 6; k++) {
            double by = k % 3 == 2 ? STEP_RAD : STEP;
            for (int s = 0; s < 2; s++) {
                RailspringHost moved = host;
                *(k < 3 ? &moved.hub[k] : &moved.section[k - 3]) += s ? by : -by;
                need(railspring_unit_advance(unit, length, &moved, &side[s]), "advance");
            }
            for (int i = 0; i < 3; i++) {
                differences[k][i] = (side[1].hub[i] - side[0].hub[i]) / (2.0 * by);
                differences[k][3 + i] = (side[1].section[i] - side[0].section[i]) / (2.0 * by);
            }
        }
        off[count++] = off_differences(tangent, differences);
    }
    railspring_unit_free(unit);
    within("tangents of units", off, TANGENTS, 0.05, 0.15);
}

void check_tangents(const RailspringElement *element, const RailspringAbout *about)
{
    contact_tangents(element, about);
    unit_tangents(element, about);
}
