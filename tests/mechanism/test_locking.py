"""Travel of the far end of a linkage per unit of the follower's, and where there is none."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linkage import Linkage, locked_at
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.plan import Dwell, MotionPlan, Move

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
    found = locked_at(linkage, there_and_back(end))
    assert found is not None
    phi, position = found
    assert there_and_back(end).jet(np.array([phi]))[0, 0] == pytest.approx(position, rel=1e-12)
    first = min(positions, key=abs)  # the motion starts at 0
    assert position == first
    assert locked_at(linkage, there_and_back(0.99 * first)) is None
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
