"""Form closure and closing error, compared with dense values and with inexact discs; linkages of
the drive: dead centres, transmission angles, and what keeps clear of them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Final

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.replay import closing_error
from camgeo.check.judge import check_pair, leverage_slope
from camgeo.check.machine import check_linkage
from camgeo.design.design import Design
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.outline.path import whole
from camgeo.geometry.outline.replay import replay_contour
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.linkage import Linkage, LinkedMotion, clear_range
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, return_on_lever
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.findings import known
from tests.integrals import cells, integrals
from tests.pairs import Pair, pairs
from tests.reference import POLYNOMIAL, mechanisms, pitch_curve_of
from tests.strategies import attack, four_bars, signs, slider_cranks, slider_driven_cranks

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
PAIRS = ("conjugate_lever", "conjugate_carriage")

TOLERANCE = 1e-3

DENSE = np.linspace(0.0, TURN, 20_001)


@settings(attack, max_examples=20)
@given(pairs())
def test_the_slope_of_the_leverage_is_its_derivative(pair: Pair) -> None:
    """Its integral over cells of every smooth piece is the difference of the leverage."""
    for curve in (pair.main, pair.other):
        low, high = cells(curve.borders, 8)

        def slope(phi: FloatArray, curve: PitchCurve = curve) -> FloatArray:
            return leverage_slope(curve, phi, "right")

        grown = curve.leverage(high, "left") - curve.leverage(low)
        # The leverage is known to some ten roundings, Gauss's rule to no more than as many.
        slack = 1e-12 * abs(curve.follower.reach)
        assert integrals(slope, low, high) == pytest.approx(grown, abs=slack)


@settings(attack, max_examples=30)
@given(pairs())
def test_the_extremes_are_those_of_dense_values(pair: Pair) -> None:
    closed, closing = check_pair(pair.main, pair.other, TOLERANCE, 1.0)
    assert (closed.name, closed.severity) == ("form-closure", "ok")
    assert (closing.name, closing.severity) == ("closing-error", "ok")
    one, two = (curve.leverage(DENSE) for curve in (pair.main, pair.other))
    product = one * two / abs(pair.main.follower.reach * pair.other.follower.reach)
    play = TOLERANCE * abs(pair.main.follower.reach) * (1.0 / np.abs(one) + 1.0 / np.abs(two))
    # Between two of the dense places lies no more than their next difference.
    for found, dense in ((closed, product), (closing, play)):
        slack = float(np.max(np.abs(np.diff(dense, 2))))
        assert np.max(dense) - 1e-12 <= known(found.value) <= np.max(dense) + slack + 1e-12


def test_two_discs_on_one_side_of_the_lever_do_not_close() -> None:
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    main = design.cam.follower
    assert isinstance(main, OscillatingRoller)
    other = return_on_lever(main, math.radians(-20.0))
    curve = PitchCurve(design.cam.drive.motion, other, design.cam.rotation)
    (closed,) = check_pair(design.cam.disc.pitch_curve, curve, TOLERANCE, 1.0)
    assert (closed.name, closed.severity) == ("form-closure", "broken")
    assert known(closed.value) > 0.0
    assert closed.cam_angle is not None
    assert "do not hold the follower" in closed.sentence


def test_a_lever_that_swings_through_the_line_of_centres_does_not_close() -> None:
    """The return arm 5 degrees off the line, swinging 14 over it: closed at cam angle 0 only."""
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    main = design.cam.follower
    assert isinstance(main, OscillatingRoller)
    chi = main.start_angle + math.radians(5.0)
    curve = PitchCurve(design.cam.drive.motion, return_on_lever(main, chi), design.cam.rotation)
    start = np.zeros(1)
    assert design.cam.disc.pitch_curve.leverage(start) * curve.leverage(start) < 0.0
    (closed,) = check_pair(design.cam.disc.pitch_curve, curve, TOLERANCE, 1.0)
    assert closed.severity == "broken"
    assert 40.0 < math.degrees(known(closed.cam_angle)) < 300.0


@pytest.mark.parametrize("scene", PAIRS)
def test_the_limit_is_the_scenes(scene: str) -> None:
    spec = camgeo.load(SCENES / f"{scene}.toml").scene
    for limit, severity in ((0.001, "broken"), (0.02, "ok")):
        findings = Design(spec.with_values({"limits.closing_error": limit})).findings
        (closing,) = [each for each in findings if each.name == "closing-error"]
        assert (closing.severity, closing.limit) == (severity, limit)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("scene", PAIRS)
def test_discs_that_are_off_by_the_tolerance_leave_that_play(scene: str, sign: float) -> None:
    """Both discs made larger or smaller by the tolerance all round, and replayed.

    The discs are fitted to a thousandth of it, and the way along the flank that the roller makes
    with it, the tolerance over 40 mm, changes the leverage by a part in 1e4 at most.
    """
    design = camgeo.load(SCENES / f"{scene}.toml")
    assert len(design.discs) == 2
    closing = next(each for each in design.findings if each.name == "closing-error")
    tolerance = design.scene.output.tolerance
    replays = []
    for disc in design.discs:
        flank = WorkingCurve(
            disc.cam.disc.pitch_curve, sign * tolerance - disc.cam.follower.roller_radius
        )
        contour = fit_arcs(whole(flank), 1e-3 * tolerance).contour
        replays.append(replay_contour(disc.cam.disc.pitch_curve, contour))
    found = closing_error(replays[0], replays[1])
    reach = abs(design.cam.follower.reach)
    worst = found.lowest if sign > 0.0 else found.highest
    assert -sign * reach * worst.value == pytest.approx(known(closing.value), rel=1.2e-3)


# Linkages -----------------------------------------------------------------------------------------

LINKED = [name for name, case in mechanisms().items() if case["params"]["kind"] == "cam_linkage"]


def acute(one: ComplexArray, other: ComplexArray) -> FloatArray:
    """[deg] between two lines."""
    return np.degrees(np.arcsin(np.abs(np.sin(np.angle(one / other)))))


def far_angle(linkage: Linkage, position: FloatArray) -> FloatArray:
    """[deg] between the coupler and the far member, or the normal of a slider's guide."""
    pin, tip = linkage.joints(position)
    if isinstance(linkage, FourBar):
        return acute(pin - tip, pin - linkage.shaft)
    return acute(pin - tip, np.full_like(tip, 1j) if linkage.member == "slider" else tip)


