"""Special positions of linkages: where they turn, close and lock; transmission angles; against
dense samples of their joints.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from typing import Final

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkage import (
    SIZES,
    TO_FAR_END,
    TO_FOLLOWER,
    Linkage,
    LinkedMotion,
    Size,
    clear_range,
    closing_sizes,
    first_locked_place,
    monotone_runs,
    openings,
    position_text,
    why_open,
)
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.motion import lift_range
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.units import TURN
from tests.long_form import examples
from tests.reference import POLYNOMIAL
from tests.strategies import attack, four_bars, slider_cranks, slider_driven_cranks

COUNT: Final = 2001

BESIDE: Final = 5
"""Cells to both sides of a minimum where it is higher by more than rounding."""

some = settings(attack, max_examples=examples(24, long=200))


def kinds() -> st.SearchStrategy[Linkage]:
    return st.one_of(slider_cranks(0.0), four_bars(0.0), slider_driven_cranks(0.0))


def grid_of(linkage: Linkage) -> FloatArray:
    """Positions on both sides of 0, farther than most linkages close."""
    reach = 1.5 * (linkage.crank + linkage.coupler) if linkage.unit == "mm" else 3.0
    return np.linspace(-0.987 * reach, reach, COUNT)


def within(found: tuple[float, ...], grid: FloatArray, cells: IntArray, slack: int = 0) -> None:
    """That there is one of `found` in each of these cells of the grid, or `slack` cells away."""
    step = grid[1] - grid[0]
    for cell in cells:
        low, high = grid[cell] - slack * step, grid[cell + 1] + slack * step
        assert any(low - 1e-12 <= each <= high + 1e-12 for each in found), (grid[cell], found)


@some
@given(linkage=kinds())
def test_dead_and_turning_positions_are_those_of_samples(linkage: Linkage) -> None:
    grid = grid_of(linkage)
    missing = linkage.missing_length(grid)
    dead = linkage.dead_positions(grid[0], grid[-1])
    crossed = np.flatnonzero(missing[:-1] * missing[1:] < 0.0)
    within(dead, grid, crossed)
    size = linkage.crank + linkage.coupler
    values = linkage.missing_length(np.array([0.0, *dead]))
    assert values[1:] == pytest.approx(np.zeros(len(dead)), abs=1e-7 * size)
    turning = linkage.turning_positions(grid[0], grid[-1])
    steps = np.diff(missing)
    highest = np.flatnonzero((steps[:-1] > 1e-9 * size) & (steps[1:] < -1e-9 * size))
    within(turning, grid, highest, slack=1)
    # Of a part of the range those in it, with both its ends.
    low, high = grid[COUNT // 3], grid[COUNT // 2]
    for every, part in (
        (dead, linkage.dead_positions(low, high)),
        (turning, linkage.turning_positions(low, high)),
    ):
        inside = sorted(each for each in every if low <= each <= high)
        assert sorted(part) == pytest.approx(inside)


def sines(linkage: Linkage, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Magnitudes of both sines from the joints: the angle of the coupler against either member."""
    pin, tip = linkage.joints(at)
    rod = (pin - tip) / np.abs(pin - tip)
    crank = np.abs(np.imag(np.conj(tip / np.abs(tip)) * rod))
    if isinstance(linkage, FourBar):
        lever = pin - linkage.shaft
        return np.abs(np.imag(np.conj(lever / np.abs(lever)) * rod)), crank
    along = np.abs(rod.real)  # of a slider the perpendicular to its guide
    return (crank, along) if isinstance(linkage, SliderDrivenCrank) else (along, crank)


