"""The minimiser of a quadratic model in a ball: by Cholesky inside it, by eigendecomposition on its surface.

Source: Conn, Gould, Toint, Trust-Region Methods (2000), section 7.3.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh

from bem.geometry.arrays import FloatArray


def trust_region_step(gradient: FloatArray, hessian: FloatArray, radius: float) -> FloatArray:
    """Minimiser of the quadratic model in a ball, (n,): by Cholesky inside, by eigendecomposition on its surface.

    In the hard case (no force along the most negative mode) the step leaves along that mode, in the direction
    in which its largest component is positive.

    Examples
    --------
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 10.0).round(9).tolist()
    [-3.0, -4.0]
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 1.0).round(9).tolist()
    [-0.6, -0.8]
    """
    try:
        newton = -cho_solve(cho_factor(hessian, check_finite=False), gradient, check_finite=False)
        if np.linalg.norm(newton) <= radius:
            return np.asarray(newton)
    except LinAlgError:  # not positive definite
        pass
    values, vectors = eigh(hessian)
    force = vectors.T @ gradient
    shift = _shift(values, force, radius)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(values + shift > 0, -force / (values + shift), 0.0)
    missing = radius**2 - float(step @ step)
    if values[0] < 0 and missing > 1e-3 * radius**2:
        leading = vectors[np.argmax(np.abs(vectors[:, 0])), 0]
        step[0] = np.copysign(np.sqrt(step[0] ** 2 + missing), step[0] if step[0] != 0 else leading)
    return np.asarray(vectors @ step)


def _shift(values: FloatArray, force: FloatArray, radius: float) -> float:
    """The shift of all eigenvalues, >= max(0, -the smallest), at which the step is as long as the radius.

    The length falls as the shift grows, and its inverse is nearly linear: Newton on that, within bounds that close in.
    Where every step is shorter (the hard case) the bounds close in on the most negative eigenvalue.
    """
    low, resolved = max(0.0, -float(values[0])), 1e-15 * float(np.abs(values).max())
    high = low + float(np.sqrt(force @ force)) / radius
    shift = low + 1e-3 * (high - low)
    while high - low > max(1e-10 * high, resolved):
        apart = values + shift
        step = force / apart
        square = float(step @ step)
        excess = np.sqrt(square) / radius - 1
        if abs(excess) <= 1e-10:
            return shift
        low, high = (shift, high) if excess > 0 else (low, shift)
        newton = shift + excess * square / float(step @ (step / apart))
        shift = newton if low < newton < high else (low + high) / 2
    return high
