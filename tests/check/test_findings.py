"""Findings: severity, value, limit and place of each check, at limits and next to them."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from types import SimpleNamespace
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import camgeo
from camgeo.cam.cam import Breadth
from camgeo.check.disc import (
    POINT_LIMIT,
    TANGENT_LIMIT,
    check_closure,
    check_face,
    check_radius_ratio,
    check_side_clearance,
    check_standstill,
    check_transmission_angle,
    check_undercut,
    largest_deviation,
    transmission_angle_limit,
)
from camgeo.check.finding import (
    Finding,
    Limits,
    Severity,
    forbidding,
    limit_finding,
)
from camgeo.check.judge import check_breadth, worst
from camgeo.check.machine import check_follower, linkage_findings
from camgeo.design.design import Design
from camgeo.geometry.outline.outline import undercut_ranges
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import TranslatingFlat
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.motion import Jet
from camgeo.kinematics.motion import MergedDwell as DwellSpan
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import RPM, TURN
from tests.contour.cams import SCENES, dwell, move, translating
from tests.findings import known
from tests.laws import LAWS
from tests.reference import (
    inner_of,
    mechanisms,
    outer_of,
    pitch_curve_of,
    reference,
    slider_crank_of,
    thesis_params,
)
from tests.scene.scenes import GROOVE, spoilt
from tests.strategies import (
    BENT,
    SMOOTH,
    attack,
    linked_pitch_curves,
    pitch_curves,
    plans,
    signs,
)

RATIO = 0.7


def cam(law: str, base: float = 60.0, roller: float = 8.0) -> PitchCurve:
    plan = MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(100), 20.0, LAWS[law]),
            Dwell(Decimal(40)),
            Move(Decimal(120), 0.0, LAWS[law]),
            Dwell(Decimal(70)),
        )
    )
    return PitchCurve(plan, TranslatingRoller(base, roller), 1)


def named(findings: tuple[Finding, ...], name: str) -> Finding:
    (found,) = [finding for finding in findings if finding.name == name]
    return found


def criteria() -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Parameters of the cams of the reference and of the thesis, and what is stated of their flanks
    by names as in the reference."""
    cases = [
        (mechanisms()[name]["params"], expected)
        for name, expected in reference("mechanism_extremes.json").items()
    ]
    for name in ("T5_schnitt", "T6_setzhub", "T7_vorschub"):
        for sigma, sense in ((1, "plus1"), (-1, "minus1")):
            found = reference("thesis_examples.toml")[name][f"results_sigma_{sense}"]
            stated = {
                f"{side}_{what}": found[f"{what}_{side}"]
                for what in ("criterion_3_36", "local_undercut")
                for side in ("inner", "outer")
            }
            cases.append((thesis_params(name, sigma), stated))
    return cases


@pytest.mark.parametrize(("params", "expected"), criteria())
def test_criteria_of_the_reference(params: dict[str, Any], expected: dict[str, Any]) -> None:
    curve = pitch_curve_of(params)
    bends = curvature_extremes(curve)
    for side, flank in (("inner", inner_of(curve)), ("outer", outer_of(curve))):
        ratio = check_radius_ratio(flank, side, bends, RATIO)
        assert (ratio.severity == "ok") == expected[f"{side}_criterion_3_36"]
        undercut = check_undercut(flank, side, bends)
        assert any(f.severity == "no-disc" for f in undercut) == expected[f"{side}_local_undercut"]


