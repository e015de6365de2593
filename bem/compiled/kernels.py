"""Which kernels run: those in C where they were built, else the functions in NumPy that they mirror.

A function marked `mirrored` is the reference.  The extension linecontact_kernels holds a kernel of its name that takes
the same arguments and gives the same to rounding: Python calls what stands in the .pyx, which calls the C files here.
`pip install` builds it where a C compiler is.  Where it fits these sources and the BLAS and LAPACK of the SciPy that is
installed, the kernel stands in for the reference from the time at which it is imported.  LINECONTACT_KERNELS=numpy in
the environment asks for the references, =compiled for an error where the kernels are not there.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any, TypeVar

VARIABLE = "LINECONTACT_KERNELS"
EXTENSION = "linecontact_kernels"
INTERFACE = "10"  # the number that the extension names too: raised when arguments or formulas change
REFERENCES: dict[str, Callable[..., Any]] = {}
F = TypeVar("F", bound=Callable[..., Any])


def compiled(asked: str) -> ModuleType | None:
    """The extension; None where it is not asked for or not there.

    Parameters
    ----------
    asked : {"", "numpy", "compiled"}

    Raises
    ------
    ImportError
        Asked for, but not built, or fitting neither these sources nor the SciPy that is installed.
    ValueError
        Another word.
    """
    if asked not in ("", "numpy", "compiled"):
        raise ValueError(f"{VARIABLE}: {asked!r} must be numpy, compiled or empty")
    if asked == "numpy":
        return None
    try:
        found = import_module(EXTENSION)
        if found.INTERFACE != INTERFACE:
            raise ImportError(f"{EXTENSION}: built from other sources, install again")
    except ImportError:
        if asked == "compiled":
            raise
        return None
    return found


CORE = compiled(os.environ.get(VARIABLE, ""))
IN_USE = "NumPy" if CORE is None else "compiled"


def mirrored(reference: F) -> F:
    """The kernel that mirrors a function, where there is one; else the function."""
    REFERENCES[reference.__name__] = reference
    kernel: F = getattr(CORE, reference.__name__, reference)
    return kernel
