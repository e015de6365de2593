/* The system of the patches, leaf by leaf and joined: hierarchical.py, collocation.py. */

#include "core.h"
#include "kernels.h"

#define BLOCK_ROWS 64      /* of the forward substitution */
#define WIDEST_SERIES 0.4  /* half_space.WIDEST_SERIES */
#define SERIES 8           /* half_space.TERMS */

/* zeta(2 k) / k, k = 1 ... 8 */
static const double zeta_over[SERIES] = {
    1.6449340668482264, 0.5411616168555691,  0.33911435399481643, 0.2510193390494861,
    0.20019891502556358, 0.166707681092218, 0.1428658925907227, 0.12500191028242608,
};

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

/* uniform - log|2 sin((x_i - x_j)/2)| above the diagonal, by columns; sine and cosine of x/2 are those of `half`. */
VECTORISED static void between_nodes(Size n, const double *RESTRICT half, double uniform, double *RESTRICT matrix)
{
    Size i, j;
    const double *sine = half, *cosine = half + n;
    for (j = 0; j < n; j++) {
        double *RESTRICT column = matrix + j * n;
        double s = 2 * sine[j], c = 2 * cosine[j];
        for (i = 0; i < j; i++)
            column[i] = uniform - log_of_size(sine[i] * c - cosine[i] * s);
        column[j] = uniform;
    }
}

/* half_space.within_patch, on and above the diagonal: uniform - moments - log r - log sinc(r (t - t')/2). */
VECTORISED static void within_patch(const Table *table, double r, double uniform, double *RESTRICT matrix, Size ld)
{
    Size i, j, n = table->n, k;
    double rest = uniform - log(r);
    for (j = 0; j < n; j++) {
        double *RESTRICT column = matrix + j * ld;
        const double *moments = table->moments + j * n;
        for (i = 0; i <= j; i++) {
            double apart = r * (table->nodes[i] - table->nodes[j]) / (2 * PI), square = apart * apart, sum = 0.0;
            for (k = SERIES - 1; k >= 0; k--)
                sum = (sum + zeta_over[k]) * square;
            column[i] = rest - moments[i] + sum;
        }
        if (r > WIDEST_SERIES)
            for (i = 0; i < j; i++) {
                double y = r * (table->nodes[i] - table->nodes[j]) / 2;
                column[i] = rest - moments[i] - log(sin(y) / y);
            }
    }
}

/* hierarchical._gram: Y = U^-T rhs in place by blocks of rows, and Y^T Y; column c of rhs begins at row begin[c]. */
static void substitute(Size n, Size m, const double *upper, double *rhs, const Size *begin, double *gram)
{
    Size start, end, active, from, to, seen;
    char triangle = 'U', transposed = 'T';
    double one = 1.0;
    memset(gram, 0, (size_t)(m * m) * sizeof(double));
    for (start = 0, active = 0; start < n; start = end) {
        int in_active, rows, ld = (int)n, ld_gram = (int)m;
        end = start + BLOCK_ROWS < n ? start + BLOCK_ROWS : n;
        while (active < m && begin[active] < end)
            active++;
        for (from = 0, seen = 0; from < start; from = to) {
            to = from + BLOCK_ROWS;
            while (seen < m && begin[seen] < to)
                seen++;
            product('T', 'N', end - start, seen, to - from, -1.0, upper + start * n + from, n, rhs + from, n, 1.0,
                    rhs + start, n);
        }
        solve_upper('T', end - start, active, upper + start * n + start, n, rhs + start, n);
        in_active = (int)active;
        rows = (int)(end - start);
        blas.dsyrk(&triangle, &transposed, &in_active, &rows, &one, rhs + start, &ld, &one, gram, &ld_gram);
    }
    for (start = 0; start < m; start++)
        for (end = 0; end < start; end++)
            gram[end * m + start] = gram[start * m + end];
}

/* hierarchical.solved_leaf(skeleton, first, last, shared, addition): b^T A^-1 b of a leaf, the lower factor of A, and
   Y of the shared columns, one a row; None where A is not positive definite. */