def near_angle(linkage: Linkage, position: FloatArray) -> FloatArray:
    """The same at the follower's end."""
    pin, tip = linkage.joints(position)
    return acute(pin - tip, np.full_like(tip, 1j) if linkage.member == "crank" else tip)


MEASURES: Final[dict[str, Callable[[Linkage, FloatArray], FloatArray]]] = {
    "dead-centre": lambda linkage, position: -linkage.missing_length(position),
    "linkage-transmission-angle": far_angle,
    "linkage-back-angle": near_angle,
}
"""What the findings should say, from the positions of the joints."""


def moving(linkage: Linkage, to: float) -> LinkedMotion:
    """A rest, a move of the far end to `to` [mm or rad], and back."""
    third = Decimal(120)
    moves = Dwell(third), Move(third, to, POLYNOMIAL), Move(third, 0.0, POLYNOMIAL)
    return LinkedMotion(MotionPlan(moves), linkage)


def linked() -> list[LinkedMotion]:
    bar = FourBar(70.0, 120.0, 85.0, 110.0 + 30.0j, math.radians(120.0), -1, -1)
    slide = SliderCrank(40.0, 110.0, math.radians(25.0), True, 1, -1, 1)
    return [
        moving(bar, math.radians(22.0)),
        moving(bar, math.radians(-45.0)),
        moving(SliderDrivenCrank(slide), math.radians(-40.0)),
        # On its way coupler and crank come to lie on one line: the crank passes, the slider turns.
        moving(SliderDrivenCrank(slide), math.radians(150.0)),
        moving(slide, -30.0),
    ]


def of_the_thesis(name: str, **other: str) -> LinkedMotion:
    motion = pitch_curve_of({**mechanisms()[name]["params"], **other}).motion
    assert isinstance(motion, LinkedMotion)
    return motion


@pytest.mark.parametrize("name", LINKED)
def test_the_linkages_of_the_thesis_need_no_word(name: str) -> None:
    found = check_linkage(of_the_thesis(name), math.radians(50.0))
    assert {each.severity for each in found} == {"ok"}


@pytest.mark.parametrize("name", LINKED)
def test_the_other_branch_is_worth_a_warning(name: str) -> None:
    """HC25 and the like of the other tables: "coupler parallel to the guide at s = 0 only" here."""
    branch = mechanisms()[name]["params"]["q23"]
    motion = of_the_thesis(name, q23="zweiter" if branch == "erster" else "erster")
    (found,) = (each for each in check_linkage(motion) if each.severity != "ok")
    assert found.name == "linkage-branch"
    assert isinstance(motion.linkage, SliderCrank)
    assert found.severity == "warning"
    assert found.cam_angle == 0.0
    assert found.value is not None
    assert found.value > known(found.limit)
    tilt = abs(math.sin(motion.linkage.coupler_angle))
    assert math.sin(math.radians(found.value)) == pytest.approx(tilt, rel=1e-12)


@pytest.mark.parametrize(("short", "reached"), [(1e-3, False), (1e-9, True), (0.0, True)])
def test_a_dead_centre_at_the_end_of_the_stroke(short: float, reached: bool) -> None:
    """The reserve is at most the present stroke: 1e-3 mm is above the limit, 1e-9 below."""
    linkage = SliderCrank(40.0, 60.0, 0.3, True, 1, 1, 1)
    stroke = max(linkage.dead_strokes) - short
    found = [each for each in check_linkage(moving(linkage, stroke)) if each.severity == "no-disc"]
    assert [finding.name for finding in found] == (["dead-centre"] if reached else [])
    if reached:
        assert f"at stroke {stroke:.6g} mm" in found[0].sentence


