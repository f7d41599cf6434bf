/* Shared parts of the conformance program; conformance.c says what it is for and how it is built. */
#ifndef CONFORMANCE_H
#define CONFORMANCE_H
#include "railspring.h"
#include <stdio.h>

/* Counts a check, and prints it where it failed. */
void expect(int holds, const char *what);
/* Ends the program where a call that has to work did not. */
void need(RailspringCode code, const char *what);
/* A number from 0 to 1; the sequence is the same on all machines. */
double random_unit(uint64_t *state);
/* A place on the study's rail at a share of its length, or RAILSPRING_OTHER_RAIL where the rail has no ends. */
double place_at(const RailspringAbout *about, double share);
/* Motions in the range of the study: rim, section and place are random, and most of them touch. */
RailspringMotions random_motions(uint64_t *state, const RailspringAbout *about);
/* A host that swings, lifts off and moves along the rail; its velocities are those of its displacements. */
RailspringHost swinging_host(double time, uint64_t seed, const RailspringAbout *about);

/* Writes and repeats test vectors. */
void write_vectors(const RailspringElement *element, const RailspringAbout *about);
void repeat_vectors(const RailspringElement *element, FILE *file, double tolerance);
/* Each function checks one group; `path` is that of the element file. */
void check_errors(const char *path, const RailspringElement *element, const RailspringAbout *about);
void check_motions(const RailspringElement *element, const RailspringAbout *about);
void check_files(const char *path);
void check_copies(const RailspringElement *element, const RailspringAbout *about);
void check_tangents(const RailspringElement *element, const RailspringAbout *about);
void check_threads(const RailspringElement *element, const RailspringAbout *about);
#endif
