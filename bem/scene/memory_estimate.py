"""Estimate of the unknowns and the memory that a scene needs, before it is solved.

Persson's theory, J. Chem. Phys. 115 (2001) 3840, says what fraction f of the period a mean pressure p brings into
contact: f = erf(p / sqrt(2 V)), where V = sum_m p_m^2 / 2 and p_m is the pressure that presses wave m flat.  A
separation s stands for the p at which the mean gap of the theory is s: s = int_p^inf dU/dp' / p' dp', where
U = sum_m p_m h_m / 4 erf(p' / sqrt(2 V_m)) and V_m sums up to wave m.  Adhesion adds the tension sqrt(2 E* w / (pi c))
that opens a crack of half length c, a quarter of a mean wave.

With H harmonics there are 0.5 H (1 - f)^0.7 contacts, fewer below f = 0.6, and the widest has 6.5 times the mean width.
Memory grows with H, with the unknowns, and with the nodes on the widest contact; with adhesion by tables of the widest
contact, on a layer with the square of all unknowns.  These numbers were measured on self-affine profiles of 300 to
20,000 harmonics: memory holds within a factor of two, unless so few gaps are left that contact may as well be
complete, which needs less.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
import psutil
from scipy.special import erf

from bem.geometry.arrays import FloatArray
from bem.geometry.ranges import Mistake
from bem.scene.elastic_tables import elastic_effects
from bem.scene.scene import Scene
from bem.scene.scene_error import SceneError

BASE, PER_HARMONIC, PER_UNKNOWN, PER_NODE, PER_PAIR = 8e7, 1.8e4, 4500.0, 6000.0, 250.0  # format: bytes, measured
ADHESIVE = 4.5e7, 1.2e8  # format: bytes, measured: of modules, and of tables of a contact as wide as the period
FEWEST_GAPS = 0.3  # format: gaps, below which contact is complete


@dataclass(frozen=True)
class MemoryEstimate:
    """Largest number of unknowns at any target, and memory in bytes."""

    unknowns: int
    bytes: float


def memory_estimate(scene: Scene) -> MemoryEstimate:
    """Return the unknowns and the memory that a scene needs.

    Examples
    --------
    >>> from bem.scene.scene import parse_scene
    >>> scene = parse_scene({
    ...     "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "loading": {"control": "penetration", "targets": [1e-5]},
    ... })
    >>> memory_estimate(scene).bytes < 2e8
    True
    """
    surface = scene.surface()
    count = surface.max_order
    fixed = BASE + PER_HARMONIC * count
    if surface.is_flat:
        return MemoryEstimate(0, fixed)
    share = _contact_fractions(scene)
    if scene.adhesion is not None:  # the path passes all fractions below the largest
        share = np.minimum(np.max(share), np.linspace(0.01, 1, 100))
    gaps = np.maximum(0.5 * count * (1 - share) ** 0.7, FEWEST_GAPS)
    if scene.adhesion is None:
        share = np.where(gaps > FEWEST_GAPS, share, 0.0)  # complete contact has no unknowns
    contacts = np.maximum(gaps * np.minimum(1, 1.6 * share), 1)
    unknowns = 17 * contacts * (2 * gaps / count) ** (-4 / 7)
    nodes = 7.5 * count * np.minimum(1, 6.5 * share / gaps)
    memory = fixed + PER_UNKNOWN * unknowns + PER_NODE * nodes
    if scene.adhesion is not None:
        memory += ADHESIVE[0] + ADHESIVE[1] * share
    if scene.layer is not None:
        width = surface.period * share / contacts / scene.layer.thickness
        unknowns = np.maximum(unknowns, contacts * np.minimum(7 * width, 12 * np.sqrt(width)))
        memory += PER_PAIR * unknowns**2
    return MemoryEstimate(round(np.max(unknowns)), float(np.max(memory)))


def refuse_beyond_memory(scene: Scene) -> None:
    """Raise SceneError if a scene needs more memory than this machine has."""
    need, present = memory_estimate(scene), psutil.virtual_memory().total
    if need.bytes > present:
        harmonics = f"{scene.surface().max_order} need about {need.bytes / 1e9:.2g} GB of memory"
        allowed = f"fewer, or targets further from complete contact: this machine has {present / 1e9:.2g} GB"
        raise SceneError([Mistake("profile.harmonics", harmonics, allowed)])


def _contact_fractions(scene: Scene) -> FloatArray:
    """Return the contact fraction at each target."""
    loading, surface = scene.loading, scene.surface()
    if loading.initial == "complete_contact":
        return np.ones(1)
    modulus = scene.solid.plane_strain_modulus
    waves = surface.q0 * surface.orders
    flat = modulus * waves * np.abs(surface.amplitudes) / 2  # p_m, Pa
    for effect in elastic_effects(scene).values():
        flat /= effect.ratio(surface.orders)
    variance = np.cumsum(flat**2) / 2
    pressures = np.array(loading.targets)
    if loading.control != "mean_pressure":
        separations = pressures if loading.control == "separation" else surface.max_height - pressures
        tried = np.geomspace(1e-6, 20, 100) * np.sqrt(variance[-1])
        energies = [np.sum(flat * np.abs(surface.amplitudes) / 4 * erf(p / np.sqrt(2 * variance))) for p in tried]
        gaps = np.cumsum((np.diff(energies) / np.sqrt(tried[1:] * tried[:-1]))[::-1])[::-1]
        pressures = np.interp(-separations, -gaps, tried[:-1])
    if scene.adhesion is not None:
        crack = pi / 2 * surface.rms_slope / surface.rms_curvature
        pressures = pressures + np.sqrt(2 * modulus * scene.adhesion.work_of_adhesion / (pi * crack))
    return np.asarray(erf(np.maximum(pressures, 0) / np.sqrt(2 * variance[-1])))
