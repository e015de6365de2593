/* Two clusters joined, and the derivatives of K: hierarchical.py, sensitivities.py. */

#include "core.h"
#include "kernels.h"

/* hierarchical._middle: M of two halves, (2 q, 2 q), from X_1, X_2 and C; 0 where the matrix is not positive definite.
   `work` has room for 6 q q + 2 q numbers; all matrices but R and the factor are symmetric. */
static int middle(Size q, const double *first, const double *second, const double *core, double *work, double *m)
{
    double *root = work, *turned = root + q * q, *inner = turned + q * q, *other = inner + q * q;
    double *through = other + q * q, *factor = through + q * q, *scratch = factor + q * q, tolerance = -1.0;
    int *pivots = (int *)through, order = (int)q, rank, info;
    char lower = 'L', upper = 'U';
    Size i, j;
    memcpy(other, first, (size_t)(q * q) * sizeof(double));
    blas.dpstrf(&lower, &order, other, &order, pivots, &rank, &tolerance, scratch, &info);
    memset(root, 0, (size_t)(q * q) * sizeof(double)); /* R^T, `rank` rows */
    for (j = 0; j < rank; j++)
        for (i = j; i < q; i++)
            root[(pivots[i] - 1) * q + j] = other[j * q + i];
    product('N', 'N', q, q, q, 1.0, second, q, core, q, 0.0, other, q);
    product('N', 'N', q, q, q, 1.0, core, q, other, q, 0.0, turned, q);
    product('N', 'T', q, rank, q, 1.0, turned, q, root, q, 0.0, other, q);
    product('N', 'N', rank, rank, q, -1.0, root, q, other, q, 0.0, factor, q);
    for (i = 0; i < rank; i++)
        factor[i * q + i] += 1.0;
    blas.dpotrf(&upper, &rank, factor, &order, &info);
    if (info != 0)
        return 0;
    solve_upper('T', rank, q, factor, q, root, q);
    product('T', 'N', q, q, rank, 1.0, root, q, root, q, 0.0, inner, q);
    product('N', 'N', q, q, q, 1.0, turned, q, inner, q, 0.0, through, q);
    for (j = 0; j < q; j++)
        for (i = 0; i < q; i++) {
            m[j * 2 * q + i] = -turned[j * q + i];
            m[(q + j) * 2 * q + i] = core[j * q + i];
        }
    product('N', 'N', q, q, q, -1.0, through, q, turned, q, 1.0, m, 2 * q);
    product('N', 'N', q, q, q, 1.0, through, q, core, q, 1.0, m + 2 * q * q, 2 * q);
    product('N', 'N', q, q, q, 1.0, inner, q, core, q, 0.0, other, q);
    product('N', 'N', q, q, q, -1.0, core, q, other, q, 0.0, m + 2 * q * q + q, 2 * q);
    for (j = 0; j < q; j++)
        for (i = 0; i < q; i++)
            m[i * 2 * q + q + j] = m[(q + j) * 2 * q + i];
    return 1;
}

/* hierarchical.joined_gram(first, second, core, count): b^T A^-1 b of two clusters, and M V of the columns shared from
   above; None where the matrix is not positive definite. */
