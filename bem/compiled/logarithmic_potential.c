/* Potentials of charges on the circle: logarithmic_potential.py; and Chebyshev series in lanes. */

#include "kernels.h"

/* sum_j charge_j log|a first_j + b second_j|, added in lanes. */
VECTORISED static void add_potential(Size n, const double *RESTRICT a, const double *RESTRICT b,
                                     const double *RESTRICT first, const double *RESTRICT second,
                                     const double *RESTRICT charge, double *RESTRICT values)
{
    double sum[LANES] = {0};
    Size i, k;
    for (k = 0; k < n; k++)
        for (i = 0; i < LANES; i++)
            sum[i] += charge[k] * log_of_size(a[i] * first[k] + b[i] * second[k]);
    for (i = 0; i < LANES; i++)
        values[i] += sum[i];
}

void pairs_potential(Size n, const double *points, Size m, const double *sources, const double *charge, double *values)
{
    Size i, k;
    for (i = 0; i < n; i += LANES) {
        Size size = n - i < LANES ? n - i : LANES;
        double a[LANES], b[LANES], sum[LANES] = {0};
        for (k = 0; k < LANES; k++) {
            a[k] = points[i + (k < size ? k : 0)];
            b[k] = points[n + i + (k < size ? k : 0)];
        }
        add_potential(m, a, b, sources, sources + m, charge, sum);
        memcpy(values + i, sum, (size_t)size * sizeof(double));
    }
}

/* Positions by the equal boxes of the circle in which they lie, as many as a power of two: where each box starts in
   their order, (boxes + 1,); the order; and the places across the boxes in (-1, 1), in it.  PyMem_Free them. */
typedef struct {
    Size *starts, *order;
    double *t;
} Boxes;

static Boxes in_boxes(Size n, const double *x, Size boxes)
{
    double unit = (double)boxes / (2 * PI), *t = workspace(n);
    Size *starts = (Size *)workspace(boxes + 2 + n), *order, i, k;
    if (t == NULL || starts == NULL) {
        PyMem_Free(t);
        PyMem_Free(starts);
        return (Boxes){NULL, NULL, NULL};
    }
    order = starts + boxes + 2;
    memset(starts, 0, (size_t)(boxes + 2) * sizeof(Size));
    for (i = 0; i < n; i++)
        starts[((Size)floor(x[i] * unit) & (boxes - 1)) + 2]++;
    for (k = 2; k < boxes + 2; k++)
        starts[k] += starts[k - 1];
    for (i = 0; i < n; i++) {
        double box = floor(x[i] * unit);
        k = starts[((Size)box & (boxes - 1)) + 1]++;
        order[k] = i;
        t[k] = 2 * (x[i] * unit - box) - 1;
    }
    return (Boxes){starts, order, t};
}

VECTORISED void add_moments(Size terms, const double *RESTRICT t, const double *RESTRICT charge, double *RESTRICT sums)
{
    double before[LANES], here[LANES];
    Size i, k;
    for (i = 0; i < LANES; i++) {
        here[i] = charge[i];
        before[i] = t[i] * charge[i];
    }
    for (k = 0; k < terms; k++)
        for (i = 0; i < LANES; i++) {
            double after = 2 * t[i] * here[i] - before[i];
            sums[k * LANES + i] += here[i];
            before[i] = here[i];
            here[i] = after;
        }
}

int moments_of_boxes(Size n, const double *position, const double *charge, Size boxes, double *moments)
{
    Boxes in = in_boxes(n, position, boxes);
    Size i, j, k;
    for (k = 0; in.t != NULL && k < boxes; k++) {
        double sums[BOX_TERMS * LANES] = {0};
        for (i = in.starts[k]; i < in.starts[k + 1]; i += LANES) {
            double t[LANES] = {0}, q[LANES] = {0};
            for (j = 0; j < LANES && i + j < in.starts[k + 1]; j++) {
                t[j] = in.t[i + j];
                q[j] = charge[in.order[i + j]];
            }
            add_moments(BOX_TERMS, t, q, sums);
        }
        for (i = 0; i < BOX_TERMS; i++) {
            moments[k * BOX_TERMS + i] = 0.0;
            for (j = 0; j < LANES; j++)
                moments[k * BOX_TERMS + i] += sums[i * LANES + j];
        }
    }
    PyMem_Free(in.t);
    PyMem_Free(in.starts);
    return in.t != NULL;
}

VECTORISED void sum_series(Size terms, const double *RESTRICT series, const double *RESTRICT t, double *RESTRICT values)
{
    double before[LANES] = {0}, here[LANES] = {0};
    Size i, k;
    for (k = terms - 1; k > 0; k--)
        for (i = 0; i < LANES; i++) {
            double after = 2 * t[i] * here[i] + (series[k] - before[i]); /* so only one operation waits for the last */
            before[i] = here[i];
            here[i] = after;
        }
    for (i = 0; i < LANES; i++)
        values[i] = series[0] + t[i] * here[i] - before[i];
}

int boxes_potential(Size n, const double *x, const double *points, Size m, const double *position,
                    const double *sources, const double *charge, Size boxes, const double *series, double *values)
{
    Boxes in = in_boxes(n, x, boxes), from = in_boxes(m, position, boxes);
    double *sorted = workspace(3 * m);
    int done = in.t != NULL && from.t != NULL && sorted != NULL;
    Size i, j, k, beside;
    for (i = 0; done && i < m; i++) {
        sorted[i] = sources[from.order[i]];
        sorted[m + i] = sources[m + from.order[i]];
        sorted[2 * m + i] = charge[from.order[i]];
    }
    for (k = 0; done && k < boxes; k++)
        for (i = in.starts[k]; i < in.starts[k + 1]; i += LANES) {
            double t[LANES], a[LANES], b[LANES], sum[LANES];
            Size size = in.starts[k + 1] - i < LANES ? in.starts[k + 1] - i : LANES;
            for (j = 0; j < LANES; j++) {
                Size at = i + (j < size ? j : 0);
                t[j] = in.t[at];
                a[j] = points[in.order[at]];
                b[j] = points[n + in.order[at]];
            }
            sum_series(BOX_TERMS, series + k * BOX_TERMS, t, sum);
            for (beside = k + boxes - 1; beside <= k + boxes + 1; beside++) {
                Size start = from.starts[beside & (boxes - 1)], end = from.starts[(beside & (boxes - 1)) + 1];
                add_potential(end - start, a, b, sorted + start, sorted + m + start, sorted + 2 * m + start, sum);
            }
            for (j = 0; j < size; j++)
                values[in.order[i + j]] = sum[j];
        }
    PyMem_Free(in.t);
    PyMem_Free(in.starts);
    PyMem_Free(from.t);
    PyMem_Free(from.starts);
    PyMem_Free(sorted);
    return done;
}
