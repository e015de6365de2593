/* The system of all patches, cluster by cluster: hierarchical.py. */

#include "hierarchical.h"
#include "kernels.h"

#define CENTRED 10.0 /* hierarchical.CENTRED */

static void release(Cluster *cluster)
{
    PyMem_Free(cluster->gram);
    PyMem_Free(cluster->factor);
    PyMem_Free(cluster->solved);
    PyMem_Free(cluster->response);
    if (cluster->halves != NULL) {
        release(&cluster->halves[0]);
        release(&cluster->halves[1]);
        PyMem_Free(cluster->halves);
    }
}

/* hierarchical._middle: the three different blocks of M of two halves, (q, q), from X_1, X_2 and C; 0 where the matrix
   is not positive definite.  `work` has room for 5 q q + 2 q numbers; C is symmetric. */
static int middle(Size q, const double *first, const double *second, const double *core, double *work, double *const *m)
{
    double *root = work, *other = root + q * q, *factor = other + q * q, *to_first = factor + q * q;
    double *to_second = to_first + q * q, *scratch = to_second + q * q, tolerance = -1.0;
    int *pivots = (int *)to_second, order = (int)q, rank, info;
    char lower = 'L';
    Size i, j;
    memcpy(other, first, (size_t)(q * q) * sizeof(double));
    blas.dpstrf(&lower, &order, other, &order, pivots, &rank, &tolerance, scratch, &info);
    memset(root, 0, (size_t)(q * q) * sizeof(double)); /* R, `rank` columns */
    for (j = 0; j < rank; j++)
        for (i = j; i < q; i++)
            root[j * q + pivots[i] - 1] = other[j * q + i];
    product('N', 'N', q, q, q, 1.0, second, q, core, q, 0.0, other, q);
    product('N', 'N', q, q, q, -1.0, core, q, other, q, 0.0, m[0], q); /* -H */
    product('N', 'N', q, rank, q, 1.0, m[0], q, root, q, 0.0, to_first, q);
    product('T', 'N', rank, rank, q, 1.0, root, q, to_first, q, 0.0, factor, q);
    for (i = 0; i < rank; i++)
        factor[i * q + i] += 1.0;
    blas.dpotrf(&lower, &rank, factor, &order, &info);
    if (info != 0)
        return 0;
    solve_lower('R', 'T', q, rank, factor, q, root, q); /* E is its product with its transpose */
    solve_lower('R', 'T', q, rank, factor, q, to_first, q);
    product('N', 'N', q, rank, q, 1.0, core, q, root, q, 0.0, to_second, q);
    memcpy(m[1], core, (size_t)(q * q) * sizeof(double));
    product('N', 'T', q, q, rank, -1.0, to_first, q, to_first, q, 1.0, m[0], q);
    product('N', 'T', q, q, rank, -1.0, to_first, q, to_second, q, 1.0, m[1], q);
    product('N', 'T', q, q, rank, -1.0, to_second, q, to_second, q, 0.0, m[2], q);
    return 1;
}

/* hierarchical._joined: b^T A^-1 b of a pair and M V of its shared columns from those of its halves.  V of the edges of
   one half has no rows of the other. */
