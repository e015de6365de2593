"""Scans of one wave, in other units, forms and places, against Westergaard's contact of it; noise of a rough one.

h = D cos(2 pi x / period), D = 100 um, period 10 mm, 64 samples; E = 1 MPa, nu = 0.5, no adhesion.  Closed forms as in
test_johnson.py: contact fraction 2 psi / pi at the penetration D S (1 - ln S), S = sin^2 psi.
"""

import numpy as np
import pytest

import bem
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
    yield "row of a map", lines(*np.array([0.5 * upright, wave(PLACE), upright - 3.0]).T), units | {"row": 1} | spacing


SCANS = {name: (text, keys) for name, text, keys in scans()}


@pytest.mark.quick
@pytest.mark.parametrize("name", SCANS)
def test_wave(rows, tmp_path, name):
    """Does a scan of a wave, whatever its form, give the contact of the wave?"""
    text, keys = SCANS[name]
    (tmp_path / "scan.txt").write_text(text, "utf-8")
    psi = FRACTIONS * np.pi / 2
    scene = {"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
             "profile": {"kind": "samples", "file": "scan.txt"} | keys,
             "loading": {"control": "penetration", "targets": WAVE.penetration(psi).tolist()}}
    states = bem.solve(bem.parse_scene(scene, tmp_path)).targets
    both = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939")
    both.compare("contact fraction", values(states, "contact_fraction"), FRACTIONS, quantity=Quantity.AREA,
                 uncertainty=estimates(states, "contact_fraction"), required=1e-10, because=TEN_DIGITS)
    both.compare("mean pressure", values(states, "mean_pressure"), WAVE.mean_pressure(psi), unit="Pa",
                 quantity=Quantity.PRESSURE, uncertainty=estimates(states, "mean_pressure"),
                 required=1e-10 * WAVE.full_contact_pressure, because=TEN_DIGITS)


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
