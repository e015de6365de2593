"""Paths: the first of two states at one load, and patches that remain when a neighbour detaches.

Rough profile of 100 harmonics (Hurst exponent 0.7, h_rms = 50 um, period 10 mm, E = 1 MPa, nu = 0.5), loaded and
unloaded.

A wave with a ripple whose crests come in pairs of nearly equal height: when one of a pair detaches, the other patch
shrinks until it is in equilibrium.  Seven equal crests lose their symmetry on unloading; which patches detach depends
on the first small asymmetry.  Reference: overdamped motion of the edges down the energy in small explicit steps,

    d(edge)/dt ~ -dU/d(edge) l / w,   l the shorter of patch and gap,

from the state before the event until forces are 1e-4 w, ended by Newton.  A patch narrower than a
thousandth of its first width has detached.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.routes.dense_algebra import reference
from validation.routes.scenes import edge_scale, estimates, solved, values

STEP, LARGEST = 0.2, 0.05  # motion of an edge in a step over l force / w, and largest motion over l
STEPS, NEWTON = 5000, 4  # most steps of the motion, and steps of Newton's rule behind it
AT_REST, GONE = 1e-4, 1e-3


@pytest.mark.quick
def test_first_state_at_a_load(rows):
    """Where events make a mean pressure occur twice on a path, is the state at that pressure the first of both?"""
    adhesion = {"work_of_adhesion": 0.05}
    twice = {1381.208: 61.8e-6, 3558.97: 48.3e-6}  # Pa, and a separation between the two states of that load
    start, spacing = 70e-6, 0.05e-6
    loading = {"targets": [start, 42e-6], "at_mean_pressures": sorted(twice)}
    states = solved("rough_100", adhesion=adhesion, loading=loading).targets
    first, bracketed = [], []
    for load, middle in twice.items():
        near = (middle + spacing * np.arange(8, -9, -1)).tolist()
        path = solved("rough_100", adhesion=adhesion, loading={"targets": [start, *near]}).targets
        before, after = next(pair for pair in pairwise(path) if pair[0].mean_pressure < load <= pair[1].mean_pressure)
        share = (load - before.mean_pressure) / (after.mean_pressure - before.mean_pressure)
        bracketed.append(before.contact_fraction + share * (after.contact_fraction - before.contact_fraction))
        first.append(next(state.contact_fraction for state in states if abs(state.mean_pressure / load - 1) < 1e-6))
    rows.compare("contact fraction at loads that occur twice", first, bracketed, of=Code.BEM, by=Code.IDENTITY,
                 quantity=Quantity.AREA, kind="construction", required=1e-3 * np.array(bracketed),
                 because="linear between states 0.05 um apart, next to a fold",
                 source="states between which the load is first passed")


@dataclass(frozen=True)
class Ripples:
    """Orders, amplitudes in m and phases of a profile with a period of 10 mm, and its work of adhesion in J/m^2."""

    orders: tuple[int, ...]
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]
    work: float

    def path(self, targets):
        """Solve the path to penetrations in m."""
        profile = {name: list(getattr(self, name)) for name in ("orders", "amplitudes", "phases")}
        return solved("sinusoid", profile=profile, adhesion={"work_of_adhesion": self.work},
                      loading={"targets": targets}, accuracy={"max_increment": 0.02, "tolerance": None})

    def state(self, edges, penetration):
        """Return the state of given patches, (n, 2) in m, at a penetration in m."""
        profile = bem.Profile.from_harmonics(0.01, self.orders, self.amplitudes, self.phases)
        solid, adhesion = bem.Solid(1e6, 0.5), bem.Adhesion(self.work, False)
        return bem.ContactState(profile, solid, edges, penetration, adhesion=adhesion, tolerance=1e-8)

    def relaxed(self, edges, penetration):
        """Return edges at rest, (n, 2) in m, by the overdamped motion from given edges."""
        widths = edges[:, 1] - edges[:, 0]
        for _ in range(STEPS):
            force = self.state(edges, penetration).gradient / self.work
            if np.max(np.abs(force)) < AT_REST:
                break
            edges = edges - np.clip(STEP * force, -LARGEST, LARGEST) * edge_scale(edges, 0.01)
            stays = edges[:, 1] - edges[:, 0] > GONE * widths
            edges, widths = edges[stays], widths[stays]
        for _ in range(NEWTON):
            state = self.state(edges, penetration)
            edges = edges - np.linalg.solve(state.hessian, state.gradient.ravel()).reshape(edges.shape)
        return edges


@pytest.mark.quick
def test_patch_that_stands(rows):
    """When one patch of a pair detaches, does the other shrink to where overdamped motion comes to rest?"""
    pairs = Ripples((1, 24), (3e-5, 4e-6), (0.0, 0.02), 0.01)
    between = 2.16e-6  # m; the outer pair detaches at penetrations of 2.22 and 2.11 um
    result = pairs.path([10e-6, between])
    last = result.targets[-1]
    before = next(s for s in reversed(result.states) if s.branch == "unloading" and s.n_patches > last.n_patches)
    fold = next(event.penetration for event in result.events if event.kind == "detachment")
    # begins 0.02 um beyond the fold, at which the motion would take for ever
    rest = pairs.relaxed(pairs.relaxed(np.array(before.edges), fold - 0.02e-6), between)
    motion = rows.between(Code.BEM, Code.IDENTITY, "overdamped motion of the edges", "construction")
    motion.compare("patches before and after", [before.n_patches, last.n_patches], [5, len(rest)],
                   quantity=Quantity.COUNT, required=0.5, because="a count")
    motion.compare("contact fraction after", last.contact_fraction, float(np.sum(np.diff(rest))) / 0.01,
                   quantity=Quantity.AREA, required=1e-10, because="Newton ends the motion at rounding")
    rows.count("evaluations", sum(state.evaluations for state in result.states), within=0.1, of=Code.BEM)


@pytest.mark.quick
def test_first_of_equal_patches_detaches(rows):
    """Do as many of seven equal patches stay as in overdamped motion that begins with one patch 1 % narrower?"""
    equal, around = Ripples((7,), (2e-5,), (0.0,), 0.1), (-5.4e-6, -5.8e-6)  # they part at -5.46 um
    first, after = equal.path([10e-6, *around]).targets[1:]
    edges = np.array(first.edges)
    edges[0] += 0.01 * (edges[0, 1] - edges[0, 0]) * np.array([0.5, -0.5])
    rows.compare("patches before and after", [first.n_patches, after.n_patches],
                 [7, len(equal.relaxed(edges, around[1]))], of=Code.BEM, by=Code.IDENTITY, quantity=Quantity.COUNT,
                 kind="construction", required=0.5, because="a count",
                 source="overdamped motion of the edges")


@pytest.mark.quick
def test_windows(rows, monkeypatch):
    """Is a contact followed in windows of a few patches that of one piece, in events, states and by dense algebra?"""
    orders, targets = np.arange(30, 60), [1.1e-6, 0.9e-6]
    heights = orders**-1.2
    profile = {"kind": "harmonics", "period": 0.01, "orders": orders.tolist(),
               "amplitudes": (heights * 1e-6 / np.sqrt(np.sum(heights**2) / 2)).tolist(),
               "phases": np.random.default_rng(7).uniform(-np.pi, np.pi, orders.size).tolist()}
    scene = bem.parse_scene({"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5}, "profile": profile,
                             "adhesion": {"work_of_adhesion": 3e-4}, "accuracy": {"tolerance": 1e-3},
                             "loading": {"control": "separation", "targets": targets}})
    whole = bem.solve(scene)
    monkeypatch.setattr("bem.windows.windowed_path.MANY_PATCHES", 20)
    monkeypatch.setattr("bem.windows.windows.CORE_PATCHES", 8)
    parts = bem.solve(scene)
    first, second = (sorted(result.events, key=lambda event: (event.kind, event.position)) for result in (parts, whole))
    assert min(state.n_patches for state in parts.targets) > 20, "the contact is followed in one piece"
    pieces = rows.between(Code.BEM, Code.IDENTITY, "the same contact in one piece", "construction")
    for name, unit, quantity in (("mean_pressure", "Pa", Quantity.PRESSURE), ("penetration", "m", Quantity.LENGTH)):
        value, other = (values(events, name) for events in (first, second))
        pieces.compare(f"{name.replace('_', ' ')} at events", value, other, unit=unit, quantity=quantity,
                       required=estimates(first, name) + estimates(second, name), because="errors that events state")
    assert np.any(value != other), "no windows: they locate penetrations to 1e-3, the contact in one piece to 1e-9"
    for name, unit, quantity in (("contact_fraction", "", Quantity.AREA), ("mean_pressure", "Pa", Quantity.PRESSURE),
                                 ("contact_stiffness", "Pa/m", Quantity.STIFFNESS)):
        value = values(parts.targets, name)
        pieces.compare(f"{name.replace('_', ' ')} at targets", value, values(whole.targets, name), unit=unit,
                       quantity=quantity, required=1e-8 * max(value), because="settled states")
        known = np.array([reference(scene, state)[name] for state in parts.targets])
        rows.compare(f"{name.replace('_', ' ')} at targets: dense algebra", value, known, unit=unit, of=Code.BEM,
                     by=Code.DENSE, quantity=quantity, uncertainty=(estimates(parts.targets, name), 1e-12 * known))
    rows.count("evaluations", sum(state.evaluations for state in parts.targets), of=Code.BEM, within=0.1)