static Status joined(Cluster *pair, const double *core)
{
    Size shared = pair->shared, q = pair->rank, size = pair->m, place = shared, edges[2], part, i, j;
    double *work = workspace(10 * q * q + 2 * q + q * (2 * shared + 2 * size)), *own[2], *m[3], *seen[2];
    double *gram = pair->gram = workspace(size * size);
    Status status = FAILED;
    pair->response = workspace(2 * q * shared);
    if (work != NULL && gram != NULL && pair->response != NULL) {
        for (i = 0; i < 2; i++) {
            edges[i] = pair->halves[i].m - shared - q;
            own[i] = work + (5 + i) * q * q + 2 * q; /* X_1 and X_2 */
        }
        for (i = 0; i < 3; i++)
            m[i] = own[1] + (1 + i) * q * q;
        seen[0] = m[2] + q * q;
        seen[1] = seen[0] + q * (shared + edges[0]);
        for (part = 0; part < 2; part++) {
            Size full = pair->halves[part].m;
            const double *from = pair->halves[part].gram;
            for (i = 0; i < q; i++)
                memcpy(own[part] + i * q, from + (shared + i) * full + shared, (size_t)q * sizeof(double));
            for (i = 0; i < shared + edges[part]; i++) {
                Size column = i < shared ? i : i + q;
                memcpy(seen[part] + i * q, from + column * full + shared, (size_t)q * sizeof(double));
            }
            for (i = 0; i < shared; i++) {
                for (j = 0; j < shared; j++)
                    gram[i * size + j] = from[i * full + j] + (part == 0 ? 0.0 : gram[i * size + j]);
                memcpy(gram + i * size + place, from + i * full + shared + q, (size_t)edges[part] * sizeof(double));
            }
            for (i = 0; i < edges[part]; i++)
                memcpy(gram + (place + i) * size + place, from + (shared + q + i) * full + shared + q,
                       (size_t)edges[part] * sizeof(double));
            place += edges[part];
        }
        status = middle(q, own[0], own[1], core, work, m) ? SOLVED : NOT_DEFINITE;
        if (status == SOLVED) {
            double *edge[2] = {seen[0] + shared * q, seen[1] + shared * q}, *reply = seen[1] + q * (shared + edges[1]);
            double *top = pair->response, *bottom = top + q, *corner = gram + shared * (size + 1);
            for (j = shared + edges[0]; j < size; j++)
                memset(gram + j * size + shared, 0, (size_t)edges[0] * sizeof(double));
            product('N', 'N', q, shared, q, 1.0, m[0], q, seen[0], q, 0.0, top, 2 * q);
            product('N', 'N', q, shared, q, 1.0, m[1], q, seen[1], q, 1.0, top, 2 * q);
            product('T', 'N', q, shared, q, 1.0, m[1], q, seen[0], q, 0.0, bottom, 2 * q);
            product('N', 'N', q, shared, q, 1.0, m[2], q, seen[1], q, 1.0, bottom, 2 * q);
            product('T', 'N', shared + edges[0], shared, q, -1.0, seen[0], q, top, 2 * q, 1.0, gram, size);
            product('T', 'N', shared, shared, q, -1.0, seen[1], q, bottom, 2 * q, 1.0, gram, size);
            product('T', 'N', edges[1], shared, q, -1.0, edge[1], q, bottom, 2 * q, 1.0, gram + shared + edges[0],
                    size);
            product('N', 'N', q, edges[0], q, 1.0, m[0], q, edge[0], q, 0.0, reply, q);
            product('N', 'N', q, edges[1], q, 1.0, m[1], q, edge[1], q, 0.0, reply + q * edges[0], q);
            product('T', 'N', edges[0], edges[0] + edges[1], q, -1.0, edge[0], q, reply, q, 1.0, corner, size);
            product('N', 'N', q, edges[1], q, 1.0, m[2], q, edge[1], q, 0.0, reply, q);
            product('T', 'N', edges[1], edges[1], q, -1.0, edge[1], q, reply, q, 1.0, corner + edges[0] * (size + 1),
                    size);
            for (j = shared; j < size; j++) {
                for (i = 0; i < shared; i++)
                    gram[j * size + i] = gram[i * size + j];
                for (i = shared + edges[0]; j < shared + edges[0] && i < size; i++)
                    gram[j * size + i] = gram[i * size + j];
            }
        }
    }
    PyMem_Free(work);
    return status;
}

/* hierarchical._cluster: patches from `first` to before `last`, with `shared` columns at their nodes. */
static Status solved_cluster(System *system, Size first, Size last, Size shared, const double *columns,
                             Cluster *cluster)
{
    const Table *tables = system->tables;
    double *wider[2] = {NULL, NULL}, *core = NULL, best = HUGE_VAL;
    const Range *range = NULL;
    Size n = tables[last].start - tables[first].start, cut = first + 1, i;
    Status status = FAILED;
    memset(cluster, 0, sizeof *cluster);
    cluster->n = n;
    cluster->m = shared + system->per_patch * (last - first);
    cluster->shared = shared;
    if (last - first == 1 || n <= system->largest || system->addition != NULL)
        return solved_leaf(system, first, last, columns, cluster);
    for (i = first + 1; i < last; i++) {
        double off = fabs((double)tables[i].start - (double)(tables[first].start + tables[last].start) / 2) / (double)n;
        double cost = CENTRED * off - log(system->left[i] - system->right[i - 1]);
        if (cost < best) {
            best = cost;
            cut = i;
        }
    }
    cluster->halves = PyMem_Calloc(2, sizeof(Cluster));
    range = cluster->halves != NULL ? widened(system, first, cut, last, shared, columns, wider) : NULL;
    if (range != NULL && wider[1] != NULL && (core = workspace(range->q * range->q)) != NULL) {
        for (i = 0; i < range->q * range->q; i++)
            core[i] = -range->core[i];
        core[range->q + 1] += system->uniform; /* the second column is 1 */
        cluster->rank = range->q;
        status = solved_cluster(system, first, cut, shared + range->q, wider[0], &cluster->halves[0]);
        if (status == SOLVED)
            status = solved_cluster(system, cut, last, shared + range->q, wider[1], &cluster->halves[1]);
        if (status == SOLVED)
            status = joined(cluster, core);
        for (i = 0; i < 2; i++) {
            PyMem_Free(cluster->halves[i].gram);
            cluster->halves[i].gram = NULL;
        }
    }
    PyMem_Free(wider[0]);
    PyMem_Free(wider[1]);
    PyMem_Free(core);
    return status;
}

