/* A descent on its way: walk.c. */

#ifndef LINECONTACT_WALK_H
#define LINECONTACT_WALK_H

#include "descent.h"

typedef enum { ERROR = -1, AGAIN, CONVERGED, TOUCHED, STUCK, ILL_CONDITIONED, CLOSING, VANISHING } Verdict;

typedef struct {
    Setting setting;
    double residual, allowed, largest, radius, wavelength, rms_curvature;
    int looks_ahead;
    Size n_crests, n_occupied, evaluations, n_gone;
    const double *crests, *occupied_left, *occupied_right;
    State floor, here; /* the nodes and modes of the first alone; the second is known where n > 0 */
    Size n;
    double *left, *right, *seen_left, *seen_right; /* in one piece, with `gone` behind */
    int64_t *gone;
    Size n_touching;
    double *touching, *depth; /* in one piece, with the gaps behind */
    int64_t *in_gap;
} Walk;

/* strides.strides: its verdict, and the rounds that remain. */
int strides(Walk *walk, Size *rounds);
void release_walk(Walk *walk);

#endif
