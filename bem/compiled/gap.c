/* Potentials of charges: logarithmic_potential.py, gap.py. */

#include "core.h"
#include "kernels.h"

#define LANES 8
#define CHUNK 256
#define NEGLIGIBLE (-39.0) /* gap.NEGLIGIBLE */

/* sum_j charge_j log|a first_j + b second_j|, in lanes that are summed last, so that the loops are vectorised. */
VECTORISED static double potential(Size n, double a, double b, const double *RESTRICT first,
                                   const double *RESTRICT second, const double *RESTRICT charge)
{
    double lanes[LANES] = {0}, terms[CHUNK], total = 0.0;
    Size start, i, k;
    for (start = 0; start < n; start += CHUNK) {
        Size size = n - start < CHUNK ? n - start : CHUNK;
        for (i = 0; i < size; i++)
            terms[i] = charge[start + i] * log_of_size(a * first[start + i] + b * second[start + i]);
        for (i = 0; i + LANES <= size; i += LANES)
            for (k = 0; k < LANES; k++)
                lanes[k] += terms[i + k];
        for (; i < size; i++)
            total += terms[i];
    }
    for (k = 0; k < LANES; k++)
        total += lanes[k];
    return total;
}

/* logarithmic_potential.pair_by_pair(points, sources, charge). */
DECLARED(pair_by_pair)
{
    Call call;
    Size of_points[2], of_sources[2], n[1], i;
    double *points, *sources, *charge, *values;
    PyObject *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    points = reals(&call, given[0], 2, of_points);
    sources = reals(&call, given[1], 2, of_sources);
    charge = reals(&call, given[2], 1, n);
    expect(&call, of_points[0] == 2 && of_sources[0] == 2 && of_sources[1] == n[0], "points and charges differ");
    result = new_reals(&call, 1, of_points[1], 0, &values);
    for (i = 0; !call.failed && i < of_points[1]; i++)
        values[i] = potential(n[0], points[i], points[of_points[1] + i], sources, sources + n[0], charge);
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
        double square = (t[k] - 1) * (t[k] + 1);
        zeta[k] = 1 / (t[k] + copysign(sqrt(square > 0 ? square : 0.0), t[k]));
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

/* gap.near_patch(center, half_width, skeletons, series, index, x): the exact logarithmic part of one patch less that of
   its skeleton, for each x the patch beside which it lies. */
DECLARED(near_patch)
{
    Call call;
    Size patches[1], of_width[1], of_charges[2], of_places[2], of_total[1], of_terms[2], n[1];
    Size n_modes, n_count, n_index, i, k, next;
    double *center, *half_width, *charges, *places, *total, *terms, *x, *values;
    int64_t *n_charges, *n_terms, *index;
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
    index = integers(&call, given[4], &n_index);
    x = reals(&call, given[5], 1, n);
    expect(&call, of_width[0] == patches[0] && of_charges[0] == patches[0] && of_places[0] == patches[0] &&
                      of_places[1] == of_charges[1] && n_modes == patches[0] && of_total[0] == patches[0] &&
                      n_count == patches[0] && of_terms[0] == patches[0] && n_index == n[0],
           "arrays of the patches differ in size");
    result = new_reals(&call, 1, n[0], 0, &values);
    for (i = 0; !call.failed && i < n[0]; i++)
        expect(&call, 0 <= index[i] && index[i] < patches[0] && n_terms[index[i]] <= of_terms[1] &&
                          n_charges[index[i]] <= of_charges[1],
               "no such patch");
    for (i = 0; !call.failed && i < n[0]; i = next) {
        Size which = (Size)index[i];
        double t[LANES], beside[LANES];
        for (next = i; next < n[0] && next < i + LANES && index[next] == which; next++)
            t[next - i] = (x[next] - center[which]) / half_width[which];
        for (k = next - i; k < LANES; k++)
            t[k] = t[0];
        beside_patch(t, total[which], (Size)n_terms[which], terms + which * of_terms[1], (Size)n_charges[which],
                     places + which * of_charges[1], charges + which * of_charges[1], beside);
        memcpy(values + i, beside, (size_t)(next - i) * sizeof(double));
    }
    leave(&call);
    return result;
}
