from __future__ import annotations

import math
import re
from decimal import Decimal

import numpy as np
import pytest

from camgeo.check.linkage import DEAD_CENTRE, check_linkage
from camgeo.mechanism.four_bar import FourBar
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.motion.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.reference import POLYNOMIAL, hard_case, mechanisms, pitch_curve_of

LINKED = [name for name, case in mechanisms().items() if case["params"]["kind"] == "cam_linkage"]


@pytest.mark.parametrize("name", LINKED)
def test_the_linkages_of_the_thesis_need_no_word(name: str) -> None:
    motion = pitch_curve_of(mechanisms()[name]["params"]).motion
    assert isinstance(motion, LinkedMotion)
    found = check_linkage(motion)
    assert [each.name for each in found] == ["dead-centre", "linkage-transmission-angle"]
    assert {each.severity for each in found} == {"ok"}
    # Both are extremes over the turn, and taken at the angle they name.
    dense = np.linspace(0.0, TURN, 3601)
    stroke = motion.demanded.jet(dense)[0]
    pin, tip = motion.linkage.joints(stroke)
    between = np.degrees(np.abs(np.arcsin(np.sin(np.angle((pin - tip) / tip)))))
    spare, angle = (each.value for each in found)
    assert spare is not None
    assert angle is not None
    least = float(np.min(-motion.linkage.missing_length(stroke)))
    # Extremes lie 0.05 deg from a sample at most, at ends of the stroke to the second order.
    assert 0.0 <= least - spare <= 1e-4
    assert 0.0 <= float(np.min(between)) - angle + 1e-9 <= 1e-4
    for each, expected in zip(found, (spare, angle), strict=True):
        assert each.cam_angle is not None
        at = motion.demanded.jet(np.array([each.cam_angle]))[0]
        pin, tip = motion.linkage.joints(at)
        turned = math.degrees(abs(math.asin(math.sin(np.angle((pin - tip) / tip)[0]))))
        value = turned if each.unit == "deg" else -motion.linkage.missing_length(at)[0]
        assert value == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("name", LINKED)
def test_the_other_branch_is_worth_a_warning(name: str) -> None:
    """HC25 and the like of the other tables: "coupler parallel to the guide at s = 0 only" here."""
    params = dict(mechanisms()[name]["params"])
    params["q23"] = "zweiter" if params["q23"] == "erster" else "erster"
    motion = pitch_curve_of(params).motion
    assert isinstance(motion, LinkedMotion)
    (found,) = (each for each in check_linkage(motion) if each.severity != "ok")
    assert found.name == "linkage-branch"
    assert isinstance(motion.linkage, SliderCrank)
    assert found.severity == "warning"
    assert found.cam_angle == 0.0
    assert found.value is not None
    assert found.limit is not None
    assert found.value > found.limit
    tilt = abs(math.sin(motion.linkage.coupler_angle))
    assert math.sin(math.radians(found.value)) == pytest.approx(tilt, rel=1e-12)


def moving(linkage: SliderCrank, stroke: float) -> LinkedMotion:
    third = Decimal(120)
    plan = MotionPlan((Dwell(third), Move(third, stroke, POLYNOMIAL), Move(third, 0.0, POLYNOMIAL)))
    return LinkedMotion(plan, linkage)


def test_hc05_a_dead_centre_at_the_start_is_fatal() -> None:
    params, _ = hard_case("HC05")
    linkage = SliderCrank(params["l_sk"], params["l_4"], 0.5 * math.pi, False, 1, -1, 1)
    (found,) = check_linkage(moving(linkage, params["s_H"]))
    assert found.name == "dead-centre"
    assert found.severity == "no-disc"
    assert found.unit == "mm"
    assert found.value == pytest.approx(0.0, abs=1e-13)
    assert found.limit == DEAD_CENTRE * 100.0
    assert "at stroke 0 mm" in found.sentence


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


def linked() -> list[LinkedMotion]:
    bar = FourBar(70.0, 120.0, 85.0, 110.0 + 30.0j, math.radians(120.0), -1, -1)
    slide = SliderCrank(40.0, 110.0, math.radians(25.0), True, 1, -1, 1)
    return [
        LinkedMotion(turning(math.radians(22.0)), bar),
        LinkedMotion(turning(math.radians(-45.0)), bar),
        LinkedMotion(turning(math.radians(-40.0)), SliderDrivenCrank(slide)),
        # On its way coupler and crank come to lie on one line: the crank passes, the slider turns.
        LinkedMotion(turning(math.radians(150.0)), SliderDrivenCrank(slide)),
        LinkedMotion(turning(-30.0), slide),
    ]


def turning(to: float) -> MotionPlan:
    third = Decimal(120)
    return MotionPlan((Dwell(third), Move(third, to, POLYNOMIAL), Move(third, 0.0, POLYNOMIAL)))


@pytest.mark.parametrize("motion", linked(), ids=range(5))
def test_distance_and_angle_are_the_least_of_samples(motion: LinkedMotion) -> None:
    spare, angle = check_linkage(motion)
    position = motion.demanded.jet(np.linspace(0.0, TURN, 7201))[0]
    pin, tip = motion.linkage.joints(position)
    between = np.degrees(np.arcsin(np.abs(np.sin(np.angle((pin - tip) / tip)))))
    assert spare.value is not None
    assert angle.value is not None
    # A step of 0.05 deg moves the far end by 2e-3 rad or 1e-1 mm at most, the angle by as much
    # in its order; ends and turns are of the second order, a passage of the line is a kink.
    least = float(np.min(-motion.linkage.missing_length(position)))
    assert -1e-12 <= least - spare.value <= 1e-3
    assert -1e-9 <= float(np.min(between)) - angle.value <= 0.2


def test_a_crank_in_line_with_its_coupler_is_no_dead_centre_of_the_slider() -> None:
    found = check_linkage(linked()[3])
    assert [each.severity for each in found] == ["ok", "ok"]
    assert found[1].value == 0.0


def test_what_keeps_clear_of_a_dead_centre_is_named_and_works() -> None:
    linkage = SliderCrank(40.0, 60.0, 0.3, True, 1, 1, 1)
    reach = max(linkage.dead_strokes)
    (fatal,) = check_linkage(moving(linkage, reach))
    assert fatal.cam_angle == pytest.approx(math.radians(240.0))
    (kept,) = re.findall(r"kept between \S+ and (\S+) mm there is none", fatal.sentence)
    assert float(kept) == pytest.approx(reach, rel=1e-5)
    assert check_linkage(moving(linkage, float(kept)))[0].severity == "ok"
