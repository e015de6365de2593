# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Search of the gaps for low points, and the potential of the patches beside a gap: bem/elastic/gap.py."""

import numpy as np
from libc.math cimport fabs, floor, cos
from libc.stdint cimport int64_t

cdef extern from "vector.h" nogil:
    enum: LANES
    enum: TERMS
    const double CIRCLE
    void beside_patch(const double *t, Py_ssize_t terms, const double *charges, Py_ssize_t n, const double *nodes,
                      const double *skeleton, double negligible, double *values)
    void at_columns(const int64_t *column, double right, double width, double size, Py_ssize_t terms,
                    const double *series, double *x, double *u)
    void expand(const double *table, Py_ssize_t rows, double spacing_inverse, Py_ssize_t order, const double *factors,
                double unit, Py_ssize_t n, const double *x, double *values)

cdef double NEGLIGIBLE = -39.0  # derived: logarithm of what a decaying power may lose
cdef Py_ssize_t WHOLE = 128  # speed: points; larger grids are looked at in stretches
cdef Py_ssize_t STRETCH = 8, ENDS = 32  # speed: points of a stretch; at each end that are always looked at
cdef Py_ssize_t LONGER = 512  # speed: points of a grid for each stretch of a longer one


def near_patches(const double[::1] center, const double[::1] half_width, const int64_t[::1] nodes,
                 const int64_t[::1] modes, const double[::1] tables, const int64_t[::1] at, const double[:, ::1] charges,
                 const double[::1] skeleton, const int64_t[::1] gap, const double[::1] x):
    """Return the logarithmic part of the two patches beside a gap less that of their skeletons, (n,).

    Of L patches: center, half width, number of charges Q_n and of coupled modes, (L,), chebyshev.packed_bases of
    these, charges Q_n, (L, most), and nodal charges, (sum of modes,); points, each in the gap behind patch `gap`, (n,).
    """
    cdef Py_ssize_t count = center.shape[0], n = x.shape[0], side, i, k, following, patch
    cdef double[LANES] t, beside
    cdef double turn
    values, starts = np.zeros(n), np.empty(count, np.int64)
    cdef double[::1] to = values
    cdef int64_t[::1] start = starts
    start[0] = 0
    for k in range(1, count):
        start[k] = start[k - 1] + modes[k - 1]
    for side in range(2):
        i = 0
        while i < n:
            patch = (gap[i] + side) % count
            turn, following = CIRCLE if side == 1 and patch <= gap[i] else 0.0, i
            while following < min(n, i + LANES) and gap[following] == gap[i]:
                t[following - i] = (x[following] - turn - center[patch]) / half_width[patch]
                following += 1
            for k in range(following - i, LANES):
                t[k] = t[0]
            beside_patch(t, nodes[patch], &charges[patch, 0], modes[patch], &tables[at[patch]], &skeleton[start[patch]],
                         NEGLIGIBLE, beside)
            for k in range(i, following):
                to[k] += beside[k - i]
            i = following
    return values


cdef void fit(const double[::1] samples, double[::1] series):
    """Fill in the Chebyshev series of samples at n nodes, by the recurrence of T_k at LANES nodes at a time."""
    cdef Py_ssize_t n = samples.shape[0], i, k, lane
    cdef double[LANES] t, last, before
    cdef double following, total
    for i in range(0, n, LANES):
        for lane in range(LANES):
            t[lane], last[lane] = cos((i + lane + 0.5) * CIRCLE / (2 * n)), samples[i + lane] if i + lane < n else 0.0
            before[lane] = t[lane] * last[lane]
        for k in range(n):
            total = 0.0 if i == 0 else series[k]
            for lane in range(LANES):
                following = 2 * t[lane] * last[lane] - before[lane]
                total += last[lane]
                before[lane], last[lane] = last[lane], following
            series[k] = total
    for k in range(n):
        series[k] *= (1.0 if k == 0 else 2.0) / n


cdef class Grid:
    """Grid in one gap, at equal steps of theta, with u as a Chebyshev series in 1 - 2 theta / pi."""

    cdef double right, width
    cdef Py_ssize_t size, terms
    cdef double[::1] series

    cdef void at(self, const int64_t[::1] column, Py_ssize_t n, double[::1] x, double[::1] u):
        """Fill in points at n columns, and u there; all arrays have room for LANES more."""
        cdef Py_ssize_t i
        for i in range(0, n, LANES):
            at_columns(&column[i], self.right, self.width, self.size, self.terms, &self.series[0], &x[i], &u[i])

    cdef void at_steps(self, Py_ssize_t first, Py_ssize_t step, Py_ssize_t n, int64_t[::1] column, double[::1] x,
                       double[::1] u):
        """Fill in columns in steps from a first one on, and `at` of them."""
        cdef Py_ssize_t i
        for i in range(n + LANES):
            column[i] = first + step * min(i, n - 1)
        self.at(column, n, x, u)


