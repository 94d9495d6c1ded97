"""Sizes against the reference and closed forms, and random ones against the checks.

The checks themselves, which know nothing of sizing, decide whether a cam is sound."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Cam, Contact
from camgeo.check.disc import disc_findings
from camgeo.check.finding import NO_OUTLINE, Limits
from camgeo.check.sizing.face import FaceTask
from camgeo.check.sizing.rounding import decimal_exponent, rounded, rounded_face
from camgeo.check.sizing.smallest import Rating, Sizing, flocke
from camgeo.check.sizing.task import RollerTask
from camgeo.errors import GeometryError
from camgeo.geometry.pieces import convexity, touch
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.cams import cam_of
from tests.findings import known
from tests.laws import LAWS
from tests.long_form import examples
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


def reference_task(name: str) -> RollerTask:
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
    return RollerTask.from_cam(cam_of(plan, follower, given["sigma"]))


def sized(name: str) -> Sizing:
    return Sizing.solve(reference_task(name), math.radians(CASES[name]["args"]["mu_min"]), 1.0)


def rise_and_return(name: str) -> tuple[float, float, float, float]:
    given = CASES[name]["args"]
    rise, back = given["phi_HP"], given["phi_HN"]
    return FIRST, rise, FIRST + rise + SECOND, back


@pytest.mark.parametrize("name", TRANSLATING)
def test_translating_is_the_reference(name: str) -> None:
    """Its place, and the cam angles that decide."""
    case, found = CASES[name], sized(name)
    assert found.answer is not None
    place = found.answer.place
    assert place.real == pytest.approx(float(case["e"]), abs=1e-12)
    assert -place.imag == pytest.approx(float(case["s_G"]), rel=1e-12)
    assert found.answer.base_radius == pytest.approx(float(case["r_G"]), rel=1e-12)
    # The reference finds this minimum by samples: it is good to 1e-5 degrees, from above.
    mu = math.degrees(found.answer.transmission_angle.value)
    assert mu == pytest.approx(float(case["true_mu_min"]), abs=1e-5)
    start, rise, second, back = rise_and_return(name)
    expected = []
    for move, z in (case["active1"], case["active2"]):
        expected.append(start + rise * float(z) if move == "rise" else second + back * float(z))
    if name == FOOT:
        expected = expected[:1]
    assert {each.name for each in found.active} == {"transmission-angle"}
    reported = [math.degrees(each.cam_angle) for each in found.active]
    assert reported == pytest.approx(sorted(expected), abs=1e-9 * 360.0)


@pytest.mark.parametrize("name", TRANSLATING)
def test_flocke_is_the_reference(name: str) -> None:
    case, task = CASES[name]["flocke"], reference_task(name)
    place = known(flocke(task, math.tan(math.radians(CASES[name]["args"]["mu_min"]))).place)
    assert place.real == pytest.approx(float(case["e"]), abs=1e-12)
    assert -place.imag == pytest.approx(float(case["s_G"]), rel=1e-12)
    assert abs(place) == pytest.approx(float(case["r_G"]), rel=1e-12)
    rating = known(Rating.from_place(task, place))
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
    start, rise, second, back = rise_and_return(name)
    reported = [math.degrees(each.cam_angle) for each in found.active]
    places = [
        (each - start) / rise if each < second else (each - second) / back for each in reported
    ]
    assert sorted(places) == pytest.approx(sorted(map(float, case["z"])), abs=1e-9)


@pytest.mark.parametrize("name", FLOCKE_OSCILLATING)
def test_flocke_of_a_rocker_is_as_printed(name: str) -> None:
    radius, angle = FLOCKE_OSCILLATING[name]
    found = known(sized(name).flocke)
    assert found.base_radius == pytest.approx(radius, abs=0.5e-4)
    assert math.degrees(found.transmission_angle.value) == pytest.approx(angle, abs=0.5e-2)


ANGLE = math.radians(45.0)


def there_and_back(stroke: float, law: str = "polynomial-345") -> MotionPlan:
    return MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(100), stroke, LAWS[law]),
            Dwell(Decimal(40)),
            Move(Decimal(90), 0.0, LAWS[law]),
            Dwell(Decimal(100)),
        )
    )


def swinging(side: int = 1, direction: int = 1, rotation: int = 1, **other: float) -> FaceTask:
    follower = OscillatingFlat(-70 + 50j, 35.0, other.get("offset", 8.0), side, direction)
    return FaceTask.from_cam(cam_of(there_and_back(math.radians(12.0)), follower, rotation))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("least", [0.0, 6.0])
def test_on_a_guide_it_is_the_largest_of_minus_lift_and_acceleration(
    direction: int, least: float
) -> None:
    """r_G = rho - min kappa_F (s + s''); for an F-cam of 3-4-5 moves in the return."""
    task = FaceTask.from_cam(
        cam_of(there_and_back(9.0), TranslatingFlat(60.0, direction=direction))
    )
    found = task.size(ANGLE, least)
    assert found.answer is not None
    span, best = math.radians(90.0), math.inf
    z = np.linspace(0.0, 1.0, 200_001)
    for width in (math.radians(100.0), span):
        lift = z**3 * (10.0 + z * (6.0 * z - 15.0))
        bend = 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z) / width**2
        best = min(best, float(np.min(direction * 9.0 * (lift + bend))))
    assert found.answer.base_radius == pytest.approx(least - best, abs=5e-7)
    assert found.answer.transmission_angle.value == pytest.approx(0.5 * math.pi)
    assert {each.name for each in found.active} == {"convexity"}
    assert found.exact


def test_a_jump_of_the_acceleration_counts_from_both_sides() -> None:
    """A parabola decelerates from its middle on: -(s + s'') = stroke (4/span^2 - 1/2)."""
    task = FaceTask.from_cam(
        cam_of(there_and_back(9.0, "quadratic-parabola"), TranslatingFlat(60.0))
    )
    found = task.size(ANGLE, 0.0)
    expected = 9.0 * (4.0 / math.radians(90.0) ** 2 - 0.5)
    assert known(found.answer).base_radius == pytest.approx(expected, abs=5e-7)


@pytest.mark.parametrize(
    ("side", "direction", "rotation"), list(itertools.product((1, -1), (1, -1), (1, -1)))
)
def test_the_conditions_are_those_of_the_support_function(
    side: int, direction: int, rotation: int
) -> None:
    task = swinging(side, direction, rotation)
    asked = task.required_limits(ANGLE, 3.0)
    phi = np.linspace(0.0, 2.0 * math.pi, 300)
    x, y = task.present.real, -task.present.imag
    at = touch(task.pitch_curve(task.present), phi)
    expected = {
        "convexity": at.pace[0] - 3.0 * at.turn[0],
        "face-over-axis": at.distance - asked.clearance,
        "transmission-angle": at.contact[0] - 8.0,
    }
    for name, values in expected.items():
        a, b, c = task.rows(name, phi, "right", asked)
        np.testing.assert_allclose(a * x + b * y - c, values, rtol=0.0, atol=1e-10)


def test_the_transmission_angle_decides_where_the_face_lies_far_beyond_the_pivot() -> None:
    """q >= tan mu |f|: at the largest admissible f a smaller base circle gives more leverage."""
    task = swinging(offset=60.0)
    assert task.size(math.radians(40.0), 0.0).answer is not None
    found = task.size(math.radians(70.0), 0.0)
    assert found.answer is None
    assert found.hopeless is None


def test_what_no_size_can_do() -> None:
    """A face that turns with the cam and faster; one whose velocity jumps; one at rest."""
    quick = MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(20), math.radians(40.0), POLYNOMIAL),
            Move(Decimal(310), 0.0, POLYNOMIAL),
        )
    )
    task = FaceTask.from_cam(cam_of(quick, OscillatingFlat(-70 + 50j, 35.0), 1))
    reasons = [side.size(ANGLE, 0.0).hopeless for side in task.sides]
    assert sum("turns back" in (each or "") for each in reasons) == 1
    rated = [side.rate_place(side.present) for side in task.sides]
    assert [each is None for each in rated] == ["turns back" in (why or "") for why in reasons]
    jumping = FaceTask.from_cam(cam_of(there_and_back(9.0, "straight-line"), TranslatingFlat(60.0)))
    found = jumping.size(ANGLE, 0.0)
    assert found.answer is None
    assert "a flat face needs a motion without shocks" in (found.hopeless or "")
    still = FaceTask.from_cam(cam_of(MotionPlan((Dwell(Decimal(360)),)), TranslatingFlat(60.0)))
    with pytest.raises(GeometryError, match="does not move"):
        still.size(ANGLE, 0.0)


SMOOTH = sorted(name for name in LAWS if name != "straight-line")
"""Laws without shocks."""


CONTACTS = [Contact.INNER, Contact.INNER, Contact.OUTER, Contact.GROOVE]


def roller_cam(seed: int) -> Cam:
    """Half of them have a lobe so high and narrow that its foot may be cut off."""
    draw = random.Random(seed)
    on_guide, narrow = draw.random() < 0.5, draw.random() < 0.5
    high = draw.uniform(40.0, 150.0) if narrow else draw.uniform(5.0, 30.0)
    stroke = high if on_guide else math.radians(draw.uniform(10.0, 45.0))
    plan = _plan(draw, stroke, (25.0, 60.0) if narrow else (50.0, 140.0))
    roller, rotation = draw.uniform(2.0, 20.0), draw.choice((1, -1))
    follower: Follower
    if on_guide:
        follower = TranslatingRoller(400.0, roller, 0.0, 1.1, draw.choice((1, -1)))
    else:
        arm, side = draw.uniform(60.0, 120.0), draw.choice((1, -1))
        pivot = complex(-1.2 * arm, 0.7 * arm)
        follower = OscillatingRoller(pivot, arm, arm, roller, side, draw.choice((1, -1)))
    return cam_of(plan, follower, rotation, draw.choice(CONTACTS))


def face_cam(seed: int) -> Cam:
    """The face has no stated length."""
    draw = random.Random(seed)
    on_guide = draw.random() < 0.4
    stroke = draw.uniform(3.0, 20.0) if on_guide else math.radians(draw.uniform(3.0, 18.0))
    plan, rotation = _plan(draw, stroke, (50.0, 140.0)), draw.choice((1, -1))
    follower: Follower
    if on_guide:
        follower = TranslatingFlat(300.0, 1.1, draw.choice((1, -1)))
    else:
        away, side = draw.uniform(60.0, 120.0), draw.choice((1, -1))
        follower = OscillatingFlat(
            complex(-0.8 * away, 0.6 * away), 0.5 * away, draw.uniform(-0.2, 0.2) * away, side,
            draw.choice((1, -1)),
        )  # fmt: skip
    return cam_of(plan, follower, rotation)


def _plan(draw: random.Random, stroke: float, spans: tuple[float, float]) -> MotionPlan:
    """A rest, a rise, a rest or none, and a return; half of them end with a second lobe."""
    rise, back = (Decimal(round(draw.uniform(*spans))) for _ in range(2))
    top, first = Decimal(draw.choice((0, 3, 30))), Decimal(12)
    moves: list[Dwell | Move] = [Dwell(first), Move(rise, stroke, _law(draw))]
    if top:
        moves.append(Dwell(top))
    moves.append(Move(back, 0.0, _law(draw)))
    rest = 360 - first - rise - top - back
    if draw.random() < 0.5 and rest > 80:
        part = Decimal(round(float(rest) * draw.uniform(0.3, 0.45)))
        moves += [Move(part, draw.uniform(0.2, 0.7) * stroke, _law(draw))]
        moves += [Move(part, 0.0, _law(draw))]
        rest -= 2 * part
    return MotionPlan((*moves, Dwell(rest)))


def _law(draw: random.Random) -> Law:
    return LAWS[draw.choice(SMOOTH)]


ANGLES = (12.0, 30.0, 45.0)


RATIOS = (0.6, 0.8, 0.95, 1.0)


RADII = (0.0, 0.0, 2.0, 8.0)


def keeps(cam: Cam, angle: float, ratio: float) -> bool:
    """Whether the checks find nothing wrong, including that a roller does not jam in its groove."""
    limits = Limits(transmission_angle=angle, radius_ratio=ratio)
    bad = ("broken", *NO_OUTLINE)
    return not any(each.severity in bad for each in disc_findings(cam, limits))


def nearby(task: RollerTask, place: complex, radius: float, seed: int) -> Iterator[complex]:
    """Places with a base radius: in all directions, and more of them near `place`."""
    theta = float(np.angle(place - task.start))
    turns = np.random.default_rng(seed).uniform(-math.pi, 0.0, 2)
    for way in (*(theta + np.array([0.0, 1e-6, -1e-6, 0.01, -0.01])), *turns):
        if -math.pi < way < 0.0:
            yield complex(task.start + radius * np.exp(1j * way))


def is_smaller(task: RollerTask, place: complex, angle: float, ratio: float) -> bool:
    """Whether the cam axis may lie at `place`, according to the checks."""
    try:
        return keeps(task.placed_cam(place), angle, ratio)
    except GeometryError:
        return False


def fits(task: FaceTask, radius: float, angle: float, least: float) -> bool:
    """Whether a flat-faced cam may have this base radius and keep radii of at least `least`."""
    try:
        cam = task.cam.sized(base_radius=radius)
    except GeometryError:
        return False
    return keeps(cam, angle, 1.0) and convexity(cam.disc.pitch_curve).radius[0] >= least


@given(
    st.integers(0, 10**6), st.sampled_from(ANGLES), st.sampled_from(RATIOS), st.sampled_from((1, 2))
)
@settings(max_examples=examples(2, long=300))
def test_the_size_of_a_roller_cam(seed: int, degrees: float, ratio: float, inches: int) -> None:
    cam, angle, unit = roller_cam(seed), math.radians(degrees), (1.0, 25.4)[inches - 1]
    for task in RollerTask.from_cam(cam).sides:
        found = Sizing.solve(task, angle, ratio)
        if found.answer is None:
            # A swing too large for the angle: at most 90 degrees less half the swing can be kept.
            assert known(found.nearest_angle) < angle
            continue
        place, limit = found.answer.place, found.answer.base_radius
        assert found.none_below <= limit * (1.0 + 1e-9)
        assert found.none_below >= limit * (1.0 - 5e-3)
        made = known(rounded(task, place, known(found.examined), angle, ratio, unit))
        assert keeps(made.cam, angle, ratio)
        last = unit * 10.0 ** decimal_exponent(limit, unit)
        written = made.cam.follower.base_radius
        assert limit * (1.0 - 1e-9) <= written
        assert written / last == pytest.approx(round(written / last), abs=1e-6)
        for value in made.lengths.values():
            for length in value if isinstance(value, list) else [value]:
                assert length == round(length, 6)
        # One unit less in the last digit, and what is just below the limit.
        for radius in (written - 1.001 * last, limit * (1.0 - 1e-6)):
            if radius < limit:
                for other in nearby(task, place, radius, seed):
                    assert not is_smaller(task, other, angle, ratio)
        if found.exact:
            assert written < limit + 1.001 * last


@given(st.integers(0, 10**6), st.sampled_from(ANGLES), st.sampled_from(RADII))
@settings(max_examples=examples(4, long=600))
def test_the_size_of_a_flat_faced_cam(seed: int, degrees: float, least: float) -> None:
    cam, angle = face_cam(seed), math.radians(degrees)
    for task in FaceTask.from_cam(cam).sides:
        found = task.size(angle, least)
        most = task.follower.farthest
        tried = np.linspace(0.0, most if math.isfinite(most) else 300.0, 14)[1:-1]
        if found.answer is None:
            assert not any(fits(task, float(radius), angle, least) for radius in tried)
            continue
        limit = found.answer.base_radius
        made = known(rounded_face(task, found.answer.place, angle, least, 1.0))
        written = made.cam.follower.base_radius
        assert fits(task, written, angle, least)
        assert limit <= written < limit + 1.001e-4
        smaller = (limit * (1.0 - 1e-6), written - 1e-4, *tried[tried < limit])
        assert not any(
            fits(task, float(radius), angle, least) for radius in smaller if radius < limit - 1e-9
        )
