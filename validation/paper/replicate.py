"""`linecontact replicate --out DIR [--quick]`: the paper's results section from an ensemble of our own.

Results of the realisations (members.py) are kept in DIR/members: the same command continues an interrupted replication
and reports a finished one again in a minute.  DIR gets report.json with the `statements` (statements.py), report.html
made from it, and the figures as SVG, PDF and CSV in figures/.  `statement_rows` returns the statements of a folder.

--quick solves the same scenes with fewer realisations and harmonics: everything runs, and statements that rest on the
paper's ensemble are `not run`.
"""

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import persson
from bem.scene.atomic_file import write_atomically
from validation.harness.provenance import provenance
from validation.harness.schema import Table
from validation.paper import (
    area,
    heights,
    hurst,
    layer_problem,
    pressure,
    separation,
    shapes,
    spectra,
    vanishing_adhesion,
)
from validation.paper.ensemble import Member, read_member, solve_members, workers
from validation.paper.evidence import Evidence, Realisation
from validation.paper.members import LOADS, PAPER, QUICK, SPECTRA_AT, Size, all_members, high_load, loading
from validation.paper.members import faint as faint_members
from validation.paper.members import hurst as hurst_members
from validation.paper.members import shapes as shapes_member
from validation.paper.members import sketch as sketch_member
from validation.paper.statements import Check, Topic, headline
from validation.references.paper_problem import MODULUS, POISSON_RATIO, WORK_OF_ADHESION, YOUNGS_MODULUS
from validation.report.figures import svg_of, write_figure
from validation.report.pages import filled

SCHEMA = "linecontact-replication/1"
TOPICS = (area, separation, spectra, pressure, hurst, shapes, heights, vanishing_adhesion, layer_problem)
REPORT, PAGE = "report.json", "report.html"


def replicate(
    folder: Path,
    *,
    quick: bool,
    jobs: int,
    executor: str = "local",
    say: Callable[[str], None] = print,
    size: Size | None = None,
) -> int:
    """Solve missing realisations and write the report; return 1 if one has no result or a check fails, else 0."""
    begun, size = time.monotonic(), size or (QUICK if quick else PAPER)
    with workers(jobs, executor) as pool:
        failed = solve_members(all_members(size), folder / "members", pool, say)
    say("figures and statements")
    evidence = gather(size, folder / "members", failed)
    topics = topics_of(evidence)
    checks = [check for topic in topics for check in topic.checks]
    rows = [statement.row() for topic in topics for statement in topic.statements]
    told = ("short form: " if quick else "") + headline(rows, checks)
    content = {
        "schema": SCHEMA,
        "headline": told,
        "command": f"linecontact replicate --out {folder.resolve().name}{' --quick' if quick else ''}",
        "statements": rows,
        "checks": [vars(check) | {"holds": check.holds} for check in checks],
        "missing": evidence.missing,
        "topics": [_topic_content(topic, folder) for topic in topics],
        "seconds": round(time.monotonic() - begun, 1),
        "provenance": provenance(),
    }
    text = json.dumps(_finite(content), indent=1, allow_nan=False) + "\n"
    write_atomically(folder / REPORT, text)
    write_atomically(folder / PAGE, filled("paper.jinja", {}, report=json.loads(text), topics=topics, draw=svg_of))
    print(f"{told}; report: {folder / PAGE}")
    return 1 if evidence.missing or not all(check.holds for check in checks) else 0


def statement_rows(folder: Path) -> list[dict[str, Any]]:
    """Return the statements of a replication that was run: statement, printed, ours, uncertainty, verdict, note."""
    rows: list[dict[str, Any]] = json.loads((folder / REPORT).read_text("utf-8"))["statements"]
    return rows


def gather(size: Size, folder: Path, failed: Mapping[str, str]) -> Evidence:
    """Read the stored realisations of a size; realisations without a result are named."""
    missing: dict[str, str] = {}

    def read(member: Member) -> Realisation | None:
        result = read_member(member, folder)
        if result is None:
            missing[member.name] = failed.get(member.name, "no result is stored")
        return None if result is None else Realisation(member.name, result)

    def group(members: list[Member]) -> tuple[Realisation, ...]:
        return tuple(realisation for member in members if (realisation := read(member)) is not None)

    ensemble = group(loading(size))
    whole = [realisations for members in faint_members(size) if len(realisations := group(members)) == len(members)]
    return Evidence(
        size=size,
        loading=tuple(member for member in ensemble if member.final_load >= LOADS[-1] * (1 - 1e-9)),
        short=tuple(member for member in ensemble if member.final_load < LOADS[-1] * (1 - 1e-9)),
        shapes=read(shapes_member(size)),
        high_load=read(high_load(size)),
        hurst={exponent: group(members) for exponent, members in hurst_members(size).items()},
        faint=tuple(whole),
        sketch=read(sketch_member()),
        missing=missing,
    )