@some
@given(linkage=kinds())
def test_transmission_angles_are_those_of_the_drawn_members(linkage: Linkage) -> None:
    low, high = clear_range(linkage)
    reach = 1.2 * linkage.crank if linkage.unit == "mm" else 2.0
    low, high = max(low, -reach), min(high, reach)
    if not low < high:
        return
    grid = low + (high - low) * np.linspace(0.001, 0.999, COUNT)
    found = linkage.transmission_sines(grid)
    out, back = sines(linkage, grid)
    assert np.abs(found[TO_FAR_END]) == pytest.approx(out, abs=1e-9)
    assert np.abs(found[TO_FOLLOWER]) == pytest.approx(back, abs=1e-9)
    assert np.all(found[TO_FOLLOWER] > 0.0) or np.all(found[TO_FOLLOWER] < 0.0)
    # Locked where the far member cannot be driven, and nowhere else.
    locked = linkage.locked_positions(grid[0], grid[-1])
    crossed = np.flatnonzero(found[TO_FAR_END][:-1] * found[TO_FAR_END][1:] < 0.0)
    within(locked, grid, crossed)
    at = linkage.transmission_sines(np.array([0.0, *locked]))[TO_FAR_END, 1:]
    assert at == pytest.approx(np.zeros(len(locked)), abs=1e-7)
    # Up to rounding a range has those at its ends.
    for each in locked:
        for low_end, high_end in (
            (math.nextafter(each, 9e9), grid[-1]), (grid[0], math.nextafter(each, -9e9))
        ):  # fmt: skip
            if low_end < high_end:
                ends = linkage.locked_positions(low_end, high_end)
                assert any(abs(end - each) <= 1e-9 for end in ends)
    far = linkage.far_turning_positions(grid[0], grid[-1])
    size = np.abs(found[TO_FAR_END])
    lows = 1 + np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]))
    lows = lows[(lows > BESIDE) & (lows < COUNT - BESIDE) & (size[lows] > 1e-2)]
    for side in (-BESIDE, BESIDE):  # of a parallelogram the angle stays, but for rounding
        lows = lows[size[lows] < size[lows + side] - 1e-8]
    within((*far, *locked), grid, lows - 1, slack=2)
    # The way back is the quotient of both sines, with the lever of each member.
    free = size > 0.05
    way = linkage.per_follower(grid[free])
    quotient = way * found[TO_FAR_END][free] / found[TO_FOLLOWER][free]
    assert np.all(quotient > 0.0) or np.all(quotient < 0.0)
    spread = np.ptp(np.abs(quotient)) / np.max(np.abs(quotient))
    assert spread <= 1e-9 or isinstance(linkage, SliderDrivenCrank)


@some
@given(linkage=kinds())
def test_the_clear_range_ends_at_the_next_dead_centre(linkage: Linkage) -> None:
    far = 2.0 * (linkage.crank + linkage.coupler) if linkage.unit == "mm" else 2.0 * math.pi
    dead = linkage.dead_positions(-far, far)
    if any(abs(each) < 1e-3 for each in dead):
        return
    low, high = clear_range(linkage)
    below, above = [each for each in dead if each < 0.0], [each for each in dead if each > 0.0]
    for end, wanted in ((low, max(below, default=None)), (high, min(above, default=None))):
        if wanted is None:
            assert not math.isfinite(end) or abs(end) >= far * (1.0 - 1e-9)
        else:
            assert end == pytest.approx(wanted)
    locked = linkage.locked_positions(-far, far)
    if any(abs(each) < 1e-3 for each in locked):
        return
    low_out, high_out = clear_range(linkage, TO_FAR_END)
    assert low_out >= low
    assert high_out <= high
    nearer = [each for each in locked if low < each < high]
    assert low_out == pytest.approx(max((e for e in nearer if e < 0.0), default=low))
    assert high_out == pytest.approx(min((e for e in nearer if e > 0.0), default=high))


def test_positions_are_told_in_the_words_of_their_member() -> None:
    slider = SliderCrank(100.0, 160.0, math.radians(15.0), True, 1, 1, 1)
    lever = FourBar(70.0, 120.0, 85.0, 110 + 30j, 2.1, -1, -1)
    assert position_text(slider, 12.5) == "stroke 12.5 mm"
    assert position_text(lever, math.radians(30.0)) == "lever angle 30 deg"
    assert position_text(SliderDrivenCrank(slider), -0.5 * math.pi) == "crank angle -90 deg"


def closes(linkage: Linkage, size: Size, length: float, low: float, high: float) -> bool | None:
    """Whether it closes at sixty positions of the range with that length; None at position 0."""
    try:
        other = linkage.resized(size, length)
    except GeometryError:
        return None
    return bool(np.all(other.missing_length(np.linspace(low, high, 60)) <= 0.0))


