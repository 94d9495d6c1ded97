"""The numerically hard cases of `fixtures/reference/hard_cases.json`, and variants of them.

`docs/hard_cases_page.py` computes the values of each case and quotes what camgeo says to it: here
no error may be larger than docs/hard-cases.md states. Below is what cases expect beyond that, under
their names. What is left of digits with other numbers is measured by `tests.stability`.
"""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.check.disc import check_standstill, check_transmission_angle, check_undercut
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.design.value_table import cam_angles, radius_of_curvature
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.outline import find_crossings, real_outline, undercut_ranges
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.findings import known
from tests.pages import page_maker
from tests.reference import angles, hard_case, inner_of, pitch_curve_of, plan_of, reference
from tests.strategies import attack, pitch_curves, with_roller

PAGE: Final = page_maker("hard_cases_page")

HARD_CASES: Final = (Path(__file__).parents[1] / "docs" / "hard-cases.md").read_text("utf-8")

CASES: Final = [case["id"] for case in reference("hard_cases.json")]

ROUNDING: Final = 64.0 * 2.0**-53
"""Roundings on the way to any quantity, of its largest term."""

SPANS: Final = (30, 100, 40, 120, 70)


# What the page states ---------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES)
def test_no_error_is_larger_than_the_page_says(case: str) -> None:
    lines = PAGE.measured(case)
    (section,) = re.findall(rf"^## {case}: .*?(?=^## |\Z)", HARD_CASES, re.MULTILINE | re.DOTALL)
    rows = re.findall(r"^\| (.*) \| (exact|<= .*) \|$", section, re.MULTILINE)
    assert [row[0].replace("\\|", "|") for row in rows] == [line.label for line in lines]
    for line, (_, claim) in zip(lines, rows, strict=True):
        bound = re.match(r"<= (\de[+-]?\d+)", claim)
        assert line.error <= (float(bound[1]) if bound else 0.0), line.label


