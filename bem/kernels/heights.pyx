# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""Profile at given points, bem/geometry/profile.py, and its length, bem/adhesive/adhesion.py.

Heights come from the Taylor series about the nearest point of a table:

h^(j)(x) = delta^-j sum_(k >= j) k! / (k - j)! c_k o^(k - j), o the offset in units of the spacing delta of the table
c_k = h^(k) delta^k / k!, (rows, 14).
"""

import numpy as np
from libc.math cimport floor

cdef extern from "vector.h" nogil:
    enum: TERMS
    const double CIRCLE
    void expand(const double *table, Py_ssize_t rows, double spacing_inverse, Py_ssize_t order, const double *factors,
                double unit, Py_ssize_t n, const double *x, double *values)


def taylor(const double[:, ::1] table, const double[::1] x, double spacing_inverse, Py_ssize_t derivatives):
    """Return h, h', ... up to a derivative at points x, (derivatives + 1, n)."""
    cdef Py_ssize_t order, k, n = x.shape[0]
    cdef double[TERMS] factors
    cdef double unit = 1.0
    values = np.empty((derivatives + 1, n))
    cdef double[:, ::1] to = values
    for k in range(TERMS):
        factors[k] = 1.0
    for order in range(derivatives + 1 if n > 0 else 0):
        expand(&table[0, 0], table.shape[0], spacing_inverse, order, factors, unit, n, &x[0], &to[order, 0])
        unit *= spacing_inverse
        for k in range(TERMS):
            factors[k] *= k - order
    return values


def integral(const double[::1] start, const double[::1] width, const double[:, ::1] series, double whole,
             const double[::1] x):
    """Return the Chebyshev series on the panel in which each position lies, and `whole` for every turn, (n,).

    Panels, (P,), fill the circle in ascending order from 0; series, (P, terms), by Clenshaw's rule.
    """
    cdef Py_ssize_t i, k, low, high, middle
    cdef double turns, place, t, last, before, following
    values = np.empty(x.shape[0])
    cdef double[::1] to = values
    for i in range(x.shape[0]):
        turns, low, high = floor(x[i] / CIRCLE), 0, start.shape[0]
        place = x[i] - turns * CIRCLE
        while high - low > 1:
            middle = (low + high) // 2
            if start[middle] <= place:
                low = middle
            else:
                high = middle
        t = min(max(2 * (place - start[low]) / width[low] - 1, -1.0), 1.0)
        last = before = 0.0
        for k in range(series.shape[1] - 1, 0, -1):
            following = 2 * t * last - before + series[low, k]
            before, last = last, following
        to[i] = turns * whole + t * last - before + series[low, 0]
    return values
