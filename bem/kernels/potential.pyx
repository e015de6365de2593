# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Logarithmic potential of charges, pair by pair: bem/elastic/logarithmic_potential.py."""

import numpy as np

cdef extern from "vector.h" nogil:
    enum: LANES
    void sum_logs(Py_ssize_t n, const double *a, const double *b, const double *f, const double *s,
                  const double *charge, double *values)


def pair_by_pair(const double[:, ::1] points, const double[:, ::1] sources, const double[::1] charge):
    """Return sum_j charge_j log|points_0 sources_0j + points_1 sources_1j|, (n,).

    Points 2 (sin x/2, cos x/2), (2, n), and sources (cos x_j/2, -sin x_j/2), (2, m), make it log|2 sin((x - x_j)/2)|.
    """
    cdef Py_ssize_t n = points.shape[1], m = charge.shape[0], first, k
    cdef double[LANES] a, b, sums
    values = np.zeros(n)
    cdef double[::1] to = values
    for first in range(0, n if m > 0 else 0, LANES):
        for k in range(LANES):
            a[k], b[k] = points[0, min(first + k, n - 1)], points[1, min(first + k, n - 1)]
        sum_logs(m, a, b, &sources[0, 0], &sources[1, 0], &charge[0], sums)
        for k in range(min(LANES, n - first)):
            to[first + k] = sums[k]
    return values
