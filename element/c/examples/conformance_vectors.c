/* Test vectors of the conformance program: 160 states of contacts and 40 of units.
 *
 * They are an array of JSON, in which each vector is an array on a line of its own. Its first word says what to do:
 *   "comment", TEXT                  nothing
 *   "contact", COEFFICIENT           makes a contact; null is the study's coefficient of friction
 *   "rest", NINE VALUES              gives it the section's flexibility by rows
 *   "start"|"try"|"step", STATE      calls railspring_contact_start, _evaluate, or _evaluate and then _commit
 *   "unit", COEFFICIENT, GRAVITY     makes a unit
 *   "unit_start"|"unit_try"|"unit_step", UNIT STATE   the same for the unit
 *   "end"                            nothing
 * A STATE has 49 numbers: rim y, z, rotation; section y, z, rotation; place; six forces; 36 of the tangent by rows.
 * A UNIT STATE has 23: `bent` or the step's length (s); hub and its velocity; section and its velocity; place; nine forces.
 *
 * A number may differ by the tolerance (1e-9) times the largest one of its unit in its line. The units are N and N m of
 * forces, and N/m, N and N m of the tangent.
 * The library balances forces to about 1 N. A port whose arithmetic rounds otherwise may therefore need 1e-4. */
#include "conformance.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CONTACT_INPUT = 7, CONTACT_OUTPUT = 42, UNIT_INPUT = 14, UNIT_OUTPUT = 9, MOST = 49, LINE = 4096 };

/* The numbers of a line in the order of the file. The structures hold doubles alone, without gaps. */
static void values_of_contact(const RailspringMotions *motions, const RailspringForces *forces, double *to)
{
    memcpy(to, motions, CONTACT_INPUT * sizeof *to);
    memcpy(to + CONTACT_INPUT, forces, CONTACT_OUTPUT * sizeof *to);
}

static void values_of_unit(double first, const RailspringHost *host, const RailspringHostForces *forces, double *to)
{
    to[0] = first;
    memcpy(to + 1, host, (UNIT_INPUT - 1) * sizeof *to);
    memcpy(to + UNIT_INPUT, forces, UNIT_OUTPUT * sizeof *to);
}

static void write_line(const char *action, int count, const double *values)
{
    printf("[\"%s\"", action);
    for (int i = 0; i < count; i++) isnan(values[i]) ? printf(",null") : printf(",%.17g", values[i]);
    printf("],\n");
}

/* Four paths of ten states; on each path friction sticks and slides, and the last state is far from the others. */
static void write_contact(const RailspringElement *element, const RailspringAbout *about, double coefficient, const double *rest, uint64_t *state)
{
    RailspringContact *contact = NULL;
    RailspringForces forces;
    double values[MOST];
    need(railspring_contact_new(element, coefficient, &contact), "contact");
    write_line("contact", 1, &coefficient);
    if (rest) {
        need(railspring_contact_set_section_rest(contact, rest), "rest");
        write_line("rest", 9, rest);
    }
    for (int path = 0; path < 4; path++) {
        RailspringMotions at = random_motions(state, about);
        if (path == 3) at.place = RAILSPRING_OTHER_RAIL;
        need(railspring_contact_start(contact, &at, &forces), "start");
        values_of_contact(&at, &forces, values);
        write_line("start", CONTACT_INPUT + CONTACT_OUTPUT, values);
        for (int step = 1; step < 10; step++) {
            RailspringMotions next = step == 9 ? random_motions(state, about) : at;
            next.rim[0] += 2e-5 * (random_unit(state) - 0.5);
            next.rim[1] += 2e-5 * (random_unit(state) - 0.5);
            next.section[2] += 1e-5 * (random_unit(state) - 0.5);
            need(railspring_contact_evaluate(contact, &next, &forces), "evaluate");
            int takes = random_unit(state) < 0.7;
            values_of_contact(&next, &forces, values);
            write_line(takes ? "step" : "try", CONTACT_INPUT + CONTACT_OUTPUT, values);
            if (takes) {
                need(railspring_contact_commit(contact), "commit");
                at = next;
            }
        }
    }
    railspring_contact_free(contact);
}

/* Twenty states of a unit, whose steps have many lengths. */
static void write_unit(const RailspringElement *element, const RailspringAbout *about, double bent, double gravity, uint64_t *state)
{
    RailspringUnit *unit = NULL;
    RailspringHostForces forces;
    double values[MOST], of_unit[2] = {NAN, gravity}, time = 0.0;
    RailspringHost host = swinging_host(time, 1, about);
    need(railspring_unit_new(element, NAN, gravity, &unit), "unit");
    write_line("unit", 2, of_unit);
    need(railspring_unit_start(unit, &host, bent != 0.0, &forces), "start");
    values_of_unit(bent, &host, &forces, values);
    write_line("unit_start", UNIT_INPUT + UNIT_OUTPUT, values);
    for (int step = 1; step < 20; step++) {
        double length = 5e-4 * exp(-4.0 * random_unit(state));
        host = swinging_host(time + length, 1, about);
        need(railspring_unit_advance(unit, length, &host, &forces), "advance");
        int takes = random_unit(state) < 0.7;
        values_of_unit(length, &host, &forces, values);
        write_line(takes ? "unit_step" : "unit_try", UNIT_INPUT + UNIT_OUTPUT, values);
        if (takes) {
            need(railspring_unit_commit(unit), "commit");
            time += length;
        }
    }
    railspring_unit_free(unit);
}

