"""Maps beyond the paper: their points, the scene of each, and what its path gave.

Three planes through the paper's profile (H = 0.7, half-space, little adhesion); every point has realisations of its
own:

    roughness   Hurst exponent 0.3 to 0.9 against bandwidth (number of harmonics) 10 to 4000
    adhesion    Hurst exponent 0.3 to 0.9 against adhesion from none to sticky
    layer       thickness from a hundredth of the period to the half-space against adhesion

Adhesion is theta = gamma / U, U = E* sum q_m h_m^2 / 8 the elastic energy of full contact per nominal area (the
paper's 0.03 J/m^2 is theta = 0.03): at theta ~ 1 roughness no longer keeps the surfaces apart.  Every realisation is
loaded from first touch to s = h_rms / 2 and unloaded until it is off.

    slope     b of A/A0 = a + b p/(E* h'_rms), least squares over the loading targets with A/A0 in `FITTED`
    loop      energy lost in the loop, the sum of the energies released at the instabilities, J/m^2, shown over gamma
    tension   the largest at an end of a branch, where something parts or joins, over E* h'_rms

The loop is also the closed integral of p dDelta, here by the trapezoidal rule over the states of the path.  Without
adhesion the path is reversible and the loop is zero.  A path that jumps into complete contact, or ends otherwise, has
no loop and no tension: its status is shown in place of a number.  What the full study
(validation/studies/maps.py) found is maps.json beside this file, as it writes it.

Source of the problem: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601; of the layer:
Carbone, Mangialardi, J. Mech. Phys. Solids 56 (2008) 684.  Limits: one period, plane strain.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources

import numpy as np

from bem.geometry.profile import Profile
from bem.scene.result import FINAL_STATUSES, Result, State
from validation.harness.ensemble import Member, member_seed
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS, PERIOD, RMS_HEIGHT
from validation.report.map_figures import Map

STORED = "corpus/maps.json"
DEEPEST = 0.5  # separation at the turning point, of h_rms
FITTED = (0.02, 0.15)  # contact fractions
ROOT = 2009  # of the seeds
TITLES = {  # of the maps, by what they show of a run
    "slope": "slope b of A/A0 = a + b p/(E* h'rms)",
    "loop": "hysteresis loop area / work of adhesion",
    "tension": "largest tension at an end of a branch / (E* h'rms)",
}
OFF = 6.0  # rms heights beyond first touch, where a sticky profile has come off
LOADING_TARGETS = 24  # evenly spaced separations, so that the slope does not depend on where increments lie


@dataclass(frozen=True)
class Point:
    """One point of a map; thickness in periods, None for the half-space."""

    hurst: float
    harmonics: int
    theta: float
    thickness: float | None


@dataclass(frozen=True)
class Plane:
    """Two axes of points, `axis` naming the fields of `Point` that vary."""

    name: str
    axis: tuple[str, str]
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Run:
    """What one realisation gave; None where it has no such number."""

    name: str
    status: str
    slope: float | None
    loop: float | None
    tension: float | None
    integral: float
    work: float
    work_of_adhesion: float
    turning_pressure: float
    states: int
    not_certified: int


@dataclass(frozen=True)
class Axes:
    """How finely the planes are covered, and by how many realisations a point."""

    hursts: tuple[float, ...]
    bandwidths: tuple[int, ...]
    thetas: tuple[float, ...]
    thicknesses: tuple[float | None, ...]
    harmonics: int  # of the plane of adhesion
    layer_harmonics: int  # of the plane of layers: those of a hundredth of the period cost ten times as much
    seeds: int


FULL_AXES = Axes(
    hursts=(0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
    bandwidths=(10, 30, 100, 300, 1000, 2000, 4000),
    thetas=(0.0, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0),
    thicknesses=(0.01, 0.03, 0.1, 0.3, None),
    harmonics=250,
    layer_harmonics=100,
    seeds=3,
)
TINY_AXES = Axes(
    hursts=(0.3, 0.7),
    bandwidths=(10, 20),
    thetas=(0.0, 0.1),
    thicknesses=(0.1, None),
    harmonics=12,
    layer_harmonics=12,
    seeds=1,
)


def planes(axes: Axes) -> tuple[Plane, ...]:
    """The planes of the study; H = 0.7 where the thickness varies, theta = 0.03 where the bandwidth does."""
    by_bandwidth = tuple(Point(h, m, 0.03, None) for h in axes.hursts for m in axes.bandwidths)
    by_adhesion = tuple(Point(h, axes.harmonics, t, None) for h in axes.hursts for t in axes.thetas)
    by_thickness = tuple(Point(0.7, axes.layer_harmonics, t, d) for d in axes.thicknesses for t in axes.thetas)
    return (
        Plane("roughness", ("hurst", "harmonics"), by_bandwidth),
        Plane("adhesion", ("hurst", "theta"), by_adhesion),
        Plane("layer", ("thickness", "theta"), by_thickness),
    )


def member_of(point: Point, k: int) -> Member:
    """Realisation k of a point."""
    seed = member_seed(ROOT, k)
    surface = Profile.self_affine(PERIOD, point.hurst, RMS_HEIGHT, point.harmonics, seed)
    loading = np.linspace(DEEPEST * RMS_HEIGHT, 0.95 * surface.max_height, LOADING_TARGETS)[::-1].tolist()
    scene = paper_problem.scene(
        f"map: H = {point.hurst:g}, {point.harmonics} harmonics, theta = {point.theta:g}",
        paper_problem.self_affine(seed, point.harmonics, point.hurst),
        {"control": "separation", "targets": [*loading, surface.max_height + OFF * RMS_HEIGHT]},
        point.theta * full_contact_energy(surface) if point.theta > 0 else None,
        **({} if point.thickness is None else {"layer": {"thickness": point.thickness * PERIOD}}),
    )
    depth = "half-space" if point.thickness is None else f"d{point.thickness:g}"
    return Member(f"H{point.hurst:g}-M{point.harmonics}-t{point.theta:g}-{depth}-{k:02d}", scene)


def full_contact_energy(surface: Profile) -> float:
    """Elastic energy of full contact with the half-space, J/m^2.

    Examples
    --------
    >>> wave = Profile.from_harmonics(1.0, [1], [0.01])
    >>> round(full_contact_energy(wave) / (MODULUS * 2 * np.pi * 0.01**2 / 8), 12)
    1.0
    """
    return MODULUS * float(np.sum(surface.q0 * surface.orders * surface.amplitudes**2)) / 8


def reduced(name: str, result: Result) -> Run:
    """The numbers of one realisation."""
    adhesion = result.scene["adhesion"]
    touching = [state for state in result.states if state.n_patches]
    ended = result.status if result.states[-1].status == "separated" or result.status not in FINAL_STATUSES else "stuck"
    joined = any(state.status == "complete_contact" for state in result.states)
    status = "complete contact" if joined else ended
    profile = result.scene["profile"]
    shape = (profile[name] for name in ("period", "hurst", "rms_height", "harmonics", "seed"))
    rms_slope = Profile.self_affine(*shape).rms_slope
    pressures = [event.mean_pressure for event in result.events if np.isfinite(event.mean_pressure)]
    closed = status == "converged"
    return Run(
        name=name,
        status=status,
        slope=area_slope([state for state in touching if state.target], rms_slope),
        loop=float(sum(event.energy_released or 0.0 for event in result.events)) if closed else None,
        tension=-min(pressures, default=0.0) / (MODULUS * rms_slope) if closed else None,
        integral=loop_integral(touching),
        work=float(
            np.sum(np.abs(np.diff([s.penetration for s in touching]) * [s.mean_pressure for s in touching[1:]]))
        ),
        work_of_adhesion=0.0 if adhesion is None else float(adhesion["work_of_adhesion"]),
        turning_pressure=max((state.mean_pressure for state in touching), default=0.0),
        states=len(result.states),
        not_certified=sum(not state.certificate.ok for state in result.states),
    )


def area_slope(states: Sequence[State], rms_slope: float) -> float | None:
    """b of A/A0 = a + b p/(E* h'_rms) on the loading branch; None with fewer than three states to fit."""
    chosen = [s for s in states if s.branch == "loading" and FITTED[0] <= s.contact_fraction <= FITTED[1]]
    if len(chosen) < 3:
        return None
    load = [state.mean_pressure / (MODULUS * rms_slope) for state in chosen]
    return float(np.polyfit(load, [state.contact_fraction for state in chosen], 1)[0])


def loop_integral(touching: Sequence[State]) -> float:
    """Closed integral of p dDelta in J/m^2 by the trapezoidal rule; apart, the pressure is zero and adds nothing."""
    depth = [state.penetration for state in touching]
    return float(np.trapezoid([state.mean_pressure for state in touching], depth)) if touching else 0.0


def maps_over(axes: Axes, runs: Mapping[str, Run]) -> list[Map]:
    """All maps over some axes, from runs by the names of their members."""
    return [found for plane in planes(axes) for found in _maps_of(plane, runs, axes.seeds)]


def _maps_of(plane: Plane, runs: Mapping[str, Run], seeds: int) -> Iterator[Map]:
    """The three quantities over a plane: mean and standard error over the realisations."""
    first, second = plane.axis
    found = {}
    for point in plane.points:
        names = [member_of(point, k).name for k in range(seeds)]
        found[getattr(point, first), getattr(point, second)] = [runs[name] for name in names if name in runs]
    rows, columns = (list(dict.fromkeys(place[k] for place in found)) for k in range(2))
    for quantity, label in TITLES.items():
        cells = [[_cell(found[row, column], quantity) for column in columns] for row in rows]
        yield Map(
            name=f"{plane.name}-{quantity}",
            title=label,
            row_label="thickness / period" if first == "thickness" else "Hurst exponent",
            column_label="harmonics" if second == "harmonics" else "theta = gamma / U",
            rows=["half-space" if row is None else f"{row:g}" for row in rows],
            columns=[f"{column:g}" for column in columns],
            values=[[value for value, _, _ in line] for line in cells],
            errors=[[error for _, error, _ in line] for line in cells],
            notes=[[note for _, _, note in line] for line in cells],
        )


def _cell(runs: Sequence[Run], quantity: str) -> tuple[float | None, float | None, str]:
    """Mean, standard error, and what is to be said of the realisations without a number."""
    given = [(one, value) for one in runs if (value := getattr(one, quantity)) is not None]
    values = [value / (one.work_of_adhesion or 1.0) if quantity == "loop" else value for one, value in given]
    without = [one.status for one in runs if getattr(one, quantity) is None]
    note = ", ".join(f"{without.count(status)} {status}" for status in dict.fromkeys(without))
    if not values:
        return None, None, note or "no result"
    error = float(np.std(values, ddof=1) / math.sqrt(len(values))) if len(values) > 1 else None
    return float(np.mean(values)), error, note


def stored_runs() -> dict[str, Run]:
    """What the full study found, by name of the member."""
    content = json.loads(resources.files("validation").joinpath(STORED).read_text("utf-8"))
    return {row["name"]: Run(**row) for row in content["runs"]}
