/* The system of all patches, cluster by cluster: hierarchical.py. */

#include "hierarchical.h"

#define CENTRED 10.0  /* hierarchical.CENTRED */
#define MOST_OFF 0.25 /* hierarchical.MOST_OFF */
#define PANEL 64      /* columns at a time of a symmetric product */

static void forget_grams(Cluster *cluster)
{
    PyMem_Free(cluster->gram);
    PyMem_Free(cluster->with_edges);
    PyMem_Free(cluster->with_slopes);
    cluster->gram = cluster->with_edges = cluster->with_slopes = NULL;
}

static void release(Cluster *cluster)
{
    forget_grams(cluster);
    PyMem_Free(cluster->factor);
    PyMem_Free(cluster->solved);
    PyMem_Free(cluster->response);
    if (cluster->halves != NULL) {
        release(&cluster->halves[0]);
        release(&cluster->halves[1]);
        PyMem_Free(cluster->halves);
    }
}

/* hierarchical._middle: the three different blocks of M of two halves, (q, q), from X_1, X_2, whose columns are `ld`
   numbers apart, and C; 0 where the matrix is not positive definite.  `work` has room for 5 q q + 2 q numbers; C is
   symmetric. */
static int middle(Size q, const double *first, const double *second, Size ld, const double *core, double *work,
                  double *const *m)
{
    double *root = work, *other = root + q * q, *factor = other + q * q, *to_first = factor + q * q;
    double *to_second = to_first + q * q, *scratch = to_second + q * q, tolerance = -1.0;
    int *pivots = (int *)to_second, order = (int)q, rank, info;
    char lower = 'L';
    Size i, j;
    for (j = 0; j < q; j++)
        memcpy(other + j * q, first + j * ld, (size_t)q * sizeof(double));
    blas.dpstrf(&lower, &order, other, &order, pivots, &rank, &tolerance, scratch, &info);
    memset(root, 0, (size_t)(q * q) * sizeof(double)); /* R, `rank` columns */
    for (j = 0; j < rank; j++)
        for (i = j; i < q; i++)
            root[j * q + pivots[i] - 1] = other[j * q + i];
    product('N', 'N', q, q, q, 1.0, second, ld, core, q, 0.0, other, q);
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

/* C -= A^T B above the diagonal of C, (n, n); A and B of q rows. */
static void subtract_upper(Size n, Size q, const double *a, Size lda, const double *b, double *c, Size ldc)
{
    Size start, end;
    for (start = 0; start < n; start = end) {
        end = start + PANEL < n ? start + PANEL : n;
        product('T', 'N', end, end - start, q, -1.0, a, lda, b + start * q, q, 1.0, c + start * ldc, ldc);
    }
}

/* -V^T M V of the edges of two halves, and of edges and slopes, into the matrices of all edges, from patch `first`. */
static void join_edges(const System *system, Size first, const Cluster *pair, double *const *m, double *reply)
{
    const Cluster *half = pair->halves;
    Size q = pair->rank, shared = pair->shared, ld = shared + q, all = system->edges, corner = 2 * first * (all + 1);
    Size n = half[0].edges, other = half[1].edges;
    const double *edge[2] = {half[0].with_edges + shared, half[1].with_edges + shared};
    double *to = system->compliance + corner, *behind = reply + q * n;
    product('N', 'N', q, n, q, 1.0, m[0], q, edge[0], ld, 0.0, reply, q);
    subtract_upper(n, q, edge[0], ld, reply, to, all);
    product('N', 'N', q, other, q, 1.0, m[1], q, edge[1], ld, 0.0, reply, q);
    product('T', 'N', n, other, q, -1.0, edge[0], ld, reply, q, 1.0, to + n * all, all);
    product('N', 'N', q, other, q, 1.0, m[2], q, edge[1], ld, 0.0, reply, q);
    subtract_upper(other, q, edge[1], ld, reply, to + n * (all + 1), all);
    if (system->per_patch == 4) {
        const double *slope[2] = {half[0].with_slopes + shared, half[1].with_slopes + shared};
        to = system->slopes + corner;
        product('N', 'N', q, n, q, 1.0, m[0], q, slope[0], ld, 0.0, reply, q);
        product('N', 'N', q, other, q, 1.0, m[1], q, slope[1], ld, 0.0, behind, q);
        product('T', 'N', n, n + other, q, -1.0, edge[0], ld, reply, q, 1.0, to, all);
        product('T', 'N', q, n, q, 1.0, m[1], q, slope[0], ld, 0.0, reply, q);
        product('N', 'N', q, other, q, 1.0, m[2], q, slope[1], ld, 0.0, behind, q);
        product('T', 'N', other, n + other, q, -1.0, edge[1], ld, reply, q, 1.0, to + n, all);
    }
}

/* b^T A'^-1 b of the shared columns with others of both halves, `sizes` of them, from those of the halves. */
static void join_columns(const Cluster *pair, const double *const *parts, const Size *sizes, double *to)
{
    Size q = pair->rank, shared = pair->shared, ld = shared + q, part, i;
    for (part = 0; part < 2; part++) {
        for (i = 0; i < sizes[part]; i++)
            memcpy(to + i * shared, parts[part] + i * ld, (size_t)shared * sizeof(double));
        product('T', 'N', shared, sizes[part], q, -1.0, pair->response + part * q, 2 * q, parts[part] + shared, ld, 1.0,
                to, shared);
        to += sizes[part] * shared;
    }
}

/* hierarchical._joined: b^T A^-1 b of a pair and M V of its shared columns from those of its halves.  V of the edges of
   one half has no rows of the other. */
static Status joined(const System *system, Size first, Cluster *pair, const double *core)
{
    const Cluster *half = pair->halves;
    Size shared = pair->shared, q = pair->rank, ld = shared + q, i, j, sizes[2] = {half[0].edges, half[1].edges};
    const double *seen[2] = {half[0].gram + shared, half[1].gram + shared};
    const double *edges[2] = {half[0].with_edges, half[1].with_edges};
    const double *slopes[2] = {half[0].with_slopes, half[1].with_slopes};
    double *work = workspace(8 * q * q + 2 * q + q * pair->edges), *top = pair->response = workspace(2 * q * shared);
    double *m[3], *bottom;
    Status status = FAILED;
    if (work != NULL && top != NULL) {
        for (i = 0; i < 3; i++)
            m[i] = work + (5 + i) * q * q + 2 * q;
        status = middle(q, seen[0] + shared * ld, seen[1] + shared * ld, ld, core, work, m) ? SOLVED : NOT_DEFINITE;
    }
    if (status == SOLVED) {
        bottom = top + q;
        product('N', 'N', q, shared, q, 1.0, m[0], q, seen[0], ld, 0.0, top, 2 * q);
        product('N', 'N', q, shared, q, 1.0, m[1], q, seen[1], ld, 1.0, top, 2 * q);
        product('T', 'N', q, shared, q, 1.0, m[1], q, seen[0], ld, 0.0, bottom, 2 * q);
        product('N', 'N', q, shared, q, 1.0, m[2], q, seen[1], ld, 1.0, bottom, 2 * q);
        for (i = 0; i < shared; i++)
            for (j = 0; j < shared; j++)
                pair->gram[i * shared + j] = half[0].gram[i * ld + j] + half[1].gram[i * ld + j];
        product('T', 'N', shared, shared, q, -1.0, seen[0], ld, top, 2 * q, 1.0, pair->gram, shared);
        product('T', 'N', shared, shared, q, -1.0, seen[1], ld, bottom, 2 * q, 1.0, pair->gram, shared);
        join_columns(pair, edges, sizes, pair->with_edges);
        if (system->per_patch == 4)
            join_columns(pair, slopes, sizes, pair->with_slopes);
        join_edges(system, first, pair, m, work + 8 * q * q + 2 * q);
    }
    PyMem_Free(work);
    return status;
}

/* Unknowns of a cluster between its middle and patch i, in parts of them all. */
static double off_middle(const Table *tables, Size first, Size last, Size i)
{
    double start = (double)tables[first].start, end = (double)tables[last].start;
    return fabs((double)tables[i].start - (start + end) / 2) / (end - start);
}

/* Where hierarchical._cluster splits patches from `first` to before `last`: in a wide gap not far from the middle. */
static Size cut_of(const System *system, Size first, Size last)
{
    const double *left = system->left, *right = system->right;
    double best = HUGE_VAL;
    Size middle = first + 1, cut = first + 1, i;
    for (i = first + 2; i < last; i++)
        if (off_middle(system->tables, first, last, i) < off_middle(system->tables, first, last, middle))
            middle = i;
    for (i = first + 1; i < last; i++) {
        double wider = log((left[i] - right[i - 1]) / (left[middle] - right[middle - 1]));
        double cost = CENTRED * off_middle(system->tables, first, last, i);
        cost -= wider < CENTRED * MOST_OFF ? wider : CENTRED * MOST_OFF;
        if (cost < best) {
            best = cost;
            cut = i;
        }
    }
    return cut;
}

/* hierarchical._cluster: patches from `first` to before `last`, with the columns shared from above. */
static Status solved_cluster(System *system, Size first, Size last, const Columns *columns, Cluster *cluster)
{
    const Table *tables = system->tables;
    double *core = NULL;
    const Range *range = NULL;
    Columns wider = {.above = columns};
    Size n = tables[last].start - tables[first].start, shared = columns->shared, cut, i;
    Status status = FAILED;
    memset(cluster, 0, sizeof *cluster);
    cluster->n = n;
    cluster->m = shared + system->per_patch * (last - first);
    cluster->shared = shared;
    cluster->edges = system->per_patch == 0 ? 0 : 2 * (last - first);
    cluster->gram = workspace(shared * shared);
    cluster->with_edges = workspace(shared * cluster->edges);
    cluster->with_slopes = workspace(system->per_patch == 4 ? shared * cluster->edges : 0);
    if (cluster->gram == NULL || cluster->with_edges == NULL || cluster->with_slopes == NULL)
        return FAILED;
    if (last - first == 1 || n <= system->largest || system->addition != NULL)
        return solved_leaf(system, first, last, columns, cluster);
    cut = cut_of(system, first, last);
    if ((cluster->halves = PyMem_Calloc(2, sizeof(Cluster))) == NULL)
        PyErr_NoMemory();
    range = cluster->halves != NULL ? widened(system, first, cut, last, &wider) : NULL;
    if (range != NULL && wider.values != NULL && (core = workspace(range->q * range->q)) != NULL) {
        for (i = 0; i < range->q * range->q; i++)
            core[i] = -range->core[i];
        core[range->q + 1] += system->uniform; /* the second column is 1 */
        cluster->rank = range->q;
        status = solved_cluster(system, first, cut, &wider, &cluster->halves[0]);
        if (status == SOLVED)
            status = solved_cluster(system, cut, last, &wider, &cluster->halves[1]);
        if (status == SOLVED)
            status = joined(system, first, cluster, core);
        for (i = 0; i < 2; i++)
            forget_grams(&cluster->halves[i]);
    }
    PyMem_Free((void *)wider.values);
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

/* The same of what edges do at edges and of the slopes that they make there, left ones first; `change` of edges. */
static void corrected_edges(const System *system, const Cluster *whole, const double *change, double *compliance,
                            double *slopes)
{
    Size k = whole->shared, edges = whole->edges, half = edges / 2, i, j;
    for (i = 0; i < edges; i++) {
        Size row = 2 * (i % half) + i / half;
        double one = whole->with_edges[row * k + 1]; /* b^T A'^-1 1 */
        double bent = system->per_patch == 4 ? whole->with_slopes[row * k + 1] : 0.0;
        for (j = 0; j < edges; j++) {
            Size column = 2 * (j % half) + j / half, low = row < column ? row : column, high = row + column - low;
            *compliance++ = system->compliance[high * edges + low] + one * change[column];
            if (system->per_patch == 4)
                *slopes++ = system->slopes[row * edges + column] + bent * change[column];
        }
    }
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

static double *zeros(Size n)
{
    double *memory = workspace(n);
    return memory == NULL ? NULL : memset(memory, 0, (size_t)n * sizeof(double));
}

Status solved_system(System *system, Size patches, Size k, const double *columns, double *const *made)
{
    Size n = system->n, edges = system->edges = system->per_patch == 0 ? 0 : 2 * patches, i;
    double *half = workspace(2 * n), *unit = workspace(k * k), *change = workspace(k + edges), remaining, share;
    Columns asked = {.values = columns, .ld = n, .count = k, .shared = k};
    Cluster whole;
    Status status = FAILED;
    memset(&whole, 0, sizeof whole);
    system->compliance = zeros(edges * edges);
    system->slopes = zeros(system->per_patch == 4 ? edges * edges : 0);
    if (half != NULL && unit != NULL && change != NULL && system->compliance != NULL && system->slopes != NULL) {
        system->half = half;
        for (i = 0; i < n; i++) {
            half[i] = sin(system->x[i] / 2);
            half[n + i] = cos(system->x[i] / 2);
        }
        for (i = 0; i < k * k; i++)
            unit[i] = i % (k + 1) == 0;
        status = solved_cluster(system, 0, patches, &asked, &whole);
        if (status == SOLVED && !charges_of(&whole, k, unit, made[3], n))
            status = FAILED;
        if (status == SOLVED && (remaining = 1 - system->uniform * whole.gram[k + 1]) <= 0)
            status = NOT_DEFINITE;
        if (status == SOLVED) {
            share = system->uniform / remaining;
            for (i = 0; i < k + edges; i++)
                change[i] = (i < k ? whole.gram[k + i] : whole.with_edges[(i - k) * k + 1]) * share;
            for (i = 0; i < k * k; i++)
                made[2][i] = whole.gram[i] + change[i / k] * whole.gram[k + i % k];
            sums_at_edges(system, patches, k, made[3], made[4], made[5]);
            corrected_edges(system, &whole, change + k, made[0], made[1]);
            corrected(k, change, n, made[3]);
            corrected(k, change, 2 * patches, made[4]);
            corrected(k, change, 2 * patches, made[5]);
        }
    }
    release(&whole);
    PyMem_Free(half);
    PyMem_Free(unit);
    PyMem_Free(change);
    PyMem_Free(system->compliance);
    PyMem_Free(system->slopes);
    return status;
}
