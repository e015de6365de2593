"""The realisations behind the figures: harmonics, final load, states, audit, and the sources that made each.

The ensemble is the paper's when 11 realisations with 1000 harmonics reached 0.025 E*; otherwise its row is not run,
and so are the statements that rest on it.
"""

from validation.harness.case import Outcome
from validation.harness.rows import Against
from validation.harness.schema import Cells, Table
from validation.replicate.evidence import Evidence, Realisation
from validation.replicate.members import LOADS, PAPER
from validation.replicate.statements import unless_short


def compute(evidence: Evidence) -> Outcome:
    """Rows and tables."""
    short = evidence.shortfall
    everyone = [*evidence.loading, *evidence.short]
    full = sum(
        one.surface.max_order == PAPER.harmonics and one.final_load >= LOADS[-1] * (1 - 1e-9)
        for one in evidence.loading
    )
    ours = Against("exact", "the paper's ensemble: 11 realisations, seeds 0 to 10").count(
        f"realisations with {PAPER.harmonics} harmonics loaded to {LOADS[-1]:g} E*", PAPER.seeds, full
    )
    rows = (
        unless_short(ours, short),
        Against("exact", "every state of a path is a stable equilibrium").count(
            "states whose certificate is not ok, all realisations", 0.0,
            sum(not s.certificate.ok for one in _all(evidence) for s in one.result.states)),
    )  # fmt: skip
    tables = [
        Table(caption="Loading ensemble: every realisation, with its harmonics and the load it reached.",
              columns=COLUMNS,
              rows=[_line(one) for one in everyone]),
        Table(caption="Other realisations: shapes, high load, other Hurst exponents, vanishing adhesion.",
              columns=COLUMNS,
              rows=[_line(one) for one in _all(evidence) if one not in everyone]),
    ]  # fmt: skip
    if evidence.missing:
        missing: list[Cells] = [[name, why] for name, why in evidence.missing.items()]
        tables.append(Table(caption="Realisations without a result.", columns=["name", "why"], rows=missing))
    return Outcome(rows=rows, tables=tuple(tables))


COLUMNS = [
    "name", "seed", "H", "harmonics", "highest load / E*", "contact fraction there", "states", "patches",
    "audit of every state", "status", "CPU s", "commit",
]  # fmt: skip


def _all(evidence: Evidence) -> list[Realisation]:
    single = [one for one in (evidence.shapes, evidence.high_load) if one is not None]
    groups = [*evidence.hurst.values(), *evidence.faint]
    return [*evidence.loading, *evidence.short, *single, *(one for group in groups for one in group)]


def _line(one: Realisation) -> Cells:
    profile = one.result.scene["profile"]
    highest = max(one.result.states, key=lambda state: state.mean_pressure)
    states = one.result.states
    certified = "ok" if all(state.certificate.ok for state in states) else "not ok"
    commit = str(one.result.provenance.get("commit", "unknown"))[:12]
    return [one.name, profile["seed"], profile["hurst"], profile["harmonics"], one.final_load,
            highest.contact_fraction, len(states), highest.n_patches, certified, one.result.status,
            sum(state.cpu_seconds for state in states), commit]  # fmt: skip
