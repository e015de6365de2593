/* Chebyshev series at some points at a time, for gap.c and logarithmic_potential.c, which defines these. */

#ifndef LINECONTACT_LANES_H
#define LINECONTACT_LANES_H

#include "core.h"

#define LANES 8 /* points at a time: loops over them are vectorised */

/* q_j T_k(t_j), added to the sums of each lane, (terms, LANES). */
void add_moments(Size terms, const double *RESTRICT t, const double *RESTRICT charge, double *RESTRICT sums);
/* sum_k series_k T_k(t) by Clenshaw's rule, in lanes. */
void sum_series(Size terms, const double *RESTRICT series, const double *RESTRICT t, double *RESTRICT values);

#endif
