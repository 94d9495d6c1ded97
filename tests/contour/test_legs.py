"""Legs of a path: their smooth pieces, and the derivatives that the proof takes from an arc."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.legs import StretchLeg, TurnLeg, legs_of
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.pieces import smooth_pieces
from tests.contour.cams import TURN, dwell, move, translating
from tests.contour.paths import cut_off_lobe, shocks
from tests.strategies import attack

CAM = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
"""Breaks at 0, 60, 180 and 240 degrees."""


@attack
@given(st.floats(0.0, 6.28), st.floats(0.01, 1.0))
def test_pieces_fill_the_stretch(start: float, share: float) -> None:
    end = start + share * TURN
    leg = StretchLeg(CAM, start, end, False, None)
    pieces = leg.pieces
    assert pieces[0].start == start
    assert pieces[-1].end == end
    assert all(one.end == other.start for one, other in pairwise(pieces))
    for piece in pieces:
        middle = math.degrees(0.5 * (piece.start + piece.end)) % 360.0
        assert piece.dwell == (middle < 60.0 or 180.0 < middle < 240.0)
    inner = {round(math.degrees(piece.start)) % 360 for piece in pieces[1:]}
    assert inner <= {0, 60, 180, 240}


@pytest.mark.parametrize("steps", [-2, -1, 0, 1, 2])
def test_no_sliver_next_to_a_break(steps: int) -> None:
    """The ends of a stretch a few ulp off a break make no piece of their own."""
    angle = math.radians(60.0)
    for _ in range(abs(steps)):
        angle = math.nextafter(angle, math.copysign(9.0, steps))
    pieces = StretchLeg(CAM, angle, angle + TURN, False, None).pieces
    assert len(pieces) == 4
    assert (pieces[0].start, pieces[-1].end) == (angle, angle + TURN)


def test_whole_path_has_the_pieces_of_the_curve() -> None:
    (leg,) = legs_of(whole(CAM))
    assert leg.closed
    assert isinstance(leg, StretchLeg)
    assert leg.pieces == smooth_pieces(CAM)


def test_legs_begin_where_corners_and_arcs_end() -> None:
    (only,) = legs_of(cut_off_lobe())
    assert only.first == cut_off_lobe().pivots[0].centre
    assert not only.closed
    path = shocks(-1, 1)
    first, turn, second = legs_of(path)
    arc, corner = path.pivots
    assert (first.first, turn.first, second.first) == (corner.centre, arc.start, arc.end)


def test_degenerate_elements_are_no_legs() -> None:
    point = complex(CAM.point(np.array([1.0]))[0])
    tiny = 4.0 * math.ulp(1.0)
    path = Path(
        (
            Stretch(CAM, 1.0, 1.0 + TURN),
            Pivot(point, 8.0, 1j, -1e-17, 1.0, 1.0),
            Stretch(CAM, 1.0, 1.0 + tiny),
            Pivot(point, 0.0, 1j, -1.0, 1.0, 1.0),
        )
    )
    (leg,) = legs_of(path)
    assert (leg.start, leg.end) == (1.0, 1.0 + TURN)


@attack
@given(st.floats(0.01, 100.0), st.floats(0.01, 3.1), st.booleans(), st.floats(0.0, 1.0))
def test_arc_as_a_leg(radius: float, size: float, back: bool, share: float) -> None:
    sweep = -size if back else size
    centre, normal = 3.0 - 4.0j, np.exp(0.7j)
    pivot = Pivot(centre, radius, complex(normal), sweep, 0.0, 0.0)
    leg = TurnLeg(centre, pivot.start, pivot.end, sweep)
    # A point is rounded to some ulp of the centre's 5 mm and of the radius.
    rounding = 1e-15 * (5.0 + radius)
    ends = leg.point(np.array([0.0, leg.end]))
    assert np.abs(ends - np.array([pivot.start, pivot.end])).max() <= rounding
    t, step = np.array([share * size]), 1e-5
    jet, bounds = leg.jet_and_bounds(t, t)
    assert abs(jet[0] - leg.point(t)) <= rounding
    # Central differences: error step^2/6 of the radius, and rounding over the step.
    allowed = radius * step**2 / 6.0 + 2.0 * rounding / step
    for order in (0, 1):
        after, before = (leg.jet_and_bounds(at, at)[0][order] for at in (t + step, t - step))
        slope = (after - before) / (2.0 * step)
        assert abs(slope - jet[order + 1])[0] <= allowed
    points, tangents, pace = leg.traced(t)
    assert points == leg.point(t)
    assert tangents == pytest.approx(jet[1] / radius, rel=1e-12)
    assert pace == pytest.approx(np.abs(jet[1]), rel=1e-12)
    assert np.all(bounds >= np.abs(jet[1]) * (1.0 - 1e-12))
    assert leg.length == pytest.approx(radius * size, rel=1e-12)
