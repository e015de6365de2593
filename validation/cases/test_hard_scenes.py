"""Hard scenes: does each end as expected, and is every number of it right?

Scenes and expectations stand in hard_scenes.py.  The elastic state at the stored edges of every target is evaluated by
dense algebra (references/dense.py: own nodes and kernels); targets away from complete contact are solved anew next to
the edges (references/dense_equilibrium.py), with U the change on twice the nodes and what rounding of the heights does
through the stiffness of the state.  One wave is compared with Westergaard and Johnson; last gaps with isolated cracks
in the pressure of complete contact (Tada, Paris, Irwin 2000).  SI units.
"""

from dataclasses import replace

import numpy as np
import pytest

import bem
from validation.cases.hard_scenes import LOW, SCENES, WAVE, scene
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid, full_contact_amplitudes
from validation.references.dense import LayerKernel, dense_nodes, evaluate_dense, layer_nodes
from validation.references.isolated_crack import closing, crack
from validation.references.paper_problem import PERIOD
from validation.references.waves import Waves
from validation.routes.dense_algebra import reference

EPS = float(np.finfo(float).eps)
ROUNDINGS = 24  # of the heights, seen through the stiffness of a state
MOST_NODES = 3000  # of dense algebra: 1 s
LEAST, NARROWEST = 1e-3, 3e-3  # contact fraction and gap, periods, where Newton by dense algebra ends within rounding
ISOLATED = 2e-6  # of the pressure unit and the separation: terms left out by isolated cracks, (c / period)^2
DENSE = {
    "mean_pressure": (Quantity.PRESSURE, "Pa"),
    "contact_fraction": (Quantity.AREA, ""),
    "elastic_energy": (Quantity.ENERGY, "J/m^2"),
    "stress_intensity_max": (Quantity.INTENSITY, "Pa m^1/2"),
}


@pytest.mark.parametrize(
    "hard", [pytest.param(hard, id=hard.name, marks=getattr(pytest.mark, hard.level)) for hard in SCENES]
)
def test_hard_scene(rows, hard):
    """Does a hard scene end as expected, and do independent solutions confirm its numbers?"""
    posed = bem.parse_scene(hard.tables)
    result = bem.solve(posed)
    statuses = tuple(state.status for state in result.targets)
    construction(rows, "targets that end otherwise than expected", statuses != hard.expected, hard.why)
    missing = set(hard.events) - {event.kind for event in result.events}
    construction(rows, "expected events that are missing", len(missing), ", ".join(sorted(missing)))
    identities(rows, result)
    rows.table(hard.why, ["target", "status", "contact fraction", "mean pressure / Pa", "patches", "unknowns"],
               [[k, state.status, state.contact_fraction, state.mean_pressure, state.n_patches, state.unknowns]
                for k, state in enumerate(result.targets, 1)])
    touching = [state for state in result.targets if state.edges]
    by_dense_algebra(rows, posed, touching)
    if "wave" in hard.checks:
        by_closed_form(rows, posed, touching)
    if "equal" in hard.checks:
        widths = [np.diff(state.edges, axis=1) for state in touching]
        spread = max(float(np.ptp(width) / width.mean()) for width in widths)
        construction(rows, "spread of the widths of equal patches", spread, allowed=8e-12)
    if "tension" in hard.checks:
        loads = [state.mean_pressure for state in touching]
        construction(rows, "load not compressive before and tensile at the end", not max(loads) > 0 > loads[-1])
    if "last gap" in hard.checks:
        by_last_gap(rows, posed, touching[-1])
    if "closing gaps" in hard.checks:
        by_closing_gaps(rows, posed, touching[-1])


def construction(rows, name, value, because="none may be there", allowed=0.5):
    """Add a row of something that must vanish."""
    rows.compare(name, float(value), 0.0, of=Code.BEM, by=Code.IDENTITY, quantity=Quantity.COUNT, kind="construction",
                 required=allowed, because=because or "none may be there")


def identities(rows, result):
    """Add rows of certificates, and of the energy that events release; sums of numbers are checked by every result."""
    met = [state for state in result.states if state.status in ("converged", "separated", "complete_contact")]
    construction(rows, "states whose certificate is not ok", sum(not state.certificate.ok for state in met))
    released = [-event.energy_released for event in result.events
                if event.energy_released is not None and event.energy_released < -1e-9 * max(
                    [abs(state.elastic_energy) for state in met] + [1e-300])]
    construction(rows, "events that take energy up", len(released))


