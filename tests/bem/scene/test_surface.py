"""Profile of a resolved [profile]."""

import pytest

from bem.scene.surface import surface_of


def test_samples_without_their_scan_are_refused_with_what_has_them():
    with pytest.raises(ValueError, match=r'profile\.kind = "samples": .*; allowed: the scan .*surface\(\)'):
        surface_of({"kind": "samples", "file": "scan.csv", "harmonics": 5, "period": 1e-3}, None)
