"""Every hint that is given about a scan is followed: what comes of it is another answer, and in the end a scan.

A hint is `key = value` in what a refusal or a warning allows, "leave it out" of the key it is about, a list of units,
or a change of the file's lines that can be made by its words.
"""

import json
import re

import numpy as np
import pytest
from scene_tables import tables

from bem.scans.scan_keys import DEFAULTS, SCAN_KEYS
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.scene import SceneError, parse_scene

COUNT = 24
X = np.arange(COUNT) * 0.25
H = np.round(np.cos(2 * np.pi * X / 6) + 5 + 0.1 * np.random.default_rng(1).normal(size=COUNT), 3)
KEYS = "|".join((*SCAN_KEYS, *DEFAULTS, "harmonics"))
HINT = re.compile(rf'\b({KEYS}) = ("[^"]*"|\[[^\]]*\]|[-+.\deE]+)')
UNITS = {"unit_x": "mm", "unit_h": "um"}


def rows(x=X, h=H, delimiter=","):
    return "".join(f"{a}{delimiter}{b}\n" for a, b in zip(x, h, strict=True))


def dropped(value, places):
    return rows(h=[value if k in places else b for k, b in enumerate(H)])


POINTS = "".join(
    f"{a},{b},{h}\n" for b, h in zip((0, 1, 2), (H, H + 1, H + 2), strict=True) for a, h in zip(X, h, strict=True)
)
MAP = "".join(",".join(map(str, H + k)) + "\n" for k in range(3))
ALONE = "".join(f"{h}\n" for h in H)
STARTS = {
    "no unit": (rows(), {}),
    "unit of one axis": ("x [mm],h\n" + rows(), {}),
    "unit of no axis": ("Unit: um\n" + rows(), {}),
    "another unit in the file": ("x [mm],h [nm]\n" + rows(), UNITS),
    "units that nobody knows": ("x [mm],h [furlong]\n" + rows(), {}),
    "unequal steps": (rows(np.r_[X[:-1], X[-1] + 1]), UNITS),
    "missing heights": (dropped("NaN", [5, 6]), UNITS),
    "dropouts": (dropped(-9999, range(5, 9)), UNITS),
    "dropouts and missing heights": (dropped(-9999, range(5, 9)).replace("0.25,", "0.25,NaN #", 1), UNITS),
    "columns of a table": ("".join(f"{a},{b},{b + 1}\n" for a, b in zip(X, H, strict=True)), UNITS),
    "swapped columns": (rows(H, X), UNITS),
    "swapped columns asked for": (rows(), {"columns": [2, 1], **UNITS}),
    "falling": (rows(X[::-1]), UNITS),
    "falling, columns swapped": (rows(X[::-1]), {"columns": [2, 1], **UNITS}),
    "repeated": (rows(np.r_[X[:-1], X[-2]]), UNITS),
    "repeated, columns swapped": (rows(np.r_[X[:-1], X[-2]]), {"columns": [2, 1], **UNITS}),
    "lines one after another": (rows() + rows(), UNITS),
    "raster": (POINTS, UNITS),
    "raster as a map": (POINTS, {"row": 0, "spacing": 0.25, **UNITS}),
    "raster as a line": (POINTS, {"columns": [1, 3], **UNITS}),
    "raster, wrong columns": (POINTS, {"row": 0, "columns": [2, 3], **UNITS}),
    "row that is not there": (MAP, {"row": 3, "spacing": 0.25, **UNITS}),
    "row of a line": (rows(), {"row": 0, **UNITS}),
    "map of a stated width": ("Width: 6.0 mm\nUnit: um\n" + MAP, {"row": 0, "spacing": 1.0, "unit_x": "mm"}),
    "heights of a stated width": ("Length: 6.0 mm\nUnit: um\n" + ALONE, {}),
    "heights of another width": ("Length: 6.0 mm\nUnit: um\n" + ALONE, {"spacing": 0.4, "unit_x": "mm"}),
    "pitch": ("Pitch: 0.25 mm\nUnit: um\n" + ALONE, {"spacing": 0.4, "unit_x": "mm"}),
    "width of the positions": ("Scan length: 6.0 um\n" + rows(), UNITS),
    "spacing beside positions": (rows(), {"spacing": 0.25, **UNITS}),
    "channel of text": (rows(), {"channel": 0, **UNITS}),
    "comma of either kind": ("".join(f"{k},{k % 3}\n" for k in range(20)), UNITS),
    "thousands": ("".join(f"{k};{1 + k % 5},{200 + k % 3}\n" for k in range(20)), UNITS),
    "exponents with D": (rows().replace("\n", "D+00\n"), UNITS),
    "units after numbers": (rows().replace(",", "mm,"), UNITS),
    "a number too large": (rows().replace("0.25,", "0.25,1e300 #", 1), UNITS),
    "a footer": (rows() + "end\n", UNITS),
}  # fmt: skip


