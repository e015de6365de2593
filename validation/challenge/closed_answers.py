"""Answers in closed form: one wave without and with adhesion, its last gap, and a wave with a ripple.

Sources: Westergaard, J. Appl. Mech. 6 (1939) A49; Johnson, Int. J. Solids Struct. 32 (1995) 423; one_patch.py.
With D the amplitude, p* = pi E* D / period, S = sin^2(pi/2 contact fraction), and without adhesion

    p = p* S,   s = D (1 - S + S ln S),   U = p* D (S^2/4 - S^2/2 ln S),   pressure = 2 p* cos v sqrt(S - sin^2 v),
    gap = 2 D (w sqrt(w^2 - S) - S arcosh(w S^-1/2)),   v = pi x / period,   w = |sin v|.

Numbers are from the problem as it is written down.  Uncertainty: rounding.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from validation.cases.exact.one_patch import WAVE
from validation.harness.arrays import FloatArray
from validation.references.one_patch import OnePatch

Given = dict[str, Any]
Answers = dict[str, FloatArray]


def _wave(problem: Given) -> tuple[float, float, float, float]:
    """Amplitude, period, E*, p*."""
    solid, profile = problem["solid"], problem["profile"]
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    depth, period = float(profile["amplitudes"][0]), float(profile["period"])
    return depth, period, modulus, np.pi * modulus * depth / period


def _westergaard(problem: Given) -> Answers:
    depth, period, _, full = _wave(problem)
    share = problem["path"]["targets"] / full

    def at(name: str) -> tuple[FloatArray, float]:
        asked = problem["asked"][name]
        return np.pi * asked["points"] / period, float(share[asked["target"] - 1])

    inside, S = at("pressure_at")
    outside, T = at("gap_at")
    w = np.abs(np.sin(outside))
    return {
        "contact_fraction": 2 / np.pi * np.arcsin(np.sqrt(share)),
        "separation": depth * (1 - share + share * np.log(share)),
        "elastic_energy": full * depth * (share**2 / 4 - share**2 / 2 * np.log(share)),
        "pressure_at": 2 * full * np.cos(inside) * np.sqrt(S - np.sin(inside) ** 2),
        "gap_at": 2 * depth * (w * np.sqrt(w**2 - T) - T * np.arccosh(w / np.sqrt(T))),
    }


def _complete(problem: Given) -> Answers:
    depth, period, _, full = _wave(problem)
    targets = problem["path"]["targets"]
    missing = np.maximum(1 - targets / full, 0.0)
    k = np.arange(2, 40)
    asked = problem["asked"]["pressure_at"]
    return {
        "gap_fraction": 2 / np.pi * np.arcsin(np.sqrt(missing)),
        "separation": depth * np.sum(missing[:, None] ** k / (k * (k - 1.0)), axis=1),  # 1 - S + S ln S
        "pressure_at": targets[asked["target"] - 1] + full * np.cos(2 * np.pi * asked["points"] / period),
    }


def _johnson(problem: Given) -> Answers:
    depth, period, modulus, _ = _wave(problem)
    work = float(problem["adhesion"]["work_of_adhesion"])
    patch = OnePatch(period, modulus, (depth,), work)
    adhesive = np.sqrt(2 * modulus * work / period) * period / (np.pi * modulus)

    def steepness(a: float) -> float:
        """dDelta/da of Delta = D S (1 - ln S) + adhesive sqrt(tan a/2) ln S, S = sin^2 a/2, times two."""
        S, rise, root = np.sin(a / 2) ** 2, np.sin(a), np.sqrt(np.tan(a / 2))
        tension = np.log(S) / (2 * root * np.cos(a / 2) ** 2) + root * rise / S
        return float(-depth * rise * np.log(S) + adhesive * tension)

    fold = float(brentq(steepness, 0.1, 1.5, xtol=1e-15, rtol=1e-15))
    lowest = float(patch.penetration(fold))

    def angle(target: float) -> float:
        return float(brentq(lambda a: float(patch.penetration(a)) - target, fold, 3.0, xtol=1e-15, rtol=1e-15))

    targets = problem["path"]["targets"]
    held = np.array([angle(target) if target >= lowest else 0.0 for target in targets])
    at = np.maximum(held, 1e-3)
    asked = problem["asked"]["gap_at"]
    where = held[asked["target"] - 1]
    pressure = float(patch.mean_pressure(where))
    touched = float(brentq(lambda a: float(patch.penetration(a)), fold, 3.0, xtol=1e-15, rtol=1e-15))
    return {
        "contact_fraction": held / np.pi,
        "mean_pressure": np.where(held > 0, patch.mean_pressure(at), 0.0),
        "elastic_energy": np.where(held > 0, patch.energy(at) + work * at / np.pi, 0.0),
        "gap_at": np.array([patch.gap(where, pressure, 2 * np.pi * x / period) for x in asked["points"]]),
        "pull_off_penetration": np.array([lowest]),
        "pull_off_mean_pressure": patch.mean_pressure([fold]),
        "dissipated_energy": patch.energy([fold]) - patch.energy([touched]),
    }


def _rippled(problem: Given) -> Answers:
    targets = problem["path"]["targets"]
    top = int(np.argmax(targets))
    rising, up = WAVE.loaded(*map(float, targets[: top + 1]))
    falling, down = WAVE.unloaded(up[-1], *map(float, targets[top + 1 :]))
    _, period, modulus, _ = _wave(problem)
    harmonics = np.zeros(int(problem["profile"]["orders"].max()))
    harmonics[problem["profile"]["orders"] - 1] = problem["profile"]["amplitudes"]
    patch = OnePatch(period, modulus, tuple(harmonics.tolist()), problem["adhesion"]["work_of_adhesion"])
    fractions = np.array(up + down) / np.pi
    return {
        "contact_fraction": fractions,
        "separation": float(harmonics.sum()) - patch.penetration(np.pi * fractions),
        "jump_mean_pressures": np.array([jump.pressure for jump in (*rising[1:], *falling)]),
    }


CLOSED: dict[str, Callable[[Given], Answers]] = {
    "westergaard": _westergaard,
    "complete-contact": _complete,
    "johnson-loop": _johnson,
    "rippled-wave": _rippled,
}
