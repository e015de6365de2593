/* Declarations of collocation.c, gap.c, logarithmic_potential.c and profile.c. */

#ifndef LINECONTACT_KERNELS_H
#define LINECONTACT_KERNELS_H

#include "hierarchical.h"

/* Chebyshev series at some points at a time: loops over them are vectorised. */
#define LANES 8

/* q_j T_k(t_j), added to the sums of each lane, (terms, LANES). */
void add_moments(Size terms, const double *RESTRICT t, const double *RESTRICT charge, double *RESTRICT sums);
/* sum_k series_k T_k(t) by Clenshaw's rule, in lanes. */
void sum_series(Size terms, const double *RESTRICT series, const double *RESTRICT t, double *RESTRICT values);

/* Sizes that numbers are rounded up to: chebyshev._size_ladder. */
typedef struct {
    Size count;
    int64_t size[MOST_SIZES];
} Sizes;

void lists_of_sizes(Sizes *modes, Sizes *nodes);
double coupling_modes(double width, double clearance, double digits); /* chebyshev.coupling_modes of e^-digits */
/* collocation.sizes, with the lists of modes and of nodes; 0 where patches overlap, or no number is enough. */
int sizes_of(const Sizes *lists, Size n, const double *left, const double *right, double digits, double order,
             const double *least, int64_t *nodes, int64_t *modes);

/* The Taylor table of a profile; scale: points of it by length. */
typedef struct {
    const double *table;
    Size rows;
    double scale;
} Surface;

typedef struct {
    double *series, *x, *columns, *tail, *energy; /* (n, most), (unknowns,), two rows of that, (2, 2 n), one number */
} RightHandSides;

/* The largest number of nodes of a patch, of which no other has more modes; 0 with an exception. */
Size most_nodes(Size n, const Table *sampling, const Table *coupled);
/* collocation.right_hand_sides; 0 with an exception. */
int right_hand_sides(const Surface *surface, Size n, const double *left, const double *right, double level,
                     const Table *sampling, const Table *coupled, Size most, const RightHandSides *to);
/* collocation.all_charges, (patches, terms). */
void charges_of_modes(const Table *tables, Size patches, Size terms, const double *series, const double *skeleton,
                      double *charges);
/* sensitivities.stress_intensity_jacobian, (2 n, 2 n); 0 without memory. */
int jacobian_of(Size n, const double *half_width, const int64_t *modes, const double *intensity,
                const double *compliance, const double *slope, double *values);
/* gap.near_patches, added to values. */
void add_near_patches(Size patches, const double *center, const double *half_width, const int64_t *nodes,
                      const Table *tables, Size terms, const double *charges, const double *skeleton, Size n,
                      const int64_t *gap, const double *x, double *values);
/* gap.low_points of grids, into `found`, rows of 4; how many there are, -1 with an exception. */
Size low_points(Size gaps, const double *right, const double *width, const int64_t *sizes, const int64_t *counts,
                const double *samples, Size rows, const double *table, Size n_highest, const double *highest,
                double level, double *found);
#define BOX_TERMS 20 /* logarithmic_potential.BOX_TERMS */
/* logarithmic_potential.box_moments, (boxes, BOX_TERMS); 0 with an exception. */
int moments_of_boxes(Size n, const double *position, const double *charge, Size boxes, double *moments);
/* logarithmic_potential.pair_by_pair and box_potential; 0 with an exception. */
void pairs_potential(Size n, const double *points, Size m, const double *sources, const double *charge, double *values);
int boxes_potential(Size n, const double *x, const double *points, Size m, const double *position,
                    const double *sources, const double *charge, Size boxes, const double *series, double *values);

/* int_0^x sqrt(1 + h'^2) dx: adhesion.TrueLength. */
typedef struct {
    Size panels, terms;
    const double *start, *width, *series;
    double whole;
} Length;

double length_up_to(const Length *length, double x);

#endif