@settings(attack, max_examples=examples(12, long=100))
@example(SliderCrank(46.0, 115.0, 0.6, False, 1, -1, 1), 1.9, 0.0)  # past the shaft
@example(SliderCrank(49.0, 109.0, 1.12, True, 1, -1, -1), -0.677, 0.0)
@example(SliderDrivenCrank(SliderCrank(50.0, 30.0, 0.5, True, 1, 1, 1)), 0.667, 0.0)  # upright
@example(SliderDrivenCrank(SliderCrank(50.0, 30.0, 0.5, True, 1, 1, 1)), -0.667, 0.0)
@given(linkage=kinds(), share=st.floats(-1.9, 1.9), back=st.floats(0.0, 0.3))
def test_whether_it_closes_changes_at_the_stated_lengths_only(
    linkage: Linkage, share: float, back: float
) -> None:
    """Lengths all over, of crank and of coupler: between two limits all close, or none."""
    reach = share * (linkage.crank + linkage.coupler if linkage.unit == "mm" else 1.5)
    low, high = sorted((-back * reach, reach))
    for size in SIZES:
        present = linkage.coupler if size == "coupler" else linkage.crank
        lengths = present * np.geomspace(0.15, 7.0, 120)
        found = [closes(linkage, size, float(each), low, high) for each in lengths]
        limits = sorted(linkage.size_limits(size, low, high))
        if not limits:
            continue
        for number in range(len(lengths) - 1):
            before, after = found[number : number + 2]
            between = lengths[number] * (1.0 - 1e-2), lengths[number + 1] * (1.0 + 1e-2)
            if {before, after} == {True, False}:
                assert any(between[0] <= each <= between[1] for each in limits), size


# Ranges in which a linkage does not close, and what would close it --------------------------------


def moving(*ends: float) -> MotionPlan:
    """Equal moves to `ends` [mm or rad], and back to 0."""
    span = Decimal(360) / (len(ends) + 1)
    spans = [span] * len(ends)
    spans.append(Decimal(360) - sum(spans))
    return MotionPlan(
        tuple(Move(s, to, POLYNOMIAL) for s, to in zip(spans, (*ends, 0.0), strict=True))
    )


@st.composite
def stretched(draw: st.DrawFn) -> tuple[Linkage, MotionPlan]:
    """A linkage and a motion that mostly goes farther than it closes."""
    kinds = st.one_of(slider_cranks(0.0), four_bars(0.0), slider_driven_cranks(0.0))
    linkage: Linkage = draw(kinds)
    reach = 150.0 if linkage.unit == "mm" else 2.5
    ends = draw(st.lists(st.floats(-reach, reach), min_size=1, max_size=3))
    return linkage, moving(*ends)


@attack
@given(case=stretched())
def test_the_ranges_are_those_in_which_samples_miss(case: tuple[Linkage, MotionPlan]) -> None:
    linkage, motion = case
    found = openings(linkage, motion)
    dense = np.linspace(0.0, TURN, 7201)
    missing = linkage.missing_length(motion.jet(dense)[0])
    size = linkage.crank + linkage.coupler
    inside = np.zeros(len(dense), dtype=bool)
    for each in found:
        within = (dense > each.start) & (dense < each.end)
        inside |= within
        at = np.array([each.start, each.place, each.end])
        values = linkage.missing_length(motion.jet(at)[0])
        # An angle is known to 4 ulps of a turn: 4e-15 rad by 150 mm by at most 20 a rad.
        assert values[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-11 * size)
        assert values[1] == pytest.approx(each.missing, rel=1e-12)
        assert np.max(missing[within], initial=0.0) <= each.missing * (1.0 + 1e-12)
    assert np.all(missing[inside] > -1e-11 * size)
    assert np.all(missing[~inside] < 1e-11 * size)
    if found:
        with pytest.raises(GeometryError, match="does not close between") as caught:
            LinkedMotion(motion, linkage)
        assert caught.value.key == "linkage"
        assert caught.value.message == why_open(linkage, motion)


