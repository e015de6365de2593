"""Dense algebra from the overlap of the undeformed shapes: no path, no search for contacts, the patches are given.

Its knob is the number of nodes on every patch.  It shows what the discretisation alone costs, digit by digit; far from
its answer, steps are limited to a third of the edge scale.  The equations are those of references/dense_equilibrium.py.
"""

from typing import Any

import numpy as np

from bem.elastic.layer import Layer
from bem.geometry.profile import Profile
from bem.geometry.scaling import Scales, Solid
from validation.harness.route import Answer, Laps, Problem
from validation.references.adapters import contact_of
from validation.references.dense import SmoothKernel
from validation.references.dense_equilibrium import Interface, converged
from validation.references.posed_contacts import overlap


def solve(problem: Problem, nodes: int) -> Answer:
    """The contact at the only target, a penetration; NoReferenceError where Newton does not converge."""
    if problem.slope_term or problem.work_of_adhesion is None:
        raise NotImplementedError("the slope term, or no adhesion")
    laps = Laps()
    (penetration,) = problem.targets
    profile = Profile.from_harmonics(problem.period, *problem.harmonics)
    solid = Solid(problem.youngs_modulus, problem.poisson_ratio)
    scales, kernel = Scales(profile.period, profile.rms_height, solid.plane_strain_modulus), None
    if problem.thickness is not None:
        addition = Layer(problem.thickness).kernel(solid, problem.period, 1e-15)
        kernel = SmoothKernel(addition.smooth, addition.slope)
    interface = Interface(problem.work_of_adhesion / scales.release_rate, profile.scaled(), 0.0)
    depth, start = penetration / scales.height, overlap(problem) / scales.length
    count = np.full(len(start), nodes)
    laps.end("setup")
    left, right, state, evaluations = converged(
        interface.profile, start[:, 0], start[:, 1], depth, count, kernel, interface, depth, (1.0, 0.0), far=True
    )
    laps.end("solve")
    edges = np.stack([left, right], axis=1) * scales.length
    values: dict[str, Any] = {
        "contact_fraction": float(np.sum(right - left)) / (2 * np.pi),
        "mean_pressure": state.load * scales.force / problem.period,
        "elastic_energy": state.elastic_energy * scales.energy_per_area,
    }
    if gap := problem.asked.get("gap_at"):
        x = np.asarray(gap["points"])
        rigid = profile.height(x) - profile.max_height + penetration
        values["gap_at"] = contact_of(problem, edges, penetration).displacement(x) - rigid
    laps.end("post")
    counts = {"evaluations": evaluations, "patches": len(start)}
    return Answer(values=problem.answered(values), unknowns=int(count.sum()), counts=counts, parts=laps.parts)
