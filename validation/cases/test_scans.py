"""Scans of one wave, in other units, forms and places, against Westergaard's contact of it; noise of a rough one.

h = D cos(2 pi x / period), D = 100 um, period 10 mm, 64 samples; E = 1 MPa, nu = 0.5, no adhesion.  Closed forms as in
test_johnson.py: contact fraction 2 psi / pi at the penetration D S (1 - ln S), S = sin^2 psi.
"""

import numpy as np
import pytest

import bem
from bem.scans.noise_floor import Spectrum
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.scenes import TEN_DIGITS, estimates, values

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.0)
FRACTIONS = np.array([0.3, 0.7])
COUNT = 64
PLACE = (np.arange(COUNT) + 0.5) / COUNT  # of the samples, in periods


def lines(*columns, mark=" "):
    """Return columns of numbers as lines of text, with all their digits."""
    return "\n".join(mark.join(repr(float(number)) for number in line) for line in zip(*columns, strict=True)) + "\n"


def wave(place):
    """Return the heights of the wave in um, with the phase 1 at the beginning."""
    return 100.0 * np.cos(2 * np.pi * place + 1.0)


def scans():
    """Yield the name of a scan, its text, and its keys in the scene."""
    x, upright = 10.0 * PLACE, 100.0 * np.cos(2 * np.pi * PLACE)
    half = np.arange(COUNT) / (2 * COUNT) + 0.25 / COUNT
    units, spacing = {"unit_x": "mm", "unit_h": "um"}, {"spacing": 10.0 / COUNT}
    yield "units in a heading", "x [mm];h [um]\n" + lines(x + 3.7, wave(PLACE), mark=";"), {}
    yield "names, and units below", "x,h\nmm,um\n" + lines(x, wave(PLACE), mark=","), {}
    yield ("inches, below two lines", "# a trace\n# upwards\n" + lines(x / 25.4, wave(PLACE) / 25.4, mark="\t"),
           {"unit_x": "in", "unit_h": "mil", "skip_lines": 2, "period": WAVE.wavelength})
    yield "tilted", lines(x, upright + 5.0 * x - 20.0), units | {"detrend": "line"}
    yield "half of it, mirrored", lines(10.0 * half, 100.0 * np.cos(2 * np.pi * half)), units | {"periodic": "mirror"}
    yield "rounded positions", lines(np.round(x, 2), wave(PLACE)), units | {"period": WAVE.wavelength}
    lost = np.full(2, -9999.0)
    yield ("missing ends", lines(np.arange(COUNT + 4) * 10.0 / COUNT, np.concatenate([lost, wave(PLACE), lost])),
           units | {"missing_value": -9999, "missing": "interpolate"})
    yield "heights alone", lines(1e-6 * wave(PLACE)), {"unit_x": "mm", "unit_h": "m"} | spacing
    rows = np.array([0.5 * upright, wave(PLACE), 1.5 * upright])
    yield "row of a map", lines(*rows.T), units | {"row": 1} | spacing
    yield "mean of a map", np.ascontiguousarray(rows[[0, 2]]).T, units | {"row": "mean"} | spacing
    yield "trace of doubles", wave(PLACE), units | spacing
    yield "decimal commas", lines(x, wave(PLACE), mark=" ; ").replace(".", ","), units
    yield "mark at the end", lines(x, wave(PLACE), mark=",").replace("\n", ",\n"), units
    wide, mean = np.arange(COUNT + 6) * 10.0 / COUNT, np.full(3, 0.1)
    yield ("column of valid heights", lines(wide, np.concatenate([mean, wave(PLACE), mean]),
                                            np.repeat([0, 7, 0], [3, COUNT, 3])),
           units | {"valid_column": 3, "missing": "interpolate"})
    yield ("dropouts at the ends", lines(wide, np.concatenate([-2e4 * mean, wave(PLACE), -2e4 * mean])),
           units | {"missing": "interpolate"})
    yield "half of it passes", lines(x, 2 * wave(PLACE)), units | {"cutoff_short": 0.01}


