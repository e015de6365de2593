"""setuptools with the extension of bem/compiled, left out, with a warning, where there is no C compiler.

NumPy's headers are found when it is built, which pyproject.toml cannot say.
"""

from functools import partial
from pathlib import Path

import numpy
import setuptools
from Cython.Build import cythonize
from setuptools.build_meta import *  # noqa: F403  the hooks

FOLDER = Path("bem/compiled")
SOURCES = [FOLDER / "linecontact_kernels.pyx", *sorted(FOLDER.glob("*.c"))]
EXTENSION = setuptools.Extension(
    "linecontact_kernels",  # no part of bem: a checkout that is not installed in place finds it too
    [path.as_posix() for path in SOURCES],
    include_dirs=[FOLDER.as_posix(), numpy.get_include()],
    depends=[".packaging/backend.py", *(path.as_posix() for path in sorted(FOLDER.glob("*.[hp]*")))],
    define_macros=[("NPY_NO_DEPRECATED_API", "NPY_2_0_API_VERSION")],
    extra_compile_args=["-O3"],
)
(CYTHONIZED,) = cythonize([EXTENSION], build_dir="build", include_path=[FOLDER.as_posix()])
CYTHONIZED.optional = True  # which cythonize does not hand on

setuptools.setup = partial(setuptools.setup, ext_modules=[CYTHONIZED])