def test_a_dead_centre_inside_the_stroke_is_found_though_both_ends_are_clear() -> None:
    """Folded, crank and coupler just reach the pin where it passes nearest, 30 mm off."""
    linkage = SliderCrank(30.0 / math.cos(0.4), 30.0 / math.cos(0.4) + 30.0, 0.4, True, 1, -1, 1)
    (found,) = check_linkage(moving(linkage, 1.5 * linkage.start_position))
    assert found.name == "dead-centre"
    assert f"at stroke {linkage.start_position:.6g} mm" in found.sentence


def wide_motions() -> st.SearchStrategy[LinkedMotion]:
    """Linkages whose far end moves as far as it can, often past where it is stuck."""

    def motion(linkage: Linkage, share: float, way: int) -> LinkedMotion:
        low, high = clear_range(linkage)
        far = 2.0 * linkage.crank if linkage.unit == "mm" else TURN
        end = min(high, far) if way > 0 else max(low, -far)
        return moving(linkage, share * end)

    linkages = st.one_of(slider_cranks(), four_bars(), slider_driven_cranks())
    return st.builds(motion, linkages, st.floats(0.1, 0.99), signs())


@attack
@given(wide_motions())
def test_the_least_distance_and_angles_and_a_passage_through_0_are_found(
    motion: LinkedMotion,
) -> None:
    """Compared with samples of the positions, whose signed sine shows where the angle passes 0.

    Samples may miss two zeros next to each other.
    """
    told = check_linkage(motion, 0.5)
    assume(told[0].severity == "ok")  # the pin may pass through the shaft itself
    end = motion.demanded.jet(np.radians([240.0]))[0][0]
    position = np.linspace(0.0, end, 4001)
    linkage = motion.linkage
    for each, measure in zip(told, MEASURES.items(), strict=False):
        assert each.name == measure[0]
        assert known(each.value) <= float(np.min(measure[1](linkage, position))) + 1e-9
        at = motion.demanded.jet(np.array([known(each.cam_angle)]))[0]
        # The position is known to within the rounding of the cam angle at the fastest motion.
        assert measure[1](linkage, at)[0] == pytest.approx(each.value, rel=1e-6, abs=1e-6)
    found = told[1]
    pin, tip = linkage.joints(position)
    if isinstance(linkage, FourBar):
        member = pin - linkage.shaft
    else:
        member = tip if linkage.member == "crank" else np.full_like(tip, 1j)
    sines = np.sin(np.angle((pin - tip) / member))
    if np.any(sines > 0.0) and np.any(sines < 0.0):
        assert found.severity == "no-disc"
    fatal = found.severity == "no-disc"
    assert fatal == (found.value == 0.0)
    assert fatal or found.severity == ("broken" if known(found.value) < math.degrees(0.5) else "ok")


def test_a_crank_cannot_be_driven_through_the_line_of_its_coupler() -> None:
    """The slider has an extreme there and the cam is regular, but the coupler pushes through the
    crank's shaft, so the crank could stop or turn back.
    """
    spare, fatal, back = check_linkage(linked()[3], math.radians(40.0))
    assert (spare.severity, fatal.severity, back.severity) == ("ok", "no-disc", "ok")
    assert (fatal.value, fatal.unit) == (0.0, "deg")
    assert fatal.limit == pytest.approx(40.0)
    assert "crank and coupler come into line" in fatal.sentence
    assert "the slider cannot turn the crank" in fatal.sentence
    (kept,) = re.findall(r"kept between \S+ and (\S+) degrees it is driven", fatal.sentence)
    linkage = linked()[3].linkage
    _, driven, _ = check_linkage(moving(linkage, math.radians(float(kept))))
    assert driven.severity == "ok"


@pytest.mark.parametrize("short", [1e-3, 1e-6, 0.0, -1e-6])
def test_a_far_member_that_stops_where_it_is_stuck(short: float) -> None:
    """Stuck at the end of its motion, within rounding of it, or a little before or beyond."""
    linkage = FourBar(70.0, 60.0, 85.0, 110.0 + 30.0j, math.radians(120.0), -1, -1)
    (stuck,) = linkage.locked_positions(-math.pi / 3.0, 0.0)
    found = check_linkage(moving(linkage, stuck + short), math.radians(40.0))[1]
    assert found.severity == ("broken" if short > 0.0 else "no-disc")
    at = stuck + max(short, 0.0)
    assert found.value == pytest.approx(far_angle(linkage, np.array([at]))[0], rel=1e-6, abs=1e-9)
    assert "coupler and lever" in found.sentence


def test_what_keeps_clear_of_a_dead_centre_is_named_and_works() -> None:
    linkage = SliderCrank(40.0, 60.0, 0.3, True, 1, 1, 1)
    reach = max(linkage.dead_strokes)
    (fatal,) = check_linkage(moving(linkage, reach))
    assert fatal.cam_angle == pytest.approx(math.radians(240.0))
    (kept,) = re.findall(r"kept between \S+ and (\S+) mm there is none", fatal.sentence)
    assert float(kept) == pytest.approx(reach, rel=1e-5)
    assert check_linkage(moving(linkage, float(kept)))[0].severity == "ok"