def test_radius_ratio_is_that_of_the_sign_that_matters() -> None:
    curve = cam("polynomial-345", base=25.0)
    bends = curvature_extremes(curve)
    convex, concave = 1.0 / bends.largest()[0], -1.0 / bends.smallest()[0]
    assert convex > 0.0
    assert concave > 0.0
    inner = check_radius_ratio(WorkingCurve(curve, -5.0), "inner", bends, RATIO)
    outer = check_radius_ratio(WorkingCurve(curve, 5.0), "outer", bends, RATIO)
    assert inner.value == pytest.approx(5.0 / convex, rel=1e-14)
    assert outer.value == pytest.approx(5.0 / concave, rel=1e-14)
    everywhere_convex = cam("polynomial-345", base=90.0)
    bends = curvature_extremes(everywhere_convex)
    free = check_radius_ratio(WorkingCurve(everywhere_convex, 8.0), "outer", bends, RATIO)
    assert (free.severity, free.value) == ("ok", 0.0)
    assert "convex everywhere" in free.sentence


def test_undercut_all_round_is_one_range() -> None:
    curve = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(10.0, 12.0), 1)
    flank = inner_of(curve)
    assert undercut_ranges(flank, curvature_extremes(curve)) == [(0.0, 2.0 * math.pi)]


def test_shock_is_fatal() -> None:
    finding = named(check_closure(cam("straight-line")), "tangent-closure")
    assert finding.severity == "no-disc"
    assert "the velocity of the follower jumps" in finding.sentence
    place = math.degrees(finding.cam_angle or 0.0)
    assert any(place == pytest.approx(joint) for joint in (30.0, 130.0, 170.0, 290.0))


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        (0.0, 0.0),
        (TURN, 0.0),
        (-1e-20, 0.0),
        (-1.0, TURN - 1.0),
        (1.5 * TURN, 0.5 * TURN),
        (math.nextafter(TURN, 0.0), math.nextafter(TURN, 0.0)),
    ],
)
def test_places_lie_within_a_turn(given: float, kept: float) -> None:
    assert Finding("any", "ok", "somewhere", cam_angle=given).cam_angle == kept


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
        found = limit_finding("any", "so much", value, limit, "mm", 1.0)
        assert (found.severity, found.value, found.limit) == (most, value, limit)
        word = "at most" if most == "ok" else "above"
        assert found.sentence == f"so much, {word} {limit:g} mm"
        found = limit_finding("any", "so much", value, limit, least=True)
        assert found.severity == least
        word = "at least" if least == "ok" else "below"
        assert found.sentence == f"so much, {word} {limit:g}"
    none = limit_finding("any", "so much", 3.0, None, "mm", 1.0)
    assert none == Finding("any", "ok", "so much", 3.0, None, "mm", 1.0)


def test_each_check_is_ok_at_its_own_value() -> None:
    """And broken where the limit is the next number on the other side of it."""
    curve = translating(dwell(40), move(140, 15.0), dwell(60), move(120, 0.0)).pitch
    bends, flank = curvature_extremes(curve), WorkingCurve(curve, -8.0)
    ratio = known(check_radius_ratio(flank, "inner", bends, 1.0).value)
    angle = known(check_transmission_angle(curve, 0.1).value)
    for limit, severity in ((ratio, "ok"), (below(ratio), "broken")):
        assert check_radius_ratio(flank, "inner", bends, limit).severity == severity
    for limit, severity in ((below(angle), "ok"), (angle * (1.0 + 1e-14), "broken")):
        found = check_transmission_angle(curve, math.radians(limit))
        assert (found.severity, found.value) == (severity, angle)
        assert found.limit == pytest.approx(angle)
        assert f"{angle:.4f} deg" in found.sentence
    cam = Breadth(MotionPlan((move(180, 5.0), move(180, 0.0))), 30.0, 1)
    off = known(check_breadth(cam, 65.5, 1.0).value)
    assert off == pytest.approx(0.5)
    for limit, severity in ((off, "ok"), (below(off), "broken")):
        assert check_breadth(cam, 65.5, limit).severity == severity


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
    wanted = [("roller-over-axis", "invalid")] if covers else []
    assert [(each.name, each.severity) for each in found] == wanted
    for each in found:
        assert (each.value, each.limit, each.unit) == (40.0, 40.0, "mm")
        assert ("groove" in each.sentence) == (clearance > 0.0)


