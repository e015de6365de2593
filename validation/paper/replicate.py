"""`linecontact replicate --out DIR [--quick]`: the paper's results section from an ensemble of our own.

Results of the realisations (members.py) are kept in DIR/members: a replication that was interrupted continues, and one
that is finished is reported again in a minute, by the command that began it.  DIR gets report.json with the
`statements` (statements.py), report.html made from it with the figures, and the numbers of these in figures/.

--quick solves the same scenes with fewer realisations and harmonics: everything runs, and statements that rest on the
paper's ensemble are `not run`.
"""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import persson
from bem.scene.atomic_file import write_atomically
from validation.harness.figure_data import Figure
from validation.harness.provenance import provenance
from validation.paper import load_curves, pressures, profiles, spectra
from validation.paper.ensemble import SOLID, Ensemble, read_ensemble, solve_members
from validation.paper.members import LOADS, PAPER, QUICK, SPECTRA_AT, Size, members_of
from validation.paper.statements import headline, judge
from validation.references.paper_problem import HURST, MODULUS, WORK_OF_ADHESION
from validation.report.figures import svg_of, table_of
from validation.report.pages import filled

SCHEMA = "linecontact-replication/2"
TOPICS = (load_curves, spectra, pressures, profiles)
REPORT, PAGE = "report.json", "report.html"


def replicate(
    folder: Path, *, quick: bool, jobs: int, say: Callable[[str], None] = print, size: Size | None = None
) -> int:
    """Solve missing realisations and write the report; return 1 if a member has no certified result, else 0."""
    begun, size = time.monotonic(), size or (QUICK if quick else PAPER)
    members = [member for group in members_of(size).values() for member in group]
    outcomes = solve_members(members, folder / "members", jobs, say)
    say("figures and statements")
    content, figures = report(read_ensemble(size, folder / "members", outcomes))
    content |= {
        "schema": SCHEMA,
        "headline": ("short form: " if quick else "") + content["headline"],
        "command": f"linecontact replicate --out {folder.resolve().name}{' --quick' if quick else ''}",
        "seconds": round(time.monotonic() - begun, 1),
        "provenance": provenance(),
    }
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    for figure in figures:
        write_atomically(folder / f"figures/{figure.id}.csv", table_of(figure))
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    write_atomically(folder / REPORT, text)
    drawings = [(figure, svg_of(figure, figure.id)) for figure in figures]
    write_atomically(folder / PAGE, filled("paper.jinja", report=json.loads(text), drawings=drawings))
    print(f"{content['headline']}; report: {folder / PAGE}")
    return 1 if content["missing"] or content["refused"] else 0


def report(ensemble: Ensemble) -> tuple[dict[str, Any], list[Figure]]:
    """Return statements, tables and failures of an ensemble, and its figures; statements need two realisations."""
    enough = len(ensemble.loading) > 1
    measured = {name: number for topic in TOPICS if enough for name, number in topic.measured(ensemble).items()}
    rows = judge(measured, ensemble.shortfall)
    figures = [figure for topic in TOPICS if enough for figure in topic.figures(ensemble)]
    content = {
        "headline": headline(rows),
        "statements": rows,
        "missing": dict(ensemble.missing),
        "refused": [
            member.name
            for member in ensemble.everything
            if not all(state.certificate.ok for state in member.result.states)
        ],
        "conventions": _conventions(ensemble) if enough else [],
        "figures": [f"figures/{figure.id}.csv" for figure in figures],
    }
    return content, figures


def _conventions(ensemble: Ensemble) -> list[tuple[str, str, str, str]]:
    """Return conventions: name, ours, the other or the paper's, and its change of the theory's area with adhesion."""
    lines, q0 = ensemble.lines, ensemble.loading[0].profile.q0
    wavenumbers = np.geomspace(lines.wavenumbers[0], lines.wavenumbers[-1], 200)
    density = np.exp(np.interp(np.log(wavenumbers), np.log(lines.wavenumbers), np.log(lines.amplitudes**2 / (4 * q0))))
    same = persson.ContinuousSpectrum(wavenumbers, density)
    scaled = persson.ContinuousSpectrum.self_affine(wavenumbers[0], wavenumbers[-1], HURST, lines.h_rms)

    def change(spectrum: persson.DiscreteSpectrum | persson.ContinuousSpectrum, **options: Any) -> str:
        words = []
        for load in SPECTRA_AT:
            other = persson.solve(
                spectrum,
                load * MODULUS,
                work_of_adhesion=WORK_OF_ADHESION,
                with_separation=False,
                **SOLID,
                **options,
            )
            ratio = other.contact_fraction / ensemble.wet[load].contact_fraction
            words.append(f"{100 * (ratio - 1):+.2g} % at {load:g} E*")
        return f"area {', '.join(words)}"

    jumped = sum(member.target_at(load) is None for member in ensemble.loading for load in LOADS)
    normalisation = "normalisation of a continuous spectrum"
    return [
        (
            normalisation,
            "the lines themselves",
            "C0 = <h_1^2> delta(0) / 4, the density of the lines",
            change(same),
        ),
        (normalisation, "the lines themselves", "the rms height of the lines, with another slope", change(scaled)),
        (
            "area factor in U_ad",
            "<sqrt(1 + h'^2)> of a slope in one direction",
            "the isotropic one, in two directions",
            change(lines, area_factor="isotropic_2d"),
        ),
        (
            "a load that an instability jumps over",
            "on the straight line between the states before and after",
            "not stated",
            f"{jumped} of {len(ensemble.loading) * len(LOADS)} loads; no spectra or distributions there",
        ),
    ]
