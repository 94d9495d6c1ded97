"""Flocke's construction and the smallest base circle against the reference, to its digits."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

import pytest

from camgeo.check.sizing.smallest import Sizing, flocke, rate, size
from camgeo.check.sizing.task import Task, task_of
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.cams import cam_of
from tests.reference import POLYNOMIAL, reference

CASES: dict[str, dict[str, Any]] = reference("flocke_reference.json")
TRANSLATING = [name for name in CASES if name.startswith("trans")]
OSCILLATING = [name for name in CASES if name.startswith("osc")]

FIRST, SECOND = 30, 40
"""Spans of the first two rests; the reference does not depend on them."""

# A small roller: the reference knows no rule for the curvature.
ROLLER = 1e-6

FOOT = "trans_F_s+1_mu30_asym"
"""The cam axis lies on the border of one condition there, not where two of them meet."""

FLOCKE_OSCILLATING = {
    "osc_F_s+1_mu45": (34.5168, 48.96),
    "osc_F_s-1_mu45": (34.5168, 49.61),
    "osc_P_s-1_mu45": (68.3244, 48.96),
}
"""Base radius [mm] and true smallest transmission angle [deg] as printed in its table."""


def reference_task(name: str) -> Task:
    given = CASES[name]["args"]
    rise, back = given["phi_HP"], given["phi_HN"]
    stroke = float(given["s_H"]) if "s_H" in given else math.radians(given["psi_H"])
    # P and N are the senses of the rocker or of a rise with a positive direction.
    plan = MotionPlan(
        (
            Dwell(Decimal(FIRST)),
            Move(Decimal(rise), stroke, POLYNOMIAL),
            Dwell(Decimal(SECOND)),
            Move(Decimal(back), 0.0, POLYNOMIAL),
            Dwell(Decimal(360 - FIRST - SECOND - rise - back)),
        )
    )
    follower: TranslatingRoller | OscillatingRoller
    if "s_H" in given:
        follower = TranslatingRoller(200.0, ROLLER, direction=given["kappa"])
    else:
        arm = float(given["l_3"])
        follower = OscillatingRoller(100 + 0j, arm, 90.0, ROLLER, 1, given["kappa_ccw"])
    return task_of(cam_of(plan, follower, given["sigma"]))


def sized(name: str) -> Sizing:
    return size(reference_task(name), math.radians(CASES[name]["args"]["mu_min"]), 1.0)


def rise_and_return(name: str) -> tuple[float, float, float, float]:
    given = CASES[name]["args"]
    rise, back = given["phi_HP"], given["phi_HN"]
    return FIRST, rise, FIRST + rise + SECOND, back


def test_every_key_is_compared() -> None:
    assert sorted(CASES) == sorted(TRANSLATING + OSCILLATING)
    assert len(CASES) == 11
    common = {"phi_HP", "phi_HN", "mu_min", "sigma"}
    for name in TRANSLATING:
        assert set(CASES[name]) == {
            "args", "m1", "m2", "e", "s_G", "r_G", "active1", "active2", "true_mu_min", "flocke",
        }  # fmt: skip
        assert set(CASES[name]["args"]) == common | {"s_H", "kappa"}
        assert set(CASES[name]["flocke"]) == {"e", "s_G", "r_G", "true_mu_min"}
    for name in OSCILLATING:
        assert set(CASES[name]) == {"args", "chi0_deg", "A0", "z", "r_G", "l_1"}
        assert set(CASES[name]["args"]) == common | {"l_3", "psi_H", "kappa_ccw"}
        assert CASES[name]["chi0_deg"] == 90


@pytest.mark.parametrize("name", TRANSLATING)
def test_bounds_of_the_region_are_the_reference(name: str) -> None:
    """s_G + T e >= m1 and s_G - T e >= m2, the largest bounds over the turn."""
    case, task = CASES[name], reference_task(name)
    tangent = math.tan(math.radians(case["args"]["mu_min"]))
    for key, t in (("m1", tangent), ("m2", -tangent)):
        assert -task.slack(0j, t).smallest()[0] == pytest.approx(float(case[key]), rel=1e-12)


@pytest.mark.parametrize("name", TRANSLATING)
def test_translating_is_the_reference(name: str) -> None:
    case, found = CASES[name], sized(name)
    assert found.answer is not None
    place = found.answer.place
    assert place.real == pytest.approx(float(case["e"]), abs=1e-12)
    assert -place.imag == pytest.approx(float(case["s_G"]), rel=1e-12)
    assert found.answer.base_radius == pytest.approx(float(case["r_G"]), rel=1e-12)
    # The reference finds this minimum by samples: it is good to 1e-5 degrees, from above.
    mu = math.degrees(found.answer.transmission_angle.value)
    assert mu == pytest.approx(float(case["true_mu_min"]), abs=1e-5)


@pytest.mark.parametrize("name", TRANSLATING)
def test_translating_is_decided_where_the_reference_says(name: str) -> None:
    case, found = CASES[name], sized(name)
    start, rise, second, back = rise_and_return(name)
    expected = []
    for key in ("active1", "active2"):
        move, z = case[key]
        expected.append(start + rise * float(z) if move == "rise" else second + back * float(z))
    reported = [math.degrees(each.cam_angle) for each in found.active]
    assert {each.name for each in found.active} == {"transmission-angle"}
    if name == FOOT:
        expected = expected[:1]
    assert reported == pytest.approx(sorted(expected), abs=1e-9 * 360.0)


@pytest.mark.parametrize("name", TRANSLATING)
def test_flocke_is_the_reference(name: str) -> None:
    case, task = CASES[name]["flocke"], reference_task(name)
    place = flocke(task, math.tan(math.radians(CASES[name]["args"]["mu_min"]))).place
    assert place is not None
    assert place.real == pytest.approx(float(case["e"]), abs=1e-12)
    assert -place.imag == pytest.approx(float(case["s_G"]), rel=1e-12)
    assert abs(place) == pytest.approx(float(case["r_G"]), rel=1e-12)
    rating = rate(task, place)
    assert rating is not None
    # The reference finds this minimum by samples: it is good to 1e-5 degrees, from above.
    mu = math.degrees(rating.transmission_angle.value)
    assert mu == pytest.approx(float(case["true_mu_min"]), abs=1e-5)


@pytest.mark.parametrize("name", OSCILLATING)
def test_oscillating_is_the_reference(name: str) -> None:
    case, found = CASES[name], sized(name)
    assert found.answer is not None
    place = found.answer.place
    assert found.answer.base_radius == pytest.approx(float(case["r_G"]), rel=1e-12)
    assert abs(place) == pytest.approx(float(case["l_1"]), rel=1e-12)
    # Its rocker points upwards at the start, and its cam axis lies clockwise of it.
    x, y = (float(value) for value in case["A0"])
    assert (-place.imag, place.real) == pytest.approx((x, y), rel=1e-12)


@pytest.mark.parametrize("name", OSCILLATING)
def test_oscillating_is_decided_where_the_reference_says(name: str) -> None:
    found = sized(name)
    start, rise, second, back = rise_and_return(name)
    reported = [math.degrees(each.cam_angle) for each in found.active]
    places = [
        (each - start) / rise if each < second else (each - second) / back for each in reported
    ]
    assert sorted(places) == pytest.approx(sorted(map(float, CASES[name]["z"])), abs=1e-9)


@pytest.mark.parametrize("name", FLOCKE_OSCILLATING)
def test_flocke_of_a_rocker_is_as_printed(name: str) -> None:
    radius, angle = FLOCKE_OSCILLATING[name]
    found = sized(name).flocke
    assert found is not None
    assert found.base_radius == pytest.approx(radius, abs=0.5e-4)
    assert math.degrees(found.transmission_angle.value) == pytest.approx(angle, abs=0.5e-2)