def test_a_guide_locks_where_it_touches_the_base_circle() -> None:
    """The next number leaves half a chord of a millionth of a millimetre."""
    for side in (1.0, -1.0):
        (found,) = check_follower(TranslatingRoller(40.0, 5.0, side * 40.0), runs_on_inner=True)
        assert (found.name, found.severity) == ("self-locking", "invalid")
        assert (found.value, found.limit) == (40.0, 40.0)
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
    plan = MotionPlan((move(180, 1.0), move(180, 0.0)))
    linked: Any = LinkedMotion(plan, slider_crank_of(thesis_params("T6_setzhub", -1)))
    for speed, slow in ((30.0 * RPM, True), (above(30.0 * RPM), False), (None, True)):
        drive: Any = SimpleNamespace(speed=speed, motion=linked)
        limits = {each.name: each.limit for each in linkage_findings(drive, Limits())}
        assert limits["linkage-transmission-angle"] == pytest.approx(40.0 if slow else 50.0)
        for unit, limit in (("rad", 45.0 if slow else 60.0), ("mm", 60.0)):
            cam: Any = SimpleNamespace(drive=drive, follower=SimpleNamespace(lift_unit=unit))
            assert math.degrees(transmission_angle_limit(cam, Limits())) == pytest.approx(limit)


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


def test_the_worst_of_findings_and_those_that_forbid_a_disc() -> None:
    severities = get_args(Severity)
    every = [Finding(each, each, "so") for each in severities]
    for count, each in enumerate(every, 1):
        assert worst(every[:count]) == each.severity
    assert worst(()) == "ok"
    assert [each.name for each in forbidding(every)] == ["no-disc", "invalid"]


def closing_of(curve: PitchCurve) -> dict[str, Finding]:
    return {finding.name: finding for finding in check_closure(curve)}


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_without_a_word(curve: PitchCurve) -> None:
    found = closing_of(curve)
    assert {name: finding.severity for name, finding in found.items()} == {
        "closure": "ok",
        "tangent-closure": "ok",
    }
    gap, turn = found["closure"], found["tangent-closure"]
    assert gap.unit == "mm"
    assert turn.unit == "deg"
    assert gap.limit is not None
    assert known(gap.value) <= gap.limit
    assert gap.limit >= POINT_LIMIT * curve.follower.base_radius
    assert turn.limit == math.degrees(TANGENT_LIMIT)


class Spiral:
    """A lift that does not come back: 1 mm more after every turn."""

    breaks = np.array([0.0])
    borders = np.array([0.0])
    dwells: tuple[DwellSpan, ...] = ()

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        inside = np.mod(phi, 2.0 * math.pi)
        if side == "left":
            inside = np.where(inside == 0.0, 2.0 * math.pi, inside)
        rate = np.full(len(phi), 0.5 / math.pi)
        return np.stack((inside * rate, rate, 0.0 * rate, 0.0 * rate))

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        return self.jet(0.5 * (low + high)), np.ones((4, len(low)))


def test_a_curve_that_does_not_close_is_seen() -> None:
    found = closing_of(PitchCurve(Spiral(), TranslatingRoller(40.0, 5.0), 1))
    assert found["closure"].severity == "no-disc"
    assert found["closure"].value == pytest.approx(1.0, rel=1e-12)
    assert found["closure"].cam_angle == 0.0


PHI: FloatArray = np.array([(k + 0.31) * TURN / 2000.0 for k in range(2000)])


MARGIN = 1e-11
"""Rounding of 1 + d kappa, with d kappa up to about a hundred."""


def flank_at(curve: PitchCurve, share: float) -> WorkingCurve:
    """An offset that has a cusp where the curvature is this share of the way through its range."""
    bends = curvature_extremes(curve)
    low, high = bends.smallest()[0], bends.largest()[0]
    kappa = low + share * (high - low)
    assume(high - low > 1e-6)
    assume(abs(kappa) > 1e-4)
    return WorkingCurve(curve, -1.0 / kappa)


