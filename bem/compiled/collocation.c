/* What stands before and behind the system of the patches: collocation.py, sensitivities.py. */

#include "core.h"
#include "kernels.h"

/* collocation.skeleton_columns(patches, coupled, series): nodes, their right-hand side, and the edge vectors. */
DECLARED(skeleton_columns)
{
    Call call;
    Size n[1], m[1], of_series[2], i, k, size = 0, largest = 0;
    double *center, *half_width, *series, *x, *force, *at_edges;
    int64_t *index;
    Table *tables;
    PyObject *classes, *parts[3] = {NULL, NULL, NULL}, *result = NULL;
    if (!enter(&call, n_given, 3))
        return NULL;
    center = reals(&call, attribute(&call, given[0], "center"), 1, n);
    half_width = reals(&call, attribute(&call, given[0], "half_width"), 1, m);
    index = integers(&call, attribute(&call, given[1], "index"), &i);
    series = reals(&call, given[2], 2, of_series);
    classes = attribute(&call, given[1], "tables");
    expect(&call, n[0] == m[0] && n[0] == i && n[0] == of_series[0], "patches, modes and series differ");
    tables = tables_of(&call, classes);
    for (i = 0; !call.failed && i < n[0]; i++) {
        expect(&call, 0 <= index[i] && index[i] < PyTuple_GET_SIZE(classes), "modes: index out of range");
        if (!call.failed) {
            size += tables[index[i]].n;
            largest = tables[index[i]].n > largest ? tables[index[i]].n : largest;
        }
    }
    expect(&call, largest <= of_series[1], "more modes than terms of the series");
    parts[0] = new_reals(&call, 1, size, 0, &x);
    parts[1] = new_reals(&call, 1, size, 0, &force);
    parts[2] = new_reals(&call, 2, size, 2, &at_edges);
    for (i = 0; !call.failed && i < n[0]; i++) {
        const Table *table = &tables[index[i]];
        for (k = 0; k < table->n; k++) {
            x[k] = center[i] + half_width[i] * table->nodes[k];
            at_edges[2 * k] = table->at_edges[k];
            at_edges[2 * k + 1] = table->at_edges[table->n + k];
        }
        times('T', table->n, table->n, 1.0, table->values, table->n, series + i * of_series[1], 0.0, force);
        x += table->n;
        force += table->n;
        at_edges += 2 * table->n;
    }
    if (!call.failed)
        result = PyTuple_Pack(3, parts[0], parts[1], parts[2]);
    for (i = 0; i < 3; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(tables);
    leave(&call);
    return result;
}

/* collocation.all_charges(coupled, series, skeleton): Q_n of every patch. */
DECLARED(all_charges)
{
    Call call;
    Size patches, of_series[2], n[1], i, k, start = 0;
    double *series, *skeleton, *charges;
    int64_t *index;
    Table *tables;
    PyObject *classes, *result;
    if (!enter(&call, n_given, 3))
        return NULL;
    index = integers(&call, attribute(&call, given[0], "index"), &patches);
    classes = attribute(&call, given[0], "tables");
    series = reals(&call, given[1], 2, of_series);
    skeleton = reals(&call, given[2], 1, n);
    tables = tables_of(&call, classes);
    for (i = 0; !call.failed && i < patches; i++) {
        expect(&call, 0 <= index[i] && index[i] < PyTuple_GET_SIZE(classes), "modes: index out of range");
        expect(&call, call.failed || tables[index[i]].n <= of_series[1], "more modes than terms of the series");
        start += call.failed ? 0 : tables[index[i]].n;
    }
    expect(&call, patches == of_series[0] && start == n[0], "charges, series and modes differ");
    result = new_reals(&call, 2, of_series[0], of_series[1], &charges);
    for (i = 0; !call.failed && i < patches; i++) {
        const Table *table = &tables[index[i]];
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

/* collocation.slopes_at_edges(coupled, charges): sum n^2 (+-1)^n Q_n of the coupled modes, left edges first. */
DECLARED(slopes_at_edges)
{
    Call call;
    Size of_charges[2], patches, i, j, k, start = 0;
    double *charges, *slopes;
    int64_t *index;
    Table *tables;
    PyObject *classes, *result;
    if (!enter(&call, n_given, 2))
        return NULL;
    index = integers(&call, attribute(&call, given[0], "index"), &patches);
    classes = attribute(&call, given[0], "tables");
    charges = reals(&call, given[1], 2, of_charges);
    tables = tables_of(&call, classes);
    for (i = 0; !call.failed && i < patches; i++) {
        expect(&call, 0 <= index[i] && index[i] < PyTuple_GET_SIZE(classes), "modes: index out of range");
        start += call.failed ? 0 : tables[index[i]].n;
    }
    expect(&call, start == of_charges[1], "charges and modes differ");
    result = new_reals(&call, 2, of_charges[0], 2 * patches, &slopes);
    for (j = 0; !call.failed && j < of_charges[0]; j++)
        for (i = 0; i < patches; i++) {
            const Table *table = &tables[index[i]];
            double left = 0.0, right = 0.0;
            for (k = 0; k < table->n; k++, charges++) {
                left += table->slopes[k] * *charges;
                right += table->slopes[table->n + k] * *charges;
            }
            slopes[j * 2 * patches + i] = left;
            slopes[j * 2 * patches + patches + i] = right;
        }
    PyMem_Free(tables);
    leave(&call);
    return result;
}

/* sensitivities.stress_intensity_jacobian(state). */
DECLARED(stress_intensity_jacobian)
{
    Call call;
    Size of_width[1], of_modes, of_intensity[1], of_compliance[2], of_slope[1], n, i, j;
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
            for (j = 0; j < 2 * n; j++)
                row[j] = compliance[i * 2 * n + j] * (PI * PI * pull[j]) / root;
            row[i] -= p * (p - 1) * pull[i] / root; /* terms that cancel: in the order of the reference */
            row[beside] -= ((modes[i % n] % 2 == 0 ? -p : p - 1) + 0.5) * pull[beside] / root;
            row[i] -= intensity[i] / (4 * r) + sqrt(PI) / root * slope[i] / 2;
        }
        PyMem_Free(pull);
    }
    leave(&call);
    return result;
}
