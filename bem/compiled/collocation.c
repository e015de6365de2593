/* What stands before and behind the system of the patches: collocation.py, sensitivities.py. */

#include "core.h"
#include "kernels.h"

#define MODES_RATIO 1.15 /* collocation.MODES_RATIO */
#define NODES_RATIO 1.4  /* collocation.NODES_RATIO */
#define MOST_SIZES 256   /* of a list: up to 1e9 in steps of MODES_RATIO there are 139 */

/* chebyshev._size_ladder */
static Size sizes_of(double ratio, int64_t *ladder)
{
    Size n = 3;
    ladder[0] = 4, ladder[1] = 6, ladder[2] = 8;
    for (; ladder[n - 1] < 1000000000 && n < MOST_SIZES; n++) {
        int64_t next = (int64_t)((double)ladder[n - 1] * ratio);
        ladder[n] = next > ladder[n - 1] + 2 ? next : ladder[n - 1] + 2;
    }
    return n;
}

/* chebyshev.rounded_up; -1 where the number is none or beyond the list. */
static int64_t rounded_up(double number, Size n, const int64_t *ladder)
{
    Size i = 0;
    while (i < n && !((double)ladder[i] >= number))
        i++;
    return i < n ? ladder[i] : -1;
}

/* collocation.sizes(patches, tolerance, max_order, least). */
DECLARED(sizes)
{
    Call call;
    Size n[1], m[1], of_least[1], i, n_modes, n_nodes;
    double *left, *right, *least, digits, order;
    int64_t *nodes, *modes, modes_ladder[MOST_SIZES], nodes_ladder[MOST_SIZES];
    PyObject *parts[2], *result = NULL;
    if (!enter(&call, n_given, 4))
        return NULL;
    left = reals(&call, attribute(&call, given[0], "left"), 1, n);
    right = reals(&call, attribute(&call, given[0], "right"), 1, m);
    digits = -log(number(&call, given[1]));
    order = number(&call, given[2]);
    least = reals(&call, given[3], 1, of_least);
    expect(&call, n[0] == m[0] && n[0] == of_least[0], "edges and least modes differ");
    parts[0] = new_integers(&call, n[0], &nodes);
    parts[1] = new_integers(&call, n[0], &modes);
    n_modes = sizes_of(MODES_RATIO, modes_ladder);
    n_nodes = sizes_of(NODES_RATIO, nodes_ladder);
    for (i = 0; !call.failed && i < n[0]; i++) {
        double before = i > 0 ? left[i] - right[i - 1] : left[0] + 2 * PI - right[n[0] - 1];
        double after = i + 1 < n[0] ? left[i + 1] - right[i] : left[0] + 2 * PI - right[i];
        double width = right[i] - left[i], kappa = width * (order / 2), z = 2 * (before < after ? before : after) / width;
        double wanted = digits / log1p(z + sqrt(z * (2 + z))) + 2.0;
        modes[i] = rounded_up(wanted < least[i] ? least[i] : wanted, n_modes, modes_ladder);
        wanted = 1.15 * kappa + 3.0 * cbrt(kappa) + 12.0; /* chebyshev.profile_nodes */
        nodes[i] = rounded_up(wanted < (double)modes[i] + 4 ? (double)modes[i] + 4 : wanted, n_nodes, nodes_ladder);
        expect(&call, modes[i] > 0 && nodes[i] > 0, "patches that overlap, or too close for any number of modes");
    }
    if (!call.failed)
        result = PyTuple_Pack(2, parts[0], parts[1]);
    Py_XDECREF(parts[0]);
    Py_XDECREF(parts[1]);
    leave(&call);
    return result;
}

