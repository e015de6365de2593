# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""System of all patches, split into clusters and solved: the formulas stand in bem/elastic/hierarchical.py.

Shapes: n nodes, L patches, k columns; a cluster shares `shared` columns with all clusters above it, and q columns carry
the kernel between two halves (bem/elastic/separated_kernel.py).  Matrices are rows of contiguous numbers: the lower
triangle that LAPACK fills by columns is L(i, j) = factor[j, i].
"""

import numpy as np
from libc.math cimport cos, fabs, fmod, log, sin
from libc.stdint cimport int64_t
from libc.string cimport memcpy
from scipy.linalg.cython_blas cimport dgemm, dsyrk, dtrsm
from scipy.linalg.cython_lapack cimport dpotrf, dpstrf

cdef extern from "vector.h" nogil:
    const double CIRCLE
    void log_row(Py_ssize_t n, const double *a, const double *b, double f, double s, double uniform, double *values)
    void series_row(Py_ssize_t n, double unit, double t, const double *nodes, const double *moments, double rest,
                    double *values)
    void polynomials(Py_ssize_t n, Py_ssize_t count, const double *t, double *values, double *work)
    void log_ratio_and_mean(Py_ssize_t n, double constant, double *u, double *m)

cdef double CENTRED = 10.0  # speed: a cluster is split in a gap e times wider, if that is off its middle by under 0.1
cdef double MOST_OFF = 0.25  # limit: and by no more than this, unless all are: clusters of clusters stay few
cdef double CLOSE_TO_END = 0.05  # derived: sine below which a difference of products has lost digits
cdef double WIDEST_SERIES = 0.4  # derived: half width; of log sinc: (0.4 / pi)^18 / 9 = 1e-17
cdef Py_ssize_t BLOCK_ROWS = 48, PANEL = 64  # speed: of the forward substitution; of a symmetric product
cdef char LOWER = b"L", LEFT = b"L", RIGHT = b"R", UPPER = b"U", PLAIN = b"N", TURNED = b"T"


cdef class System:
    """Arguments of `solved`, and the arrays that all clusters fill."""

    cdef const double[::1] x, half_width
    cdef const int64_t[::1] starts, cuts, at
    cdef const double[::1] tables
    cdef const double[:, ::1] arcs, addition, fields
    cdef list ranges
    cdef double uniform
    cdef double[:, ::1] halves  # (2, n): sine and cosine of x / 2
    cdef double[:, ::1] columns  # (n, widest): shared from above, each pair behind the pairs above it
    cdef double[:, ::1] compliance, slopes  # (2 L, 2 L): edges and slopes by edges, patch by patch
    cdef Py_ssize_t per_patch, place  # columns of the edges of a patch; clusters met so far


cdef class Cluster:
    """Solved cluster."""

    cdef Py_ssize_t size
    cdef double[:, ::1] gram  # (shared, shared): b^T A'^-1 b of the shared columns
    cdef double[:, ::1] edges  # (per_patch L, shared): edges and behind them slopes by the shared columns
    cdef double[:, ::1] solved  # leaf: Y of all columns, (n, m); pair: M V of the shared columns, (2 q, shared)
    cdef double[:, ::1] factor  # leaf: L, (n, n)
    cdef Cluster first, second  # pair: its halves


cdef void gemm(double alpha, const double[:, :] a, const double[:, :] b, double beta, double[:, :] c) noexcept:
    """C = alpha A B + beta C; rows of C are contiguous, rows or columns of A and of B."""
    cdef int m = c.shape[0], n = c.shape[1], k = a.shape[1], ldc = max(c.strides[0] // 8, n)
    cdef bint rows_a = a.strides[1] == 8, rows_b = b.strides[1] == 8
    cdef int lda = max(a.strides[0], 8 * k) // 8 if rows_a else max(a.strides[1], 8 * m) // 8
    cdef int ldb = max(b.strides[0], 8 * n) // 8 if rows_b else max(b.strides[1], 8 * k) // 8
    if m > 0 and n > 0 and k > 0:
        dgemm(&PLAIN if rows_b else &TURNED, &PLAIN if rows_a else &TURNED, &n, &m, &k, &alpha, <double *>&b[0, 0],
              &ldb, <double *>&a[0, 0], &lda, &beta, &c[0, 0], &ldc)


def splits(const double[::1] x, const double[::1] left, const double[::1] right, const int64_t[::1] starts,
           Py_ssize_t largest):
    """Return where clusters of more than `largest` nodes are split, each before its halves, and the arcs of these.

    A cut is the first patch of the second half, -1 for a leaf, (c,).  The arcs part at beta and delta; the coordinate u
    of the nodes lies between low and high: rows of (c, 4) hold all four.
    """
    cdef Py_ssize_t n = 0, first, last, patches = left.shape[0]
    cuts, arcs, waiting = np.empty(2 * patches - 1, np.int64), np.zeros((2 * patches - 1, 4)), [(0, patches)]
    cdef int64_t[::1] cut = cuts
    cdef double[:, ::1] arc = arcs
    while waiting:
        first, last = waiting.pop()
        cut[n] = -1
        if last - first > 1 and starts[last] - starts[first] > largest:
            cut[n] = cut_of(left, right, starts, first, last)
            arc_of(x, left, right, starts, first, cut[n], last, arc[n])
            waiting += [(cut[n], last), (first, cut[n])]
        n += 1
    return cuts[:n], arcs[:n]


cdef double off_middle(const int64_t[::1] starts, Py_ssize_t first, Py_ssize_t last, Py_ssize_t i):
    """Distance of patch i from the middle of a cluster, in parts of its nodes."""
    return fabs(starts[i] - (starts[first] + starts[last]) / 2.0) / (starts[last] - starts[first])


cdef Py_ssize_t cut_of(const double[::1] left, const double[::1] right, const int64_t[::1] starts, Py_ssize_t first,
                       Py_ssize_t last):
    """Return the patch behind the gap in which a cluster is split: wide, and not far from the middle."""
    cdef Py_ssize_t middle = first + 1, cut = first + 1, i
    cdef double best = 1e300, cost
    for i in range(first + 2, last):
        if off_middle(starts, first, last, i) < off_middle(starts, first, last, middle):
            middle = i
    for i in range(first + 1, last):
        cost = CENTRED * off_middle(starts, first, last, i)
        cost -= min(log((left[i] - right[i - 1]) / (left[middle] - right[middle - 1])), CENTRED * MOST_OFF)
        if cost < best:
            best, cut = cost, i
    return cut


cdef double u_at(double x, double beta, double delta):
    """Return the coordinate u between two points that part the period."""
    return log(fabs(sin((x - beta) / 2) / sin((x - delta) / 2)))


cdef void arc_of(const double[::1] x, const double[::1] left, const double[::1] right, const int64_t[::1] starts,
                 Py_ssize_t first, Py_ssize_t cut, Py_ssize_t last, double[::1] arc):
    """Find beta, delta and the range of u: it rises from beta to delta, and nodes fall within a patch."""
    cdef double behind = fmod(left[first] - right[last - 1], CIRCLE)
    cdef double beta = right[cut - 1] + (left[cut] - right[cut - 1]) / 2
    cdef double delta = right[last - 1] + (behind + CIRCLE if behind < 0 else behind) / 2
    arc[0], arc[1] = beta, delta
    arc[2] = min(u_at(x[starts[cut - 1]], beta, delta), u_at(x[starts[cut + 1] - 1], beta, delta))
    arc[3] = max(u_at(x[starts[first + 1] - 1], beta, delta), u_at(x[starts[last - 1]], beta, delta))


def solved(const double[::1] x, const double[::1] half_width, const int64_t[::1] starts,
           const double[::1] tables, const int64_t[::1] at, const double[:, ::1] columns, const int64_t[::1] cuts,
           const double[:, ::1] arcs, list ranges, double uniform, Py_ssize_t edge_columns,
           const double[:, ::1] addition=None, const double[:, ::1] fields=None):
    """Return b^T A^-1 b of edges, of slopes and edges, and of the columns; their charges; q and slopes of these.

    None where A is not positive definite.  `tables` and `at` are chebyshev.packed_bases, `ranges` holds the modes, the
    number of even ones and the core of each cluster that is split; rows of `arcs` end with middle and half range of u.
    Shapes: (2 L, 2 L), (2 L, 2 L), (k, k), (k, n), (k, 2 L), (k, 2 L); edges that are not asked for have none.
    """
    cdef Py_ssize_t n = x.shape[0], patches = half_width.shape[0], k = columns.shape[0], i, j
    cdef Py_ssize_t edges = 2 * patches if edge_columns > 0 else 0, bent = edges if edge_columns == 4 else 0
    cdef System system = System()
    system.x, system.half_width, system.starts, system.cuts, system.arcs = x, half_width, starts, cuts, arcs
    system.tables, system.at, system.ranges, system.addition, system.fields = tables, at, ranges, addition, fields
    system.uniform, system.per_patch = uniform, edge_columns
    cdef double[:, ::1] halves = np.empty((2, n)), shared = np.empty((n, widest(system, k)))
    system.halves, system.columns = halves, shared
    for i in range(n):
        halves[0, i], halves[1, i] = sin(x[i] / 2), cos(x[i] / 2)
        for j in range(k):
            shared[i, j] = columns[j, i]
    system.compliance, system.place = np.empty((edges, edges)), 0
    if bent > 0:
        system.slopes = np.empty((bent, edges))
    cdef Cluster whole = cluster(system, 0, patches, k)
    if whole is None:
        return None
    cdef double[:, ::1] gram = whole.gram
    cdef double remaining = 1 - uniform * gram[1, 1]
    if remaining <= 0:
        return None
    charges, at_edges, bends = np.empty((k, n)), np.empty((k, 2 * patches)), np.empty((k, 2 * patches))
    compliance, slopes, summed = np.empty((edges, edges)), np.empty((bent, edges)), np.empty((k, k))
    cdef double[:, ::1] work = np.zeros((k + 1, k)), unit = work[:k], charge = charges, q = at_edges, bend = bends
    cdef double[::1] change = work[k]
    for i in range(k):
        unit[i, i], change[i] = 1.0, gram[1, i] * (uniform / remaining)
    charges_of(whole, unit, charge)
    sums_at_edges(system, charge, q, bend)
    correct(change, charge)
    correct(change, q)
    correct(change, bend)
    cdef double[:, ::1] to = summed
    for i in range(k):
        for j in range(k):
            to[i, j] = gram[i, j] + change[i] * gram[1, j]
    if edges > 0:
        rearrange(system.compliance, whole.edges, 0, uniform / remaining, compliance)
    if bent > 0:
        rearrange(system.slopes, whole.edges, edges, uniform / remaining, slopes)
    return compliance, slopes, summed, charges, at_edges, bends


cdef Py_ssize_t widest(System system, Py_ssize_t shared):
    """Return the largest number of columns that a cluster and those above it share, from `place` on."""
    cdef Py_ssize_t place = system.place, below
    system.place += 1
    if system.cuts[place] < 0:
        return shared
    below = shared + system.ranges[place][2].shape[0]
    return max(widest(system, below), widest(system, below))


cdef void correct(const double[::1] change, double[:, ::1] values):
    """Take alpha 1 1^T out again by the formula of Sherman and Morrison: row 1 is that of 1, and the last to change."""
    cdef Py_ssize_t k = values.shape[0], i, j, row
    for i in range(k):
        row = (i + 2) % k
        for j in range(values.shape[1]):
            values[row, j] += change[row] * values[1, j]


cdef void rearrange(const double[:, ::1] between, const double[:, ::1] edges, Py_ssize_t first, double factor,
                    double[:, ::1] to):
    """Fill in what edges do at edges, or at slopes, left edges first, with alpha 1 1^T taken out again.

    What edges do at edges is known above the diagonal.
    """
    cdef Py_ssize_t patches = to.shape[0] // 2, i, j, side, other, row, column
    cdef double share
    for i in range(patches):
        for side in range(2):
            row = 2 * i + side
            share = factor * edges[first + row, 1]
            for j in range(patches):
                for other in range(2):
                    column = 2 * j + other
                    to[i + side * patches, j + other * patches] = share * edges[column, 1] + (
                        between[column, row] if first == 0 and column < row else between[row, column])


cdef void sums_at_edges(System system, const double[:, ::1] charges, double[:, ::1] at_edges, double[:, ::1] bends):
    """Sum q of the charges of each column at the edges, and n^2 (+-1)^n Q_n, (k, 2 L) each, left edges first."""
    cdef Py_ssize_t patches = system.half_width.shape[0], column, patch, i, start, n
    cdef const double *table
    cdef double left, right, left_bend, right_bend, charge
    for patch in range(patches):
        start, n = system.starts[patch], system.starts[patch + 1] - system.starts[patch]
        table = &system.tables[system.at[patch]]
        for column in range(charges.shape[0]):
            left = right = left_bend = right_bend = 0.0
            for i in range(n):
                charge = charges[column, start + i]
                left += table[n + i] * charge
                right += table[2 * n + i] * charge
                left_bend += table[3 * n + i] * charge
                right_bend += table[4 * n + i] * charge
            at_edges[column, patch], at_edges[column, patches + patch] = left, right
            bends[column, patch], bends[column, patches + patch] = left_bend, right_bend


cdef void charges_of(Cluster cluster, const double[:, ::1] amounts, double[:, :] to):
    """Fill in A'^-1 b of the shared columns in these amounts, (k, shared), (k, n) with contiguous rows."""
    cdef int n = cluster.size, k = amounts.shape[0], ld = to.strides[0] // 8
    cdef Py_ssize_t q, cut, shared = amounts.shape[1]
    cdef double one = 1.0
    if cluster.first is None:
        gemm(1.0, amounts, cluster.solved[:, :shared].T, 0.0, to)
        dtrsm(&LEFT, &LOWER, &TURNED, &PLAIN, &n, &k, &one, &cluster.factor[0, 0], &n, &to[0, 0], &ld)
        return
    q, cut = cluster.solved.shape[0] // 2, cluster.first.size
    cdef double[:, ::1] half = np.empty((k, shared + q))
    half[:, :shared] = amounts
    gemm(-1.0, amounts, cluster.solved[:q].T, 0.0, half[:, shared:])
    charges_of(cluster.first, half, to[:, :cut])
    gemm(-1.0, amounts, cluster.solved[q:].T, 0.0, half[:, shared:])
    charges_of(cluster.second, half, to[:, cut:])


