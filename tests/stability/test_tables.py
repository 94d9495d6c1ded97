"""The exact splines of the suite, compared with their definition and with scipy's."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.interpolate import make_interp_spline

from tests.stability.series import polynomial, variable
from tests.stability.tables import exact_spline

DIGITS = 50

X = (0.0, 0.5, 0.625, 1.5, 2.0)
Y = (0.0, 1.25, 1.5, -0.5, 0.0)

ENDS: dict[str, Any] = {
    "rest": ([(1, 0.0), (2, 0.0)], [(1, 0.0), (2, 0.0)]),
    "free": ([(3, 0.0), (4, 0.0)], [(3, 0.0), (4, 0.0)]),
    "periodic": "periodic",
}


@pytest.mark.parametrize("kind", ENDS)
def test_the_spline_is_scipy_s(kind: str) -> None:
    """Both in the same five pieces; scipy's has the digits of doubles, some of them lost."""
    theirs = make_interp_spline(X, Y, k=5, bc_type=ENDS[kind])
    with mp.workdps(DIGITS):
        ours = exact_spline(
            list(map(mpf, X)), list(map(mpf, Y)), periodic=kind == "periodic", rest=kind == "rest"
        )
        for piece, (start, end) in enumerate(pairwise(X)):
            for place in np.linspace(start, end, 7)[1:-1]:
                lift = polynomial(ours[piece], variable(mpf(float(place)) - mpf(start), 1, 4))
                for order in range(4):
                    found = float(lift.derivative(order))
                    scale = 100.0 ** (order / 2)
                    assert found == pytest.approx(theirs(place, order), rel=1e-9, abs=1e-9 * scale)


def test_a_polynomial_of_degree_five_is_its_own_spline() -> None:
    """x^3 (10 - 15 x + 6 x^2) rests at 0 and 1."""
    with mp.workdps(DIGITS):
        x = [mpf(0), mpf("0.2"), mpf("0.7"), mpf(1)]
        pieces = exact_spline(
            x, [10 * v**3 - 15 * v**4 + 6 * v**5 for v in x], periodic=False, rest=True
        )
        assert [abs(a - b) < 1e-45 for a, b in zip(pieces[0], (0, 0, 0, 10, -15, 6), strict=True)]
        for piece, start in zip(pieces, x, strict=False):
            at = mpf("0.05")
            v = start + at
            bend = polynomial(piece, variable(at, 1, 3)).derivative(2)
            assert abs(bend - (60 * v - 180 * v**2 + 120 * v**3)) < 1e-44
