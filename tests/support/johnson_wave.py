"""Johnson's contact of the wave cos x with adhesion (1995), and Westergaard's without, alpha = 0: closed forms."""

import numpy as np

from bem.geometry.patches import Patches, PatchPressure


def shares(fraction, alpha):
    """Mean pressure sin^2(psi) without adhesion and what adhesion takes from it, psi = pi / 2 contact fraction."""
    psi = np.pi * np.asarray(fraction) / 2
    return np.sin(psi) ** 2, alpha * np.sqrt(np.tan(psi))


def penetration_of(fraction, alpha=0.0):
    share, pulled = shares(fraction, alpha)
    return share * (1 - np.log(share)) + pulled * np.log(share)


def load_of(fraction, alpha=0.0):
    return 2 * np.pi * np.subtract(*shares(fraction, alpha))


def patch_of(fraction):
    return Patches(np.array([-np.pi * fraction]), np.array([np.pi * fraction]))


def gap_of(x, fraction, alpha=0.0):
    """The pressure continued past the edge is the slope of the gap; its integral with s = sin(x/2)."""
    s, sine = np.abs(np.sin(x / 2)), np.sin(np.pi * fraction / 2)
    root = np.sqrt(s**2 - sine**2)
    logarithm = np.log((s + root) / sine)
    return 2 * (s * root - sine**2 * logarithm) + 2 * shares(fraction, alpha)[1] * logarithm


def pressure_of(fraction, alpha=0.0, nodes=400):
    """The pressure as a series by its own nodes, and as a function of x."""
    half = np.pi * fraction
    t = np.cos((np.arange(nodes) + 0.5) * np.pi / nodes)

    def sigma(x):
        root = np.sqrt(np.sin((half - x) / 2) * np.sin((half + x) / 2))
        return 2 * np.cos(x / 2) * root - shares(fraction, alpha)[1] * np.cos(x / 2) / root

    q = half * np.sqrt(1 - t * t) * sigma(half * t)
    charge = np.cos(np.outer(np.arange(nodes), np.arccos(t))) @ q * (2 / nodes)
    charge[0] /= 2
    return PatchPressure(np.array([-half]), np.array([half]), (charge,)), sigma