DECLARED(joined_gram)
{
    Call call;
    Size of_first[2], of_second[2], of_core[2], shared, q, size = 0, i, j, part;
    double *grams[2], *core, *gram, *response, *work = NULL, *own, *m, *seen, *reply;
    PyObject *parts[2] = {NULL, NULL}, *result = NULL;
    if (!enter(&call, n_given, 4))
        return NULL;
    grams[0] = reals(&call, given[0], 2, of_first);
    grams[1] = reals(&call, given[1], 2, of_second);
    core = reals(&call, given[2], 2, of_core);
    shared = count(&call, given[3]);
    q = of_core[0];
    expect(&call, shared >= 0 && q > 0 && of_core[1] == q && of_first[0] == of_first[1] &&
                      of_second[0] == of_second[1] && of_first[0] >= shared + q && of_second[0] >= shared + q,
           "clusters and core differ");
    if (!call.failed)
        size = of_first[0] + of_second[0] - 2 * q - shared;
    parts[0] = new_reals(&call, 2, size, size, &gram);
    parts[1] = new_reals(&call, 2, 2 * q, shared, &response);
    if (!call.failed && (work = workspace(12 * q * q + 2 * q + 4 * q * size))) {
        Size place = shared;
        own = work + 6 * q * q + 2 * q; /* X_1 and X_2 */
        m = own + 2 * q * q;
        seen = m + 4 * q * q;
        reply = seen + 2 * q * size;
        memset(gram, 0, (size_t)(size * size) * sizeof(double));
        memset(seen, 0, (size_t)(2 * q * size) * sizeof(double));
        for (part = 0; part < 2; part++) {
            Size full = part == 0 ? of_first[0] : of_second[0], edges = full - shared - q;
            const double *from = grams[part], *beyond = from + shared + q;
            for (i = 0; i < shared; i++) {
                for (j = 0; j < shared; j++)
                    gram[i * size + j] += from[i * full + j];
                memcpy(gram + i * size + place, beyond + i * full, (size_t)edges * sizeof(double));
            }
            for (i = 0; i < edges; i++) {
                const double *row = from + (shared + q + i) * full;
                memcpy(gram + (place + i) * size, row, (size_t)shared * sizeof(double));
                memcpy(gram + (place + i) * size + place, row + shared + q, (size_t)edges * sizeof(double));
            }
            for (i = 0; i < q; i++) {
                double *row = seen + (part * q + i) * size;
                memcpy(row, from + (shared + i) * full, (size_t)shared * sizeof(double));
                memcpy(row + place, beyond + (shared + i) * full, (size_t)edges * sizeof(double));
                memcpy(own + (part * q + i) * q, from + (shared + i) * full + shared, (size_t)q * sizeof(double));
            }
            place += edges;
        }
        if (middle(q, own, own + q * q, core, work, m)) {
            product('N', 'N', size, 2 * q, 2 * q, 1.0, seen, size, m, 2 * q, 0.0, reply, size);
            product('N', 'T', size, size, 2 * q, -1.0, seen, size, reply, size, 1.0, gram, size);
            for (i = 0; i < 2 * q; i++)
                memcpy(response + i * shared, reply + i * size, (size_t)shared * sizeof(double));
            result = PyTuple_Pack(2, parts[0], parts[1]);
        } else {
            result = Py_None;
            Py_INCREF(result);
        }
    }
    for (i = 0; i < 2; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(work);
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

/* hierarchical.without_uniform(gram, charges, uniform): edges in the order of edge vectors, then the shared columns;
   alpha 1 1^T taken out by the formula of Sherman and Morrison.  None where what is left is not positive definite. */
DECLARED(without_uniform)
{
    Call call;
    Size of_gram[2], of_charges[2], m, edges, i, j;
    double *from, *charges, *gram, *values, *ones = NULL, uniform, remaining;
    PyObject *parts[2] = {NULL, NULL}, *result = NULL;
    if (!enter(&call, n_given, 3))
        return NULL;
    from = reals(&call, given[0], 2, of_gram);
    charges = reals(&call, given[1], 2, of_charges);
    uniform = number(&call, given[2]);
    m = of_gram[0];
    edges = (m - 2) / 2;
    expect(&call, m >= 2 && m % 2 == 0 && of_gram[1] == m && of_charges[1] == 2, "gram or charges of another shape");
    parts[0] = new_reals(&call, 2, m, m, &gram);
    parts[1] = new_reals(&call, 2, of_charges[0], 2, &values);
    if (!call.failed && (ones = workspace(m))) { /* b^T A'^-1 1: the column, whatever rounding left of the row */
        for (i = 0; i < m; i++)
            ones[i] = from[i * m + 1];
        remaining = 1 - uniform * ones[1];
        for (i = 0; remaining > 0 && i < m; i++) {
            /* place of the shared columns: 0 and 1; of edges: 2, 4, ... on the left, 3, 5, ... on the right */
            Size place = i < edges ? 2 + 2 * i : i < 2 * edges ? 3 + 2 * (i - edges) : i - 2 * edges;
            const double *old = from + place * m;
            double *new = gram + i * m, factor = uniform / remaining;
            for (j = 0; j < edges; j++) {
                new[j] = old[2 + 2 * j] + ones[place] * (ones[2 + 2 * j] * factor);
                new[edges + j] = old[3 + 2 * j] + ones[place] * (ones[3 + 2 * j] * factor);
            }
            new[2 * edges] = old[0] + ones[place] * (ones[0] * factor);
            new[2 * edges + 1] = old[1] + ones[place] * (ones[1] * factor);
        }
        for (i = 0; remaining > 0 && i < of_charges[0]; i++) {
            double factor = uniform / remaining;
            values[2 * i] = charges[2 * i] + charges[2 * i + 1] * (ones[0] * factor);
            values[2 * i + 1] = charges[2 * i + 1] + charges[2 * i + 1] * (ones[1] * factor);
        }
        if (remaining > 0)
            result = PyTuple_Pack(2, parts[0], parts[1]);
        else {
            result = Py_None;
            Py_INCREF(result);
        }
    }
    for (i = 0; i < 2; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(ones);
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
