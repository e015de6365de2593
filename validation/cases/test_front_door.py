"""Answers of the command for a scene, as printed and as stored, against closed forms of one wave.

h = D cos(2 pi x / period), D = 0.1 mm, period 10 mm, E = 1 MPa, nu = 0.5: with adhesion (Johnson's alpha = 0.3) at two
depths and on the way out, and without adhesion as three rows of a map whose depths differ.  U of a printed number is
half a unit of its last digit.  Sources: Johnson, Int. J. Solids Struct. 32 (1995) 423; Westergaard, J. Appl. Mech. 6
(1939) A49 (validation/references/closed_forms.py).
"""

import csv
import io
import re
from contextlib import redirect_stderr, redirect_stdout

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import bem
from bem.scene_commands import main
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
PSI, OUT = np.array([0.4, 1.0]), -2e-4  # of the depths pressed to, and penetration at the end of the way out, m
SOLID = "[solid]\nyoungs_modulus = 1e6\npoisson_ratio = 0.5\n"
PREFIX = {"k": 1e3, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "": 1.0}
OF_POINTS = ("open_gap_p", "open_gap_largest")  # heights of the gap at points
SAMPLED = 0.01  # of them: straight lines between 24 points in theta, (pi / 24)^2 / 8 of g'' / g, which is at most 5
KINDS = {"fraction": Quantity.AREA, "share": Quantity.AREA, "pressure": Quantity.PRESSURE}


def known():
    """Return the answer at the two depths by the names of a table of targets: lists in SI units."""
    share, deep = PSI * 2 / np.pi, WAVE.penetration(PSI)
    x = [psi / np.pi + (0.5 - psi / np.pi) * (np.arange(4000) + 0.5) / 4000 for psi in PSI]  # open half, in periods
    gaps = np.array([WAVE.gap(0.01 * at, psi) for at, psi in zip(x, PSI, strict=True)])
    separation = 1e-4 - deep
    parts = {f"open_gap_p{k}": [float(WAVE.gap(0.01 * (psi + (np.pi / 2 - psi) * k / 100) / np.pi, psi)) for psi in PSI]
             for k in (10, 25, 50, 75, 90)}
    return parts | {
        "mean_pressure": WAVE.mean_pressure(PSI), "contact_fraction": share, "separation": separation,
        "contact_pressure": WAVE.mean_pressure(PSI) / share, "open_share": 1 - share,
        **dict.fromkeys(("width_least", "width_median", "width_largest"), 0.01 * share),
        "open_gap_mean": separation / (1 - share), "widest_channel": 0.01 * (1 - share),
        "open_gap_largest": [float(WAVE.gap(0.005, psi)) for psi in PSI],
        "mean_cubic_root": np.cbrt(np.mean(gaps**3, axis=1) * (1 - share)),
    }


PRINTED = {  # heading: names of the numbers in a cell
    "mean pressure": ["mean_pressure"], "contact fraction": ["contact_fraction"], "separation": ["separation"],
    "contact pressure: mean": ["contact_pressure"], "open share of the period": ["open_share"],
    "widths: least, median, largest": ["width_least", "width_median", "width_largest"],
    "open gap: mean": ["open_gap_mean"], "open gap: largest": ["open_gap_largest"],
    "open gap: 10, 50, 90 % of the open length below": ["open_gap_p10", "open_gap_p50", "open_gap_p90"],
    "gap for flow along the ridges, <g³>^(1/3)": ["mean_cubic_root"], "widest open channel": ["widest_channel"],
}


def numbers(text):
    """Return the numbers in a text such as `24.2, 89.3 µm`, and half a unit of the last digit of each, in SI units."""
    parts = re.findall(r"((?:-?\d+(?:\.\d+)?(?:, )?)+) ?(?:([kmµn]?)(?:m|Pa)\b)?", text)
    return [(float(word) * PREFIX[prefix], PREFIX[prefix] * 0.5 * 10.0 ** -len(word.partition(".")[2]))
            for words, prefix in parts for word in words.split(", ") if word]


def told(*words):
    """Return the exit code of a command, and what it prints."""
    with redirect_stdout(io.StringIO()) as printed, redirect_stderr(io.StringIO()):
        status = main([str(word) for word in words])
    return status, printed.getvalue()


