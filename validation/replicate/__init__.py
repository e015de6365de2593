"""`python -m validation replicate`: the results section of the paper from an ensemble of our own, as a report.

The realisations (members.py) are computed on any executor and kept in `folder/members`; the figures and the paper's
statements follow from what is stored there, so that an interrupted replication continues, and a finished one is
reported again in seconds.  A realisation that is missing is named in the report; statements that rest on an ensemble
other than the paper's are `not run`.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

import time
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from pathlib import Path

from bem.command_line.console import scene_text
from bem.scene.result_file import CorruptResultError
from validation.harness.case import Case, Outcome
from validation.harness.ensemble import Member, OtherSceneError, read_member, run_ensemble
from validation.harness.execution import Note, answers_in_order
from validation.harness.runner import failed_record
from validation.harness.schema import SCHEMA, CaseRecord, Report
from validation.replicate import (
    area,
    heights,
    hurst,
    paper_separation,
    paper_shapes,
    paper_spectra,
    posed_problem,
    pressure,
    realisations,
    statements,
    vanishing_adhesion,
)
from validation.replicate.evidence import Evidence, Realisation
from validation.replicate.members import LOADS, PAPER, Size, all_members, high_load, loading
from validation.replicate.members import faint as faint_members
from validation.replicate.members import hurst as hurst_members
from validation.replicate.members import shapes as shapes_member
from validation.replicate.members import sketch as sketch_member
from validation.studies.bench import Bench, reported

GROUP = "the paper replicated"
ENSEMBLE_EFFECTS = ("half_space", "adhesion", "slope_term", "spectra", "pressure_distribution")

TOPICS: tuple[tuple[str, str, str, Callable[[Evidence], Outcome]], ...] = (
    ("replicate-realisations", "Which realisations is this made of?",
     r"$h_m \propto m^{-(H + 1/2)}$, phases default_rng(seed).uniform(-pi, pi)", realisations.compute),
    ("replicate-area", "Is the area linear in the load, and twice the theory's?",
     r"$A / A_0 = a + b p / E^\ast$; "
     r"Persson: $A / A_0 = \operatorname{erf}(\sqrt{2} \, p / (E^\ast h'_{\text{rms}}))$ "
     "without adhesion", area.compute),
    ("replicate-separation", "Does the separation follow the theory?",
     r"$\ln(p / E^\ast) = c - s / u_0$", paper_separation.compute),
    ("replicate-spectra", "What are the exponents of the spectra, and is contact full at short wavelengths?",
     r"$C_u \propto q^{-(2 + H)}$, $C_\sigma = (E^\ast)^2 q^2 C_u / 4$; "
     r"full contact: $C_\sigma \propto q^{1 - 2 H}$", paper_spectra.compute),
    ("replicate-pressure", "What is the distribution of the pressure?",
     r"double Gaussian; $P \to \frac{2 E^\ast}{\pi \lambda} \sum_e w_e |\sigma|^{-3}$ "
     r"for $\sigma \to -\infty$", pressure.compute),
    ("replicate-hurst", "Are short waves in full contact for H = 0.8, and not for H = 0.3?",
     r"$C_u / C = A(q) / A_0$ in the theory", hurst.compute),
    ("replicate-shapes", "What do the deformed shapes look like?",
     r"$s = \frac{1}{\lambda} \int \text{gap} \, dx$", paper_shapes.compute),
    ("replicate-heights", "Are the heights of the profiles Gaussian?",
     r"$\sum_m h_m^2 / 2 = h_{\text{rms}}^2$", heights.compute),
    ("replicate-vanishing-adhesion", "Does loading with vanishing adhesion tend to that without?",
     r"$A(\gamma) - A(0) \propto \sqrt{\gamma}$ at the same load", vanishing_adhesion.compute),
    ("replicate-problem", "What is the problem?",
     r"$s = h_{\text{max}} - \Delta$, $u_m = d \frac{(1 - 2 \nu) (1 + \nu)}{E (1 - \nu)} \sigma_0$",
     posed_problem.compute),
)  # fmt: skip


def replicate(bench: Bench, size: Size, command: str) -> Report:
    """Compute what is missing, write the figures, and hand back the report.

    Realisations go to members/ in the folder of the bench, figures (SVG, PDF, CSV) to figures/. The size is
    `members.PAPER`, or a short form that replicates nothing; `command` is what the report says it was made with.
    OSError where the disk is full or the folder not writable; what is stored stays whole, also at a KeyboardInterrupt.
    """
    begun = time.monotonic()
    outcome = run_ensemble(all_members(size), bench.folder / "members", bench.jobs, bench.say, bench.opener)
    bench.say(Note("figures and statements"))
    evidence = gather(size, bench.folder / "members", outcome.failed)
    topics = _topics(evidence, bench.folder, outcome.failed, bench.jobs)
    return Report(
        schema_=SCHEMA,
        level="replicate" if size == PAPER else "replicate, short form",
        command=command,
        planned=len(TOPICS) + 1,
        provenance=dict(bench.facts) | {"seconds": round(time.monotonic() - begun, 1), "jobs": bench.jobs},
        cases=[reported(_summary(topics), bench.folder), *topics],
    )


def _topics(evidence: Evidence, folder: Path, failed: Mapping[str, str], jobs: int) -> list[CaseRecord]:
    """Records of all topics, their figures written, in processes of this machine that begin with what takes longest."""
    asked = cases(evidence)
    if jobs == 1:
        return [reported(case, folder) for case in asked]
    from_store = partial(_reported_from, evidence.size, folder, tuple(failed.items()))
    order = sorted(range(len(TOPICS)), key=lambda index: TOPICS[index][-1] is not pressure.compute)
    records: dict[int, CaseRecord] = {}
    for index, answer in zip(order, answers_in_order(from_store, order, jobs), strict=True):
        if isinstance(answer, OSError):  # the figures cannot be written
            raise answer
        if isinstance(answer, Exception):
            answer = failed_record(asked[index], f"{type(answer).__name__}: {answer}", 0.0)
        records[index] = answer
    return [records[index] for index in range(len(TOPICS))]


def _reported_from(size: Size, folder: Path, failed: tuple[tuple[str, str], ...], index: int) -> CaseRecord:
    """In a worker: the record of a topic from what is stored."""
    return reported(cases(_gathered(size, folder, failed))[index], folder)


@lru_cache(maxsize=1)
def _gathered(size: Size, folder: Path, failed: tuple[tuple[str, str], ...]) -> Evidence:
    """In a worker, once for all of its topics."""
    return gather(size, folder / "members", dict(failed))


def gather(size: Size, folder: Path, failed: Mapping[str, str]) -> Evidence:
    """What is stored of the realisations of a size; those without a result are named."""
    missing: dict[str, str] = {}

    def read(member: Member) -> Realisation | None:
        try:
            return Realisation(member.name, read_member(member, folder))
        except (FileNotFoundError, CorruptResultError, OtherSceneError) as error:
            missing[member.name] = failed.get(member.name, str(error))
            return None

    ensemble = [one for member in loading(size) if (one := read(member)) is not None]
    reached = [one.final_load >= LOADS[-1] * (1 - 1e-9) for one in ensemble]
    return Evidence(
        size=size,
        loading=tuple(one for one, far in zip(ensemble, reached, strict=True) if far),
        short=tuple(one for one, far in zip(ensemble, reached, strict=True) if not far),
        shapes=read(shapes_member(size)),
        high_load=read(high_load(size)),
        hurst={
            exponent: tuple(one for member in group if (one := read(member)) is not None)
            for exponent, group in hurst_members(size).items()
        },
        faint=tuple(
            whole
            for group in faint_members(size)
            if len(whole := tuple(one for member in group if (one := read(member)) is not None)) == len(group)
        ),
        sketch=read(sketch_member()),
        missing=missing,
    )


def cases(evidence: Evidence) -> list[Case]:
    """One case for each topic."""
    return [Case(id=name, group=GROUP, level="full",
                 question=question,
                 equations=equations,
                 sources=("carbone2009", "persson2001"), compute=partial(_answered, compute, evidence),
                 effects=ENSEMBLE_EFFECTS,
                 scene=scene_text(loading(evidence.size)[0].scene) if name == TOPICS[0][0] else "")
            for name, question, equations, compute in TOPICS]  # fmt: skip


def _summary(topics: list[CaseRecord]) -> Case:
    """The statements of all topics on one page."""
    return Case(id="replicate-statements", group=GROUP, level="full",
                question="What does the paper state, what do we find, and do they agree?",
                equations="accepted: the tolerance, or twice the uncertainties, and at most half the way to the "
                "alternative that the row excludes",
                sources=("carbone2009",), compute=partial(statements.summary_of, topics))  # fmt: skip


def _answered(compute: Callable[[Evidence], Outcome], evidence: Evidence) -> Outcome:
    """A topic, unless there are too few realisations for a standard error."""
    if compute is not realisations.compute and len(evidence.loading) < 2:
        return Outcome(skipped=f"{len(evidence.loading)} realisations reached {LOADS[-1]:g} E*; 2 at least are needed")
    return compute(evidence)
