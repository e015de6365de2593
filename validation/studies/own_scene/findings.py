"""What the settings of a scene say about it: errors against the finest, uncertainties by source, and what to use.

All errors and changes are relative to the number itself, as the scene as it is has it, or to a tenth of the largest of
its kind on the path where that is more: a mean pressure that happens to vanish is not to be known to digits of itself.
The numerical error of a setting is its distance from the finest one; below the estimated error of that one, its floor,
nothing is claimed.
The uncertainty of a source of input is the largest change from the scene as it is, where its settings are alternatives,
and the standard deviation of the realisations where they are random.  Sources are independent: their squares add up
(ASME V&V 20, 2009, section 4).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from validation.corpus.rates import RateError, geometric
from validation.studies.own_scene.settings import BASE, FINEST, Kind, Setting
from validation.studies.own_scene.solved_setting import Key, Solved
from validation.studies.work_precision.conclusion import MethodCurve, Spot, cheapest

DIGITS = (2, 3, 4, 6, 9)
LEAST_SHARE = 0.1  # of the largest number of its kind on the path: smaller ones are measured by that
RANDOM = "seed"  # the source whose settings are realisations
FRACTION = "contact fraction"

Answered = Sequence[tuple[Setting, Solved]]


@dataclass(frozen=True)
class Off:
    """A number of a target in one setting against another: relative change, and by how much it may be off."""

    key: Key
    quantity: str
    change: float  # infinite where the target is missing
    estimate: float

    @property
    def distance(self) -> float:
        """Without the sign."""
        return abs(self.change)


@dataclass(frozen=True)
class Compared:
    """A setting against the finest one (numerical) or the scene as it is (input, model).

    `fraction`, `free` and `error` are the largest relative distances, infinite where a target is missing; `covered` of
    `judged` numbers lie within the errors that both sides estimate.
    """

    setting: Setting
    solved: Solved
    fraction: float
    free: float
    covered: int
    judged: int

    @property
    def error(self) -> float:
        """The larger distance."""
        return max(self.fraction, self.free)


@dataclass(frozen=True)
class Uncertainty:
    """Of one number at one target from one source; of the mean of realisations too, where there are some."""

    kind: Kind
    source: str
    key: Key
    quantity: str
    relative: float
    of_mean: float = math.nan
    count: int = 1


@dataclass(frozen=True)
class Advice:
    """What to use for some digits; None where no setting reaches them, or the finest does not resolve them."""

    digits: int
    setting: str | None
    evaluations: int
    seconds: float
    error: float
    open_source: str
    open_share: float


@dataclass(frozen=True)
class Findings:
    """All of it."""

    reference: str
    floor: float
    numerical: tuple[Compared, ...]
    others: tuple[Compared, ...]
    uncertainties: tuple[Uncertainty, ...]
    advice: tuple[Advice, ...]


def findings_of(answered: Answered) -> Findings:
    """What all settings say together, the scene as it is among them, converged."""
    base = next(solved for setting, solved in answered if setting.kind == "base")
    finest, reference = finest_of(answered)
    floor = max(_estimates(reference, base).values(), default=0.0)
    good = [(setting, solved, setting.kind in ("base", "numerical")) for setting, solved in answered if solved.good]
    numerical = tuple(compared(setting, solved, reference, base) for setting, solved, ours in good if ours)
    others = tuple(compared(setting, solved, base, base) for setting, solved, ours in good if not ours)
    uncertain = (*_numerical(base, reference), *_from_sources(answered, base))
    return Findings(
        finest.name if finest.source == FINEST else f"{finest.source} {finest.name}",
        floor,
        numerical,
        others,
        uncertain,
        tuple(_advice(numerical, finest, floor, uncertain)),
    )


def finest_of(answered: Answered) -> tuple[Setting, Solved]:
    """The setting that the others are measured by: the finest, else the next one that converged."""

    def rank(pair: tuple[Setting, Solved]) -> tuple[float, ...]:
        setting, _ = pair
        order = {FINEST: 0, "tolerance": 1, "max_increment": 2, BASE: 3}[setting.source]
        return order, float(setting.name) if order in (1, 2) else 0.0

    numerical = [pair for pair in answered if pair[0].kind in ("base", "numerical") and pair[1].good]
    return min(numerical, key=rank)


def offs(one: Solved, other: Solved, base: Solved) -> Iterator[Off]:
    """Relative changes of all numbers between two settings, the targets being those of `other`."""
    found, scales = {reading.key: reading for reading in one.readings}, _scales(base)
    for there in other.readings:
        key, here = there.key, found.get(there.key)
        if here is None:
            yield Off(key, FRACTION, math.inf, 0.0)
            continue
        estimates = {
            FRACTION: here.fraction_error + there.fraction_error,
            there.free: here.free_error + there.free_error,
        }
        changes = {
            FRACTION: here.contact_fraction - there.contact_fraction,
            there.free: here.free_value - there.free_value,
        }
        for quantity, change in changes.items():
            if quantity != FRACTION and math.isnan(here.free_value) and math.isnan(there.free_value):
                continue  # complete contact under a given separation: any pressure would do
            scale = scales.get((key, quantity), 1.0)
            change = math.inf if math.isnan(change) else change / scale
            yield Off(key, quantity.replace("_", " "), change, estimates[quantity] / scale)


def _scales(base: Solved) -> dict[tuple[Key, str], float]:
    """What each number is measured by."""
    numbers: dict[tuple[Key, str], float] = {}
    for reading in base.readings:
        for quantity, value in ((FRACTION, reading.contact_fraction), (reading.free, reading.free_value)):
            numbers[reading.key, quantity] = 0.0 if math.isnan(value) else abs(value)
    most = {name: max(value for (_, other), value in numbers.items() if other == name) for _, name in numbers}
    return {place: max(value, LEAST_SHARE * most[place[1]]) or 1.0 for place, value in numbers.items()}


def compared(setting: Setting, solved: Solved, reference: Solved, base: Solved) -> Compared:
    """A setting against a reference."""
    found = list(offs(solved, reference, base))
    fraction = max((off.distance for off in found if off.quantity == FRACTION), default=0.0)
    free = max((off.distance for off in found if off.quantity != FRACTION), default=0.0)
    judged = [off for off in found if not math.isnan(off.estimate)]
    return Compared(setting, solved, fraction, free, sum(off.distance <= off.estimate for off in judged), len(judged))


def _numerical(base: Solved, reference: Solved) -> Iterator[Uncertainty]:
    """Of the scene as it is: the larger of its estimated errors and of what the finest setting changes."""
    own = _estimates(base, base)
    for off in offs(base, reference, base):
        estimate = own.get((off.key, off.quantity), 0.0)
        yield Uncertainty("numerical", "numerical", off.key, off.quantity, max(off.distance, estimate))


def _estimates(solved: Solved, base: Solved) -> dict[tuple[Key, str], float]:
    """The errors that a setting estimates of its own numbers, relative, where it does."""
    twice = {(off.key, off.quantity): off.estimate for off in offs(solved, solved, base)}
    return {place: estimate / 2 for place, estimate in twice.items() if not math.isnan(estimate)}


def _from_sources(answered: Answered, base: Solved) -> Iterator[Uncertainty]:
    """Of the input and of the model, source by source; targets that a setting does not reach are left out."""
    sources: dict[tuple[Kind, str], list[Solved]] = {}
    for setting, solved in answered:
        if setting.kind in ("input", "model") and solved.good:
            sources.setdefault((setting.kind, setting.source), []).append(solved)
    for (kind, source), alternatives in sources.items():
        changes: dict[tuple[Key, str], list[float]] = {}
        for one in alternatives:
            for off in offs(one, base, base):
                if math.isfinite(off.change):
                    changes.setdefault((off.key, off.quantity), []).append(off.change)
        for (key, quantity), values in changes.items():
            if source != RANDOM:
                yield Uncertainty(kind, source, key, quantity, max(map(abs, values)), count=len(values))
                continue
            count = len(values) + 1
            spread = float(np.std([0.0, *values], ddof=1))
            yield Uncertainty(kind, source, key, quantity, spread, spread / math.sqrt(count), count)


def largest(uncertainties: Sequence[Uncertainty]) -> Uncertainty | None:
    """The one that decides; None where nothing is known."""
    return max(uncertainties, key=lambda one: one.relative, default=None)


def combined(uncertainties: Sequence[Uncertainty], kind: Kind) -> float:
    """Root of the sum of squares of those of one number and one kind."""
    return math.sqrt(sum(one.relative**2 for one in uncertainties if one.kind == kind))


def _advice(
    numerical: Sequence[Compared], finest: Setting, floor: float, uncertain: Sequence[Uncertainty]
) -> Iterator[Advice]:
    """For each number of digits the setting with the fewest evaluations."""
    by_name = {one.setting.title: one for one in numerical}
    marks = [
        Spot(
            name,
            floor if one.setting == finest else max(one.error, floor),
            float(one.solved.evaluations),
        )
        for name, one in by_name.items()
    ]
    left = largest([one for one in uncertain if one.kind != "numerical"])
    for digits in DIGITS:
        mark = cheapest(MethodCurve("settings", "the finest", tuple(marks), floor), digits)
        share, source = (0.0, "") if left is None else (left.relative, left.source)
        open_source = source if share > 10.0**-digits else ""
        if mark is None:
            yield Advice(digits, None, 0, math.nan, math.nan, open_source, share)
            continue
        chosen = by_name[mark.setting].solved
        yield Advice(digits, mark.setting, chosen.evaluations, chosen.seconds, mark.error, open_source, share)


def node_rate(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """The factor by which a node more on every patch lowers the error; nan where too few points fall."""
    known = {size: error for size, error in sorted(dict(zip(sizes, errors, strict=True)).items()) if error > 0}
    try:
        return geometric(list(known), list(known.values())).value
    except RateError:
        return math.nan
