"""The table of faults: every one still fits the sources exactly once, and its case exists."""

import re
from pathlib import Path

import pytest

from validation.studies.faults.faults import faults

ROOT = Path(__file__).parents[2]
CASES = {
    path.name: set(re.findall(r"^def (test_\w+)", path.read_text(), re.M))
    for path in (ROOT / "validation" / "cases").glob("test_*.py")
}
NAMES = {f"{file}::{name}" for file, names in CASES.items() for name in names}


@pytest.mark.parametrize("fault", faults(), ids=lambda fault: fault.name)
def test_a_fault_fits_and_its_case_exists(fault, tmp_path):
    copy = tmp_path / fault.file
    copy.parent.mkdir(parents=True)
    copy.write_text((ROOT / fault.file).read_text())
    fault.put_into(tmp_path)
    compile(copy.read_text(), fault.file, "exec")
    assert any(fault.case.partition("[")[0] in name for name in NAMES)


def test_a_fault_that_does_not_fit_is_refused_by_name(tmp_path):
    with pytest.raises(ValueError, match=rf"{faults()[0].name}: .* 0 times, not once"):
        faults()[0].put_into(tmp_path)
