"""Limits at themselves and next to them: what just keeps one is ok, the next number is not."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from typing import Any

import pytest

import camgeo
from camgeo.cam.cam import Breadth
from camgeo.check.finding import (
    Finding,
    Findings,
    Limits,
    default_linkage_transmission_angle,
    default_transmission_angle,
    forbidding,
    held,
)
from camgeo.check.flank import (
    check_face,
    check_radius_ratio,
    check_transmission_angle,
    check_undercut,
)
from camgeo.check.judge import worst
from camgeo.check.machine import check_breadth, check_follower, check_pair
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan
from camgeo.units import RPM
from tests.contour.cams import SCENES, dwell, move, translating

REST = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(10.0, 5.0), 1)


def above(value: float) -> float:
    return math.nextafter(value, math.inf)


def below(value: float) -> float:
    return math.nextafter(value, -math.inf)


@pytest.mark.parametrize("limit", [-2.5, 0.0, 1.0, 60.0])
def test_a_value_keeps_a_limit_that_it_is_equal_to(limit: float) -> None:
    for value, most, least in (
        (below(limit), "ok", "broken"),
        (limit, "ok", "ok"),
        (above(limit), "broken", "ok"),
    ):
        found = held("any", "so much", value, limit, "mm", 1.0)
        assert (found.severity, found.value, found.limit) == (most, value, limit)
        word = "at most" if most == "ok" else "above"
        assert found.sentence == f"so much, {word} {limit:g} mm"
        found = held("any", "so much", value, limit, least=True)
        assert found.severity == least
        word = "at least" if least == "ok" else "below"
        assert found.sentence == f"so much, {word} {limit:g}"
    none = held("any", "so much", 3.0, None, "mm", 1.0)
    assert none == Finding("any", "ok", "so much", 3.0, None, "mm", 1.0)


def test_each_check_is_ok_at_its_own_value() -> None:
    """And broken where the limit is the next number on the other side of it."""
    curve = translating(dwell(40), move(140, 15.0), dwell(60), move(120, 0.0)).pitch
    bends, flank = curvature_extremes(curve), WorkingCurve(curve, -8.0)
    ratio = check_radius_ratio(flank, "inner", bends, 1.0).value
    assert ratio is not None
    angle = check_transmission_angle(curve, 0.1).value
    assert angle is not None
    for limit, severity in ((ratio, "ok"), (below(ratio), "broken")):
        assert check_radius_ratio(flank, "inner", bends, limit).severity == severity
    for limit, severity in ((below(angle), "ok"), (angle * (1.0 + 1e-14), "broken")):
        assert check_transmission_angle(curve, math.radians(limit)).severity == severity
    cam = Breadth(MotionPlan((move(180, 5.0), move(180, 0.0))), 30.0, 1)
    off = check_breadth(cam, 65.5, 1.0).value
    assert off is not None
    assert off == pytest.approx(0.5)
    for limit, severity in ((off, "ok"), (below(off), "broken")):
        assert check_breadth(cam, 65.5, limit).severity == severity


def test_play_of_a_pair_is_ok_at_its_own_value() -> None:
    main, other = (
        disc.cam.disc.pitch_curve for disc in camgeo.load(SCENES / "conjugate_lever.toml").discs
    )
    _, found = check_pair(main, other, 1e-3, 1.0)
    assert found.value is not None
    for limit, severity in ((found.value, "ok"), (below(found.value), "broken")):
        assert check_pair(main, other, 1e-3, limit)[1].severity == severity


@pytest.mark.parametrize(
    ("share", "name", "severity"),
    [
        (1.0 - 2e-12, "undercut-inner", "ok"),
        (1.0 - 5e-13, "cusp-inner", "no-disc"),
        (1.0, "cusp-inner", "no-disc"),
        (1.0 + 5e-13, "cusp-inner", "no-disc"),
        (1.0 + 2e-12, "undercut-inner", "no-disc"),
    ],
)
def test_a_cusp_is_within_a_billionth_of_a_thousandth(
    share: float, name: str, severity: str
) -> None:
    found = check_undercut(WorkingCurve(REST, -10.0 * share), "inner", curvature_extremes(REST))
    assert {(each.name, each.severity) for each in found} == {(name, severity)}
    trimmed = check_undercut(
        WorkingCurve(REST, -10.0 * share), "inner", curvature_extremes(REST), "broken"
    )
    assert {each.severity for each in trimmed} == {"ok" if severity == "ok" else "broken"}


@pytest.mark.parametrize(
    ("radius", "clearance", "inside", "covers"),
    [
        (below(40.0), 0.0, True, False),
        (40.0, 0.0, True, True),
        (40.0, 0.0, False, False),
        (39.0, 1.999, True, False),
        (39.0, 2.0, True, True),
    ],
)
def test_a_roller_covers_the_axis_from_the_base_circle_on(
    radius: float, clearance: float, inside: bool, covers: bool
) -> None:
    found = check_follower(
        TranslatingRoller(40.0, radius), runs_on_inner=inside, clearance=clearance
    )
    assert [each.name for each in found] == (["roller-over-axis"] if covers else [])
    for each in found:
        assert (each.value, each.limit, each.unit) == (40.0, 40.0, "mm")
        assert ("groove" in each.sentence) == (clearance > 0.0)


def test_a_guide_locks_where_it_touches_the_base_circle() -> None:
    """The next number leaves half a chord of a millionth of a millimetre."""
    for side in (1.0, -1.0):
        (found,) = check_follower(TranslatingRoller(40.0, 5.0, side * 40.0), runs_on_inner=True)
        assert (found.name, found.value, found.limit) == ("self-locking", 40.0, 40.0)
        next_to = TranslatingRoller(40.0, 5.0, side * below(40.0))
        assert check_follower(next_to, runs_on_inner=True) == ()


def test_a_face_that_just_reaches_is_long_enough() -> None:
    """Up to rounding: a millionth of a millionth of the base radius."""
    plan = MotionPlan((move(180, 10.0), move(180, 0.0)))

    def faced(face: tuple[float, float]) -> Finding:
        curve = PitchCurve(plan, TranslatingFlat(40.0, face=face), 1)
        return check_face(curve, whole(WorkingCurve(curve, -0.0)))[0]

    reach = 1.875 * 10.0 / math.pi
    for short, severity in ((1e-11, "ok"), (2e-10, "broken")):
        for face in ((-reach + short, 20.0), (-20.0, reach - short)):
            assert faced(face).severity == severity
            assert abs(faced(face).value or 0.0) == pytest.approx(reach)


def test_a_mechanism_is_slow_up_to_thirty_turns_a_minute() -> None:
    for speed, slow in ((30.0 * RPM, True), (above(30.0 * RPM), False), (None, True)):
        rocker = math.degrees(default_transmission_angle("rad", speed))
        linkage = math.degrees(default_linkage_transmission_angle(speed))
        assert rocker == pytest.approx(45.0 if slow else 60.0)
        assert linkage == pytest.approx(40.0 if slow else 50.0)
        assert math.degrees(default_transmission_angle("mm", speed)) == pytest.approx(60.0)


GIVEN: dict[str, tuple[list[Any], list[Any]]] = {
    "transmission_angle": ([1e-6, 0.5 * math.pi], [0.0, above(0.5 * math.pi), -1.0, math.nan]),
    "linkage_transmission_angle": ([0.1, 0.5 * math.pi], [0.0, above(0.5 * math.pi)]),
    "radius_ratio": ([1e-9, 1.0], [0.0, above(1.0), math.nan]),
    "undercut": (["refuse", "trim"], ["keep", ""]),
    "closing_error": ([1e-9, 5.0], [0.0, -1.0, math.inf]),
    "diameter": ([None, 1.0], [0.0, -1.0]),
    "mass": ([None, 1e-9], [0.0, math.inf]),
    "wall": ([None, 0.5], [0.0, -0.5]),
}
"""What each limit may be, and what it may not."""


@pytest.mark.parametrize("name", GIVEN)
def test_limits_are_checked_by_their_keys(name: str) -> None:
    good, bad = GIVEN[name]
    for value in good:
        assert getattr(Limits(**{name: value}), name) == value
    for value in bad:
        with pytest.raises(camgeo.GeometryError) as caught:
            Limits(**{name: value})
        assert caught.value.key == f"limits.{name}"


def test_many_findings_are_told_in_short() -> None:
    def made(name: str, severity: Any) -> Finding:
        return Finding(name, severity, "so")

    ok = [made(f"good {k}", "ok") for k in range(5)]
    bad = [made(f"bad {k}", "warning") for k in range(4)]
    assert repr(Findings()) == "<0 findings>"
    assert repr(Findings(ok[:1])) == "<1 finding: 1 note>"
    assert repr(Findings((*ok, bad[0]))) == "<6 findings: 5 note, 1 warning (bad 0)>"
    four = repr(Findings(bad))
    assert four.startswith("<4 findings: 4 warning (bad 0, bad 1")
    assert "bad 3" not in four
    assert repr(made("one", "broken")) == "Finding('one', 'broken', 'so')"
    every = [made(each, each) for each in ("ok", "warning", "broken", "no-disc", "invalid")]
    for count, each in enumerate(every, 1):
        assert worst(every[:count]) == each.severity
    assert worst(()) == "ok"
    assert [each.name for each in forbidding(every)] == ["no-disc", "invalid"]


def test_a_knife_edge_fits_any_curvature() -> None:
    edge = replace(REST, follower=TranslatingRoller(10.0, 0.0))
    found = check_radius_ratio(WorkingCurve(edge, -0.0), "inner", curvature_extremes(edge), 0.7)
    assert (found.severity, found.value, found.limit) == ("ok", 0.0, 0.7)
    assert "knife edge" in found.sentence