/* chebyshev.coefficients of samples for which there is no matrix, in their place. */
static void transformed(Call *outer, Size n, double *samples)
{
    Call call;
    Size m[1];
    double *copy, *series;
    PyObject *module = PyImport_ImportModule("bem.geometry.chebyshev"), *array;
    enter(&call, 0, 0);
    call.failed = module == NULL;
    array = held(&call, new_reals(&call, 1, n, 0, &copy));
    if (!call.failed)
        memcpy(copy, samples, (size_t)n * sizeof(double));
    series = reals(&call, held(&call, call.failed ? NULL : PyObject_CallMethod(module, "coefficients", "O", array)), 1, m);
    expect(&call, m[0] == n, "coefficients of another number");
    if (!call.failed)
        memcpy(samples, series, (size_t)n * sizeof(double));
    outer->failed = call.failed;
    Py_XDECREF(module);
    leave(&call);
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

/* collocation.right_hand_sides(profile, patches, level, resolution). */
DECLARED(right_hand_sides)
{
    Call call;
    Size of_table[2], n[1], m[1], of_nodes, of_modes, i, k, most = 0, unknowns, widest = 0;
    double *table, *left, *right, *series, *x, *columns, *tail, *samples = NULL, *points, scale, level, energy = 0.0;
    int64_t *nodes, *modes;
    Table *sampling, *coupled;
    PyObject *parts[4], *result = NULL;
    if (!enter(&call, n_given, 4))
        return NULL;
    table = reals(&call, attribute(&call, given[0], "_table"), 2, of_table);
    scale = (double)of_table[0] / number(&call, attribute(&call, given[0], "period"));
    left = reals(&call, attribute(&call, given[1], "left"), 1, n);
    right = reals(&call, attribute(&call, given[1], "right"), 1, m);
    level = number(&call, given[2]);
    nodes = integers(&call, attribute(&call, given[3], "nodes"), &of_nodes);
    modes = integers(&call, attribute(&call, given[3], "modes"), &of_modes);
    expect(&call, of_table[0] > 0 && of_table[1] == TERMS, "a Taylor table of 14 terms");
    expect(&call, n[0] > 0 && n[0] == m[0] && n[0] == of_nodes && n[0] == of_modes, "patches and resolution differ");
    sampling = tables_of(&call, "packed_nodes", nodes, n[0]);
    coupled = tables_of(&call, "packed_basis", modes, n[0]);
    for (i = 0; !call.failed && i < n[0]; i++) {
        most = sampling[i].n > most ? sampling[i].n : most;
        widest = coupled[i].n > widest ? coupled[i].n : widest;
    }
    expect(&call, widest <= most, "more modes than terms of the series");
    unknowns = call.failed ? 0 : coupled[n[0]].start;
    parts[0] = new_reals(&call, 2, n[0], most, &series);
    parts[1] = new_reals(&call, 1, unknowns, 0, &x);
    parts[2] = new_reals(&call, 2, 2, unknowns, &columns);
    parts[3] = new_reals(&call, 2, 2, 2 * n[0], &tail);
    if (!call.failed && (samples = workspace(2 * most)) == NULL)
        call.failed = 1;
    points = call.failed ? NULL : samples + most;
    for (i = 0; !call.failed && i < n[0]; i++, series += most) {
        double center = (left[i] + right[i]) / 2, half_width = (right[i] - left[i]) / 2;
        const Table *basis = &coupled[i];
        Size size = sampling[i].n;
        double even[3] = {0.0, 0.0, 0.0}, odd[3] = {0.0, 0.0, 0.0};
        int narrow = half_width * scale <= 0.5;
        if (narrow)
            for (k = 0; k < size; k++)
                samples[k] = rise_over(table, of_table[0], center * scale, half_width * scale * sampling[i].nodes[k]);
        else {
            for (k = 0; k < size; k++)
                points[k] = center + half_width * sampling[i].nodes[k];
            expansion(table, of_table[0], scale, 0, size, points, samples);
        }
        memset(series, 0, (size_t)most * sizeof(double));
        if (sampling[i].transform != NULL)
            times('N', size, size, -PI, sampling[i].transform, size, samples, 0.0, series);
        else {
            transformed(&call, size, samples);
            for (k = 0; k < size; k++)
                series[k] = -PI * samples[k];
        }
        series[0] += PI * (level - (narrow ? height_at(table, of_table[0], center * scale) : 0.0));
        every_other(basis->n + basis->n % 2, most, series, even);
        every_other(basis->n + 1 - basis->n % 2, most, series, odd);
        tail[i] = (even[0] - odd[0]) / PI;
        tail[n[0] + i] = (even[0] + odd[0]) / PI;
        tail[2 * n[0] + i] = -(even[1] - odd[1]) / PI;
        tail[3 * n[0] + i] = -(even[1] + odd[1]) / PI;
        energy += even[2] + odd[2];
        times('T', basis->n, basis->n, 1.0, basis->values, basis->n, series, 0.0, columns);
        for (k = 0; k < basis->n; k++) {
            *x++ = center + half_width * basis->nodes[k];
            columns[unknowns] = 1.0;
            columns++;
        }
    }
    if (!call.failed)
        result = Py_BuildValue("(OOOOd)", parts[0], parts[1], parts[2], parts[3], energy);
    for (i = 0; i < 4; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(samples);
    PyMem_Free(sampling);
    PyMem_Free(coupled);
    leave(&call);
    return result;
}

/* collocation.all_charges(modes, series, skeleton): Q_n of every patch. */
DECLARED(all_charges)
{
    Call call;
    Size patches, of_series[2], n[1], i, k;
    double *series, *skeleton, *charges;
    int64_t *modes;
    Table *tables;
    PyObject *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    modes = integers(&call, given[0], &patches);
    series = reals(&call, given[1], 2, of_series);
    skeleton = reals(&call, given[2], 1, n);
    tables = tables_of(&call, "packed_basis", modes, patches);
    for (i = 0; !call.failed && i < patches; i++)
        expect(&call, tables[i].n <= of_series[1], "more modes than terms of the series");
    expect(&call, patches == of_series[0] && (call.failed || tables[patches].start == n[0]), "charges, series and modes differ");
    result = new_reals(&call, 2, of_series[0], of_series[1], &charges);
    for (i = 0; !call.failed && i < patches; i++) {
        const Table *table = &tables[i];
        times('N', table->n, table->n, 2 / PI, table->values, table->n, skeleton, 0.0, charges);
        charges[0] /= 2;
        for (k = table->n; k < of_series[1]; k++)
            charges[k] = (double)k / -PI * series[k];
        charges += of_series[1];
        series += of_series[1];
        skeleton += table->n;
    }
    PyMem_Free(tables);
    leave(&call);
    return result;
}

/* A row of the Jacobian but for the terms of the patch itself. */
VECTORISED static void compliance_row(Size n, double factor, const double *RESTRICT compliance,
                                      const double *RESTRICT pull, double *RESTRICT row)
{
    Size j;
    for (j = 0; j < n; j++)
        row[j] = compliance[j] * (PI * PI * pull[j]) * factor;
}

/* sensitivities.stress_intensity_jacobian(state). */
DECLARED(stress_intensity_jacobian)
{
    Call call;
    Size of_width[1], of_modes, of_intensity[1], of_compliance[2], of_slope[1], n, i;
    double *half_width, *intensity, *compliance, *slope, *values, *pull;
    int64_t *modes;
    PyObject *result;
    if (!enter(&call, n_given, 1))
        return NULL;
    half_width = reals(&call, attribute(&call, attribute(&call, given[0], "patches"), "half_width"), 1, of_width);
    modes = integers(&call, attribute(&call, attribute(&call, given[0], "resolution"), "modes"), &of_modes);
    intensity = reals(&call, attribute(&call, given[0], "stress_intensity"), 1, of_intensity);
    compliance = reals(&call, attribute(&call, given[0], "edge_compliance"), 2, of_compliance);
    slope = reals(&call, attribute(&call, given[0], "edge_slope"), 1, of_slope);
    n = of_width[0];
    expect(&call, of_modes == n && of_intensity[0] == 2 * n && of_slope[0] == 2 * n && of_compliance[0] == 2 * n &&
                      of_compliance[1] == 2 * n,
           "arrays of a state differ in size");
    result = new_reals(&call, 2, 2 * n, 2 * n, &values);
    if (!call.failed && (pull = workspace(2 * n))) {
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
    } else
        Py_CLEAR(result);
    leave(&call);
    return result;
}
