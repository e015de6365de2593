"""Energy release rate at every contact edge from differences of the elastic energy alone.

With the plate held and one edge moved outwards by delta,

    G = [8 (U(delta) - U(-delta)) - (U(2 delta) - U(-2 delta))] / (12 delta),

U the strain energy of the layer (half the work of the nodal reactions), every state on a mesh made anew. No stress, no
derivative at the edge and no stress intensity enter: it is independent of the domain integral (`energy_release`) and of
the splitting of G into K.

The uncertainty is that of three meshes (`result.spread`) and what the fourth-order difference changes of the
second-order one, squared over G: the error of the former where that of the latter is in its asymptotic range.

Units: J/m^2.
"""

import numpy as np

from fem_reference.closure import Control, Evaluation, evaluate, intervals
from fem_reference.mesh import Resolution, layer_mesh
from fem_reference.problem import FloatArray, InvalidProblemError
from fem_reference.result import Result, patch_order, spread, strain_energy
from fem_reference.solve import companions

STEP = 0.012  # of the shorter of the patch and the gap beside an edge
STENCIL = {1: 8.0, -1: -8.0, 2: -1.0, -2: 1.0}  # over 12


def energy_difference(state: Result) -> tuple[FloatArray, FloatArray]:
    """Return G and its uncertainty, both (n_patches, 2), at the edges of a state.

    Raises
    ------
    InvalidProblemError
        Naming `state` in complete contact, which has no edges.
    """
    if state.edges.size == 0:
        raise InvalidProblemError("state", "has no edges")
    finest = state.evaluation
    held = Control("total_displacement", state.total_displacement / state.problem.unit_height)
    values, curvature = [], np.zeros(finest.edges.shape)
    ladder = companions(state.resolution)
    for resolution in ladder:
        rates = np.zeros(finest.edges.shape)
        for place in np.ndindex(*rates.shape):
            step = _step(finest, place)
            energies = {k: _energy(finest, place, k * step, held, resolution) for k in STENCIL}
            rates[place] = sum(weight * energies[k] for k, weight in STENCIL.items()) / (12.0 * step)
            curvature[place] = abs(rates[place] - (energies[1] - energies[-1]) / (2.0 * step))
        values.append(rates)
    scale = np.maximum(np.abs(values[-1]), np.finfo(float).tiny)
    uncertain = spread(values, ladder) + curvature**2 / scale
    order, unit = patch_order(finest), state.problem.unit_release_rate
    return values[-1][order] * unit, uncertain[order] * unit


def _step(finest: Evaluation, place: tuple[int, ...]) -> float:
    """Return the distance by which an edge is moved, in periods."""
    lengths = intervals(finest.edges)
    edge = 2 * place[0] + place[1]
    return float(STEP * min(lengths[edge], lengths[edge - 1]))


def _energy(
    finest: Evaluation, place: tuple[int, ...], outwards: float, held: Control, resolution: Resolution
) -> float:
    """Return the strain energy with one edge moved outwards and the plate held, E a^2."""
    problem, edges = finest.states.problem, finest.edges.copy()
    edges[place] += outwards * (1.0 if place[1] else -1.0)
    mesh = layer_mesh(problem.depth, edges, resolution, problem.highest_order)
    return float(strain_energy(evaluate(problem, mesh, resolution, held)))
