/* Motions, places, lengths and forces out of range have to return RAILSPRING_CODE_INPUT and leave the state as it was. */
#include "conformance.h"
#include <math.h>
#include <string.h>

static void refused(RailspringCode code, const char *what)
{
    char text[300];
    snprintf(text, sizeof text, "%s: code %d, \"%.150s\"", what, (int)code, code ? railspring_message() : "");
    expect(code == RAILSPRING_CODE_INPUT && railspring_message()[0], text);
}

/* A contact and a unit with a last step, and what they return for the next one. */
typedef struct {
    RailspringContact *contact;
    RailspringUnit *unit;
    RailspringMotions motions;
    RailspringHost host;
    RailspringForces forces;
    RailspringHostForces host_forces;
} Pair;

static void next_step(Pair *pair, RailspringForces *forces, RailspringHostForces *host_forces)
{
    need(railspring_contact_evaluate(pair->contact, &pair->motions, forces), "evaluate");
    need(railspring_unit_advance(pair->unit, 2e-5, &pair->host, host_forces), "advance");
}

/* What was refused has to leave the state as it was. */
static void unchanged(Pair *pair, const char *what)
{
    RailspringForces forces;
    RailspringHostForces host_forces;
    next_step(pair, &forces, &host_forces);
    expect(!memcmp(&forces, &pair->forces, sizeof forces), what);
    expect(!memcmp(&host_forces, &pair->host_forces, sizeof host_forces), what);
}

/* A commit takes the last evaluation. Where that one was refused, it takes nothing, also none before it. */
static void commits_nothing(const Pair *pair)
{
    Pair copy = *pair;
    RailspringForces forces;
    RailspringHostForces host_forces;
    RailspringMotions motions = pair->motions;
    RailspringHost host = pair->host;
    need(railspring_contact_clone(pair->contact, &copy.contact), "clone");
    need(railspring_unit_clone(pair->unit, &copy.unit), "clone");
    for (int i = 0; i < 3; i++) {
        next_step(&copy, &forces, &host_forces);
        motions.rim[0] = host.hub[0] = i == 0 ? NAN : i == 1 ? 0.31 : pair->motions.rim[0];
        motions.place = host.place = i == 2 ? -2.0 : pair->motions.place;
        RailspringCode codes[] = {railspring_contact_evaluate(copy.contact, &motions, &forces), railspring_unit_advance(copy.unit, 2e-5, &host, &host_forces)};
        expect(codes[0] == codes[1], "a contact and a unit refuse the same");
        if (!codes[0]) continue; /* a rail without ends takes each place */
        need(railspring_contact_commit(copy.contact), "commit");
        need(railspring_unit_commit(copy.unit), "commit");
        next_step(&copy, &forces, &host_forces);
        expect(!memcmp(&forces, &pair->forces, sizeof forces), "a commit after a refused evaluation changes nothing");
        expect(!memcmp(&host_forces, &pair->host_forces, sizeof host_forces), "a commit after a refused step changes nothing");
        need(railspring_contact_restore(copy.contact, pair->contact), "restore");
        need(railspring_unit_restore(copy.unit, pair->unit), "restore");
    }
    railspring_contact_free(copy.contact);
    railspring_unit_free(copy.unit);
}

static void bad_values(Pair *pair, double bad, int in_velocities, int in_places)
{
    RailspringForces forces;
    RailspringHostForces host_forces;
    char what[100];
    for (int i = 0; i < (in_places ? 7 : 6); i++) {
        RailspringMotions motions = pair->motions;
        *(i < 3 ? &motions.rim[i] : i < 6 ? &motions.section[i - 3] : &motions.place) = bad;
        snprintf(what, sizeof what, "contact with %g in the motion %d", bad, i);
        refused(railspring_contact_evaluate(pair->contact, &motions, &forces), what);
        refused(railspring_contact_start(pair->contact, &motions, &forces), what);
    }
    for (int i = 0; i < 13; i++) {
        RailspringHost host = pair->host;
        double *of[] = {host.hub, host.hub_velocity, host.section, host.section_velocity};
        if (i == 12 ? !in_places : i / 3 % 2 && !in_velocities) continue;
        *(i < 12 ? &of[i / 3][i % 3] : &host.place) = bad;
        snprintf(what, sizeof what, "unit with %g in the motion %d", bad, i);
        refused(railspring_unit_advance(pair->unit, 2e-5, &host, &host_forces), what);
        refused(railspring_unit_start(pair->unit, &host, 0, &host_forces), what);
    }
    snprintf(what, sizeof what, "the state after %g", bad);
    unchanged(pair, what);
}

