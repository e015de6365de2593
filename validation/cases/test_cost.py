"""Cost of accuracy: CPU seconds against true error of every route, measured in this run on one thread.

The smooth problem is Johnson's adhesive wave (alpha = 0.3) at the load of contact fraction 1/2, exact.  The rough one
has 20 harmonics and adhesion along its true length, followed from first touch to one separation; its reference is the
equilibrium by dense algebra on twice the nodes, next to the edges of the finest run.  Each setting runs three times in
alternation; the median counts, and half the range is its spread.  Grid methods of other groups (extra `peers`) join
where they are installed.  Every effect is priced against the scene without it.  SI units.
"""

import time
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest

import bem
import fem_reference
import persson
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.references.dense_equilibrium import equilibrium
from validation.routes.dense_algebra import reference
from validation.routes.scenes import posed, problem_of

REPEATS = 3
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
REFINEMENTS = (0.15, 0.2, 0.3, 0.4, 0.6, 0.8)  # of the nodes of all digits
MESHES = ((2, 10, 10), (2, 16, 12), (4, 8, 12), (4, 8, 18))
RESOLUTIONS = (0.25, 0.5, 1.0, 2.0)
WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
LOAD, DEPTH = float(WAVE.mean_pressure(np.pi / 4)), float(WAVE.penetration(np.pi / 4))
THICK = {"thickness": 0.03}  # m, three periods: a half-space within 1e-12
SMOOTH = {
    "title": "smooth wave",
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3},
    "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [50e-6], "phases": [0.0]},
    "adhesion": {"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False},
    "loading": {"control": "mean_pressure", "targets": [LOAD]},
}
SEPARATION = 40e-6


def rough(**tables):
    """Return the rough adhesive scene, with some of its tables changed."""
    usual = {"profile": {"harmonics": 20}, "loading": {"targets": [SEPARATION]}}
    return posed("rough_100", **usual | tables)


def timed(runs):
    """Return, for every setting, its answer, the median of its CPU seconds and half their range."""
    seconds, answers = {setting: [] for setting in runs}, {}
    for _ in range(REPEATS):
        for setting, run in runs.items():
            begun = time.process_time()
            answers[setting] = run()
            seconds[setting].append(time.process_time() - begun)
    return {setting: (answers[setting], float(np.median(of)), float(np.ptp(of)) / 2) for setting, of in seconds.items()}


def price(rows, problem, code, measured, error_of):
    """Add the costs of a route, and return errors and seconds."""
    points = []
    for setting, (answer, seconds, spread) in measured.items():
        error = max(error_of(answer), 1e-16)
        rows.cost(problem, code, str(setting), error, seconds, spread)
        points.append((error, seconds))
    return tuple(zip(*points, strict=True))


def bem_runs(scene_at):
    """Return a run for every tolerance."""
    return {f"tolerance {t:g}": lambda t=t: bem.solve(scene_at(t)) for t in TOLERANCES}


def rows_of_bem(rows, measured, exact, source, by, u_reference):
    """Add rows of error and work at every tolerance, and a table that says where the work does not fall."""
    work, lines = [], []
    for tolerance, (result, _, _) in zip(TOLERANCES, measured.values(), strict=True):
        state = result.targets[-1]
        rows.compare(f"contact fraction at tolerance {tolerance:g}", state.contact_fraction, exact, of=Code.BEM, by=by,
                     quantity=Quantity.AREA, uncertainty=(state.error_estimate.contact_fraction or 0.0, u_reference),
                     required=max(tolerance, 1e-11) * exact, because="the tolerance asked for",
                     source=source)
        work.append(sum(each.evaluations for each in result.states))
        rows.count(f"evaluations at tolerance {tolerance:g}", work[-1], of=Code.BEM)
        lines.append([tolerance, work[-1], abs(state.contact_fraction / exact - 1)])
    level = [f"{t:g}" for t, fewer, more in zip(TOLERANCES, work, work[1:], strict=False) if fewer >= 0.98 * more]
    rows.table("Work of boundary elements by tolerance: " + (
        f"it does not fall from a digit to fewer at {', '.join(level)}, where the error is far below the tolerance"
        if level else "it falls with every tolerance"), ["tolerance", "evaluations", "true error"], lines)


