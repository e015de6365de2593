/* What stands before and behind the system of the patches: collocation.py, sensitivities.py. */

#include "descent.h"
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

/* collocation.sizes(patches, tolerance, max_order, least). */
DECLARED(sizes)
{
    Call call;
    Size n[1], m[1], of_least[1];
    double *left, *right, *least, digits, order;
    int64_t *nodes, *modes;
    Sizes lists[2];
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
    lists_of_sizes(&lists[0], &lists[1]);
    if (!call.failed)
        expect(&call, sizes_of(lists, n[0], left, right, digits, order, least, nodes, modes),
               "patches that overlap, or too close for any number of modes");
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

Size right_hand_sides(Call *call, const Surface *surface, Size n, const double *left, const double *right, double level,
                      const Table *sampling, const Table *coupled, Size most, const RightHandSides *to)
{
    Size i, k, unknowns = coupled[n].start;
    const double *table = surface->table, scale = surface->scale;
    double *series = to->series, *x = to->x, *columns = to->columns, *tail = to->tail, *points, *samples;
    if ((samples = workspace(2 * most)) == NULL)
        call->failed = 1;
    points = call->failed ? NULL : samples + most;
    *to->energy = 0.0;
    for (i = 0; !call->failed && i < n; i++, series += most) {
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
            transformed(call, size, samples);
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
    return !call->failed;
}

Surface surface_of(Call *call, PyObject *profile)
{
    Surface surface = {0};
    Size shape[2];
    surface.table = reals(call, attribute(call, profile, "_table"), 2, shape);
    surface.rows = shape[0];
    expect(call, shape[0] > 0 && shape[1] == TERMS, "a Taylor table of 14 terms");
    surface.scale = (double)shape[0] / number(call, attribute(call, profile, "period"));
    return surface;
}

Size most_nodes(Call *call, Size n, const Table *sampling, const Table *coupled)
{
    Size most = 0, widest = 0, i;
    for (i = 0; !call->failed && i < n; i++) {
        most = sampling[i].n > most ? sampling[i].n : most;
        widest = coupled[i].n > widest ? coupled[i].n : widest;
    }
    expect(call, widest <= most, "more modes than terms of the series");
    return most;
}

/* collocation.right_hand_sides(profile, patches, level, resolution). */
DECLARED(right_hand_sides)
{
    Call call;
    Size n[1], m[1], of_nodes, of_modes, i, most, unknowns;
    double *left, *right, level, energy = 0.0;
    int64_t *nodes, *modes;
    RightHandSides to = {.energy = &energy};
    Surface surface;
    Table *sampling, *coupled;
    PyObject *parts[4], *result = NULL;
    if (!enter(&call, n_given, 4))
        return NULL;
    surface = surface_of(&call, given[0]);
    left = reals(&call, attribute(&call, given[1], "left"), 1, n);
    right = reals(&call, attribute(&call, given[1], "right"), 1, m);
    level = number(&call, given[2]);
    nodes = integers(&call, attribute(&call, given[3], "nodes"), &of_nodes);
    modes = integers(&call, attribute(&call, given[3], "modes"), &of_modes);
    expect(&call, n[0] > 0 && n[0] == m[0] && n[0] == of_nodes && n[0] == of_modes, "patches and resolution differ");
    sampling = tables_of(&call, OF_NODES, nodes, n[0]);
    coupled = tables_of(&call, OF_MODES, modes, n[0]);
    most = most_nodes(&call, n[0], sampling, coupled);
    unknowns = call.failed ? 0 : coupled[n[0]].start;
    parts[0] = new_reals(&call, 2, n[0], most, &to.series);
    parts[1] = new_reals(&call, 1, unknowns, 0, &to.x);
    parts[2] = new_reals(&call, 2, 2, unknowns, &to.columns);
    parts[3] = new_reals(&call, 2, 2, 2 * n[0], &to.tail);
    if (!call.failed &&
        right_hand_sides(&call, &surface, n[0], left, right, level, sampling, coupled, most, &to))
        result = Py_BuildValue("(OOOOd)", parts[0], parts[1], parts[2], parts[3], energy);
    for (i = 0; i < 4; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(sampling);
    PyMem_Free(coupled);
    leave(&call);
    return result;
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

/* collocation.all_charges(modes, series, skeleton): Q_n of every patch. */
DECLARED(all_charges)
{
    Call call;
    Size patches, of_series[2], n[1], i;
    double *series, *skeleton, *charges;
    int64_t *modes;
    Table *tables;
    PyObject *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    modes = integers(&call, given[0], &patches);
    series = reals(&call, given[1], 2, of_series);
    skeleton = reals(&call, given[2], 1, n);
    tables = tables_of(&call, OF_MODES, modes, patches);
    for (i = 0; !call.failed && i < patches; i++)
        expect(&call, tables[i].n <= of_series[1], "more modes than terms of the series");
    expect(&call, patches == of_series[0] && (call.failed || tables[patches].start == n[0]), "charges, series and modes differ");
    result = new_reals(&call, 2, of_series[0], of_series[1], &charges);
    if (!call.failed)
        charges_of_modes(tables, patches, of_series[1], series, skeleton, charges);
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

/* sensitivities.stress_intensity_jacobian(state). */
DECLARED(stress_intensity_jacobian)
{
    Call call;
    Size of_width[1], of_modes, of_intensity[1], of_compliance[2], of_slope[1], n;
    double *half_width, *intensity, *compliance, *slope, *values;
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
    if (call.failed || !jacobian_of(n, half_width, modes, intensity, compliance, slope, values))
        Py_CLEAR(result);
    leave(&call);
    return result;
}
