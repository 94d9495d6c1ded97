"""Special positions and transmission angles of linkages, against dense samples of their joints."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linkage import (
    BACK,
    OUT,
    SIZES,
    Linkage,
    clear_range,
    position_text,
)
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.mechanism.triangle import Size
from camgeo.numeric.arrays import FloatArray, IntArray
from tests.long_form import examples
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
    assert np.abs(found[OUT]) == pytest.approx(out, abs=1e-9)
    assert np.abs(found[BACK]) == pytest.approx(back, abs=1e-9)
    assert np.all(found[BACK] > 0.0) or np.all(found[BACK] < 0.0)
    # Locked where the far member cannot be driven, and nowhere else.
    locked = linkage.locked_positions(grid[0], grid[-1])
    crossed = np.flatnonzero(found[OUT][:-1] * found[OUT][1:] < 0.0)
    within(locked, grid, crossed)
    at = linkage.transmission_sines(np.array([0.0, *locked]))[OUT, 1:]
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
    size = np.abs(found[OUT])
    lows = 1 + np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]))
    lows = lows[(lows > BESIDE) & (lows < COUNT - BESIDE) & (size[lows] > 1e-2)]
    for side in (-BESIDE, BESIDE):  # of a parallelogram the angle stays, but for rounding
        lows = lows[size[lows] < size[lows + side] - 1e-8]
    within((*far, *locked), grid, lows - 1, slack=2)
    # The way back is the quotient of both sines, with the lever of each member.
    free = size > 0.05
    way = linkage.per_follower(grid[free])
    quotient = way * found[OUT][free] / found[BACK][free]
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
    low_out, high_out = clear_range(linkage, OUT)
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