@pytest.mark.standard
def test_smooth_wave(rows):
    """On a smooth adhesive wave, how many seconds does a digit cost by every route?"""
    runs = bem_runs(lambda t: bem.parse_scene(SMOOTH | {"accuracy": {"tolerance": t}}))
    ours = timed(runs)
    rows_of_bem(rows, ours, 0.5, "Johnson 1995", Code.EXACT, 0.0)
    given = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "period": 0.01, "harmonics": ([1], [50e-6], [0.0]),
             "work_of_adhesion": WAVE.work_of_adhesion, "control": "mean_pressure", "value": LOAD} | THICK
    meshes = timed({"P{}, {} cells, {} halvings".format(*at): lambda at=at: fem_reference.solve(
        **given, resolution=fem_reference.Resolution(*at)) for at in MESHES})
    problem = problem_of(bem.parse_scene(SMOOTH), "dense algebra", "adhesion")
    problem = replace(problem, control="penetration", targets=(DEPTH,))
    half = 0.26 * WAVE.wavelength  # Newton's rule starts at the contact fraction 0.52
    nodes = timed({f"{of:g} of all nodes": lambda of=of: equilibrium(
        problem, [[-half, half]], DEPTH, DEPTH, of)["contact_fraction"] for of in REFINEMENTS})
    name = "smooth wave"

    def off(fraction):
        return abs(fraction - 0.5) / 0.5

    curves = {
        "boundary elements": price(rows, name, Code.BEM, ours, lambda r: off(r.targets[-1].contact_fraction)),
        "finite elements": price(rows, name, Code.FEM, meshes, lambda s: off(s.contact_fraction)),
        "dense algebra at a given penetration": price(
            rows, "smooth wave at a given penetration, one patch", Code.DENSE, nodes, off),
    }
    if find_spec("Adhesion") and find_spec("ContactMechanics"):
        curves["grid method (extra peers)"] = price(rows, name, Code.GRID, peers(problem), off)
    rows.curves("Smooth adhesive wave: CPU seconds against true error", "relative error of the contact fraction",
                "CPU seconds", {label: (*points, "points") for label, points in curves.items()}, log="xy",
                front=True)


def peers(problem):
    """Return runs of the FFT solver of another group, on growing grids."""
    from validation.routes import cohesive_grid

    return timed({f"{n} points": lambda n=n: cohesive_grid.contact_fraction(problem, n) for n in (2**10, 2**12, 2**14)})


@pytest.mark.standard
def test_rough_adhesive(rows):
    """On a rough adhesive contact, how many seconds does a digit cost?"""
    ours = timed(bem_runs(lambda t: rough(accuracy={"tolerance": t})))
    finest = bem.solve(rough(accuracy={"tolerance": 1e-11}))
    exact, finer = (reference(rough(), finest.targets[-1], k)["contact_fraction"] for k in (1, 2))
    rows_of_bem(rows, ours, finer, "dense algebra next to the edges of the finest run", Code.DENSE,
                abs(exact - finer) + 1e-13)
    theory = timed({f"resolution {r:g}": lambda r=r: theory_area(r, finest.targets[-1].mean_pressure)
                    for r in RESOLUTIONS})
    own = theory_area(4.0, finest.targets[-1].mean_pressure)
    curves = {
        "boundary elements": price(rows, "rough adhesive", Code.BEM, ours,
                                   lambda r: abs(r.targets[-1].contact_fraction / finer - 1)),
        "theory against its own limit": price(
            rows, "rough adhesive: error against the theory's own limit", Code.THEORY, theory,
            lambda a: abs(a / own - 1)),
    }
    rows.curves("Rough adhesive contact: CPU seconds against true error", "relative error of the contact fraction",
                "CPU seconds", {label: (*points, "points") for label, points in curves.items()}, log="xy",
                front=True)


def theory_area(resolution, pressure):
    """Return the contact fraction of Persson's theory of the rough profile at a mean pressure."""
    return persson.solve(persson.DiscreteSpectrum.of_profile(rough().surface()), pressure, youngs_modulus=1e6,
                         poisson_ratio=0.5, work_of_adhesion=0.03, with_separation=False,
                         resolution=resolution).contact_fraction


STICKY = {"adhesion": {"work_of_adhesion": 0.03, "slope_term": True}}
BACK = {"loading": {"targets": [SEPARATION, 35e-6, SEPARATION]}}
EFFECTS = {  # scene with the effect, and the one it is priced against
    "bare": ({"adhesion": None}, ""),
    "layer": ({"adhesion": None, "layer": {"thickness": 0.002}}, "bare"),
    "adhesion": ({"adhesion": {"work_of_adhesion": 0.03, "slope_term": False}}, "bare"),
    "slope term": (STICKY, "adhesion"),
    "two more targets, one on the way back": (STICKY | BACK, "slope term"),
    "spectra": (STICKY | {"output": {"spectra": True}}, "slope term"),
    "pressure distribution": (STICKY | {"output": {"pressure_distribution": True}}, "slope term"),
}


@pytest.mark.standard
def test_price_of_effects(rows):
    """For each effect of a scene, how much does it cost?"""
    measured = timed({name: lambda t=tables: bem.solve(rough(**t)) for name, (tables, _) in EFFECTS.items()})
    lines = []
    for name, (_, base) in EFFECTS.items():
        result, seconds, spread = measured[name]
        work = sum(state.evaluations for state in result.states)
        rows.count(f"evaluations, {name}", work, of=Code.BEM)
        times = seconds / measured[base][1] if base else None
        lines.append([name, base or "–", seconds, spread, times, work])
    rows.table("Price of every effect on a rough scene of 20 harmonics", ["effect", "on top of", "CPU seconds",
               "spread", "times the scene without it", "evaluations"], lines)