cdef Cluster cluster(System system, Py_ssize_t first, Py_ssize_t last, Py_ssize_t shared):
    """Solve patches from `first` to before `last`; None where their matrix is not positive definite."""
    cdef Py_ssize_t place = system.place, cut = system.cuts[place], q
    cdef Cluster one, other
    system.place += 1
    if cut < 0:
        return leaf(system, first, last, shared)
    cdef double[:, ::1] core = np.negative(system.ranges[place][2])
    core[1, 1] += system.uniform  # the second column is 1
    q = core.shape[0]
    widen(system, place, system.starts[first], system.starts[last], shared, q)
    one = cluster(system, first, cut, shared + q)
    other = None if one is None else cluster(system, cut, last, shared + q)
    return None if other is None else joined(system, first, one, other, core, shared)


cdef void kernel_within(double r, double uniform, const double *table, Py_ssize_t n, double *matrix,
                        Py_ssize_t ld) noexcept:
    """Fill in uniform - log moments - log r - log sinc(r (t - t')/2) of one patch, (n, n), on and above the diagonal."""
    cdef Py_ssize_t i, j
    cdef const double *moments = table + (5 + n) * n
    cdef double y, rest = uniform - log(r)
    for j in range(n):
        series_row(n - j, r / CIRCLE, table[j], table + j, moments + j * n + j, rest, matrix + j * ld + j)
        for i in range(j + 1, n if r > WIDEST_SERIES else 0):
            y = r * (table[i] - table[j]) / 2
            matrix[j * ld + i] = rest - moments[j * n + i] - log(sin(y) / y)


