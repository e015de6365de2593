/* What stands before and behind the system of the patches: collocation.py, sensitivities.py. */

#include "kernels.h"

#define MODES_RATIO 1.15 /* collocation.MODES_RATIO */
#define NODES_RATIO 1.4  /* collocation.NODES_RATIO */

/* chebyshev._size_ladder */
static void list_sizes(double ratio, Sizes *list)
{
    Size n = 3;
    list->size[0] = 4, list->size[1] = 6, list->size[2] = 8;
    for (; list->size[n - 1] < 1000000000 && n < MOST_SIZES; n++) {
        int64_t next = (int64_t)((double)list->size[n - 1] * ratio);
        list->size[n] = next > list->size[n - 1] + 2 ? next : list->size[n - 1] + 2;
    }
    list->count = n;
}

void lists_of_sizes(Sizes *modes, Sizes *nodes)
{
    list_sizes(MODES_RATIO, modes);
    list_sizes(NODES_RATIO, nodes);
}

/* chebyshev.rounded_up; -1 where the number is none or beyond the list. */
static int64_t rounded_up(double number, const Sizes *list)
{
    Size low = -1, high = list->count;
    while (high - low > 1) {
        Size middle = (low + high) / 2;
        if ((double)list->size[middle] >= number)
            high = middle;
        else
            low = middle;
    }
    return high < list->count && !isnan(number) ? list->size[high] : -1;
}

double coupling_modes(double width, double clearance, double digits)
{
    double z = 2 * clearance / width;
    return digits / log1p(z + sqrt(z * (2 + z))) + 2.0;
}

int sizes_of(const Sizes *lists, Size n, const double *left, const double *right, double digits, double order,
             const double *least, int64_t *nodes, int64_t *modes)
{
    Size i;
    for (i = 0; i < n; i++) {
        double before = i > 0 ? left[i] - right[i - 1] : left[0] + 2 * PI - right[n - 1];
        double after = i + 1 < n ? left[i + 1] - right[i] : left[0] + 2 * PI - right[i];
        double width = right[i] - left[i], kappa = width * (order / 2);
        double wanted = coupling_modes(width, before < after ? before : after, digits);
        modes[i] = rounded_up(wanted < least[i] ? least[i] : wanted, &lists[0]);
        wanted = 1.15 * kappa + 3.0 * cbrt(kappa) + 12.0; /* chebyshev.profile_nodes */
        nodes[i] = rounded_up(wanted < (double)modes[i] + 4 ? (double)modes[i] + 4 : wanted, &lists[1]);
        if (modes[i] < 0 || nodes[i] < 0)
            return 0;
    }
    return 1;
}

/* Of the modes n = first, first + 2, ...: sums of n C_n, of n^3 C_n and of n C_n^2, added to three numbers. */
static void every_other(Size first, Size size, const double *c, double *sums)
{
    for (; first < size; first += 2) {
        double n = (double)first, term = n * c[first];
        sums[0] += term;
        sums[1] += term * (n * n);
        sums[2] += term * c[first];
    }
}

