# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Derivatives of the stress intensities by motions of the edges: bem/elastic/sensitivities.py, second_sensitivities.py."""

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


def edge_fields(const double[::1] half_width, const int64_t[::1] modes, const double[::1] intensity,
                const double[:, ::1] jacobian, const double[::1] s, const double[:, ::1] slopes):
    """Return k_ie and c_ie with zeros on their diagonals, these diagonals, and sum_e +-k_ie^2, - for left edges e.

    Of L patches: half widths and coupled modes, (L,); K, (2 L,), dK_i/de, (2 L, 2 L), s, (2 L,), and the slopes that
    edges make at edges, (2 L, 2 L), left edges first.  Without slopes, (0, 2 L), c is 0, and not to be asked for.
    """
    cdef Py_ssize_t patches = half_width.shape[0], n = 2 * patches, i, j, other
    cdef bint known = slopes.shape[0] > 0
    cdef double p, r, tail, scale, cubes, squares
    ks, cs, own_ks, own_cs, sums = np.empty((n, n)), np.zeros((n, n)), np.empty(n), np.zeros(n), np.empty(n)
    cdef double[:, ::1] k = ks, c = cs
    cdef double[::1] own_k = own_ks, own_c = own_cs, total = sums, factor = np.empty(n)
    for i in range(n):
        factor[i] = PI * sqrt(PI) / 2 / sqrt(half_width[i % patches])
    for i in range(n):
        p, r, other, squares = modes[i % patches], half_width[i % patches], (i + patches) % n, 0.0
        for j in range(n):
            k[i, j] = jacobian[i, j] / intensity[j]
        own_k[i], k[i, i] = k[i, i] - s[i] / intensity[i], 0.0
        for j in range(patches):
            squares += k[i, patches + j] * k[i, patches + j] - k[i, j] * k[i, j]
        total[i] = squares
        if not known:
            continue
        tail, scale = 1 / sqrt(PI * r), sqrt(PI / r) / (2 * r)
        cubes = (-p * p * (2 * p - 3) if modes[i % patches] % 2 == 0 else (p - 1) * (p - 1) * (2 * p + 1)) / 4
        for j in range(n):
            c[i, j] = slopes[i, j] * factor[j]
        c[i, other] -= tail * (cubes - 0.125)
        for j in range(n):
            c[i, j] = c[i, j] * scale - k[i, j] / (8 * r)
        cubes = p * (p - 1) / 2
        own_c[i] = c[i, i] - scale * tail * (cubes * cubes - 1 / 64.0) - own_k[i] / (8 * r)
        c[i, i] = 0.0
    return ks, cs, own_ks, own_cs, sums