cdef Cluster leaf(System system, Py_ssize_t first, Py_ssize_t last, Py_ssize_t shared):
    """Solve a cluster that is not split by Cholesky, its Gram matrix by blocks of rows.

    A column of Y is zero above the first node of its patch: shared columns stand first, then those of each patch.
    """
    cdef Py_ssize_t start = system.starts[first], n = system.starts[last] - start, per = system.per_patch
    cdef Py_ssize_t m = shared + per * (last - first), patch, c, i, j, at, size, column, row, other, side
    cdef int order = n, info
    cdef Cluster made = Cluster()
    cdef double[:, ::1] factor = np.empty((n, n)), rhs = np.zeros((n, m)), gram = np.zeros((m, m)), between
    cdef const double *table
    cdef const double *sine = &system.halves[0, start]
    cdef const double *cosine = &system.halves[1, start]
    cdef const double[:, ::1] columns = system.columns, fields = system.fields, addition = system.addition
    for j in range(n):
        factor[j, j] = system.uniform
        log_row(n - j - 1, sine + j + 1, cosine + j + 1, 2 * cosine[j], -2 * sine[j], system.uniform,
                &factor[j, 0] + j + 1)
        memcpy(&rhs[j, 0], &columns[start + j, 0], shared * sizeof(double))
    for patch in range(first, last):
        at, size = system.starts[patch] - start, system.starts[patch + 1] - system.starts[patch]
        table = &system.tables[system.at[patch]]
        kernel_within(system.half_width[patch], system.uniform, table, size, &factor[at, at], n)
        for c in range(per):
            column = shared + per * (patch - first) + c
            for i in range(size):
                rhs[at + i, column] = table[(1 + c) * size + i]
                if fields is not None and c < 2:
                    rhs[at + i, column] += fields[c, start + at + i]
    if addition is not None:
        for i in range(n):
            for j in range(i, n):
                factor[i, j] -= addition[i, j]
    dpotrf(&LOWER, &order, &factor[0, 0], &order, &info)
    if info != 0:
        return None
    substitute(factor, rhs, gram, system.starts[first : last + 1], shared, per)
    cdef double[:, ::1] own = np.empty((shared, shared)), edges = np.empty((per * (last - first), shared))
    made.size, made.factor, made.solved, made.gram, made.edges = n, factor, rhs, own, edges
    for i in range(shared):
        for j in range(i + 1):
            own[i, j] = own[j, i] = gram[i, j]
    for c in range(per):
        between = system.compliance if c < 2 else system.slopes
        for patch in range(last - first):
            column, row = shared + per * patch + c, 2 * patch + c % 2
            memcpy(&edges[row + 2 * (c // 2) * (last - first), 0], &gram[column, 0], shared * sizeof(double))
            for other in range(last - first):
                for side in range(2):
                    i = shared + per * other + side
                    between[2 * first + row, 2 * (first + other) + side] = gram[max(i, column), min(i, column)]
    return made


cdef void substitute(const double[:, ::1] factor, double[:, ::1] rhs, double[:, ::1] gram, const int64_t[::1] starts,
                     Py_ssize_t shared, Py_ssize_t per):
    """Solve Y = L^-1 b in place, and fill in Y^T Y below the diagonal."""
    cdef Py_ssize_t n = rhs.shape[0], start, end, before, patch = 0, seen, past
    cdef int active, rows, ld = rhs.shape[1], ldl = n
    cdef double one = 1.0
    for start in range(0, n, BLOCK_ROWS):
        end, past = min(start + BLOCK_ROWS, n), 0
        while patch < starts.shape[0] - 1 and starts[patch] - starts[0] < end:
            patch += 1
        active, rows = shared + per * patch, end - start
        for before in range(0, start, BLOCK_ROWS):
            while starts[past] - starts[0] < before + BLOCK_ROWS:
                past += 1
            seen = shared + per * past
            gemm(-1.0, factor[before : before + BLOCK_ROWS, start:end].T, rhs[before : before + BLOCK_ROWS, :seen], 1.0,
                 rhs[start:end, :seen])
        dtrsm(&RIGHT, &LOWER, &TURNED, &PLAIN, &active, &rows, &one, <double *>&factor[start, start], &ldl,
              &rhs[start, 0], &ld)
        dsyrk(&UPPER, &PLAIN, &active, &rows, &one, &rhs[start, 0], &ld, &one, &gram[0, 0], &ld)


cdef void widen(System system, Py_ssize_t place, Py_ssize_t start, Py_ssize_t end, Py_ssize_t shared, Py_ssize_t q):
    """Fill in the columns of the kernel between two halves: m, 1 and the phi_k(u), series in T_j((u - middle) / unit)."""
    modes_, even_, _ = system.ranges[place]
    cdef const double[:, ::1] modes = modes_
    cdef Py_ssize_t n = end - start, count = modes.shape[0], even = even_, i
    cdef double beta = system.arcs[place, 0], delta = system.arcs[place, 1]
    cdef double middle = system.arcs[place, 2], unit = system.arcs[place, 3]
    cdef double[:, ::1] work = np.empty((4, n)), polynomial = np.empty((count, n)), columns = system.columns[start:end]
    sines(system, start, beta, work[0])
    sines(system, start, delta, work[1])
    log_ratio_and_mean(n, log(2 / fabs(sin((delta - beta) / 2))), &work[0, 0], &work[1, 0])
    for i in range(n):
        columns[i, shared], columns[i, shared + 1] = work[1, i], 1.0
        work[0, i] = (work[0, i] - middle) / unit
    polynomials(n, count, &work[0, 0], &polynomial[0, 0], &work[2, 0])
    gemm(1.0, polynomial[::2].T, modes[::2, :even], 0.0, columns[:, shared + 2 : shared + 2 + even])
    gemm(1.0, polynomial[1::2].T, modes[1::2, even:], 0.0, columns[:, shared + 2 + even : shared + q])


cdef void sines(System system, Py_ssize_t start, double end, double[::1] to):
    """Fill in sin((x - end)/2) of nodes from `start` on, where it is small from the difference itself."""
    cdef double s = sin(end / 2), c = cos(end / 2)
    cdef Py_ssize_t i
    for i in range(to.shape[0]):
        to[i] = system.halves[0, start + i] * c - system.halves[1, start + i] * s
    for i in range(to.shape[0]):
        if fabs(to[i]) < CLOSE_TO_END:
            to[i] = sin((system.x[start + i] - end) / 2)


cdef object middle_of(const double[:, :] first, const double[:, :] second, const double[:, ::1] core):
    """Return M of two halves from X_1, X_2 and C, (2 q, 2 q); None where the matrix is not positive definite.

    With L L^T = 1 - R^T H R it is [-H, C; C, 0] - B B^T, B = [H R; -C R] L^-T.
    """
    cdef Py_ssize_t q = core.shape[0], i, j
    cdef int order = q, twice = 2 * q, rank, info
    cdef double automatic = -1.0, one = 1.0
    cdef int[::1] pivots = np.empty(q, np.intc)
    made = np.zeros((2 * q, 2 * q))
    cdef double[:, ::1] m = made, work = np.empty((7 * q + 2, q)), half = work[:q], turned = work[q : 2 * q]
    cdef double[:, ::1] root = work[2 * q : 3 * q], both = work[3 * q : 5 * q], inner = work[5 * q : 6 * q]
    half[:, :] = first
    dpstrf(&LOWER, &order, &half[0, 0], &order, &pivots[0], &rank, &automatic, &work[5 * q, 0], &info)
    root[:, :] = 0.0
    for j in range(rank):
        for i in range(j, q):
            root[pivots[i] - 1, j] = half[j, i]
    gemm(1.0, second, core, 0.0, half)
    gemm(1.0, core, half, 0.0, turned)
    gemm(1.0, turned, root, 0.0, both[:q])
    gemm(-1.0, core, root, 0.0, both[q:])
    gemm(-1.0, root.T, both[:q], 0.0, inner)
    for i in range(rank):
        inner[i, i] += 1.0
    dpotrf(&LOWER, &rank, &inner[0, 0], &order, &info)
    if info != 0:
        return None
    dtrsm(&LEFT, &LOWER, &PLAIN, &PLAIN, &rank, &twice, &one, &inner[0, 0], &order, &both[0, 0], &order)
    for i in range(q):
        for j in range(q):
            m[i, j], m[i, q + j], m[q + i, j] = -turned[i, j], core[i, j], core[i, j]
    gemm(-1.0, both[:, :rank], both[:, :rank].T, 1.0, m)
    return made


cdef Cluster joined(System system, Py_ssize_t patch, Cluster one, Cluster other, const double[:, ::1] core,
                    Py_ssize_t shared):
    """Join two clusters from patch `patch` on with the kernel P C Q^T between them."""
    cdef Py_ssize_t q = core.shape[0], per = system.per_patch, n = one.edges.shape[0], k = other.edges.shape[0]
    cdef Py_ssize_t part, a = 2 * n // per if per > 0 else 0, b = 2 * k // per if per > 0 else 0, i, j
    found = middle_of(one.gram[shared:, shared:], other.gram[shared:, shared:], core)
    if found is None:
        return None
    cdef Cluster made = Cluster()
    cdef double[:, ::1] m = found, gram = np.empty((shared, shared)), response = np.empty((2 * q, shared))
    cdef double[:, ::1] edges = np.empty((n + k, shared)), reply = np.empty((n + k, 2 * q))
    made.size, made.first, made.second, made.gram, made.edges, made.solved = (
        one.size + other.size, one, other, gram, edges, response)
    gemm(1.0, m[:, :q], one.gram[shared:, :shared], 0.0, response)
    gemm(1.0, m[:, q:], other.gram[shared:, :shared], 1.0, response)
    for i in range(shared):
        for j in range(shared):
            gram[i, j] = one.gram[i, j] + other.gram[i, j]
    gemm(-1.0, one.gram[:shared, shared:], response[:q], 1.0, gram)
    gemm(-1.0, other.gram[:shared, shared:], response[q:], 1.0, gram)
    gemm(1.0, one.edges[:, shared:], m[:q], 0.0, reply[:n])
    gemm(1.0, other.edges[:, shared:], m[q:], 0.0, reply[n:])
    for part in range(per // 2):
        i = (a + b) * part
        edges[i : i + a] = one.edges[a * part : a * (part + 1), :shared]
        edges[i + a : i + a + b] = other.edges[b * part : b * (part + 1), :shared]
        gemm(-1.0, one.edges[a * part : a * (part + 1), shared:], response[:q], 1.0, edges[i : i + a])
        gemm(-1.0, other.edges[b * part : b * (part + 1), shared:], response[q:], 1.0, edges[i + a : i + a + b])
        join_edges(system, 2 * patch, part, reply[a * part : a * (part + 1)], reply[n + b * part : n + b * (part + 1)],
                   one.edges[:a, shared:], other.edges[:b, shared:])
    return made


cdef void join_edges(System system, Py_ssize_t first, Py_ssize_t part, const double[:, ::1] reply_one,
                     const double[:, ::1] reply_other, const double[:, :] one, const double[:, :] other):
    """Take V^T M V of two halves from what edges do at edges, above its diagonal, or at slopes (part 1).

    Leaves have filled what edges of a half do within it; between the halves there is nothing else.
    """
    cdef Py_ssize_t q = one.shape[1], a = one.shape[0], end = a + other.shape[0], start, stop
    cdef double[:, :] to
    if part == 1:
        to = system.slopes[first : first + end, first : first + end]
        gemm(-1.0, reply_one[:, :q], one.T, 1.0, to[:a, :a])
        gemm(-1.0, reply_one[:, q:], other.T, 0.0, to[:a, a:])
        gemm(-1.0, reply_other[:, :q], one.T, 0.0, to[a:, :a])
        gemm(-1.0, reply_other[:, q:], other.T, 1.0, to[a:, a:])
        return
    to = system.compliance[first : first + end, first : first + end]
    gemm(-1.0, reply_one[:, q:], other.T, 0.0, to[:a, a:])
    for start in range(0, a, PANEL):
        stop = min(start + PANEL, a)
        gemm(-1.0, reply_one[start:stop, :q], one[start:].T, 1.0, to[start:stop, start:a])
    for start in range(0, end - a, PANEL):
        stop = min(start + PANEL, end - a)
        gemm(-1.0, reply_other[start:stop, q:], other[start:].T, 1.0, to[a + start : a + stop, a + start :])