@pytest.mark.quick
def test_wave(rows, tmp_path):
    """Does the command print, and store, what Johnson's wave has at its targets and at the pull-off?"""
    targets = [*WAVE.penetration(PSI).tolist(), OUT]
    (tmp_path / "wave.toml").write_text(
        f'{SOLID}[profile]\nkind = "harmonics"\nperiod = 0.01\norders = [1]\namplitudes = [1e-4]\nphases = [0.0]\n'
        f"[adhesion]\nwork_of_adhesion = {WAVE.work_of_adhesion!r}\nslope_term = false\n"
        f'[loading]\ncontrol = "penetration"\ntargets = {targets}\n', "utf-8")
    run = "run", tmp_path / "wave.toml", "--out", tmp_path / "out", "--table"
    status, (_, text) = [told(*run)[0]], told(*run, "--resume")
    lines = {cells[0]: cells[1:] for cells in (re.split(r"  +", line) for line in text.splitlines())}
    result, answer = bem.read_result(tmp_path / "out"), known()
    johnson = rows.between(Code.BEM, Code.EXACT, "Johnson 1995")
    for heading, names in PRINTED.items():
        both = np.array([numbers(cell) for cell in lines[heading][:2]])  # target, number, value and rounding
        kind = next((kind for word, kind in KINDS.items() if word in heading), Quantity.LENGTH)
        exact = np.ravel([answer[name] for name in names])
        sampled = SAMPLED * exact if names[-1].startswith(OF_POINTS) else 0.0
        johnson.compare(f"printed: {heading}", both[..., 0].T.ravel(), exact, quantity=kind,
                        unit="Pa" if "pressure" in heading else "",
                        uncertainty=both[..., 1].T.ravel() + sampled)
    table, least = result.to_table("targets"), minimize_scalar(WAVE.mean_pressure, bounds=(0.05, 0.6), method="bounded",
                                                               options={"xatol": 1e-12})
    johnson.compare("contacts, printed and stored", [*(float(cell) for cell in lines["contacts"][:2]),
                    *table["n_patches"][:2]], 1, quantity=Quantity.COUNT, kind="construction", required=0.5,
                    because="a count")
    for which, u in (("of points", SAMPLED), ("of integrals", 1e-8)):
        chosen = [name for name in answer if name.startswith(OF_POINTS) == (which == "of points")]
        johnson.compare(f"stored over closed form, quantities {which}", np.ravel([table[name][:2] / answer[name]
                        for name in chosen]), 1.0, quantity=Quantity.LENGTH, uncertainty=u)
    apart = 1e-4 - float(WAVE.penetration(WAVE.fold()))
    words = numbers(next(line for line in text.splitlines() if line.startswith("Pull-off")).replace("< 0.01 %", ""))
    tension, at, gone = words
    johnson.compare("printed: pull-off", tension[0], -least.fun, quantity=Quantity.PRESSURE, unit="Pa",
                    uncertainty=tension[1])
    johnson.compare("printed: separations at the pull-off and where contact ends", [at[0], gone[0]],
                    [1e-4 - float(WAVE.penetration(least.x)), apart], quantity=Quantity.LENGTH, unit="m",
                    uncertainty=[at[1], gone[1]])
    names = ("contact_fraction", "n_patches", "mean_pressure", "separation", "open_gap_mean")
    ends = [table[name][2] for name in names]
    johnson.compare("stored: apart on the way out, at the separation held", [*status, *ends],
                    [0, 0, 0, 0, 1e-4 - OUT, 1e-4 - OUT], quantity=Quantity.COUNT, kind="construction",
                    required=1e-18, because="no contact, and rounding")
    facts = dict(re.findall(r"# (\w+) = ([\d.e+-]+)", told("check", tmp_path / "wave.toml")[1]))
    elastic = np.pi * WAVE.modulus * 1e-8 / 0.04  # of complete contact
    johnson.compare("printed by check: rms height and slope, pressure scale, adhesion over elastic energy; ratios",
                    [float(facts[name]) / value for name, value in (
                        ("rms_height", 1e-4 / np.sqrt(2)), ("rms_slope", np.sqrt(2) * np.pi / 100),
                        ("pressure_scale", np.sqrt(2) * np.pi / 100 * WAVE.modulus),
                        ("adhesion_over_elastic_energy", WAVE.work_of_adhesion / elastic))], 1.0,
                    quantity=Quantity.SPECTRUM, uncertainty=5e-4, source="closed forms of the wave")


@pytest.mark.quick
def test_rows_of_a_map(rows, tmp_path):
    """Are median and scatter over the rows of a map those of Westergaard's contacts of the rows?"""
    depths, load = np.array([60.0, 70.0, 100.0, 75.0]), 1e4
    place = 2 * np.pi * np.arange(64) / 64
    np.savetxt(tmp_path / "map.txt", depths[:, None] * np.cos(place))
    (tmp_path / "map.toml").write_text(
        f'{SOLID}[profile]\nkind = "samples"\nfile = "map.txt"\nunit_h = "um"\nunit_x = "mm"\nspacing = {10 / 64}\n'
        f'row = "all"\n[loading]\ncontrol = "mean_pressure"\ntargets = [{load}]\n', "utf-8")
    text = told("run", tmp_path / "map.toml", "--out", tmp_path / "out")[1]
    printed = dict(re.split(r"  +", line, maxsplit=1) for line in text.splitlines() if "  " in line)
    share = load / (np.pi * WAVE.modulus * depths * 1e-6 / 0.01)
    area = 2 / np.pi * np.arcsin(np.sqrt(share))
    of_rows = {"contact_fraction": area, "separation": 1e-6 * depths * (1 - share + share * np.log(share)),
               "peak_pressure": 2 * load / np.sqrt(share), "contact_pressure": load / area, "open_share": 1 - area}
    low, median, high = np.quantile(np.array([*of_rows.values()]), [0.16, 0.5, 0.84], axis=1)
    with (tmp_path / "out/answer.csv").open(encoding="utf-8", newline="") as file:
        stored = {line["quantity"]: (float(line["median"]), float(line["scatter"])) for line in csv.DictReader(file)}
    westergaard = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939")
    westergaard.compare("stored over closed form: median and scatter of five quantities",
                        np.array([stored[name] for name in of_rows]) / np.transpose([median, (high - low) / 2]),
                        np.ones((5, 2)), quantity=Quantity.AREA, uncertainty=1e-7)  # of stored peaks
    cells = np.array([numbers(printed[head]) for head in ("contact fraction", "contact pressure: peak")])
    exact = np.array([(median[k], (high - low)[k] / 2) for k in (0, 2)])
    westergaard.compare("printed: median and scatter of contact fraction and peak pressure, over closed form",
                        cells[..., 0] / exact, 1.0, quantity=Quantity.AREA, uncertainty=cells[..., 1] / exact)
