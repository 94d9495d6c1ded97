from __future__ import annotations

import math
from decimal import Decimal

import pytest

from camgeo.check.linkage import DEAD_CENTRE, check_linkage
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.motion.plan import Dwell, MotionPlan, Move
from tests.reference import POLYNOMIAL, hard_case, mechanisms, pitch_curve_of

LINKED = [name for name, case in mechanisms().items() if case["params"]["kind"] == "cam_linkage"]


@pytest.mark.parametrize("name", LINKED)
def test_the_linkages_of_the_thesis_need_no_word(name: str) -> None:
    motion = pitch_curve_of(mechanisms()[name]["params"]).motion
    assert isinstance(motion, LinkedMotion)
    assert check_linkage(motion) == ()


@pytest.mark.parametrize("name", LINKED)
def test_the_other_branch_is_worth_a_warning(name: str) -> None:
    """HC25 and the like of the other tables: "coupler parallel to the guide at s = 0 only" here."""
    params = dict(mechanisms()[name]["params"])
    params["q23"] = "zweiter" if params["q23"] == "erster" else "erster"
    motion = pitch_curve_of(params).motion
    assert isinstance(motion, LinkedMotion)
    (found,) = check_linkage(motion)
    assert found.name == "linkage-branch"
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
    assert found.severity == "fatal"
    assert found.unit == "mm"
    assert found.value == pytest.approx(0.0, abs=1e-13)
    assert found.limit == DEAD_CENTRE * 100.0
    assert "at stroke 0 mm" in found.sentence


@pytest.mark.parametrize(("short", "fatal"), [(1e-3, False), (1e-9, True), (0.0, True)])
def test_a_dead_centre_at_the_end_of_the_stroke(short: float, fatal: bool) -> None:
    """What is spare is at most the stroke that is: 1e-3 mm are more, 1e-9 less than the limit."""
    linkage = SliderCrank(40.0, 60.0, 0.3, True, 1, 1, 1)
    stroke = max(linkage.dead_strokes) - short
    found = check_linkage(moving(linkage, stroke))
    assert [finding.name for finding in found] == (["dead-centre"] if fatal else [])
    if fatal:
        assert f"at stroke {stroke:.6g} mm" in found[0].sentence


def test_a_dead_centre_inside_the_stroke_is_found_though_both_ends_are_clear() -> None:
    """Folded, crank and coupler just reach the pin where it passes nearest, 30 mm off."""
    linkage = SliderCrank(30.0 / math.cos(0.4), 30.0 / math.cos(0.4) + 30.0, 0.4, True, 1, -1, 1)
    (found,) = check_linkage(moving(linkage, 1.5 * linkage.start_position))
    assert found.name == "dead-centre"
    assert f"at stroke {linkage.start_position:.6g} mm" in found.sentence
