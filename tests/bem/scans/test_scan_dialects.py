"""Files made up at random from what instruments write: every one is read as it was meant, or refused; none misread."""

import random

import numpy as np

from bem.scans.scan_file import read_scan
from bem.scans.scan_preparation import prepare
from bem.scans.scan_text import ScanFileError

METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
HEADINGS = ("x [{x}]|h [{h}]", "x ({x})|h ({h})", "x / {x}|h / {h}", "{x}|{h}", "x [{x}]|h", "x|h", "Filter [um]|Gauss")
HEADER = ("Instrument 7", "Points: 1000", "Cutoff;0,8;mm", "1 2 3", "512 512", "Date 1.2.2024", "Unit: um", "# comment",
          "Lc [mm];Ls [um]", "Filter [nm] = 5;2")  # fmt: skip
DAMAGE = ("NaN", "bad", "3;4", "x", "1.2.3", "-;4")
FILES = 600


def made_up(rng):
    """A file, what the scene says of it, and the line that is meant."""
    count = rng.choice([4, 20, 60])
    numbers = np.random.default_rng(rng.randrange(2**31))
    x = np.arange(count) * rng.choice([1, 0.5, 0.25, 0.1])
    h = np.round(numbers.normal(size=count) * rng.choice([1, 10, 1000]), rng.choice([0, 1, 3]))
    alone, mark, delimiter = rng.random() < 0.2, rng.choice(".,"), rng.choice([",", ";", "\t", " ", "  ", ", ", " ; "])
    form = [rng.choice(["%g", "%.3f", "%.6e"]) for _ in "xh"]
    texts = [[form[0] % a, form[1] % b][alone:] for a, b in zip(x, h, strict=True)]
    rows = [delimiter.join(cell.replace(".", mark) for cell in cells) for cells in texts]
    units = {axis: rng.choice(list(METRES)) for axis in "xh"}
    header = rng.sample(HEADER, rng.randrange(4)) if rng.random() < 0.4 else []
    if rng.random() < 0.6:
        names = rng.choice(HEADINGS).format(**units).split("|")
        header.append(delimiter.join(names[alone:]))
    elif header and header[-1].startswith("Lc"):
        header.pop()  # in the place of a heading it is one
    if rng.random() < 0.15:
        rows[rng.randrange(1, count)] = rng.choice(DAMAGE)
    text = "\n".join([*header, *rows]).encode(rng.choice(["utf-8", "utf-8-sig", "latin-1", "utf-16"]))
    values = {f"unit_{axis}": unit for axis, unit in units.items() if rng.random() < 0.7}
    values |= {"spacing": float(x[1])} if alone else {}
    values |= {"decimal": mark} if rng.random() < 0.3 else {}
    meant = (x if alone else np.array([float(cells[0]) for cells in texts])), np.array([float(c[-1]) for c in texts])
    return text, values, [values_of * METRES[units[axis]] for axis, values_of in zip("xh", meant, strict=True)]


def test_none_is_misread(tmp_path):
    rng, path, right = random.Random(7), tmp_path / "scan.txt", 0
    for _ in range(FILES):
        content, values, meant = made_up(rng)
        path.write_bytes(content)
        try:
            x, h = prepare(read_scan(path, values), {"missing": "interpolate"}).measured
        except ScanFileError:
            continue
        right += 1
        assert h.size == meant[1].size, content
        np.testing.assert_allclose(x, meant[0], rtol=1e-9, err_msg=repr(content))
        known = np.isfinite(h)
        np.testing.assert_allclose(h[known], meant[1][known], rtol=1e-9, err_msg=repr(content))
    assert right > FILES / 3  # measured 252 of 600
