"""The solver's plain dense route as a method of its own: Newton on K = K_c with a given number of nodes per patch.

Not the production solver: no path, no search for contacts, patches and their start (the overlap of the undeformed
shapes) are given, the number of nodes is the knob.  It shows what the discretisation alone costs, digit by digit.
Steps are limited to a third of the room of an edge.  Limits: adhesion without the slope term.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

import bem
from bem.audit.dense import DenseState, SmoothKernel, evaluate_dense
from bem.geometry.patches import Patches
from bem.geometry.scaling import Scales
from validation.references.posed_contacts import Found, MethodError, Posed, overlap

FloatArray = NDArray[np.float64]

ITERATIONS, FARTHEST, CLOSED = 60, 0.3, 1e-14


def solve_dense(posed: Posed, nodes: int) -> Found:
    """Contact at the penetration of a scene with this many nodes on every patch.

    Raises
    ------
    MethodError
        Newton does not settle, or the scene has the slope term.
    """
    if posed.slope_term:
        raise MethodError("the slope term is not in this route")
    begun = time.perf_counter()
    profile = bem.Profile.from_harmonics(posed.period, posed.orders, posed.amplitudes, posed.phases)
    solid = bem.Solid(posed.youngs_modulus, posed.poisson_ratio)
    scales = Scales(profile.period, profile.rms_height, solid.plane_strain_modulus)
    layer = None if posed.thickness is None else bem.Layer(posed.thickness)
    kernel = None
    if layer is not None:
        addition = layer.kernel(solid, posed.period, 1e-15)
        kernel = SmoothKernel(addition.smooth, addition.slope)
    critical = 2 * float(np.sqrt(posed.work_of_adhesion / scales.release_rate))
    scaled, depth, start = profile.scaled(), posed.penetration / scales.height, overlap(posed) / scales.length
    ready = time.perf_counter()
    count, evaluations = np.full(len(start), nodes), 0
    patches = Patches(start[:, 0], start[:, 1])
    last = np.inf
    for _ in range(ITERATIONS):
        evaluations += 1
        state = evaluate_dense(scaled, patches.left, patches.right, depth, count, kernel)
        step = _step(state, patches, critical)
        size = float(np.max(np.abs(step) / patches.edge_room))
        if size < CLOSED or (size < 1e-9 and size > 0.5 * last):
            break
        patches, last = patches.moved(step * min(1.0, FARTHEST / size)), size
    else:
        raise MethodError(f"the last step of Newton is {last:.1e} of the room of an edge")
    solved = time.perf_counter()
    edges = np.stack([patches.left, patches.right], axis=1) * scales.length
    contact = bem.ContactState(profile, solid, edges, posed.penetration, layer)
    at = np.array([posed.trough])
    gap = contact.displacement(at) - (profile.height(at) - profile.max_height + posed.penetration)
    answer = {
        "contact_fraction": patches.contact_fraction,
        "mean_pressure": state.load * scales.force / posed.period,
        "elastic_energy": state.elastic_energy * scales.energy_per_area,
        "gap": float(gap[0]),
    }
    counts = {"evaluations": evaluations, "patches": patches.count}
    return Found(answer, int(count.sum()), counts, ready - begun, solved - ready, time.perf_counter() - solved)


def _step(state: DenseState, patches: Patches, critical: float) -> FloatArray:
    """Newton's outward motion of the edges towards K = K_c; edges that close (K < 0) move outward."""
    closing = state.stress_intensity < 0
    if np.any(closing):
        return np.where(closing, FARTHEST * patches.edge_room, 0.0)
    return np.asarray(np.linalg.solve(state.stress_intensity_jacobian, critical - state.stress_intensity))
