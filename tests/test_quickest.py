"""What bash .ci/run repeats on other kernels: the quickest tests, by how long all of them took."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from quickest import slowest

SUPPORT = Path(__file__).parent / "support"
THREE = """import time
def test_a(): pass
def test_b(): time.sleep(0.5)
def test_c(): pass
"""


@pytest.mark.parametrize(("share", "left_out"), [(0.0, "abc"), (0.3, "bc"), (0.35, "b"), (0.9, "b"), (1.0, "")])
def test_the_quickest_are_kept_up_to_a_share(share, left_out):
    assert slowest({"a": 1.0, "b": 7.0, "c": 2.5}, share) == set(left_out)


@pytest.mark.parametrize("workers", [[], pytest.param(["-n", "2"], marks=pytest.mark.slow)])
def test_seconds_of_one_run_choose_the_tests_of_the_next(tmp_path, workers):
    (tmp_path / "test_three.py").write_text(THREE)
    (tmp_path / "pytest.ini").touch()
    command = [sys.executable, "-m", "pytest", "-p", "quickest", *workers, "--seconds", "seconds.json"]
    environment = os.environ | {"PYTHONPATH": str(SUPPORT), "PYTEST_ADDOPTS": ""}

    def said(*options):
        run = subprocess.run([*command, *options], cwd=tmp_path, env=environment, capture_output=True, text=True)
        return run.stdout.splitlines()[-1]

    assert "3 passed" in said()
    assert "2 passed" in said("--quickest", "0.5")
