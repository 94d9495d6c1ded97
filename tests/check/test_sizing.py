"""The smallest base circle of a roller cam: its conditions, the search, and what cannot be met."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.size import Side
from camgeo.check.disc import disc_findings, transmission_angle_extremes, transmission_angle_limit
from camgeo.check.sizing import smallest
from camgeo.check.sizing.face import FaceTask
from camgeo.check.sizing.rounding import (
    decimal_exponent,
    size_with_arm,
    sound,
    upward,
    with_arm,
)
from camgeo.check.sizing.smallest import (
    GAP,
    PlaceConditions,
    Rating,
    Sizing,
    active_conditions,
    excluded,
    flocke,
    local_conditions,
    nearest_cells,
    nearest_point,
    place_conditions,
    ratio_map,
    row_limits,
    sample_angles,
)
from camgeo.check.sizing.task import TOUCHING, RollerTask, covered_pairs, pair_conditions
from camgeo.errors import GeometryError
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.cams import cam_of
from tests.findings import known
from tests.laws import LAWS
from tests.reference import POLYNOMIAL

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


EASY = ["plate_translating", "setzhub", "ring", "querhub", "straight_moves"]


BENT = ["schnitt", "groove", "vorschub"]
"""Where the transmission angle alone decides, and where the curvature does too."""


def required(name: str) -> tuple[RollerTask, float, float]:
    design = camgeo.load(SCENES / f"{name}.toml")
    limits = design.scene.limits
    angle = transmission_angle_limit(design.cam, limits)
    return RollerTask.from_cam(design.cam), angle, limits.radius_ratio


def agrees(task: RollerTask) -> None:
    """The terms give transmission angle, curvature and the present design again."""
    curve = task.cam.disc.pitch_curve
    phi = np.linspace(0.0, 6.2, 500)
    terms = task.terms(phi)
    u, v = terms.across_and_along(task.present)
    np.testing.assert_allclose(
        np.arctan2(u, np.abs(v)), curve.transmission_angle(phi), rtol=0.0, atol=1e-13
    )
    np.testing.assert_allclose(
        terms.curvature(task.present), curve.curvature(phi), rtol=0.0, atol=1e-13
    )
    again = task.placed_cam(task.present).follower
    np.testing.assert_allclose(
        PitchCurve(task.motion, again, task.cam.rotation).point(phi),
        curve.point(phi),
        rtol=0.0,
        atol=1e-11,
    )


@pytest.mark.parametrize(
    ("kind", "side", "direction", "rotation"),
    list(itertools.product(("guide", "rocker"), (1, -1), (1, -1), (1, -1))),
)
def test_every_arrangement_has_the_terms_of_its_pitch_curve(
    kind: str, side: int, direction: int, rotation: int
) -> None:
    stroke = 12.0 if kind == "guide" else 0.3
    follower: TranslatingRoller | OscillatingRoller
    if kind == "guide":
        follower = TranslatingRoller(50.0, 6.0, 9.0 * side, 1.1, direction)
    else:
        follower = OscillatingRoller(70.0 - 40.0j, 75.0, 48.0, 6.0, side, direction)
    plan = MotionPlan(
        (
            Dwell(Decimal(40)),
            Move(Decimal(100), stroke, POLYNOMIAL),
            Move(Decimal(120), 0.0, POLYNOMIAL),
            Dwell(Decimal(100)),
        )
    )
    agrees(RollerTask.from_cam(cam_of(plan, follower, rotation)))


def test_row_ends_are_at_the_limit() -> None:
    for name in ("plate_translating", "setzhub"):
        task, angle, _ = required(name)
        tangent = math.tan(angle)
        place = task.present
        rows = place.imag * np.array([1.0, 1.3, 1.9])
        low, high = row_limits(task, tangent, rows)
        assert np.all(low < high)
        for ends in (low, high):
            for x, y in zip(ends, rows, strict=True):
                curve = task.pitch_curve(complex(x, y))
                smallest = transmission_angle_extremes(curve).smallest()[0]
                assert smallest == pytest.approx(angle, abs=1e-9)


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_flockes_region_lies_in_the_exact_one(name: str) -> None:
    task, angle, _ = required(name)
    tangent = math.tan(angle)
    rows = task.present.imag * np.linspace(0.3, 3.0, 40)
    low, high = row_limits(task, tangent, rows)
    inner_low, inner_high = flocke(task, tangent).row_limits(rows)
    met = inner_low <= inner_high
    assert np.any(met)
    assert np.all(low[met] <= inner_low[met] + 1e-9)
    assert np.all(high[met] >= inner_high[met] - 1e-9)


def test_ratio_map_is_that_of_the_curvature() -> None:
    task, _, _ = required("schnitt")
    place = task.present
    ((value,),) = ratio_map(task, np.array([place.real]), np.array([place.imag]), 3.0)
    exact = curvature_extremes(task.pitch_curve(place)).largest()[0]
    assert value == pytest.approx(task.follower.roller_radius * exact, rel=1e-2)


def test_nearest_point_of_half_planes() -> None:
    one = np.array([1.0 + 0j, 1j])
    assert nearest_point(one, np.array([2.0, 3.0]), 0j) == pytest.approx(2.0 + 3.0j)
    assert nearest_point(one, np.array([2.0, -1.0]), 0j) == pytest.approx(2.0)
    assert nearest_point(one, np.array([-2.0, -1.0]), 0j) == 0j
    assert nearest_point(np.array([1.0 + 0j, -1.0 + 0j]), np.array([1.0, 0.0]), 0j) is None


def asked(name: str) -> tuple[RollerTask, PlaceConditions, float]:
    """Conditions of a scene at the first cam angles, and the answer's base radius [mm]."""
    task, angle, ratio = required(name)
    answer = known(Sizing.solve(task, angle, ratio).answer)
    return (
        task,
        place_conditions(task, math.tan(angle), ratio, sample_angles(task)),
        answer.base_radius,
    )