@attack
@given(curve=pitch_curves(BENT), share=st.floats(0.001, 0.999))
def test_the_ranges_are_where_the_flank_is_not_regular(curve: PitchCurve, share: float) -> None:
    flank = flank_at(curve, share)
    within = np.zeros(len(PHI), dtype=bool)
    for start, end in undercut_ranges(flank, curvature_extremes(curve)):
        if end > start:
            within |= (start < PHI) & (end > PHI)
        else:
            within |= (start < PHI) | (end > PHI)
    margin = flank.regularity(PHI)
    clear = np.abs(margin) > 1e-9  # of the edge, where rounding decides
    assert np.array_equal(within[clear], margin[clear] < 0.0)


@attack
@given(curve=pitch_curves(BENT), share=st.floats(0.001, 0.999))
def test_each_range_states_its_worst_margin(curve: PitchCurve, share: float) -> None:
    flank = flank_at(curve, share)
    found = check_undercut(flank, "inner", curvature_extremes(curve))
    assert {finding.severity for finding in found} == {"no-disc"}
    for finding in found:
        assert finding.value is not None
        assert finding.value < 0.0
        place = np.array([known(finding.cam_angle)])
        margins = [flank.regularity(place)[0], flank.regularity(place, "left")[0]]
        # The margin is right to the rounding of 1, the place to that of 2 pi.
        assert min(abs(margin - finding.value) for margin in margins) <= MARGIN
    worst = min(finding.value for finding in found if finding.value is not None)
    assert np.min(flank.regularity(PHI)) >= worst - MARGIN


def test_a_roller_as_large_as_the_base_circle_is_reported() -> None:
    """A rest between shocks is a cusp throughout; one joint lies a rounding before the first."""
    scene = load_scene(SCENES / "straight_moves.toml")
    found = Design(scene.with_values({"follower.roller_radius": 45})).findings
    assert found[0].name == "roller-over-axis"


@attack
@given(curve=pitch_curves(BENT))
def test_with_a_normal_everywhere_nothing_is_reported(curve: PitchCurve) -> None:
    """Followers that stay off the line of centres, or above the cam axis, never stand still."""
    assert check_standstill(curve) == ()


LEVERAGE = 1e-10
"""Rounding of the leverage: 1e-13 of the largest |Z'| by |Z'|, down to a thousandth of it."""


@attack
@given(
    curve=st.one_of(pitch_curves(BENT), linked_pitch_curves(BENT)), clearance=st.floats(1e-3, 1.0)
)
def test_no_cam_angle_has_more_play_than_reported(curve: PitchCurve, clearance: float) -> None:
    """(c/2)/|dn/dq| at many angles, on both sides of all breaks, and at the place itself."""
    deviation, place = largest_deviation(curve, clearance)
    phi = np.linspace(0.0, TURN, 2000)
    places: tuple[tuple[FloatArray, Side], ...] = (
        (phi, "right"),
        (curve.breaks, "right"),
        (curve.breaks, "left"),
    )
    sides = [0.5 * clearance / np.abs(curve.leverage(*each)) for each in places]
    speed = np.abs(curve.jet(phi)[1])
    assert np.max(np.concatenate(sides)) <= deviation * (1.0 + LEVERAGE)
    if np.min(speed) > 1e-3 * np.max(speed):
        at = np.array([place])
        levers = np.abs([curve.leverage(at, "left"), curve.leverage(at, "right")])
        # At the end of a piece its own value counts.
        assert 0.5 * clearance / np.min(levers) == pytest.approx(deviation, rel=1e-7)


