"""Findings: severity, value, limit and place of each check."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

import numpy as np
import pytest

from camgeo.check.finding import Finding, default_transmission_angle
from camgeo.check.flank import (
    check_radius_ratio,
    check_standstill,
    check_transmission_angle,
    check_undercut,
)
from camgeo.check.machine import check_closure, check_follower
from camgeo.geometry.outline.cusps import undercut_ranges
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import RPM, TURN, LiftUnit
from tests.laws import LAWS
from tests.reference import (
    hard_case,
    inner_of,
    mechanisms,
    outer_of,
    pitch_curve_of,
    reference,
    thesis_params,
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


@pytest.mark.parametrize("name", reference("mechanism_extremes.json"))
def test_criteria_of_the_reference(name: str) -> None:
    expected: dict[str, Any] = reference("mechanism_extremes.json")[name]
    curve = pitch_curve_of(mechanisms()[name]["params"])
    bends = curvature_extremes(curve)
    for side, flank in (("inner", inner_of(curve)), ("outer", outer_of(curve))):
        ratio = check_radius_ratio(flank, side, bends, RATIO)
        assert (ratio.severity == "ok") == expected[f"{side}_criterion_3_36"]
        undercut = check_undercut(flank, side, bends)
        assert any(f.severity == "no-disc" for f in undercut) == expected[f"{side}_local_undercut"]


@pytest.mark.parametrize("sigma", [-1, 1])
@pytest.mark.parametrize("name", ["T5_schnitt", "T6_setzhub", "T7_vorschub"])
def test_criteria_of_the_thesis_examples(name: str, sigma: int) -> None:
    sense = "plus1" if sigma > 0 else "minus1"
    expected = reference("thesis_examples.toml")[name][f"results_sigma_{sense}"]
    curve = pitch_curve_of(thesis_params(name, sigma))
    bends = curvature_extremes(curve)
    for side, flank in (("inner", inner_of(curve)), ("outer", outer_of(curve))):
        ratio = check_radius_ratio(flank, side, bends, RATIO)
        assert (ratio.severity == "ok") == expected[f"criterion_3_36_{side}"]
        (only,) = check_undercut(flank, side, bends)
        assert (only.severity == "no-disc") == expected[f"local_undercut_{side}"]


def test_transmission_angle_against_its_limit() -> None:
    curve = cam("polynomial-345")
    low = check_transmission_angle(curve, math.radians(45.0))
    assert low.severity == "ok"
    assert low.value is not None
    high = check_transmission_angle(curve, math.radians(low.value) * (1.0 + 1e-12))
    assert high.severity == "broken"
    assert high.value == low.value
    assert high.limit == pytest.approx(low.value)
    assert high.cam_angle == low.cam_angle
    assert f"{low.value:.4f} deg" in high.sentence


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


def test_cusp_and_undercut_are_distinguished() -> None:
    found = {}
    for case in ("HC21a", "HC21b", "HC21c"):
        params, expected = hard_case(case)
        curve = pitch_curve_of({**params, "kappa": 1})
        findings = check_undercut(inner_of(curve), "inner", curvature_extremes(curve))
        (found[case],) = findings
        assert found[case].severity == "no-disc"
        if case == "HC21a":
            assert found[case].name == "cusp-inner"
            assert math.degrees(found[case].cam_angle or 0.0) == pytest.approx(
                float(expected["phi_deg"]), abs=1e-6
            )
            continue
        assert found[case].name == "undercut-inner"
        within = 1e-6 if case == "HC21b" else 1e-8  # the cases' own
        start, end = found[case].cam_range or (0.0, 0.0)
        assert math.degrees(start) == pytest.approx(float(expected["cusp1_phi_deg"]), abs=within)
        assert math.degrees(end) == pytest.approx(float(expected["cusp2_phi_deg"]), abs=within)
    narrow, wide = found["HC21b"].value, found["HC21c"].value
    assert narrow == pytest.approx(-1e-6, rel=1e-6)  # r_R 1e-6 above the limit
    assert wide == pytest.approx(-0.05, rel=1e-6)


def test_undercut_all_round_is_one_range() -> None:
    curve = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(10.0, 12.0), 1)
    flank = inner_of(curve)
    assert undercut_ranges(flank, curvature_extremes(curve)) == [(0.0, 2.0 * math.pi)]


def test_undercut_that_begins_at_a_break() -> None:
    """A jump of the curvature at a joint is no root, but it bounds the range."""
    curve = cam("quadratic-parabola", base=40.0)
    bends = curvature_extremes(curve)
    roller = 1.05 / bends.largest()[0]
    ranges = undercut_ranges(WorkingCurve(curve, -roller), bends)
    assert ranges
    breaks = [float(angle) for angle in curve.breaks]
    for start, end in ranges:
        middle = (start + end) / 2.0
        flank = WorkingCurve(curve, -roller)
        assert flank.regularity(np.array([middle]))[0] < 0.0
        assert any(abs(edge - place) < 1e-12 for edge in (start, end) for place in breaks)


def test_closure_is_fine_for_smooth_laws() -> None:
    findings = check_closure(cam("modified-sine"))
    assert [f.severity for f in findings] == ["ok", "ok"]


def test_shock_is_fatal() -> None:
    finding = named(check_closure(cam("straight-line")), "tangent-closure")
    assert finding.severity == "no-disc"
    assert "the velocity of the follower jumps" in finding.sentence
    place = math.degrees(finding.cam_angle or 0.0)
    assert any(place == pytest.approx(joint) for joint in (30.0, 130.0, 170.0, 290.0))


def test_standstill_is_found_between_the_samples() -> None:
    params, _ = hard_case("HC18")
    (finding,) = check_standstill(pitch_curve_of(params))
    assert (finding.name, finding.severity) == ("standstill", "no-disc")
    assert math.degrees(finding.cam_angle or 0.0) == pytest.approx(params["phi_deg"], abs=1e-4)
    assert check_standstill(cam("polynomial-345")) == ()


def test_default_limits_of_the_sources() -> None:
    slow, fast = 30.0 * RPM, 30.1 * RPM
    expected: dict[tuple[LiftUnit, float | None], float] = {
        ("mm", None): 60.0, ("mm", slow): 60.0, ("mm", fast): 60.0,
        ("rad", None): 45.0, ("rad", slow): 45.0, ("rad", fast): 60.0,
    }  # fmt: skip
    for (unit, speed), angle in expected.items():
        found = default_transmission_angle(unit, speed)
        assert math.degrees(found) == pytest.approx(angle, rel=1e-15)


def test_what_is_no_mechanism() -> None:
    locked = TranslatingRoller(50.0, 8.0, offset=-50.0)
    (finding,) = check_follower(locked, runs_on_inner=True)
    assert (finding.name, finding.severity) == ("self-locking", "invalid")
    over = OscillatingRoller(100.0 + 0j, 80.0, 30.0, 30.0)
    (finding,) = check_follower(over, runs_on_inner=True)
    assert (finding.name, finding.severity) == ("roller-over-axis", "invalid")
    assert check_follower(over, runs_on_inner=False) == (), "inside a ring it may reach over"
    assert check_follower(TranslatingRoller(50.0, 8.0, 49.9), runs_on_inner=True) == ()


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
