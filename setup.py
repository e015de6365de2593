"""The extension of bem/compiled, left out, with a warning, where there is no C compiler; the rest: pyproject.toml."""

from pathlib import Path

import numpy
from Cython.Build import cythonize
from setuptools import Extension, setup

FOLDER = Path("bem/compiled")
SOURCES = [FOLDER / "linecontact_kernels.pyx", *sorted(FOLDER.glob("*.c"))]
EXTENSION = Extension(
    "linecontact_kernels",  # no part of bem: a checkout that is not installed in place finds it too
    [path.as_posix() for path in SOURCES],
    include_dirs=[FOLDER.as_posix(), numpy.get_include()],
    depends=[path.as_posix() for path in sorted(FOLDER.glob("*.[hp]*"))],
    define_macros=[("NPY_NO_DEPRECATED_API", "NPY_2_0_API_VERSION")],
    extra_compile_args=["-O3"],
)
(CYTHONIZED,) = cythonize([EXTENSION], build_dir="build", include_path=[FOLDER.as_posix()])
CYTHONIZED.optional = True  # which cythonize does not hand on

setup(ext_modules=[CYTHONIZED])
