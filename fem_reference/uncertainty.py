"""Uncertainty of values on meshes of increasing fineness, by least squares (Eca and Hoekstra 2014).

For values q_1 .. q_n on meshes of sizes h_1 > .. > h_n the error of q_n is that of a fit q = q_0 + alpha h^p,

    e = |alpha| h_n^p,    sigma^2 = n sum w_k (q_k - fit_k)^2 / (n - 3),    D = (max q - min q) / (n - 1).

The fit is made without weights and with w_k ~ 1 / h_k; the one of smaller sigma counts. Three meshes are fitted
exactly, sigma = 0. Where no fit has an order 0.5 <= p <= P + 0.1, P the theoretical order, exponents are prescribed:
P / 2, P, or, if p < 0.5 and there are four meshes, both together; the fit of smallest sigma counts. Then

    U = F e + sigma + |q_n - fit_n|                   where sigma < D,
    U = 3 (sigma / D) (e + sigma + |q_n - fit_n|)     elsewhere,

F = 1.25 if p is in its range and sigma < D, else 3: a statement of 95 %. Two meshes have U = 3 |q_2 - q_1|.

Source: L. Eca, M. Hoekstra, J. Comput. Phys. 262 (2014) 104, doi:10.1016/j.jcp.2014.01.006, sec. 4, who have P = 2,
at least four meshes that are alike, and choose the fit of smaller sigma first, whatever its p (the same on three).
"""

from collections.abc import Sequence

import numpy as np

from fem_reference.problem import FloatArray

STEP = 0.05  # of the orders tried
LEAST, SLACK = 0.5, 0.1  # an observed order lies between LEAST and the theoretical one and SLACK
ROUNDING = 1e-11  # relative: what the linear solver leaves, measured 1e-13 to 1e-12


def uncertainty(values: Sequence[FloatArray] | FloatArray, sizes: Sequence[float], order: float) -> FloatArray:
    """Return the uncertainty of the last of two or more values of a quantity, coarsest mesh first.

    Parameters
    ----------
    values : array_like, shape (n_meshes, ...)
    sizes : sequence of float, shape (n_meshes,)
        Sizes of the meshes in any unit, falling.
    order : float
        Theoretical order P.

    Examples
    --------
    >>> round(float(uncertainty([1 + 4.0**-2, 1 + 6.0**-2, 1 + 8.0**-2], [1 / 4, 1 / 6, 1 / 8], 4)) * 64, 2)
    1.25
    """
    every = np.asarray(values, dtype=float)
    shape, q, h = every.shape[1:], every.reshape(len(every), -1), np.asarray(sizes) / sizes[-1]
    rounding = ROUNDING * np.abs(q[-1])
    if len(q) == 2:
        return np.asarray((3.0 * np.abs(q[1] - q[0]) + rounding).reshape(shape))
    weights = (np.full(len(h), 1.0 / len(h)), 1.0 / h / np.sum(1.0 / h))
    tried = np.arange(LEAST - STEP, order + SLACK + 1.5 * STEP, STEP)
    numbers = np.full((3, q.shape[1]), np.inf)  # sigma, error of the fit, and |q_n - fit_n|
    in_range, slow = np.zeros((2, q.shape[1]), dtype=bool)
    for weight in weights:
        fits = np.array([_fit(q, h, [p], weight, max(len(h) - 3, 1)) for p in tried])  # (p, number, value)
        best = np.argmin(fits[:, 0], axis=0)
        fit = np.take_along_axis(fits, best[None, None], axis=0)[0]
        fit[0] *= len(h) > 3
        better = (best > 0) & (best < len(tried) - 1) & (fit[0] < numbers[0])
        numbers[:, better] = fit[:, better]
        in_range |= better
        slow |= best == 0
    for exponents in ([0.5 * order], [order], [0.5 * order, order])[: 3 if len(h) > 3 else 2]:
        for weight in weights:
            fit = np.array(_fit(q, h, exponents, weight, len(h) - 1 - len(exponents)))
            better = ~in_range & (fit[0] < numbers[0]) & (slow if len(exponents) == 2 else True)
            numbers[:, better] = fit[:, better]
    sigma, error, off = numbers
    span = np.ptp(q, axis=0) / (len(h) - 1)
    scattered = sigma >= span
    factor = np.where(in_range & ~scattered, 1.25, 3.0)
    wide = 3.0 * sigma / np.where(span > 0.0, span, np.inf) * (error + sigma + off)
    return np.asarray((np.where(scattered, wide, factor * error + sigma + off) + rounding).reshape(shape))


def _fit(
    q: FloatArray, h: FloatArray, exponents: list[float], weight: FloatArray, freedom: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Fit q_0 + sum alpha_i h^p_i to values (n_meshes, n_values); h is 1 on the last mesh.

    Returns
    -------
    tuple of FloatArray, each (n_values,)
        sigma, |sum alpha_i|, and |q - fit| on the last mesh.
    """
    system = np.column_stack([np.ones(len(h)), *(h**p for p in exponents)])
    root = np.sqrt(weight)[:, None]
    coefficients = np.linalg.pinv(root * system) @ (root * q)
    rest = q - system @ coefficients
    sigma = np.sqrt(len(h) * np.sum(weight[:, None] * rest**2, axis=0) / freedom)
    return sigma, np.abs(coefficients[1:].sum(axis=0)), np.abs(rest[-1])
