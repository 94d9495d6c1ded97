from __future__ import annotations

import math
import re
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linkage import (
    SIZES,
    Linkage,
    LinkedMotion,
    clear_range,
    closing_sizes,
    monotone_runs,
    openings,
    why_open,
)
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.motion import lift_range
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.units import TURN
from tests.reference import POLYNOMIAL
from tests.strategies import attack, four_bars, slider_cranks, slider_driven_cranks


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