@pytest.mark.parametrize("name", BENT)
def test_what_is_excluded_has_no_place_and_what_is_within_has_all(name: str) -> None:
    task, now, radius = asked(name)
    now = replace(now, tangent=0.0)  # the curvature decides most
    rng = np.random.default_rng(8)
    count = 1000
    middle = task.start + radius * rng.uniform(0.1, 1.4, count) * np.exp(
        1j * rng.uniform(-math.pi, 0.0, count)
    )
    half = np.abs(middle - task.start) * rng.uniform(0.02, 0.5, count)
    out = excluded(now, middle, half)
    assert 0.1 < np.mean(out) < 1.0
    for place, reach, gone in zip(middle, half, out, strict=True):
        inside = place + reach * rng.uniform(0.0, 1.0, 60) ** 0.1 * np.exp(
            1j * rng.uniform(0.0, 2.0 * math.pi, 60)
        )
        met = now.met(inside)
        assert not (gone and np.any(met))
        # Fewer cam angles, the same verdict on every place of the neighbourhood.
        assert np.array_equal(
            local_conditions(now, np.array([place]), float(reach)).met(inside), met
        )


@pytest.mark.parametrize("name", BENT)
def test_the_bound_is_sharp(name: str) -> None:
    """No place is nearer than the bound, and the answer, for more angles, is not much farther."""
    task, now, radius = asked(name)
    least = 0.2 * radius
    found = nearest_cells(now, task.start, least, 10.0 * radius)
    assert found.starts
    assert found.bound <= radius
    assert found.bound == pytest.approx(min(start[1] for start in found.starts), rel=5.0 * GAP)
    theta = np.linspace(-math.pi, 0.0, 720)
    for share in (0.5, 0.9, 0.99, 0.9999):
        assert not np.any(now.met(task.start + share * found.bound * np.exp(1j * theta)))


FOUND = Path(__file__).parents[2] / "fixtures" / "found" / "size_global_undercut.toml"


ANGLE, RATIO = math.radians(8.0), 0.7


LOCAL = complex(-5.57106515722, -14.69360434080)
"""The place with the smallest base circle, r_R/0.7, if only curvature matters."""