DECLARED(solved_leaf)
{
    Call call;
    Size n_x[1], n_patches[1], of_edges[2], of_shared[2], of_addition[2] = {0, 0}, i, k, c, first, last, n = 0, m = 0;
    double *x, *half_width, *at_edges, *shared, *addition = NULL, *matrix, *solved, *gram, *rhs = NULL, *half = NULL;
    double uniform;
    int64_t *index, *starts;
    Size n_index, n_starts, *begin = NULL;
    Table *tables;
    PyObject *coupled, *classes, *parts[3] = {NULL, NULL, NULL}, *result = NULL;
    if (!enter(&call, n_given, 6))
        return NULL;
    x = reals(&call, attribute(&call, given[0], "x"), 1, n_x);
    at_edges = reals(&call, attribute(&call, given[0], "at_edges"), 2, of_edges);
    half_width = reals(&call, attribute(&call, attribute(&call, given[0], "patches"), "half_width"), 1, n_patches);
    coupled = attribute(&call, given[0], "coupled");
    index = integers(&call, attribute(&call, coupled, "index"), &n_index);
    starts = integers(&call, attribute(&call, coupled, "starts"), &n_starts);
    classes = attribute(&call, coupled, "tables");
    first = count(&call, given[1]);
    last = count(&call, given[2]);
    shared = reals(&call, given[3], 2, of_shared);
    if (given[4] != Py_None)
        addition = reals(&call, given[4], 2, of_addition);
    uniform = number(&call, given[5]);
    expect(&call, n_patches[0] == n_index && n_starts == n_index + 1 && of_edges[0] == n_x[0] && of_edges[1] == 2,
           "patches, modes and nodes differ");
    expect(&call, 0 <= first && first < last && last <= n_index, "no such leaf");
    tables = tables_of(&call, classes);
    for (i = first; !call.failed && i < last; i++)
        expect(&call, 0 <= index[i] && index[i] < PyTuple_GET_SIZE(classes) && starts[i] >= 0 &&
                          starts[i + 1] <= n_x[0] && starts[i + 1] - starts[i] == tables[index[i]].n,
               "modes: index out of range");
    if (!call.failed) {
        n = (Size)(starts[last] - starts[first]);
        m = of_shared[1] + 2 * (last - first);
    }
    expect(&call, of_shared[0] == n && (addition == NULL || (of_addition[0] == n && of_addition[1] == n)),
           "shared columns or addition of another size");
    parts[0] = new_reals(&call, 2, m, m, &gram);
    parts[1] = new_reals(&call, 2, n, n, &matrix);
    parts[2] = new_reals(&call, 2, of_shared[1], n, &solved);
    if (!call.failed && (rhs = workspace(n * m)) && (half = workspace(2 * n)) && (begin = (Size *)workspace(m))) {
        char upper = 'U';
        int order = (int)n, info;
        x += starts[first];
        at_edges += 2 * starts[first];
        for (i = 0; i < n; i++) {
            half[i] = sin(x[i] / 2);
            half[n + i] = cos(x[i] / 2);
        }
        between_nodes(n, half, uniform, matrix);
        memset(rhs, 0, (size_t)(n * m) * sizeof(double));
        for (c = 0; c < of_shared[1]; c++)
            for (i = 0, begin[c] = 0; i < n; i++)
                rhs[c * n + i] = shared[i * of_shared[1] + c];
        for (i = first, c = of_shared[1]; i < last; i++, c += 2) {
            Size start = (Size)(starts[i] - starts[first]);
            const Table *table = &tables[index[i]];
            within_patch(table, half_width[i], uniform, matrix + start * n + start, n);
            begin[c] = begin[c + 1] = start;
            for (k = start; k < start + table->n; k++) {
                rhs[c * n + k] = at_edges[2 * k];
                rhs[(c + 1) * n + k] = at_edges[2 * k + 1];
            }
        }
        if (addition != NULL)
            for (i = 0; i < n * n; i++)
                matrix[i] -= addition[i];
        blas.dpotrf(&upper, &order, matrix, &order, &info);
        if (info == 0) {
            substitute(n, m, matrix, rhs, begin, gram);
            memcpy(solved, rhs, (size_t)(n * of_shared[1]) * sizeof(double));
            result = PyTuple_Pack(3, parts[0], parts[1], parts[2]);
        } else {
            result = Py_None;
            Py_INCREF(result);
        }
    }
    for (i = 0; i < 3; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(begin);
    PyMem_Free(half);
    PyMem_Free(rhs);
    PyMem_Free(tables);
    leave(&call);
    return result;
}
