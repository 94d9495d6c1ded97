"""Findings of flat-faced followers: convexity, jumps of the contact, the length of the face."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import pytest

from camgeo.check.finding import Finding
from camgeo.check.flank import check_convexity, check_face
from camgeo.check.machine import check_closure
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.laws import LAWS
from tests.reference import plan_of

STROKE = 12.0
SPAN = math.radians(90.0)

ACCELERATION = 10.0 / math.sqrt(3.0)
"""Largest f'' of the 3-4-5 polynomial (VDI 2143-1)."""

PLAN = plan_of({"phi_H": [30, 90, 40, 90, 110]}, STROKE)


def only(findings: tuple[Finding, ...]) -> Finding:
    (found,) = findings
    return found


def whole_of(curve: PitchCurve) -> tuple[PitchCurve, Path]:
    """The curve, and all of it as the outline."""
    return curve, whole(WorkingCurve(curve, -0.0))


def tappet(base: float, face: tuple[float, float] | None = None) -> PitchCurve:
    return PitchCurve(PLAN, TranslatingFlat(base, face=face), 1)


def smallest_excess() -> float:
    """Smallest s + s'' of a rise: it is convex from a base radius on that makes up for it."""
    best = math.inf
    for k in range(20001):
        z = k / 20000.0
        lift = z**3 * (10.0 + z * (6.0 * z - 15.0))
        bend = 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z)
        best = min(best, STROKE * (lift + bend / SPAN**2))
    return best


def test_the_smallest_base_radius_is_where_it_says() -> None:
    least = -smallest_excess()
    found = only(check_convexity(tappet(40.0)))
    assert (found.name, found.severity, found.limit) == ("convexity", "ok", 0.0)
    assert found.value == pytest.approx(40.0 - least, abs=1e-6)
    short = only(check_convexity(tappet(least - 2.0)))
    assert short.severity == "no-disc"
    assert "undercut" in short.sentence
    assert "make follower.base_radius larger" in short.sentence
    assert short.value is not None
    mended = only(check_convexity(tappet(least - 2.0 - short.value * (1.0 + 1e-6))))
    assert mended.severity == "ok"
    cusp = only(check_convexity(tappet(least - 2.0 - short.value)))
    assert cusp.severity == "no-disc"
    assert "cusp" in cusp.sentence


def test_a_rocker_is_mended_by_both() -> None:
    plan = plan_of({"phi_H": [30, 60, 80, 120, 70]}, math.radians(12.0))
    follower = OscillatingFlat(complex(-70.0, 50.0), 35.0, 8.0, 1, 1)
    found = only(check_convexity(PitchCurve(plan, follower, -1)))
    assert found.severity == "no-disc"
    assert found.value is not None
    assert "follower.base_radius and follower.face_offset both" in found.sentence
    more = -found.value + 1e-6
    larger = replace(follower, base_radius=35.0 + more, face_offset=8.0 + more)
    assert only(check_convexity(PitchCurve(plan, larger, -1))).value == pytest.approx(
        1e-6, rel=1e-3
    )


def test_a_face_that_turns_back() -> None:
    """The rocker turns with the cam and faster: chi' = 1.875 psi_H / span > 1."""
    plan = plan_of({"phi_H": [30, 130, 10, 120, 70]}, 1.9)
    follower = OscillatingFlat(-400.0 + 0j, 60.0, 0.0, 1, 1)
    found = only(check_convexity(PitchCurve(plan, follower, -1)))
    assert found.severity == "no-disc"
    assert "turns back" in found.sentence
    assert found.value == pytest.approx(1.0 - 1.875 * 1.9 / math.radians(120.0), abs=1e-9)


def test_a_shock_makes_the_contact_jump() -> None:
    law = LAWS["straight-line"]
    plan = MotionPlan(
        (Dwell(Decimal(90)), Move(Decimal(90), 10.0, law), Move(Decimal(180), 0.0, law))
    )
    curve = PitchCurve(plan, TranslatingFlat(60.0), 1)
    found = {finding.name: finding for finding in check_convexity(curve)}["contact-jump"]
    assert found.severity == "no-disc"
    # From 10/(pi/2) up to 10/pi down, at the top; ahead at both ends of the rest.
    assert found.value == pytest.approx(-30.0 / math.pi)
    assert found.cam_angle == pytest.approx(math.pi)
    assert "3 jumps" in found.sentence


def test_whatever_does_not_close_is_a_jump_of_the_contact() -> None:
    """However slight the shock, which the closure of the curve does not show."""
    law = LAWS["straight-line"]
    for stroke in (1e-12, 1e-11, 1e-10, 1e-9, 1e-6):
        moves = (Move(Decimal(90), stroke, law), Move(Decimal(180), 0.0, law))
        curve = PitchCurve(MotionPlan((Dwell(Decimal(90)), *moves)), TranslatingFlat(60.0), 1)
        closure = next(each for each in check_closure(curve) if each.name == "closure")
        reported = {each.name for each in check_convexity(curve) if each.severity == "no-disc"}
        assert closure.severity == "ok" or reported == {"contact-jump"}


def test_a_face_over_the_cam_axis() -> None:
    """An eccentric: a circle of 20 mm whose centre is 25 mm from the axis is convex, and no cam."""
    plan = MotionPlan(
        (
            Move(Decimal(180), 50.0, LAWS["simple-sine"]),
            Move(Decimal(180), 0.0, LAWS["simple-sine"]),
        )
    )
    curve = PitchCurve(plan, TranslatingFlat(45.0, direction=-1), 1)
    found = {finding.name: finding for finding in check_convexity(curve)}
    assert found["convexity"].value == pytest.approx(20.0)
    assert found["face-over-axis"].severity == "no-disc"
    assert found["face-over-axis"].value == pytest.approx(-5.0)


def test_the_face_is_as_long_as_the_velocity_says() -> None:
    """x = s' (1.875 H / span up and down), also of the other sense: its mirror."""
    reach = 1.875 * STROKE / SPAN
    found = only(check_face(*whole_of(tappet(40.0))))
    assert found.value == pytest.approx(2.0 * reach)
    assert f"{2.0 * reach:.6g} mm is needed" in found.sentence
    slack = only(check_face(*whole_of(tappet(40.0, (-reach - 1.0, reach + 0.5)))))
    assert (slack.severity, slack.limit) == ("ok", reach + 0.5)
    short = only(check_face(*whole_of(tappet(40.0, (-reach + 0.25, reach + 0.5)))))
    assert short.severity == "broken"
    assert short.value == pytest.approx(-reach)
    assert short.limit == pytest.approx(-reach + 0.25)
    assert short.cam_angle == pytest.approx(math.radians(205.0))
    assert "0.25 mm too short" in short.sentence


def test_a_contact_at_the_foot_of_the_pivot_has_no_lever() -> None:
    """A rocker that swings until its face stands square on the line of centres, and beyond."""
    plan = plan_of({"phi_H": [30, 130, 10, 120, 70]}, math.radians(40.0))
    follower = OscillatingFlat(-90.0 + 0j, 90.0 * math.sin(math.radians(60.0)), 0.0, 1, 1)
    checked = check_face(*whole_of(PitchCurve(plan, follower, 1)))
    found = {finding.name: finding for finding in checked}
    assert found["face-length"].severity == "ok"
    assert found["contact-lever"].severity == "broken"
    assert found["contact-lever"].value is not None
    assert found["contact-lever"].value < 0.0