/* A'^-1 b of the shared columns in these amounts, (shared, k) to (n, k); 0 without memory. */
static int charges_of(const Cluster *cluster, Size k, const double *amounts, double *charges, Size ld)
{
    Size shared = cluster->shared, q = cluster->rank, inner = shared + q, part, i;
    double *into, *given;
    if (cluster->halves == NULL) {
        product('T', 'N', cluster->n, k, shared, 1.0, cluster->solved, cluster->m, amounts, shared, 0.0, charges, ld);
        solve_lower('L', 'T', cluster->n, k, cluster->factor, cluster->n, charges, ld);
        return 1;
    }
    if ((into = workspace(k * (2 * q + inner))) == NULL)
        return 0;
    given = into + k * 2 * q;
    product('N', 'N', 2 * q, k, shared, -1.0, cluster->response, 2 * q, amounts, shared, 0.0, into, 2 * q);
    for (part = 0; part < 2; part++) {
        for (i = 0; i < k; i++) {
            memcpy(given + i * inner, amounts + i * shared, (size_t)shared * sizeof(double));
            memcpy(given + i * inner + shared, into + i * 2 * q + part * q, (size_t)q * sizeof(double));
        }
        if (!charges_of(&cluster->halves[part], k, given, charges + (part == 0 ? 0 : cluster->halves[0].n), ld))
            break;
    }
    PyMem_Free(into);
    return part == 2;
}

/* Values of k columns with alpha 1 1^T taken out by the formula of Sherman and Morrison: `change` times those of column
   1, the last itself. */
static void corrected(Size k, const double *change, Size n, double *values)
{
    Size i, j;
    for (i = k - 1; i >= 0; i--) {
        double *row = values + (i > 1 ? i : 1 - i) * n, factor = change[i > 1 ? i : 1 - i];
        for (j = 0; j < n; j++)
            row[j] += factor * values[n + j];
    }
}

/* The same of a Gram matrix of k shared columns, and those of patches behind them: what edges do at edges, left ones
   first, and the slopes that they make there; and the Gram matrix of the shared ones. */
static void corrected_gram(const System *system, Size patches, Size k, const double *from, const double *change,
                           double *compliance, double *slopes, double *gram)
{
    Size per_patch = system->per_patch, m = k + per_patch * patches, kind, side, i, j;
    const double *ones = from + m; /* b^T A'^-1 1 */
    for (kind = 0; kind < per_patch; kind++)
        for (i = 0; i < patches; i++) {
            Size place = k + per_patch * i + kind;
            double **to = kind < 2 ? &compliance : &slopes;
            for (side = 0; side < 2; side++)
                for (j = k + side; j < m; j += per_patch)
                    *(*to)++ = from[place * m + j] + ones[place] * change[j];
        }
    for (i = 0; i < k; i++)
        for (j = 0; j < k; j++)
            gram[i * k + j] = from[i * m + j] + change[i] * ones[j];
}

/* q of the charges of k columns at the edges, and sum n^2 (+-1)^n Q_n, (k, 2 L) each, left edges first. */
static void sums_at_edges(const System *system, Size patches, Size k, const double *charges, double *values,
                          double *slopes)
{
    Size column, i, j;
    for (column = 0; column < k; column++, values += 2 * patches, slopes += 2 * patches)
        for (i = 0; i < patches; i++) {
            const double *to = system->tables[i].at_edges;
            Size n = system->tables[i].n;
            double sums[4] = {0.0, 0.0, 0.0, 0.0};
            for (j = 0; j < n; j++, to++, charges++) {
                sums[0] += to[0] * *charges;
                sums[1] += to[n] * *charges;
                sums[2] += to[2 * n] * *charges; /* `slopes` stands behind `at_edges` */
                sums[3] += to[3 * n] * *charges;
            }
            values[i] = sums[0];
            values[patches + i] = sums[1];
            slopes[i] = sums[2];
            slopes[patches + i] = sums[3];
        }
}

