"""Where the certificate stops accepting: a bump in a gap just short of the other body and just beyond it, and the like.

Westergaard's two patches on a wave cos 2x, each half as wide as the wave, leave at x = pi/2 and 3 pi/2 gaps of depth

    g = 2 sqrt(1 - s^2) - 2 s^2 log((1 + sqrt(1 - s^2)) / s),   s^2 = 1/2,

lengths of the wave's amplitude.  A bump B exp(-((x - x_0) / b)^2) on the profile in the middle of one gap is felt
nowhere else.  It is accepted for B below g, refused for B beyond it by twice the limit of the certificate, and the gap
is named.  A series cut short, a penetration that is no number, patches a little too narrow or too deep are refused too.
Dimensionless.
"""

from __future__ import annotations

import numpy as np
from scipy.fft import dct

from bem.audit.certificate import Demands, certify
from bem.audit.verdict import Certificate
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile
from validation.cases.shared.checks import Against, case
from validation.harness.case import Outcome

HALF = np.pi / 4  # half width of each patch
MIDDLES = np.array([np.pi / 2, 3 * np.pi / 2])  # of the gaps behind the patches
DEPTH = float(np.sqrt(2) - np.log(1 + np.sqrt(2)))  # of either gap
WIDTH, ORDERS = 0.15, 90  # of a bump; its harmonics beyond are below 1e-19
LIMIT = Demands().interpenetration
NODES = 60


def _certified(
    bump: float = 0.0, gap: int = 0, nodes: int = NODES, wider: float = 0.0, deeper: float = 0.0
) -> Certificate:
    """The certificate of the two patches, with a bump in a gap, few coefficients, or another width or penetration."""
    order = np.arange(1, ORDERS + 1)
    heights = bump * WIDTH / np.sqrt(np.pi) * np.exp(-((order * WIDTH / 2) ** 2)) * np.exp(1j * order * MIDDLES[gap])
    heights[1] += 1.0
    profile = Profile.from_harmonics(2 * np.pi, order, np.abs(heights), -np.angle(heights))
    t = np.cos((np.arange(NODES) + 0.5) * np.pi / NODES)
    x = HALF * t
    q = 2 * HALF * np.cos(x) * np.sqrt((0.5 - np.sin(x) ** 2) * (1 - t * t)) * 2
    series = (dct(q, type=2) / NODES / np.where(np.arange(NODES) == 0, 2, 1))[:nodes]
    half = HALF * (1 + wider)
    centres = np.array([0.0, np.pi])
    pressure = PatchPressure(centres - half, centres + half, (series, series))
    return certify(profile, pressure, 0.5 * (1 + np.log(2)) + deeper, None)


def _refusals() -> Outcome:
    accepted = {
        "as they are": _certified(),
        "bump short of the other body by half the limit": _certified(DEPTH - LIMIT / 2),
        "in the other gap": _certified(DEPTH - LIMIT / 2, gap=1),
    }
    refused = {
        "interpenetration 2.00e-10 exceeds 1e-10 in the gap behind patch 0": _certified(DEPTH + 2 * LIMIT),
        "interpenetration 2.00e-10 exceeds 1e-10 in the gap behind patch 1": _certified(DEPTH + 2 * LIMIT, gap=1),
        "truncation": _certified(nodes=8),
        "contact residual 1.00e-07": _certified(deeper=1e-7),
        "contact residual 9.53e-08": _certified(wider=1e-7),
        "mean gap less separation nan": _certified(deeper=float("nan")),
    }
    known = Against("exact", "Westergaard's two patches, and a bump as high as the gap is deep")
    named = [any(said.startswith(reason) for said in found.reasons) for reason, found in refused.items()]
    alone = [len(refused[reason].reasons) == 1 for reason in list(refused)[:2]]
    return Outcome(rows=(
        known.count(f"accepted (1: yes): {', '.join(accepted)}", [1.0] * 3, [found.ok for found in accepted.values()]),
        known.count(f"refused with this reason (1: yes): {', '.join(refused)}", [1.0] * len(refused), named),
        known.count("a bump is the only reason (1: yes)", [1.0, 1.0], alone),
    ))  # fmt: skip


CASES = (
    case("refusal-limits", "identities", _refusals,
         "Does the certificate accept what is just within its limits, and refuse and name what is just beyond?",
         r"gap $\ge -10^{-10}$ rms heights, $u = h - h_{\text{max}} + \Delta$ on patches, every figure a number",
         "westergaard1939", "half_space"),
)  # fmt: skip