cdef bint has_room(const double[::1] highest, double x, double following, double least_u, double bend, double level):
    """Check whether u less the profile may come below a level between two points."""
    cdef Py_ssize_t rows = highest.shape[0], at
    cdef double unit = rows / CIRCLE, most = -1e300
    for at in range(<Py_ssize_t>floor(x * unit), <Py_ssize_t>floor(following * unit) + 1):
        most = max(most, highest[at % rows + rows if at % rows < 0 else at % rows])
    return least_u - bend - most < level


cdef double bend_at(const double[::1] u, Py_ssize_t i):
    """Return the size of a second difference."""
    return fabs(u[i + 1] - u[i] - (u[i] - u[i - 1]))


cdef Py_ssize_t with_columns(Py_ssize_t first, Py_ssize_t last, Py_ssize_t n, int64_t[::1] column):
    """Append the columns from one to another that are not among the n known ones; return their new number."""
    cdef Py_ssize_t i
    for i in range(max(first, column[n - 1] + 1) if n > 0 else first, last + 1):
        column[n] = i
        n += 1
    return n


cdef Py_ssize_t looked_at(Grid grid, const double[::1] highest, double level, int64_t[::1] column, double[:, ::1] work,
                          int64_t[:, ::1] columns):
    """Fill in the columns of a grid that are looked at, and return their number.

    Of a large grid these are the ends, and stretches where bounds of u and of the profile leave room below the level:
    bounds of long stretches decide where those of the short ones in them are needed.
    """
    cdef Py_ssize_t size = grid.size, step = STRETCH * max(1, size // LONGER), edges, n, i, k, first
    cdef double[::1] x = work[0], u = work[1], inner_x = work[2], inner_u = work[3]
    cdef double bend
    if size <= WHOLE:
        return with_columns(0, size - 1, 0, column)
    edges, n = (size - 2 * ENDS + step - 1) // step, with_columns(0, ENDS + 1, 0, column)
    grid.at_steps(ENDS, step, edges, columns[0], x, u)
    for i in range(edges - 1):
        bend = (bend_at(u, i) if i > 0 else 0.0) + (bend_at(u, i + 1) if i + 2 < edges else 0.0)
        if not has_room(highest, x[i], x[i + 1], min(u[i], u[i + 1]), bend, level):
            continue
        first = ENDS + step * i
        grid.at_steps(first - STRETCH, STRETCH, step // STRETCH + 3, columns[1], inner_x, inner_u)
        for k in range(1, step // STRETCH + 1):
            bend = bend_at(inner_u, k) + bend_at(inner_u, k + 1)
            if has_room(highest, inner_x[k], inner_x[k + 1], min(inner_u[k], inner_u[k + 1]), bend, level):
                n = with_columns(first + STRETCH * (k - 1) - 1, first + STRETCH * k + 1, n, column)
    return with_columns(ENDS + step * (edges - 1) - 1, size - 1, n, column)


def low_points(const double[::1] right, const double[::1] width, const int64_t[::1] sizes, const int64_t[::1] counts,
               const double[::1] samples, const double[:, ::1] table, const double[::1] highest, double level):
    """Return points of grids in the gaps where u less the profile is lower than beside, and may come below a level.

    Of the gaps: right edge before it, width, points of its grid and samples of u at Chebyshev nodes in theta, (L,) each;
    all samples, one gap after the other; the Taylor table of the profile, and upper bounds of it between points of that
    many parts of the circle.  Rows are gap, and the points before, there and behind, (n, 4).
    """
    cdef Py_ssize_t most = 0, terms = 0, total = 0, i, k, n = 0, looked, start = 0, rows = table.shape[0]
    cdef double[TERMS] ones
    cdef double sag
    cdef Grid grid = Grid()
    for i in range(sizes.shape[0]):
        most, terms, total = max(most, sizes[i]), max(terms, counts[i]), total + sizes[i]
    points = np.empty((total // 2, 4))
    cdef double[:, ::1] to = points, work = np.empty((4, most + LANES))
    cdef int64_t[:, ::1] columns = np.empty((3, most + LANES), np.int64)
    cdef int64_t[::1] column = columns[2]
    cdef double[::1] x = work[0], value = work[1], height = work[2], series = np.empty(terms)
    grid.series = series
    for k in range(TERMS):
        ones[k] = 1.0
    for i in range(right.shape[0]):
        fit(samples[start : start + counts[i]], series)
        start += counts[i]
        grid.right, grid.width, grid.size, grid.terms = right[i], width[i], sizes[i], counts[i]
        looked = looked_at(grid, highest, level, column, work, columns)
        for k in range(LANES):
            column[looked + k] = column[looked - 1]
        grid.at(column, looked, x, value)
        expand(&table[0, 0], rows, rows / CIRCLE, 0, ones, 1.0, looked, &x[0], &height[0])
        for k in range(looked):
            value[k] -= height[k]
        for k in range(1, looked - 1):
            sag = value[k - 1] + value[k + 1] - 2 * value[k]
            if (column[k + 1] == column[k - 1] + 2 and value[k] <= value[k - 1] and value[k] < value[k + 1]
                    and value[k] - sag < level):
                to[n, 0], to[n, 1], to[n, 2], to[n, 3] = i, x[k - 1], x[k], x[k + 1]
                n += 1
    return points[:n].copy()
