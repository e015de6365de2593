"""Minimiser of a quadratic model in a ball: by Cholesky inside it and on its surface.

On the surface the shift that makes the step as long as the radius is found by Newton (More and Sorensen), one Cholesky
factorisation each; of the eigenvalues only the smallest is needed, and only where the Hessian is indefinite.
Source: Conn, Gould, Toint, Trust-Region Methods (2000), section 7.3.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.lowest_modes import lowest_modes
from bem.geometry.arrays import FloatArray

ON_SURFACE = 1e-4  # speed: of the radius, within which a step is scaled to it: the model is then off by 1e-8


def trust_region_step(gradient: FloatArray, hessian: FloatArray, radius: float) -> FloatArray:
    """Return the minimiser of the quadratic model in a ball, (n,).

    In the hard case (no force along the most negative mode) the step leaves along that mode, in the direction
    in which its largest component is positive.

    Examples
    --------
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 10.0).round(9).tolist()
    [-3.0, -4.0]
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 1.0).round(9).tolist()
    [-0.6, -0.8]
    """
    newton = _shifted(gradient, hessian, 0.0)
    if newton is not None:
        step, bend = newton
        size = float(np.sqrt(step @ step))
        if size <= radius:
            return step
        return _on_surface(gradient, hessian, radius, 0.0, (size / radius - 1) * size**2 / bend)
    values, modes = lowest_modes(hessian, 1)
    mode, low = modes[:, 0], max(0.0, -float(values[0]))
    step = _on_surface(gradient, hessian, radius, low, low + abs(float(mode @ gradient)) / radius)
    missing = radius**2 - float(step @ step)
    if values[0] < 0 < missing:
        along = float(step @ mode)
        leading = along if along != 0 else mode[np.argmax(np.abs(mode))]
        step = step + (np.copysign(np.sqrt(along**2 + missing), leading) - along) * mode
    return np.asarray(step)


def _on_surface(gradient: FloatArray, hessian: FloatArray, radius: float, low: float, start: float) -> FloatArray:
    """Return the step as long as the radius by a shift of all eigenvalues, (n,); `low` is the least shift allowed.

    The length falls as the shift grows, and its inverse is nearly linear: Newton on the inverse, within bounds that
    close in, from a shift that is not too large: by Newton from no shift, or by the force along the lowest mode alone.
    Where every step is shorter (the hard case) the bounds close in on the least shift, and so is the step.
    """
    resolved = 1e-15 * float(np.abs(hessian).sum(axis=1).max())
    high = low + float(np.sqrt(gradient @ gradient)) / radius
    shift, step = max(start, low + 1e-3 * (high - low)), np.zeros(gradient.size)
    while high - low > max(1e-10 * high, resolved):
        solution = _shifted(gradient, hessian, shift)
        if solution is None:
            low, shift = shift, (shift + high) / 2
            continue
        step, bend = solution
        square = float(step @ step)
        excess = float(np.sqrt(square)) / radius - 1
        if abs(excess) <= ON_SURFACE:
            return step / (1 + excess)
        low, high = (shift, high) if excess > 0 else (low, shift)
        newton = shift + excess * square / bend
        shift = newton if low < newton < high else (low + high) / 2
    solution = _shifted(gradient, hessian, high)
    return step if solution is None else solution[0]


def _shifted(gradient: FloatArray, hessian: FloatArray, shift: float) -> tuple[FloatArray, float] | None:
    """Return s = -(H + shift)^-1 g, (n,), and s^T (H + shift)^-1 s; None where H + shift is not positive definite."""
    matrix = hessian.T.copy()
    matrix.ravel()[:: gradient.size + 1] += shift
    factor, step, info = lapack.dposv(matrix.T, -gradient, lower=0, overwrite_a=1)
    if info != 0:
        return None
    half, _ = lapack.dtrtrs(factor, step, lower=0, trans=1)
    return step, float(half @ half)
