/* Checks a build of the library, a binding to another language, or a port: test vectors, errors, copies, threads.
 *
 * Build and run:
 *   cc -std=c99 -O2 conformance*.c -L. -lrailspring_c -lm -lpthread -o conformance
 *   ./conformance pair.rse vectors.json [RELATIVE_TOLERANCE]     repeats the vectors, then runs all checks
 *   ./conformance --write pair.rse >vectors.json                 writes vectors
 * The exit status is 0 where everything holds. conformance_vectors.c describes the vectors.
 *
 * The files: conformance_vectors.c; conformance_errors.c (input that is refused); conformance_motions.c (motions out of
 * range); conformance_checks.c (copies and tangents); conformance_threads.c (random states and steps in two threads). */
#include "conformance.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int checks, failures;

void expect(int holds, const char *what)
{
    checks++;
    if (!holds) {
        failures++;
        printf("FAILED: %s\n", what);
    }
}

void need(RailspringCode code, const char *what)
{
    if (code != RAILSPRING_CODE_DONE) {
        fprintf(stderr, "%s: code %d: %s\n", what, (int)code, railspring_message());
        exit((int)code);
    }
}

double random_unit(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t bits = *state;
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((bits ^ (bits >> 31)) >> 11) / 9007199254740992.0;
}

double place_at(const RailspringAbout *about, double share)
{
    return isnan(about->rail_length) ? RAILSPRING_OTHER_RAIL : about->rail_length * share;
}

/* The height (m) at which the study's wheel about touches, where it stands y (m) to the side. */
static double touches(double y)
{
    return y < 0.0 ? -0.012 * y : -14.0 * y * y;
}

RailspringMotions random_motions(uint64_t *state, const RailspringAbout *about)
{
    double of[7];
    for (int i = 0; i < 7; i++) of[i] = random_unit(state);
    double y = -5e-3 + 9e-3 * of[0];
    RailspringMotions motions = {
        {y, touches(y) + 2e-4 * (of[1] - 0.25), 1e-3 * (of[2] - 0.5)},
        {1e-4 * (of[3] - 0.5), 1e-4 * (of[4] - 0.5), 1e-3 * (of[5] - 0.5)},
        place_at(about, of[6]),
    };
    return motions;
}

/* Adds a swing of an amplitude and a frequency (Hz) to a displacement and its velocity. */
static void swing(double time, double amplitude, double frequency, double phase, double *displacement, double *velocity)
{
    double turn = 2.0 * 3.14159265358979323846 * frequency;
    *displacement += amplitude * sin(turn * time + phase);
    *velocity += amplitude * turn * cos(turn * time + phase);
}

RailspringHost swinging_host(double time, uint64_t seed, const RailspringAbout *about)
{
    static const double amplitude[6] = {2e-3, 1e-4, 2e-5, 2e-5, 2e-5, 1e-4};
    static const double frequency[6] = {7.0, 90.0, 35.0, 150.0, 110.0, 60.0};
    RailspringHost host = {{-1e-3, 3e-5, 0.0}, {0}, {0}, {0}, 0.0};
    for (int i = 0; i < 6; i++) {
        double phase = 6.28 * random_unit(&seed), *displacement = i < 3 ? &host.hub[i] : &host.section[i - 3];
        swing(time, amplitude[i], frequency[i], phase, displacement, i < 3 ? &host.hub_velocity[i] : &host.section_velocity[i - 3]);
    }
    double y = host.hub[0];
    host.hub[1] += touches(y);
    host.hub_velocity[1] += (y < 0.0 ? -0.012 : -28.0 * y) * host.hub_velocity[0];
    host.place = place_at(about, 0.5 - 0.45 * cos(3.0 * time));
    return host;
}

int main(int count, char **arguments)
{
    int writes = count == 3 && !strcmp(arguments[1], "--write");
    if (!writes && count != 3 && count != 4) {
        fprintf(stderr, "usage: conformance FILE VECTORS [TOLERANCE] | conformance --write FILE\n");
        return 2;
    }
    const char *path = writes ? arguments[2] : arguments[1];
    RailspringElement *element = NULL;
    RailspringAbout about;
    need(railspring_element_open(path, &element), path);
    need(railspring_element_about(element, &about), "about");
    if (writes) {
        write_vectors(element, &about);
        railspring_element_free(element);
        return fflush(stdout) ? 1 : 0;
    }
    FILE *file = fopen(arguments[2], "r");
    if (!file) return perror(arguments[2]), 2;
    printf("railspring %s\n", railspring_version());
    repeat_vectors(element, file, count == 4 ? atof(arguments[3]) : 1e-9);
    fclose(file);
    check_errors(path, element, &about);
    check_motions(element, &about);
    check_files(path);
    check_copies(element, &about);
    check_tangents(element, &about);
    check_threads(element, &about);
    railspring_element_free(element);
    printf("%d checks, %d failed\n", checks, failures);
    return failures ? 1 : 0;
}