def by_dense_algebra(rows, posed, states):
    """Add rows of the elastic states at the stored edges, and of the equilibria next to them, by dense algebra."""
    surface = Waves.of(posed.surface())
    affordable = [state for state in states if dense_nodes(surface, *angles(state)).sum() <= MOST_NODES]
    if affordable:
        elastic_states(rows, posed, surface, affordable)
    equilibria = [state for state in affordable if state.contact_fraction >= LEAST and gaps(state).min() >= NARROWEST]
    if not equilibria:
        return
    exact, finer = ([reference(posed, state, factor) for state in equilibria] for factor in (1, 2))
    for name, (quantity, unit) in DENSE.items():
        if name == "stress_intensity_max" and posed.adhesion is None:
            continue  # it vanishes
        references = np.array([each[name] for each in exact])
        scale = np.abs(references) + (pressure_unit(posed, surface) if name == "mean_pressure" else 0.0)
        soft = [rounded_pressure(surface, state) if name == "mean_pressure" else 0.0 for state in equilibria]
        # what is held, and the critical stress intensity of equal works of adhesion, both sides have from the scene
        slopes = posed.adhesion is not None and posed.adhesion.slope_term
        given = name == posed.loading.control or (name == "stress_intensity_max" and not slopes)
        own = [getattr(state.error_estimate, name) or 0.0 for state in equilibria] + 1e-12 * scale
        theirs = np.abs(references - [each[name] for each in finer]) + 1e-12 * scale + soft
        rows.compare(name.replace("_", " "), [getattr(state, name) for state in equilibria], references, of=Code.BEM,
                     by=Code.DENSE, quantity=quantity, unit=unit, uncertainty=(own, theirs),
                     kind="construction" if given else "accuracy",
                     source="equilibrium next to the edges, own nodes and derivatives")


def elastic_states(rows, posed, surface, states):
    """Add rows of mean pressure and of K^2 / (2 E* w) at every edge, of the stored edges and penetrations."""
    modulus, q0 = posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2), 2 * np.pi / PERIOD
    scaled, work = Waves(2 * np.pi, surface.orders, surface.amplitudes, surface.phases), posed.adhesion
    kernel = None
    if posed.layer is not None:
        kernel = LayerKernel.of(q0 * posed.layer.thickness, posed.solid.poisson_ratio)
    loads, rounding, closures = [], [], []
    for state in states:
        left, right = angles(state)
        nodes = dense_nodes(surface, left, right)
        if kernel is not None:
            nodes = np.maximum(nodes, layer_nodes(left, right, q0 * posed.layer.thickness))
        dense = evaluate_dense(scaled, left, right, state.penetration, nodes, kernel)
        unit = modulus * q0 / 2 / (2 * np.pi)
        loads.append(dense.load * unit)
        # heights and places of edges are rounded
        moved = abs(dense.load_rate) * surface.highest + 2 * np.pi * np.abs(dense.load_jacobian).sum()
        rounding.append(ROUNDINGS * EPS * moved * unit)
        if work is not None:
            slope = surface.height(np.concatenate([left, right]) / q0, 1) if work.slope_term else 0.0
            needed = work.work_of_adhesion * np.sqrt(1 + slope**2)
            closures.append((dense.stress_intensity * modulus * np.sqrt(q0) / 2) ** 2 / (2 * modulus * needed) - 1)
    scale = np.maximum(np.abs(loads), pressure_unit(posed, surface))
    own = np.array([state.error_estimate.mean_pressure or 0.0 for state in states])
    theirs = rounding + 2e-10 * scale
    rows.compare("mean pressure at the stored edges", [state.mean_pressure for state in states], loads, of=Code.BEM,
                 by=Code.DENSE, quantity=Quantity.PRESSURE, unit="Pa", uncertainty=(own, theirs),
                 source="elastic state at given edges and penetration")
    if closures:
        rows.compare("G / w at every edge", 1 + np.concatenate(closures), 1.0, of=Code.BEM, by=Code.DENSE,
                     quantity=Quantity.INTENSITY, uncertainty=(posed.accuracy.tolerance, 1e-10), required=1e-5,
                     because="closure of the edges; K loses digits as gaps close",
                     source="K at the stored edges by dense algebra")


def gaps(state):
    """Return the gaps behind the patches, in periods."""
    edges = np.array(state.edges) / PERIOD
    return np.append(edges[1:, 0], edges[0, 0] + 1) - edges[:, 1]