class Asked(dict[str, Any]):
    """Values that note which of them have been asked for."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self.asked: set[str] = set()

    def __getitem__(self, key: str) -> Any:
        self.asked.add(key)
        return super().__getitem__(key)


LEFT_OUT: Final[dict[str, set[str]]] = {
    # What the half-angle formula and the program of the thesis make of the case.
    "HC06": {"A", "B", "C", "D", "theta_zweiter_deg"},
    "HC24": {"points_by_accumulation", "last_accumulated"},
    "HC28": {"A", "C", "A_minus_C_over_A", "B_plus_D"},
    # Zeros, what messages name, and values that follow from others of the case.
    "HC08": {"sum_deg", "correct"},
    "HC09": {"psi1", "psi2"},
    "HC15": {"s_G", "mu_at_0"},
    "HC16": {"limit_r_G_min", "psi_G_at_limit"},
    "HC18": {"psi1", "psi_t"},
    "HC19": {"rho"},
    "HC20": {"phi_deg", "convex_everywhere"},
    "HC20b": {"n"},
    "HC21a": {"inner_speed"},
    "HC22b": {"r_R_over_0_7"},
    # Below.
    "HC22": {"rho_convex_min_phi", "r_R_over_rho"},
}
"""Numbers of cases of which the page has no error."""


@pytest.mark.parametrize("case", CASES)
def test_the_page_measures_all_values_of_a_case(case: str) -> None:
    params, expected = hard_case(case)
    values = Asked(expected)
    if case in PAGE.MEASURES:
        PAGE.MEASURES[case](params, values)
    numbers = {
        key
        for key, value in expected.items()
        if not isinstance(value, str) or re.match(r"-?\d", value)
    }
    assert numbers - values.asked == LEFT_OUT.get(case, set())
    assert case in PAGE.MEASURES or case in PAGE.WORDS


def test_there_are_33_cases() -> None:
    assert len(CASES) == len(set(CASES)) == 33


def test_an_error_is_measured_from_all_digits_of_the_reference() -> None:
    line = PAGE.share("a third", (1.0 / 3.0, "0." + 30 * "3"))
    # The double nearest to 1/3 is 2^-54/3 below it.
    assert line.error == pytest.approx(2.0**-54, rel=1e-9)
    off = PAGE.distance("a point", "mm", 1.0, (3.0 + 4.0j, ["0", "0"]))
    assert off.error == 5.0


def test_errors_are_rounded_up() -> None:
    found = [PAGE.rounded_up(value) for value in (0.0, 1e-15, 1.01e-15, 9.5e-3)]
    assert found == [0, 1e-15, 2e-15, 1e-2]


# Linkages ---------------------------------------------------------------------------------------


def test_hc26_a_crank_that_passes_180_degrees_swings_without_a_jump() -> None:
    linkage = SliderCrank(50.0, 48.0, math.asin(0.8), False, 1, -1, -1)
    motion = LinkedMotion(plan_of({"phi_H": (60, 100, 40, 100, 60)}, 10.0), linkage)
    swing = motion.jet(angles(*np.linspace(60.0, 160.0, 2001)))[0]
    assert np.max(np.abs(np.diff(swing))) < math.radians(0.02)


# Plans and laws ---------------------------------------------------------------------------------


@attack
@given(curve=pitch_curves(), places=st.lists(st.integers(0, 2), min_size=1, max_size=4))
def test_hc09_rests_of_zero_length_change_nothing(curve: PitchCurve, places: list[int]) -> None:
    plan = curve.motion
    assert isinstance(plan, MotionPlan)
    segments = list(plan.segments)
    for place in places:
        segments.insert(place, Dwell(Decimal(0)))
    padded = replace(curve, motion=MotionPlan(tuple(segments)))
    phi = np.concatenate((spread(40), angles(*map(float, plan.joints_deg))))
    sides: tuple[Side, ...] = ("left", "right")
    for side in sides:
        assert np.array_equal(curve.jet(phi, side), padded.jet(phi, side))
    bends, others = curvature_extremes(curve), curvature_extremes(padded)
    assert np.array_equal(bends.phi, others.phi)
    assert check_undercut(inner_of(curve), "inner", bends) == check_undercut(
        inner_of(padded), "inner", others
    )


def test_hc10_without_a_stroke_all_curves_are_circles() -> None:
    params, _ = hard_case("HC10")
    curve = PitchCurve(plan_of(params, 0.0), TranslatingRoller(50.0, 10.0), 1)
    for offset, radius in ((-10.0, 40.0), (0.0, 50.0), (10.0, 60.0)):
        points = WorkingCurve(curve, offset).point(spread(100))
        assert np.abs(points) == pytest.approx(radius, rel=1e-15)


def test_hc13_findings_of_a_cam_with_its_inflection_at_a_millionth() -> None:
    """f'' = 2.9 10^6: curvature and undercut are reported, over a range of some 1e-5 degrees."""
    params = {"phi_H": SPANS, "lambda_rise": 1e-6, "lambda_return": 0.5}
    curve = PitchCurve(plan_of(params, 20.0), TranslatingRoller(50.0, 10.0), 1)
    assert_finite(check_undercut(inner_of(curve), "inner", curvature_extremes(curve)))
    outer = WorkingCurve(curve, 10.0)
    findings = check_undercut(outer, "outer", curvature_extremes(curve))
    assert_finite(findings)
    start, end = known(findings[0].cam_range)
    # f'' is 60 u (1 - u)(1 - 2 u)/(2 lambda), u = z/(2 lambda): concave from near the joint on.
    assert math.radians(30.0) <= start < end <= math.radians(30.0 + 1.01e-4)


@pytest.mark.parametrize("step", [0.2, *hard_case("HC24")[0]["others_with_the_same_fault"]])
def test_hc24_no_extra_row(step: float) -> None:
    rows = cam_angles(Decimal(str(step)))
    assert (len(rows), rows[-1]) == (round(360.0 / step), float(360 - Decimal(str(step))))


# Where the mechanism ends -----------------------------------------------------------------------


@pytest.mark.parametrize("case", ["HC15", "HC27"])
def test_hc15_and_hc27_the_follower_locks(case: str) -> None:
    """The guide touches the base circle, or the rocker passes the line of centres."""
    curve = pitch_curve_of({"kappa": 1, **hard_case(case)[0]})
    found = check_transmission_angle(curve, math.radians(45.0))
    assert (found.severity, found.unit) == ("broken", "deg")
    assert found.value == pytest.approx(0.0, abs=1e-12)
    assert curve.transmission_angle(np.array([known(found.cam_angle)])) == pytest.approx(
        [0.0], abs=1e-12
    )


@pytest.mark.parametrize("over", [1.0, 1.2, 3.0])
@pytest.mark.parametrize(
    ("follower", "stroke"),
    [
        (TranslatingRoller(50.0, 10.0), 20.0),
        (TranslatingRoller(50.0, 10.0, -12.0), 20.0),
        (OscillatingRoller(-90.0 + 20.0j, 70.0, 50.0, 8.0), 0.3),
    ],
)
def test_hc17_rollers_larger_than_the_base_circle(
    follower: TranslatingRoller | OscillatingRoller, stroke: float, over: float
) -> None:
    """In the rest the pitch curve is the base circle, its inner flank one on the other side."""
    pitch = PitchCurve(plan_of({"phi_H": SPANS}, stroke), follower, -1)
    curve, rest = with_roller(pitch, over * 50.0), angles(0, 10, 29, 300)
    inner, bends = inner_of(curve), curvature_extremes(curve)
    circle = curve.point(rest) * (1.0 - over)
    assert inner.point(rest) == pytest.approx(circle, rel=0.0, abs=ROUNDING * over * 50.0)
    assert inner.regularity(rest) == pytest.approx(np.full(4, 1.0 - over), abs=ROUNDING * over)
    findings = check_undercut(inner, "inner", bends)
    assert_finite(findings)
    assert {each.severity for each in findings} == {"no-disc"}
    if over > 1.0:
        ranges = undercut_ranges(inner, bends)
        assert any(start > end or end - start == TURN for start, end in ranges), "past 0"
        with pytest.raises(UndercutError, match="over the cam axis"):
            real_outline(inner)


# Where the roller centre stands still in the cam ------------------------------------------------


@st.composite
def standing_still(draw: st.DrawFn) -> tuple[PitchCurve, float]:
    """A cam with Z' = 0 in the middle of its rise, whose cam angle comes with it.

    The rocker swings inward to the line of centres, psi_G = psi_H/2, and l_1 is made to be
    l_3 (1 - sigma psi') there.
    """
    span = draw(st.integers(40, 150))
    swing = math.radians(draw(st.floats(4.0, 0.4 * span)))
    first = draw(st.integers(5, 40))
    arm = draw(st.floats(1.0, 500.0))
    top = 15.0 / 8.0 * swing / math.radians(span)
    # Inward: psi' = -top in the rise, so that sigma = +1 makes 1 + top.
    distance = arm * (1.0 + top)
    half = 0.5 * swing
    base = math.sqrt((distance - arm) ** 2 + 4.0 * distance * arm * math.sin(0.5 * half) ** 2)
    rocker = OscillatingRoller(complex(-distance, 0.0), arm, base, 0.1 * base, 1, -1)
    plan = plan_of({"phi_H": (first, span, 0, 150, 210 - span - first)}, swing)
    return PitchCurve(plan, rocker, 1), math.radians(first) + 0.5 * math.radians(span)


@attack
@given(case=standing_still())
def test_hc18_pitch_curves_with_a_real_cusp(case: tuple[PitchCurve, float]) -> None:
    curve, phi = case
    (finding,) = check_standstill(curve)
    assert (finding.name, finding.severity) == ("standstill", "no-disc")
    assert finding.cam_angle == pytest.approx(phi, abs=1e-6)
    assert_finite([finding])
    # Exactly there an error, or, where rounding has moved the cusp between two doubles, a number.
    for quantity in (curve.curvature, curve.transmission_angle, inner_of(curve).point):
        with suppress(GeometryError):
            assert np.all(np.isfinite(quantity(np.array([phi]))))


def test_hc18_what_has_no_value_at_a_cusp_is_refused() -> None:
    params, _ = hard_case("HC18")
    curve = pitch_curve_of(params)
    for quantity in (
        curve.curvature, curve.transmission_angle, curve.pressure_angle, curve.curvature_slope,
        curve.leverage, WorkingCurve(curve, -5.0).point,
    ):  # fmt: skip
        assert np.all(np.isfinite(quantity(angles(100))))
        with pytest.raises(GeometryError, match="stands still in the turning cam"):
            quantity(angles(params["phi_deg"]))
    # psi_t reaches -0.1 or 0.1 degrees where it stood still: 100 mm of it are 0.17 mm a rad.
    for start in (5.9, 6.1):
        assert check_standstill(pitch_curve_of(params | {"psi_G_deg": start})) == ()


# Curvature, cusps and lobes ---------------------------------------------------------------------


def test_hc22_the_tightest_place_of_a_lobe_that_is_symmetric_about_50_degrees() -> None:
    params, expected = hard_case("HC22")
    _, place = curvature_extremes(pitch_curve_of(params)).largest()
    off = abs(math.degrees(place) - 50.0)
    # A flat extremum has half the digits.
    assert off == pytest.approx(50.0 - float(expected["rho_convex_min_phi"]), abs=1e-6)


def test_hc20_the_radius_of_curvature_alone_may_be_infinite() -> None:
    kappa = np.array([-2.0, -(2.0**-900), -0.0, 0.0, 0.5])
    assert radius_of_curvature(kappa).tolist() == [-0.5, -(2.0**900), math.inf, math.inf, 2.0]


@pytest.mark.parametrize("excess", [1e-3, 1e-6, 1e-9, 0.0, -1e-9, -1e-6, -1e-3])
@pytest.mark.parametrize(
    ("base", "offset", "stroke", "spans", "sigma"),
    [
        (25.0, 0.0, 20.0, (30, 60, 40, 80, 150), 1),
        (25.0, 0.0, 20.0, (30, 60, 40, 80, 150), -1),
        (40.0, 12.0, 31.0, (20, 70, 25, 95, 150), 1),
        (18.0, -7.5, 14.0, (10, 55, 5, 60, 230), -1),
        (60.0, 20.0, 55.0, (0, 75, 0, 130, 155), 1),
    ],
)
def test_hc21_rollers_next_to_the_cusp_limit(
    base: float, offset: float, stroke: float, spans: tuple[int, ...], sigma: int, excess: float
) -> None:
    """The tightest place of these cams is within a move, not on a rest and not at a joint."""
    follower = TranslatingRoller(base, 1.0, offset)
    pitch = PitchCurve(plan_of({"phi_H": spans}, stroke), follower, sigma)
    bends = curvature_extremes(pitch)
    kappa, place = bends.largest()
    flank = inner_of(with_roller(pitch, (1.0 + excess) / kappa))
    (finding,) = check_undercut(flank, "inner", bends)
    name = "undercut-inner" if excess else "cusp-inner"
    assert (finding.name, finding.severity) == (name, "ok" if excess < 0.0 else "no-disc")
    assert finding.value == pytest.approx(-excess, abs=ROUNDING)
    ranges = undercut_ranges(flank, bends)
    assert ranges == ([finding.cam_range] if excess > 0.0 else [])
    for start, end in ranges:
        assert start < place < end
        assert flank.regularity(np.array([start, end])) == pytest.approx([0.0, 0.0], abs=ROUNDING)


@pytest.mark.parametrize("scale", [1.0, 1e-6])
@pytest.mark.parametrize(("case", "lobes"), [("HC21c", 0), ("HC22", 1), ("HC22b", 1)])
def test_hc21c_and_hc22_what_is_cut_off_between_crossings(
    case: str, lobes: int, scale: float
) -> None:
    """The neck of a lobe is cut through where it is left first, and the lobe falls off."""
    params, _ = hard_case(case)
    lengths = {key: scale * float(params[key]) for key in ("r_G", "r_R", "s_H")}
    flank = inner_of(pitch_curve_of(params | lengths))
    crossings, outline = find_crossings(flank), real_outline(flank)
    there = find_crossings(inner_of(pitch_curve_of(params)))
    for one, two in zip(crossings, there, strict=True):
        assert (one.first, one.second) == pytest.approx((two.first, two.second), abs=1e-11)
        assert one.point == pytest.approx(scale * two.point, rel=1e-12)
    tips = [path.pivots[0].centre for path in (outline.path, *outline.lobes)]
    assert len(outline.lobes) == lobes
    assert tips == pytest.approx([each.point for each in crossings], rel=1e-12)
    dropped = [[crossings[0].first, crossings[0].second]]
    assert outline.dropped == pytest.approx(np.array(dropped), abs=1e-11)


# Scales -----------------------------------------------------------------------------------------


def assert_finite(findings: Any) -> None:
    """No number of a finding is NaN or infinite."""
    for finding in findings:
        assert isinstance(finding, Finding)
        numbers = [finding.value, finding.limit, finding.cam_angle, *(finding.cam_range or ())]
        assert all(math.isfinite(n) for n in numbers if n is not None), finding
        assert "nan" not in finding.sentence.split()
        assert "inf" not in finding.sentence.split()


def spread(count: int) -> FloatArray:
    """Cam angles that are no joints."""
    return np.array([(k + 0.37) * TURN / count for k in range(count)])


SCALES = [1e-6, 1e-3, 1e3, 1e6]


SCENE = """camgeo = 1
name = "scale"
[cam]
rotation = "{sense}"
[follower]
kind = "{kind}"
base_radius = {base}
roller_radius = {roller}
{own}
[[motion]]
dwell = 30
[[motion]]
law = "polynomial-345"
span = 60
to = {stroke}
[[motion]]
dwell = 40
[[motion]]
law = "modified-sine"
span = 80
to = 0
[[motion]]
dwell = 150
[output]
tolerance = {tolerance}
"""


def scene(kind: str, factor: float, roller: float, sense: str = "ccw") -> Design:
    """A cam with a base radius of 40 times `factor` [mm], read from text."""
    translating = kind == "translating-roller"
    pivot = f"pivot = [{-60.0 * factor!r}, {-50.0 * factor!r}]\narm = {70.0 * factor!r}"
    text = SCENE.format(
        sense=sense,
        kind=kind,
        base=repr(40.0 * factor),
        roller=repr(roller * factor),
        own=f"offset = {5.0 * factor!r}" if translating else pivot,
        stroke=repr(20.0 * factor) if translating else "20",
        # The format's own limits: 1e-7 to 1 mm.
        tolerance=repr(min(1.0, max(1e-7, 1e-4 * factor))),
    )
    return Design(parse_scene(text))


ROUNDED = ("closure", "tangent-closure")
"""Findings whose value is a rounding, and its place that of the largest one."""


def place_of(finding: Finding) -> tuple[str, float | None]:
    """What distinguishes a finding from others of the same design."""
    if finding.cam_angle is None or finding.name in ROUNDED:
        return finding.name, None
    return finding.name, round(finding.cam_angle, 6)


@pytest.mark.parametrize("factor", SCALES)
@pytest.mark.parametrize(
    ("kind", "roller"),
    [("translating-roller", 41.0), ("oscillating-roller", 8.0)],
)
def test_scenes_at_all_scales_give_the_same_findings(
    kind: str, roller: float, factor: float
) -> None:
    one, two = scene(kind, 1.0, roller), scene(kind, factor, roller)
    stated, there = ({place_of(f): f for f in each.findings} for each in (one, two))
    assert stated.keys() == there.keys()
    assert_finite(two.findings)
    for key, finding in stated.items():
        other = there[key]
        assert finding.severity == other.severity
        if finding.name in ROUNDED:
            continue
        if finding.value is None or other.value is None:
            assert finding.value == other.value
            continue
        size = factor if finding.unit.startswith("mm") else 1.0
        assert other.value == pytest.approx(size * finding.value, rel=1e-12, abs=1e-12 * size)
    phi = spread(200)
    assert two.disc.pictured.curve("pitch", phi) == pytest.approx(
        factor * one.disc.pictured.curve("pitch", phi), rel=1e-12, abs=1e-13 * factor
    )