def topics_of(evidence: Evidence) -> list[Topic]:
    """Return all topics; with fewer than two realisations, topics that need a standard error hold a message instead."""
    topics = [_realisations(evidence)]
    if len(evidence.loading) < 2:
        message = f"{len(evidence.loading)} realisations reached {LOADS[-1]:g} E*; 2 are needed"
        return [*topics, *(Topic(module.__name__.rpartition(".")[2], message=message) for module in TOPICS)]
    return [*topics, _conventions(evidence), *(module.compute(evidence) for module in TOPICS)]


def _realisations(evidence: Evidence) -> Topic:
    """List every realisation: harmonics, load, audit."""
    single = [realisation for realisation in (evidence.shapes, evidence.high_load) if realisation is not None]
    groups = [*evidence.hurst.values(), *evidence.faint]
    realisations = [
        *evidence.loading,
        *evidence.short,
        *single,
        *(realisation for group in groups for realisation in group),
    ]
    lines = []
    for realisation in realisations:
        profile, states = realisation.result.scene["profile"], realisation.result.states
        highest = max(states, key=lambda state: state.mean_pressure)
        lines.append(
            [
                realisation.name,
                profile["seed"],
                profile["hurst"],
                profile["harmonics"],
                realisation.final_load,
                highest.contact_fraction,
                len(states),
                highest.n_patches,
                realisation.result.status,
                sum(state.cpu_seconds for state in states),
            ]
        )
    refused = sum(not state.certificate.ok for realisation in realisations for state in realisation.result.states)
    columns = [
        "name",
        "seed",
        "H",
        "harmonics",
        "highest load / E*",
        "contact fraction there",
        "states",
        "patches",
        "status",
        "CPU s",
    ]
    caption = (
        "Every realisation, with its harmonics and the load it reached; phases default_rng(seed).uniform(-pi, pi)."
    )
    check = Check("states whose certificate is not ok, all realisations", float(refused), 0.0, 0.0)
    table = Table(caption=caption, columns=columns, rows=lines)
    return Topic("Which realisations is this made of?", checks=(check,), tables=(table,))


def _conventions(evidence: Evidence) -> Topic:
    """List conventions of ours beside the paper's, with what each changes in the theory's area with adhesion."""
    lines, q0 = evidence.lines, evidence.loading[0].surface.q0
    solid: Any = {
        "youngs_modulus": YOUNGS_MODULUS,
        "poisson_ratio": POISSON_RATIO,
        "work_of_adhesion": WORK_OF_ADHESION,
    }

    def areas(spectrum: persson.DiscreteSpectrum | persson.ContinuousSpectrum, **options: Any) -> list[float]:
        states = (
            persson.solve(spectrum, load * MODULUS, with_separation=False, **solid, **options) for load in SPECTRA_AT
        )
        return [state.contact_fraction for state in states]

    def change(other: list[float]) -> str:
        triples = zip(ours, other, SPECTRA_AT, strict=True)
        return ", ".join(f"{100 * (b / a - 1):+.2g} % at {load:g} E*" for a, b, load in triples)

    wavenumbers = np.geomspace(lines.wavenumbers[0], lines.wavenumbers[-1], 200)
    density = np.exp(np.interp(np.log(wavenumbers), np.log(lines.wavenumbers), np.log(lines.amplitudes**2 / (4 * q0))))
    ours, same = areas(lines), persson.ContinuousSpectrum(wavenumbers, density)
    scaled = persson.ContinuousSpectrum.self_affine(wavenumbers[0], wavenumbers[-1], 0.7, lines.h_rms)
    pairs = len(evidence.loading) * len(LOADS)
    rows = [
        [
            "normalisation of a continuous spectrum",
            "the lines themselves",
            "C0 = <h_1^2> delta(0) / 4, the density of the lines",
            f"area {change(areas(same))}",
        ],
        ["", "", "the rms height of the lines, with another slope", f"area {change(areas(scaled))}"],
        [
            "area factor in U_ad",
            "<sqrt(1 + h'^2)> of a slope in one direction",
            "the isotropic one, in two directions",
            f"area {change(areas(lines, area_factor='isotropic_2d'))}",
        ],
        [
            "a load that an instability jumps over",
            "on the straight line between the states before and after",
            "not stated",
            f"{evidence.jumped()} of {pairs} loads; no spectra or distributions there",
        ],
    ]
    caption = "Conventions, and the change of the theory's contact area with adhesion by the other choice."
    table = Table(caption=caption, columns=["what", "ours", "other, or the paper's", "change"], rows=rows)
    return Topic("Which conventions stand beside the statements?", tables=(table,))


def _topic_content(topic: Topic, folder: Path) -> dict[str, Any]:
    """Write the figures of a topic, and return it for report.json."""
    for figure in topic.figures:
        write_figure(figure, folder / "figures")
    return {
        "question": topic.question,
        "message": topic.message,
        "tables": [table.model_dump() for table in topic.tables],
        "figures": [f"figures/{figure.id}.svg" for figure in topic.figures],
    }


def _finite(value: Any) -> Any:
    """Return a value in which NaN and infinity are None: JSON has neither."""
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
