/* A cluster that is not split: the kernel between its nodes and its Cholesky factor: hierarchical.py, half_space.py. */

#include "hierarchical.h"

#define BLOCK_ROWS 48      /* of the forward substitution */
#define WIDEST_SERIES 0.4  /* half_space.WIDEST_SERIES */
#define SERIES 8           /* half_space.TERMS */

/* zeta(2 k) / k, k = 1 ... 8 */
static const double zeta_over[SERIES] = {
    1.6449340668482264, 0.5411616168555691,  0.33911435399481643, 0.2510193390494861,
    0.20019891502556358, 0.166707681092218, 0.1428658925907227, 0.12500191028242608,
};

/* uniform - log|2 sin((x_i - x_j)/2)| below the diagonal, by columns; sine and cosine of x/2 are those of `half`. */
VECTORISED static void between_nodes(Size n, const double *RESTRICT half, double uniform, double *RESTRICT matrix)
{
    Size i, j;
    const double *sine = half, *cosine = half + n;
    for (j = 0; j < n; j++) {
        double *RESTRICT column = matrix + j * n;
        double s = 2 * sine[j], c = 2 * cosine[j];
        for (i = j + 1; i < n; i++)
            column[i] = uniform - log_of_size(sine[i] * c - cosine[i] * s);
        column[j] = uniform;
    }
}

/* half_space.within_patch, on and below the diagonal: uniform - moments - log r - log sinc(r (t - t')/2). */
VECTORISED static void within_patch(const Table *table, double r, double uniform, double *RESTRICT matrix, Size ld)
{
    Size i, j, n = table->n, k;
    double rest = uniform - log(r);
    for (j = 0; j < n; j++) {
        double *RESTRICT column = matrix + j * ld;
        const double *moments = table->moments + j * n;
        for (i = j; i < n; i++) {
            double apart = r * (table->nodes[i] - table->nodes[j]) / (2 * PI), square = apart * apart, sum = 0.0;
            for (k = SERIES - 1; k >= 0; k--)
                sum = (sum + zeta_over[k]) * square;
            column[i] = rest - moments[i] + sum;
        }
        if (r > WIDEST_SERIES)
            for (i = j + 1; i < n; i++) {
                double y = r * (table->nodes[i] - table->nodes[j]) / 2;
                column[i] = rest - moments[i] - log(sin(y) / y);
            }
    }
}

/* hierarchical._gram: Y^T = rhs L^-T in place by blocks of columns, and Y^T Y, (m, m), above its diagonal; row c of rhs
   begins at column begin[c]. */
static void substitute(Size n, Size m, const double *lower, double *rhs, const Size *begin, double *gram)
{
    Size start, end, active, from, to, seen;
    char triangle = 'U', plain = 'N';
    double one = 1.0;
    memset(gram, 0, (size_t)(m * m) * sizeof(double));
    for (start = 0, active = 0; start < n; start = end) {
        int in_active, columns, ld = (int)m;
        end = start + BLOCK_ROWS < n ? start + BLOCK_ROWS : n;
        while (active < m && begin[active] < end)
            active++;
        for (from = 0, seen = 0; from < start; from = to) {
            to = from + BLOCK_ROWS;
            while (seen < m && begin[seen] < to)
                seen++;
            product('N', 'T', seen, end - start, to - from, -1.0, rhs + from * m, m, lower + from * n + start, n, 1.0,
                    rhs + start * m, m);
        }
        solve_lower('R', 'T', active, end - start, lower + start * n + start, n, rhs + start * m, m);
        in_active = (int)active;
        columns = (int)(end - start);
        blas.dsyrk(&triangle, &plain, &in_active, &columns, &one, rhs + start * m, &ld, &one, gram, &ld);
    }
}

/* An entry of a symmetric matrix known above its diagonal. */
static inline double entry(Size m, const double *gram, Size i, Size j)
{
    return i < j ? gram[j * m + i] : gram[i * m + j];
}

/* The parts of the Gram matrix of a leaf, to where they belong; its columns are the shared ones, then the edges and
   slopes of each patch. */
static void distribute(const System *system, Size first, const double *gram, Cluster *leaf)
{
    Size shared = leaf->shared, m = leaf->m, per_patch = system->per_patch, edge, other, i, j;
    for (i = 0; i < shared; i++)
        for (j = 0; j < shared; j++)
            leaf->gram[i * shared + j] = entry(m, gram, i, j);
    for (edge = 0; edge < leaf->edges; edge++) {
        Size column = shared + per_patch * (edge / 2) + edge % 2, at = (2 * first + edge) * system->edges + 2 * first;
        memcpy(leaf->with_edges + edge * shared, gram + column * m, (size_t)shared * sizeof(double));
        if (per_patch == 4)
            memcpy(leaf->with_slopes + edge * shared, gram + (column + 2) * m, (size_t)shared * sizeof(double));
        for (other = 0; other < leaf->edges; other++) {
            Size row = shared + per_patch * (other / 2) + other % 2;
            system->compliance[at + other] = entry(m, gram, row, column);
            if (per_patch == 4)
                system->slopes[at + other] = entry(m, gram, row, column + 2);
        }
    }
}

Status solved_leaf(const System *system, Size first, Size last, const Columns *columns, Cluster *leaf)
{
    Size start = system->tables[first].start, n = leaf->n, m = leaf->m, i, k, c, row;
    double *matrix = leaf->factor = workspace(n * n), *rhs = leaf->solved = workspace(n * m), *half = workspace(2 * n);
    double *gram = workspace(m * m);
    Size *begin = (Size *)workspace(m);
    Status status = FAILED;
    if (matrix != NULL && rhs != NULL && half != NULL && begin != NULL && gram != NULL) {
        char lower = 'L';
        int order = (int)n, info;
        memcpy(half, system->half + start, (size_t)n * sizeof(double));
        memcpy(half + n, system->half + system->n + start, (size_t)n * sizeof(double));
        between_nodes(n, half, system->uniform, matrix);
        memset(rhs, 0, (size_t)(n * m) * sizeof(double));
        for (; columns != NULL; columns = columns->above)
            for (c = 0; c < columns->count; c++) {
                const double *from = columns->values + c * columns->ld + start - columns->first;
                double *to = rhs + columns->shared - columns->count + c;
                for (i = 0; i < n; i++)
                    to[i * m] = from[i];
            }
        for (c = 0; c < leaf->shared; c++)
            begin[c] = 0;
        for (i = first; i < last; i++) {
            const Table *table = &system->tables[i];
            Size from = table->start - start;
            within_patch(table, system->half_width[i], system->uniform, matrix + from * n + from, n);
            for (row = 0; row < system->per_patch; row++, c++) { /* `slopes` stands behind `at_edges` */
                begin[c] = from;
                const double *more = row < 2 && system->edge_fields != NULL ? system->edge_fields + row * system->n : NULL;
                for (k = 0; k < table->n; k++)
                    rhs[(from + k) * m + c] = table->at_edges[row * table->n + k];
                for (k = 0; more != NULL && k < table->n; k++)
                    rhs[(from + k) * m + c] += more[table->start + k];
            }
        }
        if (system->addition != NULL)
            for (i = 0; i < n * n; i++)
                matrix[i] -= system->addition[i];
        blas.dpotrf(&lower, &order, matrix, &order, &info);
        status = info == 0 ? SOLVED : NOT_DEFINITE;
        if (status == SOLVED) {
            substitute(n, m, matrix, rhs, begin, gram);
            distribute(system, first, gram, leaf);
        }
    }
    PyMem_Free(gram);
    PyMem_Free(half);
    PyMem_Free(begin);
    return status;
}