SCANS = {name: (text, keys) for name, text, keys in scans()}


@pytest.mark.quick
@pytest.mark.parametrize("name", SCANS)
def test_wave(rows, tmp_path, name):
    """Does a scan of a wave, whatever its form, give the contact of the wave?"""
    content, keys = SCANS[name]
    file = tmp_path / ("scan.txt" if isinstance(content, str) else "scan.npy")
    file.write_text(content, "utf-8") if isinstance(content, str) else np.save(file, content)
    psi = FRACTIONS * np.pi / 2
    scene = {"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
             "profile": {"kind": "samples", "file": file.name} | keys,
             "loading": {"control": "penetration", "targets": WAVE.penetration(psi).tolist()}}
    states = bem.solve(bem.parse_scene(scene, tmp_path)).targets
    both = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939")
    both.compare("contact fraction", values(states, "contact_fraction"), FRACTIONS, quantity=Quantity.AREA,
                 uncertainty=estimates(states, "contact_fraction"), required=1e-10, because=TEN_DIGITS)
    both.compare("mean pressure", values(states, "mean_pressure"), WAVE.mean_pressure(psi), unit="Pa",
                 quantity=Quantity.PRESSURE, uncertainty=estimates(states, "mean_pressure"),
                 required=1e-10 * WAVE.full_contact_pressure, because=TEN_DIGITS)


def prepared(heights, **keys):
    """Return the prepared scan, and facts by step, of heights in m at distances of 1 um."""
    profile = {"kind": "samples", "h": np.asarray(heights), "spacing": 1e-6} | keys
    scene = bem.parse_scene({"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5}, "profile": profile,
                             "loading": {"control": "penetration", "targets": [1e-7]}})
    return scene, {step["step"]: step for step in scene.preparation()}


@pytest.mark.quick
def test_preparation(rows):
    """Do detrending, filters and cut leave of waves what closed forms tell, and is a broken flank mended straight?"""
    n, orders, a, tilt, kept = 512, np.array([4, 16, 64]), np.array([1e-6, 3e-7, 5e-8]), 0.02, 30
    x = 1e-6 * (np.arange(n) - (n - 1) / 2)  # waves are even about the middle: a straight line is orthogonal to them
    scene, steps = prepared(np.cos(2e6 * np.pi / n * np.outer(x, orders)) @ a + tilt * x + 3e-6, detrend="line",
                            cutoff_short=2e-5, cutoff_long=1e-4, harmonics=kept)
    f = orders / (n * 1e-6)
    b = a * 2.0 ** -((2e-5 * f) ** 2) * (1 - 2.0 ** -((1e-4 * f) ** 2))
    slopes = np.pi * np.sqrt(2) * f * b
    level = float(np.sqrt(np.sum(a**2) / 2))
    between = float(np.sqrt(2 * n / (n - 1) * np.sum((a * np.sin(np.pi * orders / n)) ** 2))) * 1e6
    whole = float(np.sqrt(level**2 + tilt**2 * 1e-12 * (n**2 - 1) / 12))
    both = rows.between(Code.BEM, Code.EXACT, "sums of orthogonal waves; ISO 16610-21")
    for name, unit, value, reference in (  # sums of 512 terms round
        ("tilt, and the line taken away at the ends over its span", "",
         [steps["detrend"]["tilt"], *np.diff(steps["detrend"]["removed"]) / (x[-1] - x[0])], [tilt, tilt]),
        ("rms heights before and after detrending, filter and cut", "m",
         [*steps["detrend"]["rms_height"], steps["detrend"]["rms_without_tilt"], *steps["cut"]["rms_height"]],
         [whole, level, level, *np.sqrt(np.cumsum(b**2)[[2, 1]] / 2)]),
        ("rms slopes after detrending, filter and cut", "",
         [steps["detrend"]["rms_slope"][1], *steps["cut"]["rms_slope"]],
         [between, *np.sqrt(np.cumsum(slopes**2)[[2, 1]])]),
        ("share of the slope kept", "", steps["cut"]["slope_share_kept"],
         np.sqrt(np.sum(slopes[:2] ** 2) / np.sum(slopes**2))),
        ("amplitudes solved", "m", np.abs(scene.surface().amplitudes)[orders[:2] - 1], b[:2]),
    ):
        u = 1e-12 * np.max(reference)
        both.compare(name, value, reference, quantity=Quantity.SPECTRUM, unit=unit, uncertainty=u)
    flanks = 1e-7 * np.abs((np.arange(n) - 10) % 128 - 64.0)  # steps of 0.1 um, turns every 64 samples
    broken = flanks.copy()
    broken[[100, 101, 102]], broken[[30, 240]], broken[[300, 301]] = 0.009999, 3e-5, np.nan
    scene, steps = prepared(broken, missing="interpolate", outliers="replace", detrend="none")
    spikes = np.isin(np.arange(n), [30, 240])
    both.compare("heights with dropouts and gaps mended", scene.scan.h[~spikes], flanks[~spikes], unit="m",
                 quantity=Quantity.POINTS, uncertainty=1e-20, source="straight flanks")
    both.compare("heights with spikes mended", scene.scan.h[spikes], flanks[spikes], quantity=Quantity.POINTS, unit="m",
                 kind="construction", required=1.000001e-7, because="one step, and rounding", source="straight flanks")
    both.compare("dropouts, spikes, gaps, longest gap and threshold over the step",
                 [steps[name]["count"] for name in ("dropouts", "outliers", "missing")]
                 + [steps["missing"]["longest_gap"], steps["outliers"]["threshold"] * 1e7], [3, 2, 5, 3, 15],
                 quantity=Quantity.COUNT, kind="construction", required=1e-12, because="counts, and rounding")