def scene_of(folder, text, values):
    (folder / "scan.csv").write_text(text)
    return parse_scene(tables({"kind": "samples", "file": "scan.csv", **values}, "mean_pressure", [1e5]), folder)


def line_of(found):
    return int(re.search(r"line (\d+)", found)[1])


def edited(lines, mistake):
    """The lines of a file after what a mistake says should be done to them; None if it says nothing of the kind."""
    found, allowed = mistake.found, mistake.allowed
    if "reverse the order of the lines" in allowed:
        return lines[::-1]
    if "keep one of the lines that share a position" in allowed:
        return list({line.split(",")[0]: line for line in lines}.values())
    if "one scan line: remove the others" in allowed:
        return lines[: line_of(found) - 1]
    if "remove it" in allowed or "NaN" in allowed:
        return lines[: line_of(found) - 1] + lines[line_of(found) :]
    if "replace D by E" in allowed:
        return [line.replace("D", "E") for line in lines]
    if "numbers alone" in allowed:
        return [line.replace("mm", "") for line in lines]
    if "convert it" in allowed:
        number = line_of(found) - 1
        return [*lines[:number], lines[number].replace("furlong", "um"), *lines[number + 1 :]]
    if "remove the commas" in allowed:
        return [line.replace(",", "") for line in lines]
    return None


def ways(text, values, mistake):
    """What a mistake says may be done: texts and values."""
    key = mistake.path.removeprefix("profile.")
    for name, value in HINT.findall(mistake.allowed.partition(" (unit_x")[0]):
        unit = re.search(rf'{re.escape(value)}.*?\(unit_x = "(\w+)"\)', mistake.allowed) if name == "spacing" else None
        more = {} if unit is None else {"unit_x": unit[1]}
        yield text, values | {name: json.loads(value.rstrip("."))} | more
    if mistake.allowed.startswith("the distance of two samples"):
        yield text, values | {"spacing": 0.25}
    if "leave it out" in mistake.allowed:
        yield text, {name: value for name, value in values.items() if name != key}
    if re.fullmatch(r'one of ("\w+"(, )?)+', mistake.allowed):
        for unit in re.findall(r'"(\w+)"', mistake.allowed)[:4]:
            yield text, values | {key: unit}
    lines = edited(text.splitlines(), mistake)
    if lines is not None:
        yield "\n".join(lines) + "\n", values


def mistakes_of(folder, text, values):
    try:
        scene_of(folder, text, values)
    except SceneError as error:
        return error.mistakes
    return ()


@pytest.mark.parametrize("name", STARTS)
def test_hints_lead_on(name, tmp_path):
    """No hint leads back to a mistake that stood on its way, and some way ends in a scan."""
    text, values = STARTS[name]
    waiting, ends = [(text, values, ())], 0
    assert mistakes_of(tmp_path, text, values)
    while waiting:
        text, values, seen = waiting.pop()
        mistakes = mistakes_of(tmp_path, text, values)
        ends += not mistakes
        assert not set(mistakes) & set(seen), (values, mistakes)
        if len(seen) > 8:
            continue
        for mistake in mistakes[:1]:
            found = list(ways(text, values, mistake))
            assert found, mistake
            waiting += [(*way, (*seen, mistake)) for way in found]
    assert ends


WARNED = {
    "tilt": rows(h=H + 2 * X),
    "jump": rows(h=5 + 0.1 * (X - 2.9) ** 3),
    "spike": dropped(90.0, [7]),
    "dropouts kept": dropped(-9999, range(5, 9)),
    "rounded": "".join(f"{a:.1f},{b}\n" for a, b in zip(X * 0.7, H, strict=True)),
    "alternating": rows(h=[(-1) ** k for k in range(COUNT)]),
    "cut": rows(),
}  # fmt: skip


@pytest.mark.parametrize("name", WARNED)
def test_hints_of_warnings_are_their_end(name, tmp_path):
    values = UNITS | ({"dropouts": "keep"} if "kept" in name else {}) | ({"harmonics": 1} if name == "cut" else {})
    values |= {"detrend": "line"} if name == "jump" else {}
    text, followed = WARNED[name], 0
    told = cautions(tmp_path, text, values)
    assert told
    for about, message in told.items():
        for key, value in HINT.findall(message.partition(": ")[2]):
            if json.loads(value) == values.get(key):
                continue
            after = values | {key: json.loads(value)} | ({"missing": "interpolate"} if key == "dropouts" else {})
            assert message != cautions(tmp_path, text, after).get(about), (about, key, value)
            followed += 1
    assert followed or name in ("rounded", "alternating")


def cautions(folder, text, values):
    scene = scene_of(folder, text, values)
    return {caution.about: caution.message for caution in cautions_of(scene, groups_of(scene))}