@attack
@given(case=stretched())
def test_what_would_close_it_closes_it(case: tuple[Linkage, MotionPlan]) -> None:
    linkage, motion = case
    assume(openings(linkage, motion))
    reported = why_open(linkage, motion)
    low, high = lift_range(motion)
    for size in SIZES:
        for words in re.findall(
            rf"with a {size} of (at least \S+|at most \S+|\S+ to \S+) mm", reported
        ):
            lengths = [float(text) for text in re.findall(r"[\d.]+", words)]
            for length in lengths:
                LinkedMotion(motion, linkage.resized(size, length))
        limits = closing_sizes(linkage, size, low, high)
        if limits is None:
            continue
        # A hair outside it does not close: the figures are no larger than need be.
        for limit, outside in zip(limits, (1.0 - 1e-6, 1.0 + 1e-6), strict=True):
            if 0.0 < limit < math.inf:
                with pytest.raises(GeometryError):
                    LinkedMotion(motion, linkage.resized(size, limit * outside))
    least, most = clear_range(linkage)
    scale = 1.0 if linkage.unit == "mm" else math.radians(1.0)
    (kept,) = re.findall(r"kept between (\S+) and (\S+) ", reported) or [None]
    if kept is not None:
        ends = [scale * float(text) for text in kept]
        assert least <= ends[0] <= 0.0 <= ends[1] <= most
        LinkedMotion(moving(*ends), linkage)
    for end in (least, most):
        if end and math.isfinite(end):
            at = np.array([0.999 * end, end, 1.001 * end])
            values = linkage.missing_length(at)
            assert values[0] < 0.0
            assert values[1] == pytest.approx(0.0, abs=1e-9)


def test_three_linkages_name_their_cures() -> None:
    """Each by hand: the pin's farthest distance, and the crank's farthest height."""
    slide = SliderCrank(40.0, 60.0, 0.0, True, 1, 1, 1)
    # At stroke s: (60 + s)^2 + 40^2 <= (40 + l)^2 with s_0 = l: l >= s^2 / (80 - 2 s) for s < 40.
    reported = why_open(slide, moving(35.0))
    assert "with a coupler of at least 122.5 mm" in reported
    assert f"and {math.sqrt(100.0**2 - 40.0**2) - 60.0:.4f}"[:8] in reported
    bar = FourBar(40.0, 90.0, 40.0, 100.0 + 0.0j, math.radians(100.0), 1, -1)
    reported = why_open(bar, moving(-math.radians(100.0)))
    assert "with a coupler of 100 to" in reported
    assert "misses by up to 10 mm" in reported
    crank = SliderDrivenCrank(SliderCrank(50.0, 30.0, 0.0, True, 1, -1, 1))
    # The crank upright, the guide at its tip: 50 (1 - cos x) <= 30.
    reported = why_open(crank, moving(math.radians(90.0)))
    assert "misses by up to 20 mm" in reported
    assert "with a coupler of at least 50 mm, with a crank of at most 30 mm" in reported
    edge = math.degrees(math.acos(0.4))
    assert f"crank angle kept between -{edge:.4f}" in reported


def test_each_range_is_named() -> None:
    linkage = SliderCrank(40.0, 60.0, 0.0, True, 1, 1, 1)
    motion = moving(40.0, 0.0, 40.0)
    assert len(openings(linkage, motion)) == 2
    assert why_open(linkage, motion).count(" and between ") == 1
    many = why_open(linkage, moving(*[40.0, 0.0] * 7))
    assert "and in 3 more ranges" in many


def test_first_angle_is_the_first() -> None:
    motion = moving(10.0, -5.0, 10.0)
    phi = monotone_runs(motion).first_angle(7.0)
    assert motion.jet(np.array([phi]))[0][0] == pytest.approx(7.0, abs=1e-12)
    assert phi < math.radians(90.0)
    assert monotone_runs(motion).first_angle(10.0) == pytest.approx(math.radians(90.0))
    assert monotone_runs(motion).first_angle(99.0) == pytest.approx(math.radians(90.0))


@pytest.mark.parametrize(
    ("linkage", "side"),
    [
        # 3-4-5: crank and coupler in line at position 0, stretched or folded.
        (FourBar(30.0, 20.0, 30.0, 40 + 0j, 0.5 * math.pi, 1, 1), 1),
        (FourBar(30.0, 20.0, 30.0, 40 + 0j, 0.5 * math.pi, -1, 1), -1),
    ],
)
def test_from_a_dead_centre_the_range_goes_to_the_side_that_closes(
    linkage: FourBar, side: int
) -> None:
    """Wherever it closes: the other side begins with what is missing."""
    near = 1e-3 * np.array([-1.0, 1.0])
    missing = linkage.missing_length(near)
    assert np.sort(missing)[0] < 0.0 < np.sort(missing)[1]
    closes = -1 if missing[0] < 0.0 else 1
    assert closes == side
    low, high = clear_range(linkage)
    dead = [each for each in linkage.dead_positions(-TURN, TURN) if abs(each) > 1e-6]
    if side > 0:
        assert low == 0.0
        assert high == pytest.approx(min(each for each in dead if each > 0.0))
    else:
        assert high == 0.0
        assert low == pytest.approx(max(each for each in dead if each < 0.0))
    inside = np.linspace(low, high, 103)[1:-1]
    assert np.all(linkage.missing_length(inside) < 0.0)