def test_it_is_stated_in_the_unit_of_the_lift() -> None:
    rocker = design("oscillating")
    (found,) = (f for f in rocker.findings if f.name == "side-clearance")
    assert found.severity == "ok"
    assert found.unit == "deg"
    deviation, place = largest_deviation(rocker.cam.disc.pitch_curve, 0.1)
    assert found.value == pytest.approx(math.degrees(deviation))
    assert found.cam_angle == place
    guide = design("translating")
    assert {f.unit for f in guide.findings if f.name == "side-clearance"} == {"mm"}
    assert not [f for f in design("translating", 0.0).findings if f.name == "side-clearance"]


def test_a_follower_that_locks_has_no_bound() -> None:
    curve = design("translating").cam.disc.pitch_curve
    follower = curve.follower
    assert isinstance(follower, TranslatingRoller)
    locked = replace(follower, offset=follower.base_radius)
    found = check_side_clearance(replace(curve, follower=locked), 0.1)
    assert found.value is None
    assert "any amount" in found.sentence


MOVES = """[[motion]]
dwell = 90
[[motion]]
law = "modified-sine"
span = 90
to = {to}
[[motion]]
dwell = 90
[[motion]]
law = "modified-sine"
span = 90
to = 0
"""


def design(kind: str, clearance: float = 0.1, roller: float = 8.0, to: float = 12.0) -> Design:
    text = spoilt(
        GROOVE,
        ("[[motion]]\ndwell = 360\n", MOVES.format(to=to)),
        ("roller_radius = 8\n", f"roller_radius = {roller!r}\nside_clearance = {clearance!r}\n"),
    )
    if kind == "oscillating":
        text = spoilt(
            text, ('"translating-roller"', '"oscillating-roller"\npivot = [100, 0]\narm = 75')
        )
    return Design(parse_scene(text))


def test_the_rule_of_thumb_is_of_the_roller_and_the_cusp_of_the_flank() -> None:
    """Between r_K - c/2 and r_K the roller fits and the groove's flank undercuts; the cure is the
    roller whose groove just has no cusp."""
    sharp = design("translating", 0.0, 5.0, 40.0)
    radius = 1.0 / max(sharp.cam.disc.bends.largest()[0], -sharp.cam.disc.bends.smallest()[0])
    roller = radius - 0.1
    cam = design("translating", 0.5, roller, 40.0)
    ratios = [f.value for f in cam.findings if f.name.startswith("radius-ratio")]
    assert max(value or 0.0 for value in ratios) == pytest.approx(roller / radius, rel=1e-12)
    assert [f for f in cam.findings if f.name.startswith("undercut") and f.severity == "no-disc"]
    without = design("translating", 0.0, roller, 40.0)
    assert not [f for f in without.findings if f.name.startswith("undercut") and f.severity != "ok"]
    found = {(each.fault, each.knob): each for each in cam.judgement.cures}
    cure = found["undercut", "roller radius"]
    assert cure.limit == pytest.approx(radius - 0.25, rel=1e-9)


HEIGHT = 40.0


ROUNDING = 1e-14 * 2.0 * HEIGHT
"""A sum of four lengths of the breadth's size at most."""


@attack
@given(plan=plans(BENT, 20.0), direction=signs())
def test_the_error_is_the_largest_of_the_turn_and_is_reached(
    plan: MotionPlan, direction: int
) -> None:
    cam = Breadth(plan, HEIGHT, direction)
    breadth = 2.0 * HEIGHT + 7.0 * direction
    phi = np.linspace(0.0, TURN, 721)
    # From the lift itself: the two faces' distances from the axis at the same cam angle.
    sides = [HEIGHT + direction * plan.jet(angles)[0] for angles in (phi, phi + math.pi)]
    error = np.abs(sides[0] + sides[1] - breadth)
    finding = check_breadth(cam, breadth, 0.02)
    assert finding.value is not None
    assert finding.value >= float(np.max(error)) - ROUNDING
    there = np.array([known(finding.cam_angle)])
    at = [abs(float(cam.width(there, side)[0]) - breadth) for side in ("right", "left")]
    assert finding.value == pytest.approx(max(at), abs=1e-9)
    assert (finding.severity == "broken") == (finding.value > 0.02)