@pytest.mark.quick
def test_slope_of_noise(rows):
    """Is the slope that is found in the spectrum of white noise zero on average, with the scatter that is stated?"""
    tails = np.array([Spectrum(h, 1e-6).tail for h in np.random.default_rng(2).normal(size=(2000, 90))])
    shares, u = tails[:, 0] / tails[:, 1], 2 / np.sqrt(len(tails))
    rows.compare("mean and rms of slopes over the stated error", [shares.mean(), np.sqrt(np.mean(shares**2))], [0, 1],
                 of=Code.BEM, by=Code.EXACT, quantity=Quantity.SPECTRUM, uncertainty=u, source="drawn")


@pytest.mark.quick
def test_noise(rows, tmp_path):
    """Does a rough scan with white noise tell the rms height of the noise?

    Its power is the median over bands of means of squares of normal numbers, half as many as samples: k = 2 is
    2 / sqrt(samples) of the rms for one mean of all, and 1.25 times that for the median.
    """
    random, orders, count, rms = np.random.default_rng(1), np.arange(1, 200), 8192, 2e-9
    phases = np.multiply.outer(np.arange(count) / count, 2 * np.pi * orders) + random.uniform(0, 2 * np.pi, orders.size)
    heights = np.cos(phases) @ (1e-6 * orders**-1.3) + random.normal(0, rms, count)
    (tmp_path / "scan.txt").write_text(lines(heights), "utf-8")
    scene = {"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
             "profile": {"kind": "samples", "file": "scan.txt", "unit_h": "m", "unit_x": "m", "spacing": 1e-6,
                         "harmonics": 300},
             "loading": {"control": "penetration", "targets": [1e-7]}}
    facts = {key: value for step in bem.parse_scene(scene, tmp_path).preparation() for key, value in step.items()}
    rows.compare("rms of the noise", facts.get("noise_rms", 0.0), rms, of=Code.BEM, by=Code.EXACT, unit="m",
                 quantity=Quantity.SPECTRUM, uncertainty=2.5 / np.sqrt(count) * rms, source="drawn")
