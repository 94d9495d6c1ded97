"""The exact slotted lever of the suite against the hard cases and the arc tangent."""

from __future__ import annotations

from typing import Any

import pytest
from mpmath import mp, mpf

from tests.reference import hard_case
from tests.stability.slotted_levers import exact_angle

DIGITS = 60

PRINTED = mpf(10) ** -25


def near(found: Any, expected: str) -> bool:
    return bool(abs(found - mpf(expected)) <= PRINTED * max(1, abs(mpf(expected))))


def test_hc03_a_lever_that_turns() -> None:
    params, expected = hard_case("HC03")
    with mp.workdps(DIGITS):
        beta = mpf(str(params["beta"]))
        for degrees, phi in expected["phi_deg_unwrapped"].items():
            theta = mp.radians(mpf(degrees))
            if 0 < theta < 2 * mp.pi:
                assert near(mp.degrees(exact_angle(theta, 1, beta, 1).terms[0]), phi)
        speed = 2 * mp.pi * mpf(str(params.get("n", 1)))
        assert near(exact_angle(mp.pi, 1, beta, 2).terms[1] * speed, expected["omega2_at_180"])


def test_hc04_a_tiny_crank() -> None:
    params, expected = hard_case("HC04")
    with mp.workdps(DIGITS):
        beta = mpf(str(params["beta"]))
        phi = exact_angle(mp.pi / 2, 1, beta, 1).terms[0]
        assert near(mp.degrees(phi), expected["phi_deg_at_90"])
        velocity = exact_angle(mp.pi / 3, 1, beta, 2).terms[1]
        assert near(velocity, expected["omega2_over_omega0_at_60"])


@pytest.mark.parametrize("beta", ["0.5", "0.999", "1", "1.001", "3"])
def test_the_angle_has_the_lever_s_direction_and_no_jumps(beta: str) -> None:
    """phi = atan2(R sin theta, a - R cos theta) except for whole turns, at steps of a tenth."""
    with mp.workdps(DIGITS):
        distance = mpf(beta)
        before: Any = None
        for step in range(-70, 200):
            theta = mpf(step) / 10 + mpf("0.05")
            phi = exact_angle(theta, 1, distance, 1).terms[0]
            line = mp.atan2(mp.sin(theta), distance - mp.cos(theta))
            turns = (phi - line) / (2 * mp.pi)
            if distance == 1:  # the same line, not the same direction
                turns *= 2
            assert abs(turns - mp.nint(turns)) < mpf(10) ** -(DIGITS - 8)
            if before is not None and distance != 1:
                # At most by half a turn, past the pin at its nearest, and by the crank's own step.
                assert abs(phi - before) < mp.pi + mpf("0.1")
            before = phi


def test_derivatives_are_those_of_the_closed_forms() -> None:
    with mp.workdps(DIGITS):
        crank, distance = mpf(25), mpf(60)
        beta = distance / crank
        for theta in (mpf("0.3"), mpf("2.5"), mpf("5.1")):
            phi = exact_angle(theta, crank, distance, 3)
            square = 1 + beta**2 - 2 * beta * mp.cos(theta)
            velocity = (beta * mp.cos(theta) - 1) / square
            acceleration = beta * (1 - beta**2) * mp.sin(theta) / square**2
            assert abs(phi.derivative(1) - velocity) < mpf(10) ** -(DIGITS - 5)
            assert abs(phi.derivative(2) - acceleration) < mpf(10) ** -(DIGITS - 5)
