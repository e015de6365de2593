"""The results of the fault study: table, faults.json, and the figure of faults against cases."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure as Canvas

from validation.harness.runner import write_atomically
from validation.harness.verdict import case_verdicts
from validation.report.figures import SETTINGS
from validation.studies.faults.fault_findings import Finding
from validation.studies.faults.fault_injection import Examined

SCHEMA = "linecontact-faults/1"
DECADES = 12.0  # beyond which the colour no longer deepens


def write_matrix(path: Path, cases: Sequence[str], findings: Sequence[Finding]) -> None:
    """Draw faults (rows) against cases (columns) as SVG.

    Parameters
    ----------
    path : Path
    cases : sequence of str
        Those of the control run, in order; columns of cases that were shown no fault are left out.
    findings : sequence of Finding
        One row each.
    """
    shown = [case for case in cases if any(case in finding.asked for finding in findings)]
    with mpl.rc_context(SETTINGS):
        labels = max(len(finding.fault.id) for finding in findings), max(map(len, shown), default=0)
        size = (4.0 + 0.09 * labels[0] + 0.3 * len(shown), 3.0 + 0.09 * labels[1] + 0.22 * len(findings))
        canvas = Canvas(figsize=size, layout="constrained")
        axes = canvas.subplots()
        colours = mpl.colormaps["viridis_r"]
        for y, finding in enumerate(findings):
            for x, case in enumerate(shown):
                excesses = [sight.excess for sight in finding.sights if sight.case == case]
                if excesses:
                    depth = min(math.log10(max(excesses)), DECADES) / DECADES if max(excesses) < math.inf else 1.0
                    axes.add_patch(mpl.patches.Rectangle((x - 0.45, y - 0.45), 0.9, 0.9, facecolor=colours(depth)))
                elif case in finding.failed or case in finding.apart:
                    axes.plot(x, y, "x", color="#a3261d", markersize=5)
                elif case in finding.asked:
                    axes.plot(x, y, ".", color="#999999", markersize=3)
        axes.set_xticks(range(len(shown)), shown, rotation=90)
        axes.set_yticks(range(len(findings)), [finding.fault.id for finding in findings])
        axes.set_xlim(-0.5, len(shown) - 0.5)
        axes.set_ylim(len(findings) - 0.5, -0.5)
        axes.grid(visible=False)
        axes.set_title("square: caught; cross: crash or refusal; dot: called, not seen; blank: not called or not asked")
        axes.title.set_fontsize(8)
        scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, DECADES), colours)
        canvas.colorbar(scale, ax=axes, label="log10 of error over allowed", fraction=0.05, aspect=50)
        stream = io.StringIO()
        canvas.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    write_atomically(path, stream.getvalue())


def failures_of(findings: Iterable[Finding]) -> list[str]:
    """What the study asks for and did not get, one line each.

    Parameters
    ----------
    findings : iterable of Finding
    """
    lines = []
    for finding in findings:
        name = finding.fault.id
        if not finding.calls and not finding.noticed and not finding.apart:
            lines.append(f"{name}: no case calls {finding.fault.target}")
        elif not finding.noticed:
            lines.append(f"{name}: nothing catches it; asked: {', '.join(finding.asked)}")
    return lines


def table_of(findings: Iterable[Finding]) -> str:
    """The table on stdout.

    Parameters
    ----------
    findings : iterable of Finding
    """
    lines = [f"{'fault':34} {'caught by':>9} {'error/allowed':>13} {'smallest':>9} {'keenest case'}"]
    for finding in findings:
        cases = {sight.case for sight in finding.sights}
        best = max(finding.sights, key=lambda sight: sight.excess, default=None)
        unseen = f"by name: {', '.join(sorted(finding.failed))}" if finding.failed else "NOTHING"
        keenest = unseen if best is None else f"{best.case}: {best.quantity}"
        smallest = "-" if finding.smallest is None else f"{finding.smallest:.0e}"
        apart = f"  [apart: {', '.join(sorted(finding.apart))}]" if finding.apart else ""
        lines.append(
            f"{finding.fault.id:34} {len(cases):>3} of {len(finding.asked):<2} {finding.excess:>13.3g} "
            f"{smallest:>9} {keenest}{apart}"
        )
    return "\n".join(lines)


def content_of(
    facts: dict[str, Any], control: Examined, findings: Iterable[Finding], planned: int, failures: list[str]
) -> dict[str, Any]:
    """Contents of faults.json.

    Parameters
    ----------
    facts : dict
        Provenance.
    control : Examined
    findings : iterable of Finding
    planned : int
        Faults that were to be examined.
    failures : list of str
        What was not met.
    """
    return {
        "schema": SCHEMA,
        "provenance": facts,
        "planned": planned,
        "failures": failures,
        "control": [
            {"case": record.id, "seconds": record.seconds, "verdicts": list(case_verdicts(record))}
            for record in control.records
        ],
        "faults": [
            {
                "id": finding.fault.id,
                "what": finding.fault.what,
                "target": finding.fault.target,
                "size": finding.fault.size,
                "caught": finding.caught,
                "noticed": finding.noticed,
                "calls": finding.calls,
                "size_shown": finding.size,
                "asked": finding.asked,
                "caught_by": [
                    {
                        "case": sight.case,
                        "quantity": sight.quantity,
                        "verdict": sight.verdict,
                        "error": sight.error,
                        "error_over_allowed": sight.excess,
                    }
                    for sight in sorted(finding.sights, key=lambda sight: -sight.excess)
                ],
                "crashes_and_refusals": finding.failed,
                "apart": finding.apart,
                "smallest_size_caught": finding.smallest,
                "largest_size_missed": finding.unseen,
            }
            for finding in findings
        ],
    }
