"""Where the problems come from: each as a record, from which problem.toml is written in plain SI numbers.

A profile is h(x) = sum_m h_m cos(2 pi m x / period + phi_m), given by orders, amplitudes and phases, and again by its
heights at x = k period / n.  Self-affine ones: h_m proportional to m^-(hurst + 1/2), sum h_m^2 / 2 = rms_height^2,
phases uniform in (-pi, pi) from `numpy.random.default_rng(seed)`.  The scan is a random walk with a tilt: its record is
not periodic, so that a jump stands at the end of the period, as in a measured one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validation.harness.arrays import FloatArray

Harmonics = tuple[NDArray[np.int64], FloatArray, FloatArray]
PERIOD = 0.01
LEAST_SAMPLES = 64

MEANINGS: dict[str, tuple[str, str]] = {
    "contact_fraction": ("", "projected contact area over nominal area, at every target"),
    "gap_fraction": ("", "1 - contact fraction, at every target"),
    "mean_pressure": ("Pa", "force per nominal area, at every target"),
    "separation": ("m", "mean gap over the period, at every target"),
    "elastic_energy": (
        "J/m^2",
        "per nominal area, without the uniform compression of a layer, at every target",
    ),
    "patches": ("", "number of contacts in a period, at every target"),
    "edges": (
        "m",
        "where contacts begin and end, a1, b1, a2, b2, ..., a in [0, period) ascending, at the target (counted from 1)",
    ),
    "stress_intensity_max": ("Pa m^1/2", "largest K over all edges, at every target"),
    "pressure_at": ("Pa", "contact pressure at the points, at the target (counted from 1)"),
    "gap_at": ("m", "gap at the points, at the target (counted from 1)"),
    "displacement_amplitudes": (
        "m",
        "|u_m| of the displaced surface u(x) = mean + sum u_m cos(2 pi m x / period + psi_m), at the orders, "
        "at the target (counted from 1)",
    ),
    "pull_off_penetration": ("m", "highest point of the profile less separation where the last contact breaks"),
    "pull_off_mean_pressure": ("Pa", "there, before it breaks"),
    "dissipated_energy": ("J/m^2", "sum over all jumps of the path of the energy that each sets free"),
    "jump_mean_pressures": (
        "Pa",
        "at which contact jumps, in order; left out are first touch and what releases less than 1e-3 of the work "
        "of adhesion",
    ),
}


@dataclass(frozen=True)
class Pose:
    """A problem before it is written down."""

    name: str
    title: str
    difficulty: str
    hard_part: str
    harmonics: Harmonics  # orders, amplitudes in m, phases, (n,) each
    control: str  # "mean_pressure", "separation" or "penetration"
    targets: tuple[float, ...]  # Pa or m, visited in this order from surfaces apart
    asked: tuple[Any, ...]  # names of MEANINGS, or (name, {"target": which, from 1, "points" or "orders": at which})
    youngs_modulus: float = 1e6
    poisson_ratio: float = 0.5
    thickness: float | None = None
    work_of_adhesion: float | None = None
    slope_term: bool = False
    level: str = "quick"  # the level at which a test makes the answers again


def self_affine(hurst: float, harmonics: int, seed: int, rms: float = 50e-6) -> Harmonics:
    """Orders, amplitudes and phases, (harmonics,) each."""
    m = np.arange(1, harmonics + 1)
    shape = m ** -(hurst + 0.5)
    phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, harmonics)
    return m, shape * rms / np.sqrt(np.sum(shape**2) / 2), phases


def scan(points: int, harmonics: int, seed: int, rms: float) -> Harmonics:
    """Harmonics of a tilted random walk, as a discrete Fourier transform gives them."""
    random = np.random.default_rng(seed)
    heights = np.cumsum(random.standard_normal(points)) + 0.05 * np.arange(points)
    modes = np.fft.rfft(heights)[1 : harmonics + 1]
    amplitudes = np.abs(modes)
    return np.arange(1, harmonics + 1), amplitudes * rms / np.sqrt(np.sum(amplitudes**2) / 2), np.angle(modes)


def wave(orders: Iterable[int], amplitudes: Iterable[float], phases: Iterable[float]) -> Harmonics:
    """Orders, amplitudes and phases as arrays."""
    return np.array([*orders]), np.array([*amplitudes]), np.array([*phases])


STATES = ("contact_fraction", "mean_pressure", "elastic_energy", "patches")
LOADED = ("contact_fraction", "separation", "elastic_energy", "patches")
CRESTS = (20e-6, 50e-6, 10e-6)
MODULUS = 1e6 / (1 - 0.5**2)
FULL = np.pi * MODULUS * 1e-4 / PERIOD  # closes the wave of 1e-4 m


def poses() -> dict[str, Pose]:
    """All, by their names, easy ones first."""
    one = wave([1], [1e-4], [0.0])
    two = wave([1, 2, 3], CRESTS, [0.3, -0.4, 1.0])
    three = wave([1, 2, 3, 4], [1e-5, 1.5e-5, 4e-5, 5e-6], [0.3, -0.4, 1.0, 2.0])
    all_poses = (
        Pose("westergaard", "One wave without adhesion", "easy", "nothing, it has a closed form", one, "mean_pressure",
             tuple(FULL * share for share in (0.05, 0.25, 0.5, 0.9)),
             ("contact_fraction", "separation", "elastic_energy",
              ("pressure_at", {"target": 3, "points": [0.0, 0.001, 0.002]}),
              ("gap_at", {"target": 3, "points": [0.003, 0.004, 0.005]}))),
        Pose("complete-contact", "The last gap of one wave, and complete contact", "easy",
             "a gap that vanishes like the root of the missing load", one, "mean_pressure",
             tuple(FULL * (1 - missing) for missing in (1e-2, 1e-4, 1e-6, -0.2)),
             ("gap_fraction", "separation", ("pressure_at", {"target": 4, "points": [0.0, 0.0025, 0.005]}))),
        Pose("johnson-loop", "One wave with adhesion, loaded and pulled off", "easy",
             "edges with true singularities, a jump into contact, pull-off", one, "penetration",
             (2e-5, 6e-5, 9e-5, 6e-5, 2e-5, 0.0, -6e-5),
             ("contact_fraction", "mean_pressure", "elastic_energy",
              ("gap_at", {"target": 2, "points": [0.004, 0.005]}), "pull_off_penetration", "pull_off_mean_pressure",
              "dissipated_energy"), work_of_adhesion=0.15),
        Pose("rippled-wave", "A wave with a ripple, loaded and unloaded under load control", "medium",
             "contact jumps from ripple to ripple, back at other loads", wave([1, 30], [1e-4, 2e-6], [0.0, 0.0]),
             "mean_pressure", (0.0, 3e3, 1e4, 1.4e4, 1e4, 3e3, -1e3),
             ("contact_fraction", "separation", "jump_mean_pressures"), work_of_adhesion=0.062),
        Pose("two-crests-thick", "Two unequal crests on a layer twice as thick as the period, nu = 0.3", "medium",
             "two contacts that press on each other", two, "penetration", (5e-5,),
             (*STATES, ("edges", {"target": 1}), "stress_intensity_max"), poisson_ratio=0.3, thickness=0.02,
             work_of_adhesion=0.03, slope_term=True),
        Pose("three-crests", "Three crests on a layer a fifth of the period thick, nu = 0.49", "medium",
             "a layer that is nearly incompressible", three, "penetration", (5e-5,),
             (*STATES, ("edges", {"target": 1}), "stress_intensity_max"), poisson_ratio=0.49, thickness=0.002,
             work_of_adhesion=0.03, slope_term=True),
        Pose("two-crests-thin", "Two crests on a layer a twentieth of the period thick, nu = 0.5", "hard",
             "thin and incompressible: elements lock, grids need many points through the layer", two, "penetration",
             (6e-5,), (*STATES, ("edges", {"target": 1}), "stress_intensity_max"), thickness=5e-4,
             work_of_adhesion=0.03, slope_term=True),
        Pose("rough-100", "Self-affine profile without adhesion, 100 harmonics", "medium", "many contacts",
             self_affine(0.7, 100, 1), "mean_pressure", (2e3, 6e3, 1.5e4), LOADED),
        Pose("rough-1000", "Self-affine profile without adhesion, 1000 harmonics", "hard",
             "contacts a thousandth of the period wide", self_affine(0.7, 1000, 2009), "mean_pressure",
             tuple(share * MODULUS for share in (0.005, 0.01, 0.02)), LOADED),
        Pose("near-complete", "Rough without adhesion, nearly in complete contact", "medium",
             "what is left are gaps, thin and few", self_affine(0.8, 50, 4), "mean_pressure", (6e4, 1e5, 1.3e5),
             ("gap_fraction", "separation", "patches")),
        Pose("rough-adhesion", "Self-affine profile with adhesion, loaded and unloaded", "hard",
             "the state depends on the path; jumps dissipate", self_affine(0.7, 60, 1), "separation",
             (70e-6, 50e-6, 35e-6, 50e-6, 70e-6, 100e-6),
             (*STATES, "pull_off_penetration", "pull_off_mean_pressure", "dissipated_energy"),
             work_of_adhesion=0.03),
        Pose("scan", "A profile like a measured one, with a jump at the end of its period, and adhesion", "hard",
             "steep at one place; the spectrum of the displaced surface", scan(256, 100, 5, 20e-6), "separation",
             (40e-6, 30e-6, 20e-6, 12e-6),
             (*STATES, ("displacement_amplitudes", {"target": 4, "orders": [1, 2, 4, 8, 16, 32]})),
             work_of_adhesion=0.01, slope_term=False),
        Pose("thin-incompressible", "Rough on a layer a fiftieth of the period thick, nu = 0.5, loaded and unloaded",
             "hard", "the layer hardly yields, each contact is on its own", self_affine(0.7, 20, 1), "separation",
             (80e-6, 60e-6, 40e-6, 60e-6, 80e-6, 200e-6), (*STATES, "dissipated_energy"), thickness=2e-4,
             work_of_adhesion=0.03, slope_term=True),
        Pose("steep", "Hurst exponent 0.2 with adhesion and the slope term", "hard", "slopes of order one",
             self_affine(0.2, 60, 2), "separation", (90e-6, 75e-6, 60e-6), STATES, work_of_adhesion=0.1,
             slope_term=True),
        Pose("paper-profile", "The paper's profile: 1000 harmonics with adhesion, loaded", "hard",
             "hundreds of contacts on a path", self_affine(0.7, 1000, 0), "separation", (60e-6, 45e-6, 30e-6), STATES,
             work_of_adhesion=0.03, slope_term=True, level="full"),
    )  # fmt: skip
    return {pose.name: pose for pose in all_poses}