void write_vectors(const RailspringElement *element, const RailspringAbout *about)
{
    static const double rest[9] = {2e-10, 1e-11, 1e-9, 1e-11, 1e-10, 2e-10, 1e-9, 2e-10, 2e-8};
    uint64_t state = 1;
    printf("[\n[\"comment\",\"contact: rim y, z (m), rotation; section y, z (m), rotation; place (m); six forces (N, N m); 36 of the tangent\"],\n");
    printf("[\"comment\",\"unit: bent or length (s); hub; its velocity; section; its velocity; place; hub, section and rim forces (N, N m)\"],\n");
    write_contact(element, about, NAN, NULL, &state);
    write_contact(element, about, NAN, rest, &state);
    write_contact(element, about, 0.3, NULL, &state);
    write_contact(element, about, 0.0, NULL, &state);
    write_unit(element, about, 0.0, 0.0, &state);
    write_unit(element, about, 1.0, 9.81, &state);
    printf("[\"end\"]\n]\n");
}

/* Reads `count` numbers after commas to the end of an array; 0 where they are not there. */
static int numbers(const char *text, int count, double *to)
{
    for (int i = 0; i < count; i++) {
        char *end;
        if (*text++ != ',') return 0;
        if (!strncmp(text, "null", 4)) {
            to[i] = NAN;
            text += 4;
            continue;
        }
        to[i] = strtod(text, &end);
        if (end == text) return 0;
        text = end;
    }
    return *text == ']';
}

/* Which unit a number has: N, N m; N/m, N, N m of the tangent. Each third force and each third motion is one of rotation. */
static int unit_of(int number, int forces)
{
    if (number < forces) return number % 3 == 2;
    number -= forces;
    return 2 + (number / 6 % 3 == 2) + (number % 3 == 2);
}

/* The largest difference of `count` numbers over the largest value of the unit; the first `forces` are no tangent. */
static double difference(const double *expected, const double *got, int count, int forces)
{
    double scale[5] = {0}, largest = 0.0;
    for (int i = 0; i < count; i++) scale[unit_of(i, forces)] = fmax(scale[unit_of(i, forces)], fabs(expected[i]));
    for (int i = 0; i < count; i++) {
        double off = fabs(got[i] - expected[i]);
        if (isnan(off)) return INFINITY;
        if (off > 0.0) largest = fmax(largest, off / scale[unit_of(i, forces)]); /* infinite where all have to be 0 */
    }
    return largest;
}

static double repeat_contact(RailspringContact *contact, char action, const double *value, const char *what)
{
    RailspringMotions motions;
    RailspringForces forces;
    double got[MOST];
    memcpy(&motions, value, sizeof motions);
    if (action == 'b') {
        need(railspring_contact_start(contact, &motions, &forces), what);
    } else {
        need(railspring_contact_evaluate(contact, &motions, &forces), what);
        if (action == 's') need(railspring_contact_commit(contact), what);
    }
    values_of_contact(&motions, &forces, got);
    return difference(value + CONTACT_INPUT, got + CONTACT_INPUT, CONTACT_OUTPUT, 6);
}

static double repeat_unit(RailspringUnit *unit, char action, const double *value, const char *what)
{
    RailspringHost host;
    RailspringHostForces forces;
    double got[MOST];
    memcpy(&host, value + 1, sizeof host);
    if (action == 'b') {
        need(railspring_unit_start(unit, &host, value[0] != 0.0, &forces), what);
    } else {
        need(railspring_unit_advance(unit, value[0], &host, &forces), what);
        if (action == 's') need(railspring_unit_commit(unit), what);
    }
    values_of_unit(value[0], &host, &forces, got);
    return difference(value + UNIT_INPUT, got + UNIT_INPUT, UNIT_OUTPUT, UNIT_OUTPUT);
}

void repeat_vectors(const RailspringElement *element, FILE *file, double tolerance)
{
    char line[LINE], what[96];
    RailspringContact *contact = NULL;
    RailspringUnit *unit = NULL;
    double value[MOST], largest = 0.0;
    int row = 0, states = 0;
    while (fgets(line, sizeof line, file)) {
        row++;
        const char *name = line + 2; /* after [" */
        if (line[0] != '[' || line[1] != '"') continue; /* of the whole array */
        if (!strncmp(name, "comment\"", 8) || !strncmp(name, "end\"", 4)) continue;
        const char *rest = name + strcspn(name, "\"");
        if (*rest) rest++;
        snprintf(what, sizeof what, "vectors, line %d", row);
        int of_unit = !strncmp(name, "unit_", 5);
        const char *word = of_unit ? name + 5 : name;
        char action = !strncmp(word, "start\"", 6) ? 'b' : !strncmp(word, "step\"", 5) ? 's' : !strncmp(word, "try\"", 4) ? 't' : 0;
        if (!strncmp(name, "contact\"", 8) && numbers(rest, 1, value)) {
            railspring_contact_free(contact);
            contact = NULL;
            need(railspring_contact_new(element, value[0], &contact), what);
        } else if (!strncmp(name, "unit\"", 5) && numbers(rest, 2, value)) {
            railspring_unit_free(unit);
            unit = NULL;
            need(railspring_unit_new(element, value[0], value[1], &unit), what);
        } else if (!strncmp(name, "rest\"", 5) && numbers(rest, 9, value)) {
            need(railspring_contact_set_section_rest(contact, value), what);
        } else if (action && numbers(rest, of_unit ? UNIT_INPUT + UNIT_OUTPUT : CONTACT_INPUT + CONTACT_OUTPUT, value)) {
            double off = of_unit ? repeat_unit(unit, action, value, what) : repeat_contact(contact, action, value, what);
            largest = fmax(largest, off);
            states++;
            expect(off <= tolerance, what);
        } else {
            fprintf(stderr, "%s: cannot be read\n", what);
            exit(2);
        }
    }
    railspring_contact_free(contact);
    railspring_unit_free(unit);
    expect(states > 0, "vectors with states");
    printf("%d states, largest relative difference %.3g\n", states, largest);
}
