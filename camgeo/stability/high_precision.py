"""Access to mpmath, which is imported only when a reference is computed."""

from __future__ import annotations

from typing import Any, Final

from camgeo.errors import CamgeoError

Number = Any
"""A real or complex number of mpmath, which has no type annotations."""

DIGITS: Final = 80
"""Digits of the references. The textbook formulas lose most of them where a lift begins: f = 1e-48
of the 4-5-6-7 polynomial at z = 1e-12 leaves 32 digits of 1 - f; a double needs 16, a change by
half an ulp 16 more."""


def multiprecision() -> Any:
    """mpmath's context `mp`.

    Raises
    ------
    CamgeoError
        If mpmath is not installed.
    """
    try:
        from mpmath import mp
    except ImportError:
        raise CamgeoError(
            "the stability suite needs mpmath for its references, and it is not installed;"
            " `pip install mpmath` brings it"
        ) from None
    return mp
