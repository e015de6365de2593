"""Scans: formats accepted, and every way a file can be wrong."""

import numpy as np
import pytest

from bem.scene.scan_file import ScanFileError, read_scan

GOOD = "0 1\n1 2\n2 3\n3 2\n"


def scan_of(tmp_path, text):
    path = tmp_path / "scan.csv"
    path.write_text(text)
    return read_scan(path)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(GOOD, id="blanks"),
        pytest.param(GOOD.replace(" ", ","), id="commas"),
        pytest.param(GOOD.replace(" ", " ; "), id="semicolons"),
        pytest.param(GOOD.replace(" ", "\t"), id="tabs"),
        pytest.param("x, h\n" + GOOD, id="heading"),
        pytest.param("# metres\n\n" + GOOD + "\n", id="comment and empty lines"),
        pytest.param("\ufeff" + GOOD.replace("\n", "\r\n"), id="byte order mark, other line ends"),
    ],
)
def test_format_is_read(text, tmp_path):
    scan = scan_of(tmp_path, text)
    np.testing.assert_array_equal(scan.x, [0, 1, 2, 3])
    np.testing.assert_array_equal(scan.h, [1, 2, 3, 2])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        pytest.param("", "0 samples", id="empty"),
        pytest.param("0 1\n1 2\n", "2 samples", id="too short"),
        pytest.param(GOOD + "4\n", "line 5 has 1 column", id="ragged"),
        pytest.param(GOOD + "4 5 6\n", "line 5 has 3 columns", id="three columns"),
        pytest.param(GOOD + "4 nan\n", "line 5", id="nan"),
        pytest.param(GOOD + "inf 4\n", "line 5", id="inf"),
        pytest.param(GOOD + "4 high\n", "line 5", id="text"),
        pytest.param("x h\nm m\n" + GOOD, "line 2", id="two headings"),
        pytest.param("0 1\n2 2\n1 3\n", "not increasing", id="backward"),
        pytest.param("0 1\n1 2\n1 3\n", "not increasing", id="repeated"),
        pytest.param("0 1\n1 2\n2.01 3\n3 2\n", "not uniform", id="uneven"),
    ],
)
def test_wrong_file_is_told(text, said, tmp_path):
    with pytest.raises(ScanFileError, match=said):
        scan_of(tmp_path, text)


def test_missing_file_is_told(tmp_path):
    with pytest.raises(ScanFileError, match="cannot be read"):
        read_scan(tmp_path / "nowhere.csv")


def test_all_sorts_of_mistakes_are_told_at_once(tmp_path):
    with pytest.raises(ScanFileError) as caught:
        scan_of(tmp_path, GOOD + "4\n5 nan\n")
    assert len(caught.value.mistakes) == 2


def test_many_bad_lines_are_counted(tmp_path):
    with pytest.raises(ScanFileError, match="and 7 more lines"):
        scan_of(tmp_path, "1 nan\n" * 10)


def test_positions_rounded_below_the_limit_are_uniform(tmp_path):
    assert scan_of(tmp_path, "0 1\n1 2\n2.0004 3\n3 2\n").spacing == 1.0