static void places(Pair *pair, const RailspringAbout *about)
{
    double beyond[] = {-1e-6, about->rail_length * 1.000001, -2.0, 1e6};
    RailspringForces forces;
    RailspringHostForces host_forces;
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond && !isnan(about->rail_length); i++) {
        RailspringMotions motions = pair->motions;
        RailspringHost host = pair->host;
        motions.place = host.place = beyond[i];
        refused(railspring_contact_evaluate(pair->contact, &motions, &forces), "contact beyond the rail");
        refused(railspring_contact_start(pair->contact, &motions, &forces), "contact beyond the rail");
        refused(railspring_unit_advance(pair->unit, 2e-5, &host, &host_forces), "unit beyond the rail");
        refused(railspring_unit_start(pair->unit, &host, 0, &host_forces), "unit beyond the rail");
    }
    unchanged(pair, "the state after a place beyond the rail");
    RailspringMotions other = pair->motions;
    other.place = RAILSPRING_OTHER_RAIL;
    expect(!railspring_contact_evaluate(pair->contact, &other, &forces), "a place on another rail");
    unchanged(pair, "the state after an evaluation on another rail was not taken");
}

/* Wheels that left the rail, and contacts under more than ten times the largest load. */
static void beyond_use(Pair *pair, double largest_force)
{
    static const double gone[][2] = {{0.15, 0.0}, {-0.2, 0.0}, {0.25, -0.02}, {-0.25, -0.05}};
    RailspringForces forces;
    RailspringHostForces host_forces;
    RailspringUnit *unit = NULL;
    char what[100];
    int overloads = 0;
    need(railspring_unit_clone(pair->unit, &unit), "clone");
    for (size_t i = 0; i < sizeof gone / sizeof *gone; i++) {
        RailspringMotions motions = pair->motions;
        RailspringHost host = pair->host;
        motions.rim[0] = host.hub[0] = gone[i][0];
        motions.rim[1] = host.hub[1] = gone[i][1];
        snprintf(what, sizeof what, "a wheel that is moved by %g and %g m", gone[i][0], gone[i][1]);
        refused(railspring_contact_evaluate(pair->contact, &motions, &forces), what);
        refused(railspring_unit_start(unit, &host, 0, &host_forces), what);
    }
    unchanged(pair, "the state after wheels that left the rail");
    for (double down = 2e-4; down < 0.01; down *= 1.2) {
        RailspringMotions motions = pair->motions;
        RailspringHost host = pair->host;
        motions.rim[1] += down;
        host.hub[1] += down;
        RailspringCode code = railspring_contact_evaluate(pair->contact, &motions, &forces);
        overloads += code == RAILSPRING_CODE_INPUT;
        snprintf(what, sizeof what, "a contact pressed down by %g m has code %d", down, (int)code);
        expect(code ? code == RAILSPRING_CODE_INPUT && overloads : hypot(forces.rim[0], forces.rim[1]) <= 10.0 * largest_force && !overloads, what);
        code = railspring_unit_advance(pair->unit, 2e-5, &host, &host_forces);
        snprintf(what, sizeof what, "a unit pressed down by %g m has code %d", down, (int)code);
        expect(code ? code == RAILSPRING_CODE_INPUT : hypot(host_forces.rim[0], host_forces.rim[1]) <= 10.0 * largest_force, what);
    }
    expect(overloads > 0, "an overload is refused");
    unchanged(pair, "the state after overloads");
    railspring_unit_free(unit);
}

void check_motions(const RailspringElement *element, const RailspringAbout *about)
{
    static const double lengths[] = {0.0, -1e-5, NAN, INFINITY, -INFINITY, 1.0};
    Pair pair;
    RailspringHostForces host_forces;
    RailspringMotions first = {{-1e-4, 1e-4, 0.0}, {0}, place_at(about, 0.5)}, second = {{-1.1e-4, 1.1e-4, 0.0}, {0}, place_at(about, 0.5)};
    RailspringHost begin = {{-1e-4, 1e-4, 0.0}, {0}, {0}, {0}, place_at(about, 0.5)};
    memset(&pair, 0, sizeof pair);
    need(railspring_contact_new(element, NAN, &pair.contact), "contact");
    need(railspring_unit_new(element, NAN, 0.0, &pair.unit), "unit");
    need(railspring_contact_start(pair.contact, &first, &pair.forces), "start");
    need(railspring_unit_start(pair.unit, &begin, 0, &host_forces), "start");
    pair.motions = second;
    pair.host = begin;
    pair.host.hub[1] += 1e-6;
    next_step(&pair, &pair.forces, &pair.host_forces);
    need(railspring_contact_commit(pair.contact), "commit");
    need(railspring_unit_commit(pair.unit), "commit");
    pair.motions.rim[0] -= 1e-5;
    pair.host.hub[1] += 1e-6;
    next_step(&pair, &pair.forces, &pair.host_forces);

    commits_nothing(&pair);
    bad_values(&pair, NAN, 1, 1);
    bad_values(&pair, INFINITY, 1, 1);
    bad_values(&pair, -INFINITY, 1, 1);
    bad_values(&pair, 0.301, 0, 0);
    bad_values(&pair, -0.301, 0, 0);
    bad_values(&pair, 20.0, 0, 0);
    bad_values(&pair, -1e300, 0, 0);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) refused(railspring_unit_advance(pair.unit, lengths[i], &pair.host, &host_forces), "a length out of range");
    unchanged(&pair, "the state after lengths out of range");
    places(&pair, about);
    beyond_use(&pair, about->largest_force);
    railspring_contact_free(pair.contact);
    railspring_unit_free(pair.unit);
}
