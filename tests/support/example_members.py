"""Small ensembles, and what runs them in a process of its own that a test may kill; importable by worker processes."""

import sys
from pathlib import Path

from validation.harness.ensemble import Member, run_ensemble


def members(count, harmonics=3, seed=0):
    return [_member(k, harmonics, seed + k) for k in range(count)]


def _member(k, harmonics, seed):
    profile = {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": harmonics}
    return Member(
        name=f"seed-{k:02d}",
        scene={
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": profile | {"seed": seed},
            "adhesion": {"work_of_adhesion": 0.03},
            "loading": {"control": "separation", "targets": [6e-5, 3e-5]},
            "output": {"spectra": True},
        },
    )


if __name__ == "__main__":
    run_ensemble(
        members(int(sys.argv[2]), int(sys.argv[3])), Path(sys.argv[1]), 2, lambda note: print(note.text, flush=True)
    )
