/* What the parts of the hierarchical solver share: leaf.c, separated_kernel.c, hierarchical.c.  Matrices by columns. */

#ifndef LINECONTACT_HIERARCHICAL_H
#define LINECONTACT_HIERARCHICAL_H

#include "core.h"

#define MOST_RANGES 64 /* for which tables are held in one call */

/* separated_kernel.modes_and_core of a half range: `count` coefficients of each of q - 2 functions, of which the first
   are even, and the core, (q, q). */
typedef struct {
    Size steps, count, even, q;
    const double *modes, *core;
} Range;

/* What is asked of Python, which holds it in a list; NULL or below 0 with an exception. */
typedef struct {
    int (*table)(PyObject *held, Packing packing, Size n, Table *table);             /* chebyshev.packed_... */
    int (*range)(PyObject *held, Size steps, double accuracy, Range *range);         /* modes_and_core */
    int (*coefficients)(Size n, double *samples);                                    /* chebyshev.coefficients */
} Asked;

extern Asked asked;

/* Nodes, patches and their tables; what an effect adds to the matrix, and to the edge vectors, (2, n), or NULL; sine and
   cosine of half of each position, one behind the other; what edges do at edges, two of each patch, above the diagonal,
   and, a column each, the slopes that they make at edges. */
typedef struct {
    Call *call;
    Size n, largest, per_patch, edges; /* per_patch: columns of the edges of each patch: none, 2 or 4 */
    const double *x, *half, *left, *right, *half_width, *addition, *edge_fields;
    double *compliance, *slopes; /* (edges, edges) */
    const Table *tables;
    double uniform, accuracy;
    Range ranges[MOST_RANGES];
    Size n_ranges;
} System;

/* A solved cluster: b^T A'^-1 b of the columns shared from above, of these with its edges, two of each patch, and with
   the slopes there.  Of a leaf: L with A' = L L^T, and Y^T = b^T L^-T, (m, n); of a pair: M V of the shared columns,
   (2 q, shared), and its halves. */
typedef struct Cluster {
    Size n, m, shared, edges, rank;
    double *gram, *with_edges, *with_slopes, *factor, *solved, *response;
    struct Cluster *halves;
} Cluster;

/* Right-hand sides at the nodes of a cluster from node `first` of all on, by columns `ld` numbers apart, and those
   shared from above. */
typedef struct Columns {
    const struct Columns *above;
    const double *values;
    Size first, ld, count, shared; /* `shared` counts them all */
} Columns;

typedef enum { FAILED = -1, NOT_DEFINITE = 0, SOLVED = 1 } Status;

/* hierarchical.solved of k columns, (k, n): into compliance, slope compliance, gram, charges, q at the edges, slopes. */
Status solved_system(System *system, Size patches, Size k, const double *columns, double *const *made);

/* hierarchical._leaf of the patches from `first` to before `last`, whose sizes the leaf says. */
Status solved_leaf(const System *system, Size first, Size last, const Columns *columns, Cluster *leaf);

/* separated_kernel.separated_kernel between the patches before and from `middle`: its columns, whose values the caller
   frees; NULL with an exception. */
const Range *widened(System *system, Size first, Size middle, Size last, Columns *added);

#endif