def angles(state):
    """Return left and right edges as angles of the period."""
    return np.array(state.edges).T * 2 * np.pi / PERIOD


def pressure_unit(posed, surface):
    """Return E* h_rms / period, Pa."""
    return posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2) * surface.rms_height / PERIOD


def rounded_pressure(surface, state):
    """Return the pressure, Pa, by which rounding of the heights is seen through the stiffness of a state."""
    return ROUNDINGS * EPS * surface.highest * abs(state.contact_stiffness or 0.0)


def by_closed_form(rows, posed, states):
    """Add rows of pressure and penetration of one wave at the contact fraction found (Westergaard, Johnson)."""
    alpha = 0.3 if posed.adhesion else 0.0
    exact = Sinusoid(WAVE, PERIOD, posed.solid.youngs_modulus, posed.solid.poisson_ratio, alpha)
    gap = [np.pi / 2 * (1 - state.contact_fraction) for state in states]  # the complement keeps the digits
    for name, quantity, unit, scale in (
        ("mean_pressure", Quantity.PRESSURE, "Pa", exact.full_contact_pressure),
        ("penetration", Quantity.LENGTH, "m", WAVE),
    ):
        known = np.array([float(getattr(exact, name)(np.pi / 2 - g)) for g in gap])
        own = np.array([getattr(state.error_estimate, name) or 0.0 for state in states])
        rows.compare(name.replace("_", " "), [getattr(state, name) for state in states], known, of=Code.BEM,
                     by=Code.EXACT, quantity=quantity, unit=unit, uncertainty=own,
                     required=2e-8 * np.maximum(scale, np.abs(known)), source="Johnson 1995",
                     because="heights known to 1e-16 leave 1e-8 at a contact fraction of 0.9999")


def by_last_gap(rows, posed, state):
    """Add rows of load and separation of the last gap with adhesion, by an isolated crack of its width."""
    surface, ((start, end),) = posed.surface(), state.edges
    modulus = posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2)
    pressure, separation = crack(surface, modulus, posed.adhesion.work_of_adhesion, end, start + surface.period)
    pair = rows.between(Code.BEM, Code.EXACT, "isolated crack, Tada, Paris, Irwin 2000")
    estimate = state.error_estimate
    pair.compare("mean pressure of the last gap", state.mean_pressure, pressure, quantity=Quantity.PRESSURE, unit="Pa",
                 uncertainty=(estimate.mean_pressure or 0.0, ISOLATED * abs(pressure)))
    pair.compare("separation of the last gap", state.separation, separation, quantity=Quantity.LENGTH, unit="m",
                 uncertainty=(estimate.separation or 0.0, ISOLATED * separation))


def by_closing_gaps(rows, posed, state):
    """Add rows of load and widths of the last gaps without adhesion, by isolated cracks."""
    surface, modulus = posed.surface(), posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2)
    amplitudes = full_contact_amplitudes(surface.orders, surface.amplitudes, surface.period, modulus)
    pressure, widths = closing(replace(surface, amplitudes=amplitudes), modulus, state.separation)
    pair = rows.between(Code.BEM, Code.EXACT, "isolated cracks, Tada, Paris, Irwin 2000")
    pair.compare("mean pressure of the last gaps", state.mean_pressure, pressure, quantity=Quantity.PRESSURE,
                 unit="Pa", uncertainty=(state.error_estimate.mean_pressure or 0.0, 2.5e-14 * pressure))
    pair.compare("share without contact", 1 - state.contact_fraction, widths.sum() / surface.period,
                 quantity=Quantity.AREA,
                 uncertainty=(state.error_estimate.contact_fraction or 0.0, 5e-9 * widths.sum() / surface.period))
    pair.compare("last gaps", state.n_patches, widths.size, quantity=Quantity.COUNT, kind="construction", required=0.5,
                 because="a count")


def test_many_samples(rows, tmp_path):
    """Is a scan of 50,000 noisy samples solved as its harmonics are?"""
    number, smooth = 50_000, bem.Profile.self_affine(PERIOD, 0.7, 50e-6, 2000, 0)
    x = np.arange(number) * (PERIOD / number)
    height = smooth.height(x) + np.random.default_rng(0).normal(0.0, 1e-7, number)
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, height]), delimiter=",", fmt="%.12e")
    scan = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": 100}
    posed = bem.parse_scene(scene(scan, "separation", LOW, 0.03, True), tmp_path)
    result = bem.solve(posed)
    identities(rows, result)
    by_dense_algebra(rows, posed, [state for state in result.targets if state.edges])
