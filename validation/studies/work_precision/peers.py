"""The FFT solvers (extra `peers`) as methods of the study, and what is said of them beside the others."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from validation.harness.route import Answer, Problem
from validation.routes import cohesive_grid
from validation.studies.work_precision.methods import Method, MethodPoint, by_method

RANGE = "cohesive range / m"
POINTS = tuple(2**k for k in range(10, 17))


STEPS = 20  # of the path from first touch


def solve_adhesive(spacings: int, problem: Problem, points: int) -> Answer:
    """The contact on a grid: from the geometric overlap, or along a path where it depends on it."""
    return cohesive_grid.solve(problem, points, spacings, STEPS if problem.id == "rough" else 1)


def _method(spacings: int, finest: int, finest_rough: int) -> Method:
    """With this many spacings along which cohesion acts, up to a finest grid on the sinusoid and on the rough profile.

    At c = 8 the lattice holds edges so much that a grid of 2^14 takes three times the iterations of c = 16; on the
    rough profile the wider range costs more.
    """
    return Method(name=f"fft, c = {spacings}", code="fft", knob="points of the grid",
                  fixed=f"cohesion along {spacings} spacings; rough: path of {STEPS} steps from first touch",
                  settings=tuple(points for points in POINTS if points <= finest), scenes=("sinusoid", "rough"),
                  solve=partial(solve_adhesive, spacings),
                  cannot={"layer": "the package provides layers under areas, not under lines",
                          "paper": "not tried: a path of a hundred steps on grids of 2^14 points and more"}, slow=2,
                  other_settings={"rough": tuple(points for points in POINTS if points <= finest_rough)})  # fmt: skip


FFT_METHODS: tuple[Method, ...] = (_method(8, 2**15, 2**16), _method(16, 2**16, 2**13))


def peer_table(points: Sequence[MethodPoint]) -> list[list[Any]]:
    """Rows of scene, method, points, cohesive range, errors of area and mean pressure, seconds."""
    return [
        [point.scene, point.method, found.unknowns, 1e6 * found.details[RANGE], point.errors["contact_fraction"],
         point.errors["mean_pressure"], point.timed.cpu_seconds]
        for point in points
        if (found := point.timed.found) is not None and point.errors and RANGE in found.details
    ]  # fmt: skip


PEER_COLUMNS = ("scene", "peer", "points", "rho/um", "error of area", "of mean pressure", "cpu/s")


def peer_sentences(points: Sequence[MethodPoint]) -> Iterator[str]:
    """Who needs what time for which error, and how much the area still depends on the cohesive range."""
    peers = [method.name for method in FFT_METHODS]
    for scene in dict.fromkeys(point.scene for point in points):
        found = by_method(points, scene)
        others = [point for name, known in found.items() if name not in peers for point in known]
        for name in peers:
            if name in found:
                yield _beside(min(found[name], key=lambda point: point.error), others)
        yield from _dependence([point for name in peers for point in found.get(name, [])])


def _beside(best: MethodPoint, others: Sequence[MethodPoint]) -> str:
    """The best of a peer, and what the other methods take for as small an error."""
    found = best.timed.found
    rho = found.details[RANGE] if found is not None else float("nan")
    reported = []
    for name in dict.fromkeys(point.method for point in others):
        good = [point for point in others if point.method == name and max(point.error, point.floor) <= best.error]
        if good:
            quick = min(good, key=lambda point: point.timed.cpu_seconds)
            error = max(quick.error, quick.floor)
            reported.append(f"{name} {quick.timed.cpu_seconds:.2g} s (error {error:.1e} at {quick.timed.setting})")
        else:
            reported.append(f"{name} never")
    return (
        f"{best.scene}: the best of {best.method} is an error of {best.error:.1e} at {best.timed.setting} points, "
        f"rho = {1e6 * rho:.2g} um, in {best.timed.cpu_seconds:.2g} s; as small an error takes {', '.join(reported)}."
    )


def _dependence(peers: Sequence[MethodPoint]) -> Iterator[str]:
    """How much the area changes with the cohesive range on the finest grid that two ranges share, and in all."""
    areas: dict[int, dict[str, float]] = {}
    for point in peers:
        if (found := point.timed.found) is not None:
            areas.setdefault(found.unknowns, {})[point.method] = found.values["contact_fraction"][0]
    shared = [count for count, by_method in areas.items() if len(by_method) == len(FFT_METHODS)]
    if not shared:
        return
    at = areas[max(shared)]
    every = [area for by_method in areas.values() for area in by_method.values()]
    grown, whole = (100 * (max(known) / min(known) - 1) for known in (list(at.values()), every))
    yield (
        f"{peers[0].scene}: on {max(shared)} points the area changes by {grown:.2g} % when rho grows by sqrt 2, "
        f"over all grids and ranges by {whole:.2g} %."
    )