# Where the follower cannot move the far end -------------------------------------------------------

SLIDER: Final = SliderCrank(100.0, 160.0, math.radians(15.0), True, 1, 1, 1)

LINKAGES: Final[dict[str, tuple[Linkage, float, float]]] = {
    "slider": (SLIDER, -60.0, 60.0),
    "slider, mirrored": (SliderCrank(90.0, 140.0, 0.4, False, -1, 1, -1, True), -20.0, 90.0),
    "lever": (FourBar(70.0, 120.0, 85.0, 110 + 30j, 2.1, -1, -1), -0.7, 1.1),
    "lever, other branch": (FourBar(40.0, 100.0, 60.0, -90 + 70j, 0.4, 1, 1), -0.3, 0.5),
    "crank": (SliderDrivenCrank(SLIDER), -0.9, 0.9),
    "crank, mirrored": (
        SliderDrivenCrank(SliderCrank(40.0, 110.0, 0.4, True, 1, -1, 1, True)),
        -0.6,
        0.6,
    ),
}
"""Each with a range of positions that keeps clear of both kinds of dead centres."""


@pytest.mark.parametrize("name", LINKAGES)
@given(share=st.floats(0.0, 1.0), first=st.floats(0.2, 3.0), second=st.floats(-3.0, 3.0))
def test_the_way_is_the_reciprocal_of_the_transform_and_the_rod_keeps_its_length(
    name: str, share: float, first: float, second: float
) -> None:
    """|P - T|^2 has no first and no second derivative."""
    linkage, low, high = LINKAGES[name]
    position = np.array([low + share * (high - low)])
    unit = 40.0 if linkage.unit == "mm" else 1.0
    demanded = unit * np.array([[first], [second]])
    own = linkage.transform(np.concatenate((position[np.newaxis], demanded, [[0.0]])), 2)[1:]
    way = linkage.per_follower(position)
    # Both are quotients of areas of triangles that are no flatter than some 20 degrees.
    assert way * own[0] == pytest.approx(demanded[0], rel=1e-12)
    pin, tip = linkage.joints(position)
    rod = pin - tip
    pins, tips = linkage.joint_rates(position, demanded, own)
    once, again = pins - tips
    size = abs(rod[0]) * (abs(pins) + abs(tips)).max() + abs(once[0]) ** 2
    assert abs((np.conj(rod) * once).real[0]) <= 1e-12 * size
    assert abs((np.conj(rod) * again).real[0] + abs(once[0]) ** 2) <= 1e-12 * size


@pytest.mark.parametrize("name", LINKAGES)
def test_the_rates_are_those_of_the_joints(name: str) -> None:
    """Central differences of places: their error is h^2, and rounding by h, 1e-10 each."""
    linkage, low, high = LINKAGES[name]
    position = np.linspace(low, high, 9)
    unit = 40.0 if linkage.unit == "mm" else 1.0
    jet = np.stack((position, np.full(9, unit), np.zeros(9), np.zeros(9)))
    pins, tips = linkage.joint_rates(position, jet[1:3], linkage.transform(jet, 2)[1:])
    h = 1e-5
    ahead, behind = linkage.joints(position + h * unit), linkage.joints(position - h * unit)
    for rates, one, other in zip((pins, tips), ahead, behind, strict=True):
        assert np.max(np.abs(rates[0] - (one - other) / (2.0 * h))) <= 1e-8 * 200.0


LOCKING: Final[dict[str, tuple[Linkage, float]]] = {
    "slider": (SliderCrank(100.0, 60.0, 0.0, True, 1, -1, 1), 155.0),
    "lever": (FourBar(70.0, 60.0, 85.0, 110 + 30j, math.radians(120.0), -1, -1), -math.pi / 3.0),
    "crank": (SliderDrivenCrank(SliderCrank(60.0, 160.0, 0.3, False, -1, 1, 1)), 2.6),
    "crank, many turns": (SliderDrivenCrank(SliderCrank(40.0, 110.0, 0.4, True, 1, -1, 1)), -9.0),
}


