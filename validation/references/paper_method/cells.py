"""Graded cells of uniform pressure on the contact patches, and how they act on one another.

A patch [a, b] = c + r [-1, 1] has n cells with faces t_f = -cos(pi f / n), crowded at the edges where the pressure is
singular like 1/sqrt(distance); cell j carries the charge y_j.  The displacement of cell j by cell k, less the mean, is

    A_jk = -(1/pi) log|2 sin((x_j - x_k)/2)|                            centre to centre, on different patches,
    A_jk = -(1/pi) [log r + C_jk + log sinc(r (t_j - t_k)/2)]           on the same one,

C_jk the mean of log|t - t'| over both cells: exact, and the same at any width of the patch.  A layer adds
(1/pi) sum_m (ratio - 1)/m cos m(x_j - x_k).  A is symmetric and positive definite.  Error: second order in 1/n.
Limits: gaps not narrower than the cells beside them.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from validation.harness.arrays import FloatArray, IntArray
from validation.references.paper_method.surface import Surface

NEAR = 6.0  # widths of the wider cell within which the mean over both cells is taken in closed form


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of all patches, patch after patch."""

    edges: FloatArray  # patches, dimensionless, in order on the circle, (L, 2)
    counts: IntArray  # cells of each, (L,)
    centre: FloatArray  # x_j, (n,)
    width: FloatArray  # of the cells, (n,)
    place: FloatArray  # t_j, (n,)
    owner: IntArray  # patch of each cell, (n,)

    @property
    def radius(self) -> FloatArray:
        """Half widths of the patches, (L,)."""
        return np.asarray(np.diff(self.edges, axis=1)[:, 0] / 2)


def graded(edges: FloatArray, counts: IntArray) -> Cells:
    """Return graded cells on the patches, `counts` per patch."""
    radius, middle = np.diff(edges, axis=1)[:, 0] / 2, edges.mean(axis=1)
    faces = [-np.cos(np.pi * np.arange(n + 1) / n) for n in counts]
    places = [(f[1:] + f[:-1]) / 2 for f in faces]
    return Cells(
        edges=edges,
        counts=counts,
        centre=np.concatenate([c + r * t for c, r, t in zip(middle, radius, places, strict=True)]),
        width=np.concatenate([r * np.diff(f) for r, f in zip(radius, faces, strict=True)]),
        place=np.concatenate(places),
        owner=np.repeat(np.arange(counts.size), counts),
    )


def compliance(surface: Surface, cells: Cells) -> FloatArray:
    """Return the compliance matrix A, (n, n)."""
    half = np.subtract.outer(cells.centre, cells.centre) / 2
    np.fill_diagonal(half, 1.0)
    matrix = np.log(np.abs(2 * np.sin(half)))
    for block, n, r in _blocks(cells):
        place = cells.place[block]
        smooth = np.log(np.sinc(r * np.subtract.outer(place, place) / (2 * np.pi)))
        matrix[block, block] = np.log(r) + _mean_logarithm(int(n)) + smooth
    modes = surface.layer_modes
    if modes.size:
        angle = np.outer(cells.centre, np.arange(1, modes.size + 1))
        cosine, sine = np.cos(angle), np.sin(angle)
        matrix -= (cosine * modes) @ cosine.T + (sine * modes) @ sine.T
    return np.asarray(-matrix / np.pi)


def attraction(surface: Surface, cells: Cells, charges: FloatArray) -> FloatArray:
    """Return sum_{k != j} y_k d/dx log|2 sin((x_j - x_k)/2)| plus the part of a layer, at every cell, (n,)."""
    half = np.subtract.outer(cells.centre, cells.centre) / 2
    np.fill_diagonal(half, np.pi / 2)
    field = 0.5 / np.tan(half) @ charges
    modes = surface.layer_modes
    if modes.size:
        order = np.arange(1, modes.size + 1)
        angle = np.outer(cells.centre, order)
        cosine, sine = np.cos(angle), np.sin(angle)
        field += sine @ (modes * order * (cosine.T @ charges)) - cosine @ (modes * order * (sine.T @ charges))
    return np.asarray(field)


def _blocks(cells: Cells) -> list[tuple[slice, int, float]]:
    stops = np.cumsum(cells.counts)
    return [(slice(s - n, s), n, r) for s, n, r in zip(stops, cells.counts, cells.radius, strict=True)]


@cache
def _mean_logarithm(n: int) -> FloatArray:
    """Return C, the mean of log|t - t'| over t in cell j and t' in cell k of [-1, 1], (n, n).

    Near cells by the second integral of the logarithm, F(x) = x^2 (log|x| - 3/2) / 2, far ones by Taylor's series.
    """
    faces = -np.cos(np.pi * np.arange(n + 1) / n)
    place, width = (faces[1:] + faces[:-1]) / 2, np.diff(faces)
    distance = np.abs(np.subtract.outer(place, place))
    first, second = width[:, None], width[None, :]
    with np.errstate(divide="ignore"):
        far = np.log(distance)
        second_moment, fourth = (first**2 + second**2) / 12, (first**4 + second**4) / 80 + first**2 * second**2 / 24
        far += -second_moment / (2 * distance**2) - fourth / (4 * distance**4)
    unit = np.maximum(first, second)
    d, v, w = distance / unit, first / unit, second / unit
    near = sum(
        sign * _integral(d + (i * v + j * w) / 2) for i, j, sign in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
    )
    exact = np.asarray(near) / (v * w) + np.log(unit)
    return np.asarray(np.where(distance < NEAR * unit, exact, far))


def _integral(x: FloatArray) -> FloatArray:
    """Return F(x) = x^2 (log|x| - 3/2) / 2, zero at zero."""
    size = np.abs(x)
    safe = np.where(size > 0, size, 1.0)
    return np.asarray(x**2 * (np.log(safe) - 1.5) / 2)
