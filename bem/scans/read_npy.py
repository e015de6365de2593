"""Heights in `.npy` files (NumPy, versions 1 and 2 of the format).

The array holds real numbers, and the file is as long as its header says, to the byte.  An array of one index, or with
one sample along one of two, is a trace; of any other the first index runs along x, so that row j is the column a[:, j].
"""

from __future__ import annotations

from io import BytesIO
from math import prod

import numpy as np
from numpy.lib import format as npy

from bem.geometry.arrays import FloatArray
from bem.scans.scan_file_error import refused

SIGNATURE = b"\x93NUMPY"
REAL = "iuf"  # kinds of numbers in NumPy: integers and floating-point numbers
REAL_NUMBERS = "real numbers, of an integer or floating-point type"
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_npy(content: bytes) -> FloatArray:
    """Return the heights in the bytes of a `.npy` file, (n,) or (n_rows, n).

    ScanFileError for another length than the header says, and for anything but a trace or a map of real numbers.
    """
    stream = BytesIO(content)
    try:
        shape, by_columns, kind = HEADERS[npy.read_magic(stream)](stream)
    except Exception as error:  # of the tokenizer of Python among others
        problem = f"is a .npy file whose header cannot be read: {error}"
        raise refused("file", problem, "a file that numpy.save has written") from error
    if kind.kind not in REAL:
        raise refused("file", f"is a .npy file of type {kind}", REAL_NUMBERS)
    if len(shape) not in (1, 2) or min(shape) < 1:
        raise refused("file", f"is a .npy file of shape {shape}", "heights along one or two indices")
    size, expected = len(content) - stream.tell(), prod(shape) * kind.itemsize
    if size != expected:
        problem = f"is a .npy file with {size} bytes of numbers, where its header says {expected}, of shape {shape}"
        raise refused("file", problem, "a whole file: copy or save it again")
    values = np.frombuffer(content, kind, offset=stream.tell())
    return trace_or_rows(values.reshape(shape, order="F" if by_columns else "C").astype(np.float64))


def trace_or_rows(array: FloatArray) -> FloatArray:
    """Return the heights of an array without lengths, as a trace, (n,), or as the rows of a map, (n_rows, n).

    Examples
    --------
    >>> [trace_or_rows(np.zeros(shape)).shape for shape in ((64, 8), (64, 1), (1, 64))]
    [(8, 64), (64,), (64,)]
    """
    return array.ravel() if 1 in array.shape else array.T
