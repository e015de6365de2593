"""Named states of the theory and the action to take for each; a silent number is never returned where it has no answer.

| status           | meaning                                                                     |
| ---------------- | --------------------------------------------------------------------------- |
| converged        | one state, fixed point met                                                  |
| complete_contact | A/A0 = 1 to rounding; the barrier at the largest wavenumber is not felt      |
| branches         | contact persists at zero load, where separation, A = 0, is a state too      |
| below_zero       | the work balance gives a negative separation: area and energy only          |
| single_line      | one line only: the theory needs roughness on many scales                    |
| not_converged    | the fixed point was not met; the figures must not be used                   |

sigma_0 <= 0 is bad input: the separation integral diverges at zero load, and the diffusion starts on the barrier.
"""

from __future__ import annotations

from typing import Literal

Status = Literal["converged", "complete_contact", "branches", "below_zero", "single_line", "not_converged"]

ADVICE: dict[Status, str] = {
    "converged": "",
    "complete_contact": "contact is complete to rounding: use the full-contact closed forms of the stress and energy",
    "branches": (
        "adhesion holds contact at zero load (zero_load_contact_fraction), where A = 0 is a state too: the figures are "
        "of the state in contact; the theory does not say at which tension it ends, nor that the surfaces have jumped "
        "into it; a separation below zero is of no use"
    ),
    "below_zero": (
        "the separation is the mean gap and cannot be negative: with so much adhesion the energies of the theory are "
        "not those of one branch of states; do not use the separation, and take the contact fraction as an estimate"
    ),
    "single_line": (
        "a single line is no self-affine roughness and the diffusion of stress does not describe it: "
        "use Westergaard's or Johnson's exact solution of the sinusoid"
    ),
    "not_converged": (
        "the effective work of adhesion did not converge: raise max_iterations or lower the work of adhesion"
    ),
}


def advice_for(status: Status) -> str:
    """Return the action to take for a status; empty if no action is needed.

    Examples
    --------
    >>> advice_for("single_line")[:13]
    'a single line'
    """
    return ADVICE[status]
