/* A host for the drivers of the user routines; they include this file.
 *
 * Rim and rail section have two displacements and a rotation each, on springs and dampers. The loads on the rim swing. */
#ifndef MOCK_HOST_H
#define MOCK_HOST_H
#include "railspring.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double MASS[6] = {600.0, 600.0, 40.0, 30.0, 30.0, 0.3};
static const double STIFFNESS[6] = {0.0, 0.0, 2e7, 3e7, 1e8, 5e6};
static const double DAMPING[6] = {5e3, 1e4, 1e3, 2e4, 2e4, 100.0};
static const double PLACE = 0.2775;

static void load(double time, double to[6])
{
    double on = time < 5e-3 ? pow(sin(0.5 * 3.14159265358979323846 * time / 5e-3), 2.0) : 1.0;
    for (int i = 0; i < 6; i++) to[i] = 0.0;
    to[0] = on * 15e3 * sin(2.0 * 3.14159265358979323846 * 25.0 * time);
    to[1] = on * (60e3 + 20e3 * sin(2.0 * 3.14159265358979323846 * 40.0 * time));
}

static void check(RailspringCode code, const char *what)
{
    if (code) {
        fprintf(stderr, "%s: code %d: %s\n", what, (int)code, railspring_message());
        exit((int)code);
    }
}

static RailspringMotions motions_of(const double x[6])
{
    RailspringMotions motions = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, PLACE};
    return motions;
}

/* Solves six equations in place, with row pivots. */
static inline void solve_six(double matrix[36], double right[6])
{
    for (int k = 0; k < 6; k++) {
        int pivot = k;
        for (int i = k + 1; i < 6; i++)
            if (fabs(matrix[6 * i + k]) > fabs(matrix[6 * pivot + k])) pivot = i;
        for (int j = 0; j < 6; j++) {
            double swap = matrix[6 * k + j];
            matrix[6 * k + j] = matrix[6 * pivot + j];
            matrix[6 * pivot + j] = swap;
        }
        double swap = right[k];
        right[k] = right[pivot];
        right[pivot] = swap;
        for (int i = k + 1; i < 6; i++) {
            double factor = matrix[6 * i + k] / matrix[6 * k + k];
            for (int j = k; j < 6; j++) matrix[6 * i + j] -= factor * matrix[6 * k + j];
            right[i] -= factor * right[k];
        }
    }
    for (int k = 5; k >= 0; k--) {
        for (int j = k + 1; j < 6; j++) right[k] -= matrix[6 * k + j] * right[j];
        right[k] /= matrix[6 * k + k];
    }
}
#endif
