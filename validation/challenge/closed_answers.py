"""Answers in closed form: one wave without and with adhesion, its last gap, and a wave with a ripple.

Sources: Westergaard, J. Appl. Mech. 6 (1939) A49; Johnson, Int. J. Solids Struct. 32 (1995) 423; their formulas in
closed_forms.py, those of a ripple in one_patch.py.  Next to complete contact, where 1 - S is given, by its series.

Numbers are from the problem as it is written down.  Uncertainty: rounding.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from validation.harness.arrays import FloatArray
from validation.references.closed_forms import Sinusoid
from validation.references.one_patch import OnePatch
from validation.references.rippled_wave import WAVE

Given = dict[str, Any]
Answers = dict[str, FloatArray]


def _wave(problem: Given) -> Sinusoid:
    """The wave of a problem, with its adhesion."""
    solid, profile = problem["solid"], problem["profile"]
    bare = Sinusoid(float(profile["amplitudes"][0]), float(profile["period"]), **solid, alpha=0.0)
    work = problem.get("adhesion", {}).get("work_of_adhesion", 0.0)
    return replace(bare, alpha=np.sqrt(2 * bare.modulus * work / bare.wavelength) / bare.full_contact_pressure)


def _westergaard(problem: Given) -> Answers:
    wave, targets = _wave(problem), problem["path"]["targets"]
    psi = np.arcsin(np.sqrt(targets / wave.full_contact_pressure))
    inside, outside = problem["asked"]["pressure_at"], problem["asked"]["gap_at"]
    return {
        "contact_fraction": 2 / np.pi * psi,
        "separation": wave.amplitude - wave.penetration(psi),
        "elastic_energy": np.array([wave.elastic_energy(angle) for angle in psi]),
        "pressure_at": wave.pressure(inside["points"], psi[inside["target"] - 1]),
        "gap_at": wave.gap(outside["points"], psi[outside["target"] - 1]),
    }


def _complete(problem: Given) -> Answers:
    wave, targets, asked = _wave(problem), problem["path"]["targets"], problem["asked"]["pressure_at"]
    missing = np.maximum(1 - targets / wave.full_contact_pressure, 0.0)
    k, phase = np.arange(2, 40), 2 * np.pi * asked["points"] / wave.wavelength
    return {
        "gap_fraction": 2 / np.pi * np.arcsin(np.sqrt(missing)),
        "separation": wave.amplitude * np.sum(missing[:, None] ** k / (k * (k - 1.0)), axis=1),  # 1 - S + S ln S
        "pressure_at": targets[asked["target"] - 1] + wave.full_contact_pressure * np.cos(phase),
    }


def _johnson(problem: Given) -> Answers:
    wave, targets, asked = _wave(problem), problem["path"]["targets"], problem["asked"]["gap_at"]
    tension = wave.alpha * wave.wavelength * wave.full_contact_pressure / (np.pi * wave.modulus)

    def steepness(psi: float) -> float:
        """dDelta/dpsi."""
        S, root = np.sin(psi) ** 2, np.sqrt(np.tan(psi))
        adhesive = np.log(S) / (2 * root * np.cos(psi) ** 2) + 2 * root / np.tan(psi)
        return float(-wave.amplitude * np.sin(2 * psi) * np.log(S) + tension * adhesive)

    def total_energy(psi: float) -> float:
        return wave.elastic_energy(psi) - wave.work_of_adhesion * 2 * psi / np.pi

    fold = float(brentq(steepness, 0.05, 0.75, xtol=1e-15, rtol=1e-15))
    lowest, touched = float(wave.penetration(fold)), wave.angle(0.0, fold, 1.5)
    held = np.array([wave.angle(target, fold, 1.5) if target >= lowest else 0.0 for target in targets])
    at = np.maximum(held, 1e-3)
    return {
        "contact_fraction": 2 / np.pi * held,
        "mean_pressure": np.where(held > 0, wave.mean_pressure(at), 0.0),
        "elastic_energy": np.where(held > 0, [wave.elastic_energy(psi) for psi in at], 0.0),
        "gap_at": wave.gap(asked["points"], held[asked["target"] - 1]),
        "pull_off_penetration": np.array([lowest]),
        "pull_off_mean_pressure": np.array([wave.mean_pressure(fold)]),
        "dissipated_energy": np.array([total_energy(fold) - total_energy(touched)]),
    }


def _rippled(problem: Given) -> Answers:
    targets = problem["path"]["targets"]
    top = int(np.argmax(targets))
    rising, up = WAVE.loaded(*map(float, targets[: top + 1]))
    falling, down = WAVE.unloaded(up[-1], *map(float, targets[top + 1 :]))
    wave, profile = _wave(problem), problem["profile"]
    harmonics = np.zeros(int(profile["orders"].max()))
    harmonics[profile["orders"] - 1] = profile["amplitudes"]
    work = problem["adhesion"]["work_of_adhesion"]
    patch = OnePatch(wave.wavelength, wave.modulus, tuple(harmonics.tolist()), work)
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