def lobe() -> RollerTask:
    return RollerTask.from_cam(camgeo.load(FOUND).cam)


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_a_pair_is_the_distance_of_roller_and_flank(name: str) -> None:
    task, _, _ = required(name)
    rng = np.random.default_rng(5)
    first, second = rng.uniform(0.0, TURN, (2, 200))
    for side in task.sides:
        disc = side.placed_cam(side.present).disc
        for _, flank in disc.flanks:
            gap, _ = pair_conditions(side, first, second, flank.distance).gap(
                np.array([side.present])
            )
            apart = np.abs(flank.point(first) - disc.pitch_curve.point(second))
            np.testing.assert_allclose(gap[0], apart - abs(flank.distance), rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("name", BENT)
def test_a_pair_changes_no_faster_than_its_bound(name: str) -> None:
    task, _, _ = required(name)
    rng = np.random.default_rng(6)
    first, second = rng.uniform(0.0, TURN, (2, 300))
    pairs = pair_conditions(task, first, second, task.cam.distances[0])
    for half in (0.01, 1.0, 20.0):
        gap, pace = pairs.gap(np.array([task.present]))
        bound = pairs.change(np.array([[half]]), pace)
        moves = half * np.exp(1j * rng.uniform(0.0, TURN, 50)) * rng.uniform(0.0, 1.0, 50)
        others, _ = pairs.gap(task.present + moves)
        assert np.all(np.abs(others - gap) <= bound + 1e-12)


def test_what_is_cut_off_is_found_at_its_deepest() -> None:
    task = lobe()
    found = covered_pairs(task, LOCAL)
    gap = found.gap(np.array([LOCAL]))[0][0]
    assert len(gap) > 1
    assert gap[0] == np.min(gap)
    # No point of the flank lies deeper in any roller, to within the width of the grid.
    disc = task.placed_cam(LOCAL).disc
    around = np.linspace(0.0, TURN, 1500)
    flank, rollers = disc.inner_curve.point(around), disc.pitch_curve.point(around)
    dense = np.abs(flank[:, np.newaxis] - rollers) - disc.flank_distance
    assert gap[0] == pytest.approx(np.min(dense), abs=1e-2)
    assert gap[0] <= np.min(dense) + 1e-9


@pytest.mark.parametrize("name", ["plate_translating", "groove", "straight_moves"])
def test_nothing_is_found_where_nothing_is_cut_off(name: str) -> None:
    """Corners of the pitch curve, which every size has, do not count either."""
    task, _, _ = required(name)
    assert len(covered_pairs(task, task.present).first) == 0


def test_the_smallest_cam_is_not_cut_off() -> None:
    """15.7143 mm would keep r_R/r_K but lose 116.9 of 120 mm of the lift; 17.4184 mm are needed."""
    task, limits = lobe(), camgeo.load(FOUND).scene.limits
    lost = {each.name: each for each in disc_findings(task.placed_cam(LOCAL), limits)}
    assert lost["lost-stroke-inner"].value == pytest.approx(116.9, abs=0.1)
    found = Sizing.solve(task, ANGLE, RATIO)
    assert found.answer is not None
    # The motion is its own mirror image, so the axis lies below the guide.
    assert found.answer.place.real == pytest.approx(0.0, abs=0.01)
    assert found.answer.base_radius == pytest.approx(17.418378, abs=1e-6)
    assert [each.name for each in found.active] == ["global-undercut"]
    assert found.none_below == pytest.approx(found.answer.base_radius, rel=2e-3)
    assert not found.exact
    # Without offset, touching sides follow from the pitch curve alone: its shortest chord that is
    # normal to it at both ends is as long as the roller is wide.
    below = -1j * found.answer.base_radius
    deep = covered_pairs(task, below * (1.0 - 1e-4))
    curve = task.pitch_curve(below)
    chord = abs(complex(np.diff(curve.point(np.array([deep.first[0], deep.second[0]])))[0]))
    assert chord == pytest.approx(2.0 * 11.0, abs=2e-3)
    for share in (1.0 - 1e-6, 0.95):
        for turn in (0.0, 0.02, -0.4):
            place = below * share * np.exp(1j * turn)
            assert not sound(task.placed_cam(complex(place)), ANGLE, RATIO)
    assert sound(task.placed_cam(below * (1.0 + 10.0 * TOUCHING)), ANGLE, RATIO)


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_the_answer_keeps_its_requirement_and_no_smaller_one_does(name: str) -> None:
    task, angle, ratio = required(name)
    found = Sizing.solve(task, angle, ratio)
    assert found.answer is not None
    best = found.answer.place
    assert found.answer.transmission_angle.value >= angle - 1e-9
    assert found.answer.radius_ratio.value <= ratio + 1e-9
    assert {each.name for each in found.active} == (
        {"transmission-angle"} if name in EASY else {"transmission-angle", "radius-ratio"}
    )
    radius, start = found.answer.base_radius, task.start
    direction = np.angle(best - start)
    for shrink in (1e-7, 1e-5, 1e-3, 3e-2):
        # Both free parameters: a smaller base circle, and everywhere on it.
        turns = np.concatenate(([0.0], np.geomspace(1e-8, 1.0, 11)))
        for turn in (*turns, *-turns):
            theta = direction + turn
            if not -math.pi < theta < 0.0:
                continue
            place = start + radius * (1.0 - shrink) * np.exp(1j * theta)
            rating = Rating.from_place(task, complex(place))
            assert (
                rating is None
                or rating.transmission_angle.value < angle
                or rating.radius_ratio.value > ratio
            ), (shrink, turn)


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(("law", "roller"), [("polynomial-345", 15.0), ("modified-sine", 40.0)])
def test_a_roller_that_comes_to_the_axis_decides(law: str, roller: float, rotation: int) -> None:
    """A follower that is let in by 20 mm and turns there at once: nothing but that distance, and
    the transmission angle elsewhere, keeps the cam from being smaller."""
    half, angle = Decimal(180), math.radians(20.0)
    plan = MotionPlan((Move(half, 20.0, LAWS[law]), Move(half, 0.0, LAWS[law])))
    task = RollerTask.from_cam(
        cam_of(plan, TranslatingRoller(100.0, roller, direction=-1), rotation)
    )
    found = Sizing.solve(task, angle, 1.0)
    assert found.answer is not None
    dense = np.linspace(0.0, TURN, 721)

    def margins(place: complex) -> tuple[float, float, float]:
        curve = task.pitch_curve(place)
        return (
            float(np.min(np.abs(curve.point(dense)))) / roller - 1.0,
            1.0 - roller * float(np.max(curve.curvature(dense))),
            float(np.min(curve.transmission_angle(dense))) - angle,
        )

    best, radius = found.answer.place, found.answer.base_radius
    assert min(margins(best)) >= -1e-9
    assert margins(best)[0] <= 1e-8
    over = {each.name: each.cam_angle for each in found.active}
    assert over["roller-over-axis"] == pytest.approx(math.pi, abs=1e-6)
    assert "transmission-angle" in over
    for shrink in (1e-5, 1e-3, 0.03):
        for theta in np.angle(best) + np.linspace(-0.6, 0.6, 61):
            place = radius * (1.0 - shrink) * np.exp(1j * theta)
            assert place.imag > -20.0 or min(margins(complex(place))) < 0.0


def test_an_angle_that_no_place_keeps() -> None:
    """Setzhub's rocker swings by 23.866 degrees: mu <= 90 - psi_H/2 (mechanisms, section 5)."""
    task, _, ratio = required("setzhub")
    lift = task.motion.jet(np.radians([200.0]))[0]
    bound = 0.5 * math.pi - 0.5 * abs(float(lift[0]))
    found = Sizing.solve(task, bound + 1e-3, ratio)
    assert found.answer is None
    assert found.for_angle is None
    assert found.nearest_angle == pytest.approx(bound, abs=1e-5)
    assert Sizing.solve(task, known(found.nearest_angle) - 1e-3, 1.0).for_angle is not None


def test_however_large_the_roller_a_large_cam_takes_it() -> None:
    """Far out the pitch curve is a circle: r_G is about r_R/ratio there."""
    for name in ("vorschub", "groove"):
        task, angle, _ = required(name)
        roller = task.follower.roller_radius
        found = Sizing.solve(task, angle, 1e-3)
        assert found.answer is not None
        assert found.answer.radius_ratio.value <= 1e-3 * (1.0 + 1e-9)
        assert found.answer.base_radius == pytest.approx(roller / 1e-3, rel=0.1)
    huge = RollerTask.from_cam(task.cam.sized(roller_radius=500.0))
    answer = known(Sizing.solve(huge, angle, 0.7).answer)
    assert {each.name for each in active_conditions(huge, answer, angle, 0.7)} == {
        "transmission-angle",
        "radius-ratio",
    }


def test_a_ratio_that_no_place_keeps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only where large cams are excluded, see above."""
    monkeypatch.setattr(smallest, "REACH", 1.5)
    monkeypatch.setattr(smallest, "ROOM", 0.0)
    task, angle, _ = required("vorschub")
    found = Sizing.solve(task, angle, 1e-3)
    assert found.answer is None
    assert found.none_below == math.inf
    assert found.reach == pytest.approx(1.5 * known(found.for_angle).base_radius)
    assert found.nearest_ratio is not None
    assert found.nearest_ratio > 1e-3
    reported = known(Side(task, found, "mm").infeasible)
    assert (
        "there is no place without undercut and with r_R/r_K at most 0.001 up to a base" in reported
    )
    assert f"the smallest ratio found is about {found.nearest_ratio:.3g}" in reported


@pytest.mark.parametrize(
    ("for_face", "angle", "other", "key"),
    [
        (False, 0.0, 0.7, "transmission_angle"),
        (False, math.pi / 2.0, 0.7, "transmission_angle"),
        (False, math.nan, 0.7, "transmission_angle"),
        (False, 1.0, 0.0, "radius_ratio"),
        (False, 1.0, 1.1, "radius_ratio"),
        (True, 0.0, 0.0, "transmission_angle"),
        (True, 1.0, -1.0, "radius_of_curvature"),
        (True, 1.0, math.inf, "radius_of_curvature"),
        (True, 1.0, math.nan, "radius_of_curvature"),
    ],
)
def test_a_wrong_requirement_is_refused(
    for_face: bool, angle: float, other: float, key: str
) -> None:
    roller, face = (
        required("setzhub")[0],
        FaceTask.from_cam(camgeo.load(SCENES / "tappet.toml").cam),
    )
    search: Callable[..., object] = face.size if for_face else partial(Sizing.solve, roller)
    with pytest.raises(GeometryError) as caught:
        search(angle, other)
    assert caught.value.key == key


def test_for_the_angle_alone_all_scales_and_the_shortest_arm_is_best() -> None:
    task, angle, _ = required("setzhub")
    small = RollerTask.from_cam(task.cam.sized(roller_radius=1e-3))
    found = [Sizing.solve(with_arm(small, arm), angle, 1.0).answer for arm in (30.0, 60.0)]
    assert found[0] is not None
    assert found[1] is not None
    assert found[1].place == pytest.approx(2.0 * found[0].place, rel=1e-11)
    sized, sizing = size_with_arm(small, angle, 1.0, 30.0, 60.0)
    assert isinstance(sized.follower, OscillatingRoller)
    assert sized.follower.arm == 30.0
    assert sizing.answer == found[0]


@pytest.mark.parametrize("contact", ["inner", "outer"])
def test_no_other_arm_of_the_range_is_better(contact: str) -> None:
    task, angle, ratio = required("schnitt")
    task = RollerTask.from_cam(replace(task.cam, contact=contact))  # type: ignore[arg-type]  # the name of a contact
    low, high = 12.0, 60.0
    sized, sizing = size_with_arm(task, angle, ratio, low, high)
    assert isinstance(sized.follower, OscillatingRoller)
    assert low <= sized.follower.arm <= high
    assert sizing.answer is not None
    assert sizing.answer.transmission_angle.value >= angle - 1e-9
    assert sizing.answer.radius_ratio.value <= ratio + 1e-9
    for arm in (low, 40.0, *(sized.follower.arm * np.array([0.97, 1.03]))):
        if low <= arm <= high:
            other = known(Sizing.solve(with_arm(task, float(arm)), angle, ratio).answer)
            # The best arm inside the range is found to 1e-3 of itself.
            assert other.base_radius >= sizing.answer.base_radius * (1.0 - 1e-3)


@pytest.mark.parametrize(
    ("name", "low", "high", "key"),
    [
        ("plate_translating", 30.0, 60.0, "follower.kind"),
        ("setzhub", 60.0, 30.0, "arm"),
        ("setzhub", 5.0, 30.0, "arm"),
        ("setzhub", 30.0, float("inf"), "arm"),
        ("setzhub", float("nan"), 30.0, "arm"),
    ],
)
def test_what_is_no_range_is_refused(name: str, low: float, high: float, key: str) -> None:
    task, angle, ratio = required(name)
    with pytest.raises(GeometryError) as caught:
        size_with_arm(task, angle, ratio, low, high)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("length", "unit", "exponent"),
    [
        (44.5059, 1.0, -4),
        (1.0, 1.0, -4),
        (9999.0, 1.0, -4),
        (0.5, 1.0, -5),
        (2.5e-6, 1.0, -10),
        (1.2e4, 1.0, -3),
        (3.7e8, 1.0, 1),
        (23.5, 25.4, -5),
    ],
)
def test_the_last_decimal(length: float, unit: float, exponent: int) -> None:
    """0.1 um from 1 mm to 10 m, otherwise a fraction of the length; one digit more in inches."""
    assert decimal_exponent(length, unit) == exponent


@given(st.floats(1e-9, 1e12), st.sampled_from((1.0, 25.4)))
def test_a_length_is_rounded_up_by_less_than_its_last_decimal(length: float, unit: float) -> None:
    exponent = decimal_exponent(length, unit)
    found = upward(length, exponent, unit)
    last = Decimal(1).scaleb(exponent)
    assert found % last == 0
    exact = Decimal(length / unit)
    assert exact * (1 - Decimal("1.1e-11")) <= found < exact + last
    assert float(last) * unit <= 2.55e-4 * length


def test_a_limit_that_has_so_many_decimals_is_kept() -> None:
    """14 mm / 0.7 is 20 mm, though not in binary."""
    assert upward(14.0 / 0.7, -4, 1.0) == 20
    assert upward(20.0 * (1.0 + 1e-13), -4, 1.0) == 20
    assert upward(20.0 * (1.0 + 1e-10), -4, 1.0) == Decimal("20.0001")