def there_and_back(end: float) -> MotionPlan:
    law = make_law("polynomial-345")
    moves = Move(Decimal(150), end, law), Move(Decimal(150), 0.0, law)
    return MotionPlan((Dwell(Decimal(60)), *moves))


@pytest.mark.parametrize("name", LOCKING)
def test_a_far_end_is_locked_where_the_follower_turns_back(name: str) -> None:
    """There the member and the coupler are in line, and dq/dx changes its sign; nowhere else."""
    linkage, end = LOCKING[name]
    low, high = sorted((0.0, end))
    positions = np.array(linkage.locked_positions(low, high))
    assert len(positions) > 0
    grid = np.linspace(low, high, 2000)
    jet = np.stack((grid, np.ones(2000), np.zeros(2000), np.zeros(2000)))
    changes = np.flatnonzero(np.diff(np.sign(linkage.transform(jet, 1)[1])))
    assert len(changes) == len(positions)
    for place, after in zip(sorted(positions), changes, strict=True):
        assert grid[after] < place < grid[after + 1]
    found = first_locked_place(linkage, there_and_back(end))
    assert found is not None
    phi, position = found
    assert there_and_back(end).jet(np.array([phi]))[0, 0] == pytest.approx(position, rel=1e-12)
    first = min(positions, key=abs)  # the motion starts at 0
    assert position == first
    assert first_locked_place(linkage, there_and_back(0.99 * first)) is None
    # Near it the ratio is a pole: it grows as the reciprocal of the way to it, on both sides.
    ways = linkage.per_follower(first + 1e-5 * np.array([-2.0, -1.0, 1.0, 2.0]))
    assert ways[1] / ways[0] == pytest.approx(2.0, rel=1e-3)
    assert ways[1] / ways[2] == pytest.approx(-1.0, rel=1e-3)


def test_a_dead_centre_of_the_follower_stops_the_far_end() -> None:
    """Crank and coupler of a four-bar in line, 3-4-5 with the shafts; the coupler across."""
    stretched = FourBar(30.0, 20.0, 30.0, 40 + 0j, 0.5 * math.pi, 1, 1)
    assert stretched.missing_length(np.zeros(1))[0] == pytest.approx(0.0, abs=1e-14)
    assert stretched.per_follower(np.zeros(1))[0] == pytest.approx(0.0, abs=1e-7)
    linkage = SliderDrivenCrank(SliderCrank(50.0, 40.0, 0.0, True, 1, 1, 1))
    (dead, *_) = linkage.dead_positions(0.0, 3.0)
    assert linkage.per_follower(np.array([dead]))[0] == pytest.approx(0.0, abs=1e-7)


def test_exactly_in_line_there_is_no_ratio() -> None:
    """Lever and coupler along y = 40 with a crank of 3-4-5; crank and coupler on the guide; the
    coupler across it, its tip 40 mm over the shaft.
    """
    lever = FourBar(50.0, 20.0, 10.0, 40j, 0.0, 1, 1)
    crank = SliderDrivenCrank(SliderCrank(40.0, 60.0, 0.5 * math.pi, False, 1, 1, 1))
    across = 60.0 + math.sqrt(100.0**2 - 40.0**2)
    with pytest.raises(GeometryError, match="square to the guide") as caught:
        LOCKING["slider"][0].per_follower(np.array([0.0, across]))
    assert caught.value.key == "linkage"
    for linkage in (lever, crank):
        with pytest.raises(GeometryError, match="in line"):
            linkage.per_follower(np.array([0.1, 0.0]))
        assert 0.0 in linkage.locked_positions(-1e-12, 1e-12) or np.allclose(
            linkage.locked_positions(-1e-12, 1e-12), 0.0, atol=1e-13
        )


def test_each_branch_is_locked_at_its_own_places() -> None:
    """The loops of one set of lengths: a place with two members in line belongs to one of them."""
    found = []
    for branch in (1, -1):
        linkage = FourBar(70.0, 60.0, 85.0, 110 + 30j, math.radians(120.0), -1, branch)
        positions = linkage.locked_positions(-math.pi, math.pi)
        assert positions
        for each in positions:
            pin, tip = linkage.joints(np.array([each]))
            sine = np.imag((pin - tip) / (pin - linkage.shaft))
            assert sine[0] == pytest.approx(0.0, abs=1e-9)
        found.append(set(positions))
    assert not found[0] & found[1]
