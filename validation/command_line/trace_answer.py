"""`linecontact answer TRACE ...`: a measured trace, a solid and pressures in; a scene, its result and its page out.

Choices that the command line does not make are made as follows, and each is a commented line of DIR/scene.toml.

units      the ones that the file states, else --profile unit_x=.. unit_h=.., else the trace is refused
outliers   spikes, which `check` tells of, are replaced by the median of their neighbours
detrend    the least-squares line, which is the tilt of the instrument; the mean alone where the ends meet without
periodic   as it is where the ends of the trace meet within `LARGEST_JUMP` rms steps, else followed by its mirror image
cut        the wavelength at which the trace falls below its noise floor, where `check` suggests one, but at least
           `FEWEST_SAMPLES` samples, as ISO 3274 has it, and at most `MOST_WAVES` waves along the trace, or
           `MOST_ADHERING` with adhesion, which take seconds; the reason is named, with the rms slope that it leaves
tolerance  1e-3, three digits

--pull-off unloads the contact from the last pressure until it comes apart.  Of a map, --profile row=all solves every
row, every=n each n-th, with the choices of the first; the page has the median and scatter of their answers.

The scene is then solved as `linecontact run DIR/scene.toml` solves it.  The trace stays where it is; the scene names
its path from DIR.
"""

import argparse
import math
import os
import re
import sys
import textwrap
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bem import row_commands, scene_commands
from bem.command_line.checkpoint import OutputFolderError, usable
from bem.command_line.console import positive, toml_text
from bem.command_line.folder_lock import locked
from bem.command_line.perform import BAD_INPUT, INTERRUPTED, perform
from bem.geometry.ranges import Mistake
from bem.map_rows import asks_for_rows, rows_of, tables_of_row
from bem.path_for import check_path
from bem.scans.periodic_samples import PeriodicSamples
from bem.scene.atomic_file import write_atomically
from bem.scene.memory_estimate import refuse_beyond_memory
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.scene import Scene, SceneError, load_scene, parse_scene
from bem.scene.scene_file import read_tables
from bem.scene.scene_scan import ALL_ROWS
from validation.report.pages import PAGE
from validation.report.rows_page import write_rows_page
from validation.report.run_page import write_run_page
from validation.studies.scene_settings import LARGEST_JUMP

SCENE_FILE = "scene.toml"
TOLERANCE = 1e-3
FEWEST_SAMPLES = 5  # in the shortest wave
MOST_WAVES, MOST_ADHERING = 800, 125  # of the shortest wave along the trace, without and with adhesion
WIDTH = 100  # characters of a line of the scene, where a file name allows
NEGATIVE = re.compile(r"-\d*\.?\d+(?:[eE][-+]?\d+)?$")

Lines = Iterator[str]


@dataclass(frozen=True)
class Choice:
    """Scene of a trace: tables, the scene that they resolve to, its samples, and keys of the command line.

    `jump` is the step between the ends of the detrended trace, over the rms step of neighbours.
    """

    tables: dict[str, Any]
    scene: Scene
    scan: PeriodicSamples
    given: Mapping[str, Any]
    jump: float


