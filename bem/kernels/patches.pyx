# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Sizes, right-hand sides and charges of all patches: bem/elastic/collocation.py.

L patches have N_i nodes for the profile and p_i coupled modes each; `most` is the largest N_i.  Tables are
those of bem/geometry/chebyshev.py, packed_nodes and packed_bases, with the place where that of each patch begins.
"""

import numpy as np
from libc.math cimport cbrt, log, log1p, sqrt, nearbyint
from libc.stdint cimport int64_t
from libc.string cimport memset

cdef extern from "vector.h" nogil:
    enum: TERMS
    const double CIRCLE
    void expand(const double *table, Py_ssize_t rows, double spacing_inverse, Py_ssize_t order, const double *factors,
                double unit, Py_ssize_t n, const double *x, double *values)
    void add_rows(Py_ssize_t n, const double *factors, const double *matrix, double *sums)
    const double *nearest_row(const double *table, Py_ssize_t rows, double place, double *offset)

cdef double PI = CIRCLE / 2


cdef int64_t rounded_up(double number, const int64_t[::1] ladder) except -1:
    """Return the first size of a ladder that is not below a number."""
    cdef Py_ssize_t low = -1, high = ladder.shape[0], middle
    while high - low > 1:
        middle = (low + high) // 2
        if ladder[middle] >= number:
            high = middle
        else:
            low = middle
    if high == ladder.shape[0] or number != number:
        raise ValueError("patches that overlap, or too close for any number of modes")
    return ladder[high]


def sizes(const double[::1] left, const double[::1] right, double tolerance, double max_order, const double[::1] least,
          const int64_t[::1] of_modes, const int64_t[::1] of_nodes):
    """Return nodes and modes of each patch, (L,), from the ladders of sizes of both.

    Modes are -ln(tolerance) / ln(rho) + 2, `least` at least, rho = 1 + z + sqrt(z (2 + z)), z = 2 clearance / width;
    nodes 1.15 kappa + 3 kappa^(1/3) + 12, kappa = width max_order / 2, and four more than modes at least.
    """
    cdef Py_ssize_t n = left.shape[0], i
    cdef double width, before, after, z, kappa, wanted
    nodes, modes = np.empty(n, np.int64), np.empty(n, np.int64)
    cdef int64_t[::1] to_nodes = nodes, to_modes = modes
    for i in range(n):
        before = left[i] - right[i - 1] if i > 0 else left[0] + CIRCLE - right[n - 1]
        after = left[i + 1] - right[i] if i + 1 < n else left[0] + CIRCLE - right[i]
        width = right[i] - left[i]
        z, kappa = 2 * min(before, after) / width, width * max_order / 2
        wanted = -log(tolerance) / log1p(z + sqrt(z * (2 + z))) + 2
        to_modes[i] = rounded_up(least[i] if wanted < least[i] else wanted, of_modes)
        wanted = 1.15 * kappa + 3 * cbrt(kappa) + 12
        to_nodes[i] = rounded_up(max(wanted, to_modes[i] + 4), of_nodes)
    return nodes, modes


cdef double rise(const double *row, double offset, double step):
    """Return h(x + step) - h(x) without its cancellation, in units of the spacing of the table, from the row nearest x.

    Powers are subtracted one by one: (o + d)^k - o^k = (o + d) ((o + d)^(k-1) - o^(k-1)) + d o^(k-1).
    """
    cdef double power = 1.0, difference = 0.0, total = 0.0
    cdef Py_ssize_t k
    for k in range(1, TERMS):
        difference = (offset + step) * difference + step * power
        power *= offset
        total += row[k] * difference
    return total


cdef double sample(const double[:, ::1] table, double center, double half_width, const double *nodes, Py_ssize_t n,
                   double[::1] x, double[::1] values):
    """Fill in h - h_0 at the nodes of a patch, and return h_0, that of a node in the middle or of the middle.

    Sums over the samples then round what h varies by, not h.  On patches of less than a cell of the table h varies by
    less than its rounding, and is expanded about the middle.
    """
    cdef double scale = table.shape[0] / CIRCLE, offset, mean
    cdef double[TERMS] ones
    cdef const double *row
    cdef Py_ssize_t k
    for k in range(TERMS):
        ones[k] = 1.0
    if half_width * scale > 0.5:
        for k in range(n):
            x[k] = center + half_width * nodes[k]
        expand(&table[0, 0], table.shape[0], scale, 0, ones, 1.0, n, &x[0], &values[0])
        mean = values[n // 2]
        for k in range(n):
            values[k] -= mean
        return mean
    row = nearest_row(&table[0, 0], table.shape[0], center * scale, &offset)
    for k in range(n):
        values[k] = rise(row, offset, half_width * scale * nodes[k])
    expand(&table[0, 0], table.shape[0], scale, 0, ones, 1.0, 1, &center, &mean)
    return mean


def right_hand_sides(const double[:, ::1] table, const double[::1] center, const double[::1] half_width, double level,
                     const int64_t[::1] nodes, const double[::1] sampling, const int64_t[::1] at_nodes,
                     const int64_t[::1] modes, const double[::1] coupled, const int64_t[::1] at_modes,
                     double[:, ::1] series, Py_ssize_t most_transformed):
    """Return coupled nodes x, columns R and 1, what modes that are not coupled make at the edges, and their energy.

    R = pi (level - h).  `series`, (L, most), holds zeros, and is filled with the coefficients C_n of R; of patches
    of more nodes than `most_transformed` it holds those of -pi h.  Shapes: (n,), (2, n), (2, 2 L): sums over n >= p of
    (n/pi) C_n (+-1)^n and of -(n^3/pi) C_n (+-1)^n, left edges first; the energy is the sum of n C_n^2.
    """
    cdef Py_ssize_t patches = center.shape[0], most = series.shape[1], i, j, k, n, p, first = 0
    cdef double energy = 0.0, term, mean
    cdef double[4] sums
    cdef const double *basis
    cdef double[::1] samples = np.empty(most), points = np.empty(most), x
    cdef double[:, ::1] columns, tail
    for i in range(patches):
        first += modes[i]
    places, sides, tails = np.empty(first), np.empty((2, first)), np.empty((2, 2 * patches))
    x, columns, tail, first = places, sides, tails, 0
    for i in range(patches):
        basis, p, n, mean = &coupled[at_modes[i]], modes[i], nodes[i], 0.0
        if n <= most_transformed:
            mean = sample(table, center[i], half_width[i], &sampling[at_nodes[i]], n, points, samples)
            add_rows(n, &samples[0], &sampling[at_nodes[i] + n], &series[i, 0])
            for j in range(n):
                series[i, j] *= -PI
        series[i, 0] += PI * (level - mean)
        memset(sums, 0, sizeof(sums))
        for j in range(p, most):
            term = j * series[i, j]
            sums[j % 2] += term
            sums[2 + j % 2] += term * j * j
            energy += term * series[i, j]
        tail[0, i], tail[0, patches + i] = (sums[0] - sums[1]) / PI, (sums[0] + sums[1]) / PI
        tail[1, i], tail[1, patches + i] = (sums[3] - sums[2]) / PI, -(sums[2] + sums[3]) / PI
        for k in range(p):
            x[first + k], term = center[i] + half_width[i] * basis[k], 0.0
            for j in range(p):
                term += basis[(5 + k) * p + j] * series[i, j]
            columns[0, first + k], columns[1, first + k] = term, 1.0
        first += p
    return places, sides, tails, energy


def all_charges(const int64_t[::1] modes, const double[::1] coupled, const int64_t[::1] at, const double[:, ::1] series,
                const double[::1] skeleton):
    """Return Q_n of every patch, (L, most): of the coupled modes from the nodal charges, of the others -n C_n / pi."""
    cdef Py_ssize_t patches = modes.shape[0], most = series.shape[1], i, j, k, p, first = 0
    cdef const double *basis
    charges = np.zeros((patches, most))
    cdef double[:, ::1] to = charges
    for i in range(patches):
        p, basis = modes[i], &coupled[at[i]]
        add_rows(p, &skeleton[first], basis + 5 * p, &to[i, 0])
        for j in range(p):
            to[i, j] *= 2 / PI if j > 0 else 1 / PI
        for j in range(p, most):
            to[i, j] = -j / PI * series[i, j]
        first += p
    return charges
