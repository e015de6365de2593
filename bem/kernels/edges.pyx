# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Derivatives of the stress intensities by motions of the edges: bem/elastic/sensitivities.py."""

import numpy as np
from libc.math cimport sqrt
from libc.stdint cimport int64_t

cdef double PI = 3.14159265358979323846


def stress_intensity_jacobian(const double[::1] half_width, const int64_t[::1] modes, const double[::1] intensity,
                              const double[:, ::1] compliance, const double[::1] slope):
    """Return dK_i / d(outward motion of edge e), (2 L, 2 L), left edges first.

    Of L patches: half widths and coupled modes, (L,); K, (2 L,), edge compliance, (2 L, 2 L), and edge slope, (2 L,).
    """
    cdef Py_ssize_t patches = half_width.shape[0], n = 2 * patches, i, j, other
    cdef double p, r, root, factor
    jacobian, pulls = np.empty((n, n)), np.empty(n)
    cdef double[:, ::1] to = jacobian
    cdef double[::1] pull = pulls
    for i in range(n):
        pull[i] = intensity[i] / (2 * sqrt(half_width[i % patches]))
    for i in range(n):
        p, r, other = modes[i % patches], half_width[i % patches], (i + patches) % n
        root = sqrt(r)
        factor = PI * PI / root
        for j in range(n):
            to[i, j] = compliance[i, j] * pull[j] * factor
        to[i, i] -= p * (p - 1) * pull[i] / root  # cancels the compliance but for a difference
        to[i, other] -= ((-p if modes[i % patches] % 2 == 0 else p - 1) + 0.5) * pull[other] / root
        to[i, i] -= intensity[i] / (4 * r) + sqrt(PI) / root * slope[i] / 2
    return jacobian
