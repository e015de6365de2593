"""Tension inside a contact and at a flaw.  The equilibria of JKR hold any tension away from the edges.

A flaw is a crack of length 2 c on the interface.  Without friction the solid and its mirror image are one body with
that crack, so that tension sigma over it gives K = sigma sqrt(pi c), and it runs where G = K^2 / (2 E*) exceeds w
(Griffith, Phil. Trans. R. Soc. A 221 (1921) 163):

    2 c = 4 E* w / (pi sigma^2),  or 8 w / (pi sigma^2) with the dimensionless K^2 / 4 = G.

No surface is without flaws of atomic size.  Looked at are places at least a flaw away from the edges, where the
singularity of K = 2 sqrt(w) alone carries half of what opens a flaw there.
Dimensionless.  Limits: flaws that are short beside the patch and beside the waves of the pressure.
"""

from __future__ import annotations

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import PatchPressure


def largest_tension(pressure: PatchPressure, margin: float) -> float:
    """Return the largest tension at least `margin` from the edges, at nodes of the series and between; 0 if none.

    Examples
    --------
    >>> pressure = PatchPressure(np.array([-1.0]), np.array([1.0]), (np.array([-2.0, 0.0, 0.5, 0.0, 0.0, 0.0]),))
    >>> largest_tension(pressure, 0.9)
    2.5
    """
    largest = 0.0
    for left, right, series in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        radius, count = (right - left) / 2, 2 * series.size
        angle = np.arange(1, count) * (np.pi / count)
        inside = radius * (1 - np.abs(np.cos(angle))) >= margin
        spectrum = np.zeros(count + 1)
        spectrum[: series.size] = count * series
        spectrum[0] *= 2
        regular = np.fft.irfft(spectrum, 2 * count)[1:count]
        largest = max(largest, float(np.max(-regular[inside] / (radius * np.sin(angle[inside])), initial=0.0)))
    return largest


def opening_tension(work: FloatArray, flaw: float) -> float:
    """Return the tension that opens a flaw of length `flaw` at the largest of the given works of adhesion.

    Examples
    --------
    >>> round(opening_tension(np.array([1.0]), 8 / np.pi), 12)
    1.0
    """
    return float(np.sqrt(8 * np.max(work) / (np.pi * flaw)))