/* hierarchical.solved(skeleton, splitting). */
DECLARED(solved)
{
    Call call;
    Size n[1], patches[1], of_left[1], of_right[1], of_columns[2], of_addition[2], of_modes, i, k, edges;
    double *half = NULL, *unit = NULL, *change = NULL, *columns, *made[6], remaining;
    int64_t *modes;
    System system;
    Cluster whole;
    Status status = FAILED;
    PyObject *object, *parts[6], *result = NULL;
    if (!enter(&call, n_given, 2))
        return NULL;
    memset(&whole, 0, sizeof whole);
    memset(&system, 0, sizeof system);
    system.call = &call;
    system.x = reals(&call, attribute(&call, given[0], "x"), 1, n);
    columns = reals(&call, attribute(&call, given[0], "columns"), 2, of_columns);
    object = attribute(&call, given[0], "patches");
    system.half_width = reals(&call, attribute(&call, object, "half_width"), 1, patches);
    system.left = reals(&call, attribute(&call, object, "left"), 1, of_left);
    system.right = reals(&call, attribute(&call, object, "right"), 1, of_right);
    modes = integers(&call, attribute(&call, given[0], "modes"), &of_modes);
    system.per_patch = count(&call, attribute(&call, given[0], "edge_columns"));
    expect(&call, system.per_patch == 0 || system.per_patch == 2 || system.per_patch == 4, "edge columns: 0, 2 or 4");
    object = attribute(&call, given[0], "addition");
    if (object != Py_None)
        system.addition = reals(&call, object, 2, of_addition);
    system.accuracy = number(&call, attribute(&call, given[1], "accuracy"));
    system.largest = count(&call, attribute(&call, given[1], "largest"));
    system.uniform = number(&call, attribute(&call, given[1], "uniform"));
    system.n = n[0];
    expect(&call, of_modes > 0 && patches[0] == of_modes && of_left[0] == of_modes && of_right[0] == of_modes,
           "patches and modes differ");
    expect(&call, of_columns[0] >= 2 && of_columns[1] == n[0], "columns and nodes differ");
    expect(&call, system.addition == NULL || (of_addition[0] == n[0] && of_addition[1] == n[0]),
           "addition of another size");
    system.tables = tables_of(&call, "packed_basis", modes, of_modes);
    expect(&call, call.failed || system.tables[of_modes].start == n[0], "modes and nodes differ");
    k = of_columns[0];
    edges = system.per_patch == 0 ? 0 : 2 * of_modes;
    parts[0] = new_reals(&call, 2, edges, edges, &made[0]);
    parts[1] = new_reals(&call, 2, system.per_patch == 4 ? edges : 0, edges, &made[1]);
    parts[2] = new_reals(&call, 2, k, k, &made[2]);
    parts[3] = new_reals(&call, 2, k, n[0], &made[3]);
    parts[4] = new_reals(&call, 2, k, 2 * of_modes, &made[4]);
    parts[5] = new_reals(&call, 2, k, 2 * of_modes, &made[5]);
    if (!call.failed && (half = workspace(2 * n[0])) && (unit = workspace(k * k))) {
        system.half = half;
        for (i = 0; i < n[0]; i++) {
            half[i] = sin(system.x[i] / 2);
            half[n[0] + i] = cos(system.x[i] / 2);
        }
        for (i = 0; i < k * k; i++)
            unit[i] = i % (k + 1) == 0;
        status = solved_cluster(&system, 0, of_modes, k, columns, &whole);
        if (status == SOLVED && !charges_of(&whole, k, unit, made[3], n[0]))
            status = FAILED;
        if (status == SOLVED && (remaining = 1 - system.uniform * whole.gram[whole.m + 1]) <= 0)
            status = NOT_DEFINITE;
        if (status == SOLVED && (change = workspace(whole.m)) == NULL)
            status = FAILED;
        if (status == SOLVED) {
            for (i = 0; i < whole.m; i++)
                change[i] = whole.gram[whole.m + i] * (system.uniform / remaining);
            sums_at_edges(&system, of_modes, k, made[3], made[4], made[5]);
            corrected_gram(&system, of_modes, k, whole.gram, change, made[0], made[1], made[2]);
            corrected(k, change, n[0], made[3]);
            corrected(k, change, 2 * of_modes, made[4]);
            corrected(k, change, 2 * of_modes, made[5]);
            result = PyTuple_Pack(6, parts[0], parts[1], parts[2], parts[3], parts[4], parts[5]);
        } else if (status == NOT_DEFINITE) {
            result = Py_None;
            Py_INCREF(result);
        }
    }
    release(&whole);
    for (i = 0; i < 6; i++)
        Py_XDECREF(parts[i]);
    PyMem_Free(half);
    PyMem_Free(unit);
    PyMem_Free(change);
    PyMem_Free((void *)system.tables);
    leave(&call);
    return result;
}
