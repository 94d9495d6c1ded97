"""Banded equations solved by LAPACK, with scipy's wrapper of it and none of `scipy.linalg` else.

That package takes twenty times as long to import as the wrapper: longer than all equations of a
drawing take to be solved.
"""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from typing import Any, Final

import numpy as np

from camgeo.numeric.arrays import FloatArray

WRAPPER: Final = "scipy.linalg._flapack"


def banded(matrix: FloatArray, right: FloatArray, width: int) -> FloatArray:
    """Solution (n,) of the equations with the right sides `right` (n,).

    Parameters
    ----------
    matrix : (2 width + 1, n) the diagonals, the uppermost first, each element in its column.
    width : distance of the outermost diagonals from the middle one.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular.
    """
    # The first rows are for what elimination adds above the uppermost diagonal.
    room = np.zeros((3 * width + 1, matrix.shape[1]))
    room[width:] = matrix
    _, _, found, info = _lapack().dgbsv(width, width, room, right, overwrite_ab=True)
    return _sound(found, info)


def tridiagonal(beside: FloatArray, middle: FloatArray, right: FloatArray) -> FloatArray:
    """Solution (n,) with the diagonals `middle` (n,) and on both sides of it `beside` (n - 1,).

    Raises numpy's LinAlgError if the matrix is not positive definite.
    """
    if len(middle) == 1:  # which LAPACK's wrapper does not take
        return right / middle
    _, _, found, info = _lapack().dptsv(middle, beside, right)
    return _sound(found, info)


def _sound(found: FloatArray, info: int) -> FloatArray:
    if info:
        raise np.linalg.LinAlgError("the matrix is singular or not positive definite")
    return found


def _lapack() -> Any:
    """The wrapper; `scipy.linalg.lapack`, which has its names, if it is not where it was."""
    if WRAPPER in sys.modules:
        return sys.modules[WRAPPER]
    import scipy

    spec = PathFinder.find_spec(WRAPPER, [f"{place}/linalg" for place in scipy.__path__])
    if spec is None or spec.loader is None:
        from scipy.linalg import lapack

        return lapack
    module = sys.modules[WRAPPER] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