class _Rising(argparse.Action):
    """Action that keeps positive numbers that rise, and refuses others."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: Any, values: Any, option: str | None = None) -> None:
        for before, value in zip([0.0, *values], values, strict=False):
            if not before < value < math.inf:
                after = f" after {before:g}" if before else ""
                allowed = "allowed: numbers > 0 that rise; falling loads and tensions are written into the scene"
                raise argparse.ArgumentError(self, f"{value:g}{after}; {allowed}, as loading.targets")
        setattr(namespace, self.dest, values)


PRESSURES: dict[str, Any] = {"required": True, "nargs": "+", "action": _Rising, "help": "mean pressures, Pa, rising"}


def _number(allowed: str) -> Callable[[str], float]:
    """Return the reader of a number of the command line; `allowed` are the words of its error message."""

    def read(word: str) -> float:
        try:
            return float(word)
        except ValueError as error:
            raise argparse.ArgumentTypeError(f"{word!r}; allowed: {allowed}") from error

    return read


def add_command(commands: Any) -> None:
    """Add `answer` to the commands of a program."""
    parser = commands.add_parser(
        "answer",
        help="a measured trace to a page of answers: writes the scene that it made, solves it to three digits",
        description="Make a scene of a measured trace, solve it to three digits, and write the page of its answers; of "
        "a map with --profile row=all, the median and scatter of its rows. "
        "Every choice is a commented line of DIR/scene.toml: edit the scene, then run it again with linecontact run.",
    )
    parser.add_argument(
        "trace", type=Path, metavar="TRACE", help="text file of positions and heights, or an instrument's file"
    )
    parser._negative_number_matcher = NEGATIVE  # or -5e6 is no number to it, and the scene cannot say why it is refused
    for flag, needed, keywords in (
        ("--youngs-modulus", "a number in Pa, as in 50e6", {"required": True, "help": "of the solid, Pa"}),
        ("--poisson-ratio", "a number, as in 0.49", {"required": True, "help": "of the solid; 0.5: incompressible"}),
        ("--pressure", "numbers in Pa, as in 50e3 1e6", PRESSURES),
        ("--work-of-adhesion", "a number in J/m^2, as in 0.05", {"help": "J/m^2 (default: no adhesion)"}),
        (
            "--thickness",
            "a number in m, as in 1e-3",
            {"help": "of the solid on a rigid plate, m (default: a half-space)"},
        ),
    ):
        parser.add_argument(flag, type=_number(needed), metavar="NUMBER", **keywords)
    parser.add_argument("--pull-off", action="store_true", help="unload until the contact comes apart, at what tension")
    parser.add_argument(
        "--profile",
        nargs="+",
        type=_key_and_value,
        default=[],
        metavar="KEY=VALUE",
        help="keys of [profile] that the trace needs, as in unit_x=mm unit_h=um (linecontact keys profile)",
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of the answer (default: TRACE-answer, here)")
    parser.add_argument("--overwrite", action="store_true", help="replace the scene and the answer that DIR holds")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    cores = os.cpu_count() or 1
    parser.add_argument("--jobs", type=positive, default=cores, metavar="N", help=f"processes (default: {cores})")
    parser.set_defaults(command=_answer, perform=perform)


def _answer(options: argparse.Namespace) -> int:
    """Write the scene of a trace, solve it, and write its page; the last line is the path of the page."""
    folder: Path = options.out or Path(f"{options.trace.stem}-answer")
    given = dict(options.profile)
    try:
        choice = choice_for(options, given)
    except SceneError as error:
        print(f"error: {error}{_flags(error)}", file=sys.stderr)
        return BAD_INPUT
    refuse_beyond_memory(choice.scene)
    check_path(choice.scene)
    usable(folder)
    with locked(folder) as new:
        if not new and not options.overwrite:
            raise OutputFolderError(f"{folder}: exists; choose another folder with --out, or --overwrite replaces it")
        choice.tables["profile"]["file"] = _path_from(folder, options.trace)
        write_atomically(folder / SCENE_FILE, "\n".join(scene_lines(choice)) + "\n")
        print(
            f"{folder / SCENE_FILE}: every choice is a line there; solved to three digits, "
            f"accuracy.tolerance = {TOLERANCE:g}",
            file=sys.stderr,
        )
        for key in ("outliers", "cutoff_short"):
            if key in choice.tables["profile"].keys() - given.keys():
                print(f"note: profile.{key}: {_reasons(choice)[key]}", file=sys.stderr)
        run = {"scene": folder / SCENE_FILE, "out": folder, "resume": False, "overwrite": True, "plot": False}
        run |= {"quiet": options.quiet, "json": False, "table": True, "jobs": options.jobs}
        if asks_for_rows(choice.tables):
            code = row_commands.run_alone(read_tables(folder / SCENE_FILE), argparse.Namespace(**run), new)
            write_rows_page(folder)
            print(folder / PAGE, flush=True)
            return code
        code = scene_commands.run_alone(load_scene(folder / SCENE_FILE), argparse.Namespace(**run), new)
        if code == INTERRUPTED:
            print(
                f"continue: linecontact run {folder / SCENE_FILE} --out {folder} --resume; linecontact report {folder}",
                file=sys.stderr,
            )
        write_run_page(folder)
    print(folder / PAGE, flush=True)
    if not code and not options.quiet:
        print(
            f"next, how far its choices move the answer: linecontact study scene {folder / SCENE_FILE} --quick "
            f"--out {folder}",
            file=sys.stderr,
        )
    return code


def _flags(error: SceneError) -> str:
    """Return a line that says how the keys of [profile] in an error are given here; nothing if there are none."""
    keys = [mistake.path.removeprefix("profile.") for mistake in error.mistakes if mistake.path.startswith("profile.")]
    named = " ".join(f"{key}=.." for key in dict.fromkeys(keys) if key != "file") or "KEY=VALUE"
    return f"\n  keys of [profile] are given as: --profile {named}" if keys else ""


def _key_and_value(word: str) -> tuple[str, Any]:
    """Return a key of [profile] and its value; a value that is no TOML is a text.

    Examples
    --------
    >>> _key_and_value("unit_x=mm"), _key_and_value("columns=[1, 3]"), _key_and_value("row=4")
    (('unit_x', 'mm'), ('columns', [1, 3]), ('row', 4))
    """
    key, equals, value = word.partition("=")
    if not equals or not value or key in ("kind", "file"):
        allowed = "KEY=VALUE with a key of [profile] other than kind and file, as in unit_x=mm"
        raise argparse.ArgumentTypeError(f"{word!r}; allowed: {allowed}")
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key, value


def choice_for(options: argparse.Namespace, given: Mapping[str, Any]) -> Choice:
    """Return the scene of a trace with every choice made; SceneError in the words of `check`."""
    trace: Path = options.trace
    tables: dict[str, Any] = {
        "title": trace.name,
        "solid": {"youngs_modulus": options.youngs_modulus, "poisson_ratio": options.poisson_ratio},
        "profile": {"kind": "samples", "file": trace.name} | dict(given),
        "loading": {"control": "mean_pressure", "targets": list(options.pressure) + _way_out(options)},
        "accuracy": {"tolerance": TOLERANCE},
    }
    if options.thickness is not None:
        tables["layer"] = {"thickness": options.thickness}
    if options.work_of_adhesion is not None:
        tables["adhesion"] = {"work_of_adhesion": options.work_of_adhesion}
    rows = {key: given[key] for key in ("row", "every") if key in given}
    if asks_for_rows(tables):
        _, first = rows_of(tables, trace.parent)
        assert isinstance(first.profile.row, int)
        tables = tables_of_row(tables, first.profile.row)
    for tables["profile"]["detrend"] in [given["detrend"]] if "detrend" in given else ["mean", "line"]:
        scan = _scan(tables, trace)
        if scan.end_jump <= LARGEST_JUMP:
            break
    if "outliers" not in given and scan.step("outliers")["count"]:
        tables["profile"]["outliers"] = "replace"
        scan = _scan(tables, trace)
    if "periodic" not in given:
        tables["profile"]["periodic"] = "mirror" if scan.end_jump > LARGEST_JUMP else "as_is"
    if not {"cutoff_short", "harmonics"} & given.keys():
        if scan.spectrum.h.size < 2 * FEWEST_SAMPLES:
            few, allowed = f"has {scan.spectrum.h.size} samples", f"{2 * FEWEST_SAMPLES} or more, two waves"
            raise SceneError([Mistake("profile.file", few, f"{allowed}; or a cut of yours, cutoff_short=.. (m)")])
        coarse = _coarse(scan, _most(tables))[0]
        tables["profile"]["cutoff_short"] = float(f"{max(scan.spectrum.crossing or 0.0, coarse):.4g}")
    choice = Choice(tables, parse_scene(tables, trace.parent), _scan(tables, trace), given, scan.end_jump)
    tables["profile"] |= rows
    return choice


def _way_out(options: argparse.Namespace) -> list[float]:
    """Return the targets (Pa) of the way out, where pull-off is asked for: no load, and a tension of about E*.

    SceneError without adhesion.
    """
    if not options.pull_off:
        return []
    if options.work_of_adhesion is None:
        raise SceneError([Mistake("--pull-off", "without adhesion", "with --work-of-adhesion")])
    modulus = options.youngs_modulus / (1 - options.poisson_ratio**2)
    return [0.0, -float(f"{modulus:.1e}")]


def _scan(tables: Mapping[str, Any], trace: Path) -> PeriodicSamples:
    """Return the prepared samples of a trace."""
    scan = parse_scene(tables, trace.parent).scan
    assert scan is not None
    return scan


def _most(tables: Mapping[str, Any]) -> int:
    """Return the most waves along a trace that a first answer has."""
    return MOST_ADHERING if "adhesion" in tables else MOST_WAVES


def _coarse(scan: PeriodicSamples, most: int) -> tuple[float, str]:
    """Return the shortest wave (m) that a first answer has, at most so many along the trace, and the reason."""
    samples = scan.spectrum.h.size
    if samples > FEWEST_SAMPLES * most:
        return scan.spacing * samples / most, f"{most} waves along the trace, for a first answer in seconds"
    return FEWEST_SAMPLES * scan.spacing, f"{FEWEST_SAMPLES} samples, as in ISO 3274"


def _path_from(folder: Path, trace: Path) -> str:
    """Return the path of the trace from the folder of the scene; absolute if no relative path leads there."""
    try:
        return Path(os.path.relpath(trace, folder)).as_posix()
    except ValueError:  # another drive of Windows
        return trace.absolute().as_posix()


def scene_lines(choice: Choice) -> Lines:
    """Yield the lines of the scene file, with a comment for each choice."""
    tables = choice.tables
    yield "# Made by linecontact answer.  Edit any line, then solve the scene into a new folder and make its page:"
    yield f"#   linecontact run {SCENE_FILE} --out again && linecontact report again"
    yield f"title = {toml_text(tables['title'])}"
    yield "\n[solid]"
    yield from _keys(tables["solid"], {"youngs_modulus": "Pa, as given", "poisson_ratio": "as given"})
    yield "\n[profile]"
    yield from _keys(tables["profile"], _reasons(choice) | _given(choice))
    yield from _resolved_lines(choice)
    if "layer" in tables:
        yield "\n[layer]"
        yield from _keys(tables["layer"], {"thickness": "m, as given"})
    else:
        yield "\n# no [layer] with its thickness: the solid is a half-space"
    if "adhesion" in tables:
        yield "\n[adhesion]"
        yield from _keys(tables["adhesion"], {"work_of_adhesion": "J/m^2, as given"})
    else:
        yield "\n# no [adhesion] with its work_of_adhesion: the contact does not adhere"
    yield "\n[loading]"
    back = "Pa, as given; values that fall, such as 0.0 and tensions < 0, unload: then the pull-off is found too"
    yield from _keys(tables["loading"], {"control": "the load is prescribed", "targets": back})
    yield "\n[accuracy]"
    yield from _keys(tables["accuracy"], {"tolerance": "three digits; 1e-6 for more, which takes longer"})


def _given(choice: Choice) -> dict[str, str]:
    """Return the comment of each key that the command line gave; that of a row says which line of the file it is."""
    comments, taken = dict.fromkeys(choice.given, "as given"), choice.scan.steps[0].get("taken")
    if "row" in comments and taken:
        each = f"row {choice.scene.profile.row} is " * (choice.given["row"] == ALL_ROWS)
        comments["row"] += f": {each}{taken}"
    return comments


def _reasons(choice: Choice) -> dict[str, str]:
    """Return the reason of each choice in [profile]."""
    scan = choice.scan
    line, tilt = scan.step("detrend")["method"] == "line", scan.step("detrend")["tilt"]
    taken = f'the tilt of {tilt:.3g} is subtracted; "mean" keeps it, "quadratic" takes a bow away too'
    reasons = {"detrend": taken if line else 'the ends of the trace meet without; "line" subtracts a tilt'}
    cautions = cautions_of(choice.scene, groups_of(choice.scene))
    forms = [caution.message for caution in cautions if caution.about == "profile.detrend"]
    reasons["detrend"] += "".join(f"; {form}, or --profile detrend=quadratic" for form in forms)
    samples = int(scan.spectrum.h.size)
    reasons["file"] = f"{samples} samples at {scan.spacing * 1e6:.4g} um; its path is from the folder of this scene"
    apart = f"the ends of the trace are {choice.jump:.2g} rms steps apart"
    mirrored = choice.tables["profile"].get("periodic") == "mirror"
    reasons["periodic"] = f"{apart}: it is followed by its mirror image" if mirrored else f"{apart}: it repeats"
    reasons["periodic"] += f'; "window" tapers the ends. Period {scan.period * 1e3:.6g} mm'
    least, coarse = _coarse(scan, _most(choice.tables))
    spikes = scan.step("outliers")
    if spikes["count"]:
        told = f"{spikes['count']} of up to {spikes['largest'] * 1e6:.3g} um, the first at {spikes['first']}"
        reasons["outliers"] = f'spikes ({told}) take the median of their neighbours; "keep" keeps them'
    crossing, noise = scan.spectrum.crossing, scan.step("spectrum")["noise"]
    if crossing is None:
        reason = f"{coarse}; the data suggest no other cut: {noise}"
    elif crossing >= least:
        reason = f"there the trace falls below its noise of {scan.spectrum.noise_rms:.2g} m rms"
    else:
        reason = f"{coarse}; the trace falls below its noise at {crossing:.3g} m only, try that next"
    if any(step["step"] == "filter" for step in scan.steps):
        before, after = scan.step("filter")["rms_slope"]
        reason += f". It leaves an rms slope of {after:.3g} of {before:.3g}; contact areas go as the inverse"
    return reasons | {"cutoff_short": f"m, Gaussian filter: {reason}"}


def _resolved_lines(choice: Choice) -> Lines:
    """Yield the keys of [profile] that the file states or that have their defaults, as comments."""
    tables, scan, profile = choice.tables, choice.scan, choice.scene.profile
    for key in ("unit_x", "unit_h"):
        if scan.steps[0].get(f"{key}_from") == "file":
            yield f"# {key} = {toml_text(getattr(profile, key))}: stated by the file"
    if "harmonics" not in tables["profile"]:
        yield f"# harmonics = {profile.harmonics} waves a period: as many as the filter leaves; set fewer to be quicker"
    for key, words in (("missing", "gaps"), ("outliers", "spikes")):
        if key not in tables["profile"]:
            yield f"# {key} = {toml_text(getattr(profile, key))}: {words}, as by default"


def _keys(table: Mapping[str, Any], reasons: Mapping[str, str]) -> Lines:
    """Yield the lines of a table, each with its reason behind it, or above it where that is long."""
    for key, value in table.items():
        reason, line = reasons.get(key, ""), f"{key} = {toml_text(value)}"
        if len(line) + len(reason) > WIDTH:
            yield textwrap.fill(reason, WIDTH, initial_indent="# ", subsequent_indent="# ")
            reason = ""
        yield f"{line}  # {reason}" if reason else line