int right_hand_sides(const Surface *surface, Size n, const double *left, const double *right, double level,
                     const Table *sampling, const Table *coupled, Size most, const RightHandSides *to)
{
    Size i, k, unknowns = coupled[n].start;
    const double *table = surface->table, scale = surface->scale;
    double *series = to->series, *x = to->x, *columns = to->columns, *tail = to->tail, *points, *samples;
    if ((samples = workspace(2 * most)) == NULL)
        return 0;
    points = samples + most;
    *to->energy = 0.0;
    for (i = 0; i < n; i++, series += most) {
        double center = (left[i] + right[i]) / 2, half_width = (right[i] - left[i]) / 2;
        const Table *basis = &coupled[i];
        Size size = sampling[i].n;
        double even[3] = {0.0, 0.0, 0.0}, odd[3] = {0.0, 0.0, 0.0};
        int narrow = half_width * scale <= 0.5;
        if (narrow)
            for (k = 0; k < size; k++)
                samples[k] = rise_over(table, surface->rows, center * scale, half_width * scale * sampling[i].nodes[k]);
        else {
            for (k = 0; k < size; k++)
                points[k] = center + half_width * sampling[i].nodes[k];
            expansion(table, surface->rows, scale, 0, size, points, samples);
        }
        memset(series, 0, (size_t)most * sizeof(double));
        if (sampling[i].transform != NULL)
            times('N', size, size, -PI, sampling[i].transform, size, samples, 0.0, series);
        else {
            if (asked.coefficients(size, samples) < 0)
                break;
            for (k = 0; k < size; k++)
                series[k] = -PI * samples[k];
        }
        series[0] += PI * (level - (narrow ? height_at(table, surface->rows, center * scale) : 0.0));
        every_other(basis->n + basis->n % 2, most, series, even);
        every_other(basis->n + 1 - basis->n % 2, most, series, odd);
        tail[i] = (even[0] - odd[0]) / PI;
        tail[n + i] = (even[0] + odd[0]) / PI;
        tail[2 * n + i] = -(even[1] - odd[1]) / PI;
        tail[3 * n + i] = -(even[1] + odd[1]) / PI;
        *to->energy += even[2] + odd[2];
        times('T', basis->n, basis->n, 1.0, basis->values, basis->n, series, 0.0, columns);
        for (k = 0; k < basis->n; k++) {
            *x++ = center + half_width * basis->nodes[k];
            columns[unknowns] = 1.0;
            columns++;
        }
    }
    PyMem_Free(samples);
    return i == n;
}

Size most_nodes(Size n, const Table *sampling, const Table *coupled)
{
    Size most = 0, widest = 0, i;
    for (i = 0; i < n; i++) {
        most = sampling[i].n > most ? sampling[i].n : most;
        widest = coupled[i].n > widest ? coupled[i].n : widest;
    }
    if (widest <= most)
        return most;
    PyErr_SetString(PyExc_ValueError, "more modes than terms of the series");
    return 0;
}

void charges_of_modes(const Table *tables, Size patches, Size terms, const double *series, const double *skeleton,
                      double *charges)
{
    Size i, k;
    for (i = 0; i < patches; i++) {
        const Table *table = &tables[i];
        times('N', table->n, table->n, 2 / PI, table->values, table->n, skeleton, 0.0, charges);
        charges[0] /= 2;
        for (k = table->n; k < terms; k++)
            charges[k] = (double)k / -PI * series[k];
        charges += terms;
        series += terms;
        skeleton += table->n;
    }
}

/* A row of the Jacobian but for the terms of the patch itself. */
VECTORISED static void compliance_row(Size n, double factor, const double *RESTRICT compliance,
                                      const double *RESTRICT pull, double *RESTRICT row)
{
    Size j;
    for (j = 0; j < n; j++)
        row[j] = compliance[j] * (PI * PI * pull[j]) * factor;
}

int jacobian_of(Size n, const double *half_width, const int64_t *modes, const double *intensity,
                const double *compliance, const double *slope, double *values)
{
    double *pull = workspace(2 * n);
    Size i;
    if (pull == NULL)
        return 0;
    for (i = 0; i < 2 * n; i++)
        pull[i] = intensity[i] / (2 * sqrt(half_width[i % n]));
    for (i = 0; i < 2 * n; i++) {
        double p = (double)modes[i % n], r = half_width[i % n], root = sqrt(r), *row = values + i * 2 * n;
        Size beside = i < n ? i + n : i - n;
        compliance_row(2 * n, 1 / root, compliance + i * 2 * n, pull, row);
        row[i] -= p * (p - 1) * pull[i] / root; /* terms that cancel: in the order of the reference */
        row[beside] -= ((modes[i % n] % 2 == 0 ? -p : p - 1) + 0.5) * pull[beside] / root;
        row[i] -= intensity[i] / (4 * r) + sqrt(PI) / root * slope[i] / 2;
    }
    PyMem_Free(pull);
    return 1;
}
