/* Potentials of charges: logarithmic_potential.py, gap.py. */

#include "core.h"
#include "kernels.h"

#define LANES 8            /* points at a time: loops over them are vectorised */
#define BOX_TERMS 20       /* logarithmic_potential.BOX_TERMS */
#define NEGLIGIBLE (-39.0) /* gap.NEGLIGIBLE */

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

/* logarithmic_potential.pair_by_pair(points, sources, charge). */
DECLARED(pair_by_pair)
{
    Call call;
    Size of_points[2], of_sources[2], n[1], i, k;
    double *points, *sources, *charge, *values;
    PyObject *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    points = reals(&call, given[0], 2, of_points);
    sources = reals(&call, given[1], 2, of_sources);
    charge = reals(&call, given[2], 1, n);
    expect(&call, of_points[0] == 2 && of_sources[0] == 2 && of_sources[1] == n[0], "points and charges differ");
    result = new_reals(&call, 1, of_points[1], 0, &values);
    for (i = 0; !call.failed && i < of_points[1]; i += LANES) {
        Size size = of_points[1] - i < LANES ? of_points[1] - i : LANES;
        double a[LANES], b[LANES], sum[LANES] = {0};
        for (k = 0; k < LANES; k++) {
            a[k] = points[i + (k < size ? k : 0)];
            b[k] = points[of_points[1] + i + (k < size ? k : 0)];
        }
        add_potential(n[0], a, b, sources, sources + n[0], charge, sum);
        memcpy(values + i, sum, (size_t)size * sizeof(double));
    }
    leave(&call);
    return result;
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

/* q_j T_k(t_j), added to the sums of each lane, (BOX_TERMS, LANES). */
VECTORISED static void add_moments(const double *RESTRICT t, const double *RESTRICT charge, double *RESTRICT sums)
{
    double before[LANES], here[LANES];
    Size i, k;
    for (i = 0; i < LANES; i++) {
        here[i] = charge[i];
        before[i] = t[i] * charge[i];
    }
    for (k = 0; k < BOX_TERMS; k++)
        for (i = 0; i < LANES; i++) {
            double after = 2 * t[i] * here[i] - before[i];
            sums[k * LANES + i] += here[i];
            before[i] = here[i];
            here[i] = after;
        }
}

/* logarithmic_potential.box_moments(position, charge, boxes). */
DECLARED(box_moments)
{
    Call call;
    Size n[1], of_charge[1], boxes, i, j, k;
    double *position, *charge, *moments;
    Boxes in = {NULL, NULL, NULL};
    PyObject *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    position = reals(&call, given[0], 1, n);
    charge = reals(&call, given[1], 1, of_charge);
    boxes = count(&call, given[2]);
    expect(&call, n[0] == of_charge[0] && boxes > 0 && (boxes & (boxes - 1)) == 0, "charges, or boxes, do not fit");
    result = new_reals(&call, 2, boxes, BOX_TERMS, &moments);
    if (!call.failed)
        in = in_boxes(n[0], position, boxes);
    for (k = 0; in.t != NULL && k < boxes; k++) {
        double sums[BOX_TERMS * LANES] = {0};
        for (i = in.starts[k]; i < in.starts[k + 1]; i += LANES) {
            double t[LANES] = {0}, q[LANES] = {0};
            for (j = 0; j < LANES && i + j < in.starts[k + 1]; j++) {
                t[j] = in.t[i + j];
                q[j] = charge[in.order[i + j]];
            }
            add_moments(t, q, sums);
        }
        for (i = 0; i < BOX_TERMS; i++) {
            moments[k * BOX_TERMS + i] = 0.0;
            for (j = 0; j < LANES; j++)
                moments[k * BOX_TERMS + i] += sums[i * LANES + j];
        }
    }
    if (in.t == NULL)
        Py_CLEAR(result);
    PyMem_Free(in.t);
    PyMem_Free(in.starts);
    leave(&call);
    return result;
}

/* sum_k series_k T_k(t) by Clenshaw's rule, in lanes. */
VECTORISED static void sum_series(Size terms, const double *RESTRICT series, const double *RESTRICT t,
                                   double *RESTRICT values)
{
    double before[LANES] = {0}, here[LANES] = {0};
    Size i, k;
    for (k = terms - 1; k > 0; k--)
        for (i = 0; i < LANES; i++) {
            double after = series[k] + 2 * t[i] * here[i] - before[i];
            before[i] = here[i];
            here[i] = after;
        }
    for (i = 0; i < LANES; i++)
        values[i] = series[0] + t[i] * here[i] - before[i];
}

/* gap.chebyshev_sums(series, node). */
DECLARED(chebyshev_sums)
{
    Call call;
    Size of_series[2], n[2], row, i, k;
    double *series, *node, *values;
    PyObject *result;
    if (!enter(&call, n_given, 2))
        return NULL;
    series = reals(&call, given[0], 2, of_series);
    node = reals(&call, given[1], 2, n);
    expect(&call, of_series[0] == n[0] && of_series[1] > 0, "series and nodes differ");
    result = new_reals(&call, 2, n[0], n[1], &values);
    for (row = 0; !call.failed && row < n[0]; row++, node += n[1], values += n[1])
        for (i = 0; i < n[1]; i += LANES) {
            double t[LANES] = {0}, sum[LANES];
            Size size = n[1] - i < LANES ? n[1] - i : LANES;
            for (k = 0; k < size; k++)
                t[k] = node[i + k];
            sum_series(of_series[1], series + row * of_series[1], t, sum);
            memcpy(values + i, sum, (size_t)size * sizeof(double));
        }
    leave(&call);
    return result;
}

/* gap.lower_bounds(gap, x, u, highest). */
DECLARED(lower_bounds)
{
    Call call;
    Size n, of_x[1], of_u[1], of_highest[1], i, k;
    double *x, *u, *highest, *bounds, bend, before = 0.0, unit;
    int64_t *gap;
    PyObject *result;
    if (!enter(&call, n_given, 4))
        return NULL;
    gap = integers(&call, given[0], &n);
    x = reals(&call, given[1], 1, of_x);
    u = reals(&call, given[2], 1, of_u);
    highest = reals(&call, given[3], 1, of_highest);
    unit = (double)of_highest[0] / (4 * PI);
    expect(&call, of_x[0] == n && of_u[0] == n, "points and values differ");
    result = new_reals(&call, 1, n, 0, &bounds);
    for (i = 0; !call.failed && i < n; i++) {
        expect(&call, 0 <= x[i] && x[i] * unit < (double)of_highest[0], "a point beyond two periods");
        bounds[i] = HUGE_VAL;
        if (i + 1 < n && gap[i] == gap[i + 1] && !call.failed) {
            Size last = (Size)(x[i + 1] * unit);
            double most = -HUGE_VAL;
            bend = i + 2 < n && gap[i + 1] == gap[i + 2] ? fabs(u[i + 2] - u[i + 1] - (u[i + 1] - u[i])) : 0.0;
            for (k = (Size)(x[i] * unit); k <= last && k < of_highest[0]; k++)
                most = highest[k] > most ? highest[k] : most;
            bounds[i] = (u[i] < u[i + 1] ? u[i] : u[i + 1]) - bend - before - most;
            before = bend;
        } else
            before = 0.0;
    }
    if (call.failed)
        Py_CLEAR(result);
    leave(&call);
    return result;
}

/* logarithmic_potential.box_potential(x, points, position, sources, charge, series). */
DECLARED(box_potential)
{
    Call call;
    Size n[1], m[1], of_charge[1], of_points[2], of_sources[2], of_series[2], boxes, i, j, k, beside;
    double *x, *points, *position, *sources, *charge, *series, *values, *sorted = NULL;
    Boxes in = {NULL, NULL, NULL}, from = {NULL, NULL, NULL};
    PyObject *result;
    if (!enter(&call, n_given, 6))
        return NULL;
    x = reals(&call, given[0], 1, n);
    points = reals(&call, given[1], 2, of_points);
    position = reals(&call, given[2], 1, m);
    sources = reals(&call, given[3], 2, of_sources);
    charge = reals(&call, given[4], 1, of_charge);
    series = reals(&call, given[5], 2, of_series);
    boxes = of_series[0];
    expect(&call, of_points[0] == 2 && of_points[1] == n[0] && of_sources[0] == 2 && of_sources[1] == m[0] &&
                      of_charge[0] == m[0],
           "points and charges differ");
    expect(&call, boxes > 2 && (boxes & (boxes - 1)) == 0 && of_series[1] == BOX_TERMS, "boxes do not fit");
    result = new_reals(&call, 1, n[0], 0, &values);
    if (!call.failed && (sorted = workspace(3 * m[0])) != NULL) {
        in = in_boxes(n[0], x, boxes);
        from = in_boxes(m[0], position, boxes);
    }
    for (i = 0; in.t != NULL && from.t != NULL && i < m[0]; i++) {
        sorted[i] = sources[from.order[i]];
        sorted[m[0] + i] = sources[m[0] + from.order[i]];
        sorted[2 * m[0] + i] = charge[from.order[i]];
    }
    for (k = 0; in.t != NULL && from.t != NULL && k < boxes; k++)
        for (i = in.starts[k]; i < in.starts[k + 1]; i += LANES) {
            double t[LANES], a[LANES], b[LANES], sum[LANES];
            Size size = in.starts[k + 1] - i < LANES ? in.starts[k + 1] - i : LANES;
            for (j = 0; j < LANES; j++) {
                Size at = i + (j < size ? j : 0);
                t[j] = in.t[at];
                a[j] = points[in.order[at]];
                b[j] = points[n[0] + in.order[at]];
            }
            sum_series(BOX_TERMS, series + k * BOX_TERMS, t, sum);
            for (beside = k + boxes - 1; beside <= k + boxes + 1; beside++) {
                Size start = from.starts[beside & (boxes - 1)], end = from.starts[(beside & (boxes - 1)) + 1];
                add_potential(end - start, a, b, sorted + start, sorted + m[0] + start, sorted + 2 * m[0] + start, sum);
            }
            for (j = 0; j < size; j++)
                values[in.order[i + j]] = sum[j];
        }
    if (in.t == NULL || from.t == NULL)
        Py_CLEAR(result);
    PyMem_Free(in.t);
    PyMem_Free(in.starts);
    PyMem_Free(from.t);
    PyMem_Free(from.starts);
    PyMem_Free(sorted);
    leave(&call);
    return result;
}

/* What one patch adds at LANES points beside it, t half widths from its center: -pi times its series, by Horner's rule
   in zeta with all terms that the point nearest to it sees, less the potential of its skeleton. */
VECTORISED static void beside_patch(const double *RESTRICT t, double total, Size n_terms, const double *RESTRICT terms,
                                    Size n, const double *RESTRICT places, const double *RESTRICT charges,
                                    double *RESTRICT values)
{
    double zeta[LANES], sum[LANES] = {0}, coarse[LANES] = {0}, nearest = 0.0, most;
    Size i, k;
    for (k = 0; k < LANES; k++) {
        double outside = fabs(t[k]) < 1 ? copysign(1.0, t[k]) : t[k];
        zeta[k] = 1 / (outside + copysign(sqrt((outside - 1) * (outside + 1)), outside));
        nearest = fabs(zeta[k]) > nearest ? fabs(zeta[k]) : nearest;
    }
    most = NEGLIGIBLE / log(nearest - 1e-16);
    for (i = most < (double)n_terms ? (Size)ceil(most) : n_terms; i > 0; i--)
        for (k = 0; k < LANES; k++)
            sum[k] = (sum[k] + terms[i - 1]) * zeta[k];
    for (i = 0; i < n; i++)
        for (k = 0; k < LANES; k++)
            coarse[k] += charges[i] * log_of_size(t[k] - places[i]);
    for (k = 0; k < LANES; k++)
        values[k] = -PI * (log_of_size(2 * zeta[k]) * total + sum[k]) - coarse[k];
}

/* gap.near_patches(center, half_width, skeletons, series, gap, x): the exact logarithmic part of the two patches beside
   a gap less that of their skeletons. */
DECLARED(near_patches)
{
    Call call;
    Size patches[1], of_width[1], of_charges[2], of_places[2], of_total[1], of_terms[2], n[1];
    Size n_modes, n_count, n_gap, side, i, k, next;
    double *center, *half_width, *charges, *places, *total, *terms, *x, *values;
    int64_t *n_charges, *n_terms, *gap;
    PyObject *result;
    if (!enter(&call, n_given, 6))
        return NULL;
    center = reals(&call, given[0], 1, patches);
    half_width = reals(&call, given[1], 1, of_width);
    expect(&call, PyTuple_Check(given[2]) && PyTuple_GET_SIZE(given[2]) == 3 && PyTuple_Check(given[3]) &&
                      PyTuple_GET_SIZE(given[3]) == 3,
           "skeletons and series are three arrays each");
    if (call.failed) {
        leave(&call);
        return NULL;
    }
    charges = reals(&call, PyTuple_GET_ITEM(given[2], 0), 2, of_charges);
    places = reals(&call, PyTuple_GET_ITEM(given[2], 1), 2, of_places);
    n_charges = integers(&call, PyTuple_GET_ITEM(given[2], 2), &n_modes);
    total = reals(&call, PyTuple_GET_ITEM(given[3], 0), 1, of_total);
    n_terms = integers(&call, PyTuple_GET_ITEM(given[3], 1), &n_count);
    terms = reals(&call, PyTuple_GET_ITEM(given[3], 2), 2, of_terms);
    gap = integers(&call, given[4], &n_gap);
    x = reals(&call, given[5], 1, n);
    expect(&call, of_width[0] == patches[0] && of_charges[0] == patches[0] && of_places[0] == patches[0] &&
                      of_places[1] == of_charges[1] && n_modes == patches[0] && of_total[0] == patches[0] &&
                      n_count == patches[0] && of_terms[0] == patches[0] && n_gap == n[0],
           "arrays of the patches differ in size");
    result = new_reals(&call, 1, n[0], 0, &values);
    for (i = 0; !call.failed && i < patches[0]; i++)
        expect(&call, n_terms[i] <= of_terms[1] && n_charges[i] <= of_charges[1], "more terms than there are");
    for (i = 0; !call.failed && i < n[0]; i++) {
        expect(&call, 0 <= gap[i] && gap[i] < patches[0], "no such gap");
        values[i] = 0.0;
    }
    for (side = 0; side < 2; side++)
        for (i = 0; !call.failed && i < n[0]; i = next) {
            Size which = ((Size)gap[i] + side) % patches[0];
            double turn = side == 1 && which <= gap[i] ? 2 * PI : 0.0, t[LANES], beside[LANES];
            for (next = i; next < n[0] && next < i + LANES && gap[next] == gap[i]; next++)
                t[next - i] = (x[next] - turn - center[which]) / half_width[which];
            for (k = next - i; k < LANES; k++)
                t[k] = t[0];
            beside_patch(t, total[which], (Size)n_terms[which], terms + which * of_terms[1], (Size)n_charges[which],
                         places + which * of_charges[1], charges + which * of_charges[1], beside);
            for (k = i; k < next; k++)
                values[k] += beside[k - i];
        }
    if (call.failed)
        Py_CLEAR(result);
    leave(&call);
    return result;
}
