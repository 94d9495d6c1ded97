"""Leads: along the path where they join it, as large as there is room, never into the part."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, distances, least_distance
from camgeo.milling.clear import biarcs
from camgeo.milling.track import (
    CLOSE,
    SMALLEST_SHARE,
    Lead,
    LeadSpec,
    Track,
    begin_at_distance,
    begin_in_piece,
    fit_leads,
    flattest,
    join_leads,
)
from camgeo.part.boundaries import CurveBoundary
from tests.contour.cams import outline
from tests.contour.paths import cut_off_lobe, swallow_tail
from tests.toolpath.plane.tracks import dense

ROUNDING = 1e-10
"""Of distances [mm] from arcs as flat as the random paths have."""

HALF_WIDTH = 1.0

SLOT = Contour(
    np.array([-10 - 1j, 10 - 1j, 10 + 1j, -10 + 1j]),
    np.array([0.0, np.pi, 0.0, np.pi]),
    np.array([0j, 10.0, 0j, -10.0]),
)
"""A slot of width 2, counter-clockwise: the cutter's centre runs round its inside."""


def test_start_in_the_middle_of_a_piece() -> None:
    for index in range(4):
        contour = begin_in_piece(SLOT, index)
        assert contour.area == pytest.approx(SLOT.area, rel=1e-14)
        assert contour.length == pytest.approx(SLOT.length, rel=1e-14)
        middle = contour.vertices[0]
        half = SLOT.lengths[index] / 2.0
        assert contour.lengths[0] == pytest.approx(half)
        assert contour.lengths[-1] == pytest.approx(half)
        assert outline(SLOT).distances(np.array([middle]))[0] < 1e-14
    assert begin_in_piece(SLOT, 0).vertices[0] == pytest.approx(-1j)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.5, 0.77, 1.0])
def test_start_anywhere(share: float) -> None:
    contour = begin_at_distance(SLOT, share * SLOT.length)
    assert contour.area == pytest.approx(SLOT.area, rel=1e-12)
    assert contour.length == pytest.approx(SLOT.length, rel=1e-12)
    there, _ = Track.around(SLOT).points_and_tangents(np.array([share * SLOT.length]))
    assert contour.vertices[0] == pytest.approx(there[0])
    assert np.min(contour.lengths) > 1e-7


def test_flattest_places_come_first() -> None:
    order = list(flattest(SLOT))
    assert set(order[:2]) == {0, 2}
    assert set(order) == {0, 1, 2, 3}
    # A short line between long arcs is no place.
    pill = Contour(SLOT.vertices * 0.01 + 0.0, SLOT.sweeps, SLOT.centres * 0.01)
    assert len(list(flattest(pill))) == 4


def checked(path: Contour, lead: Lead, free: int) -> None:
    track = Track.around(path)
    assert lead.entry.end == pytest.approx(track.start)
    assert lead.exit.start == pytest.approx(track.start)
    assert lead.entry.headings[1] == pytest.approx(track.headings[0], abs=1e-9)
    assert lead.exit.headings[0] == pytest.approx(track.headings[0], abs=1e-9)
    ring = path.points(1e-5)
    inside = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
    for each in (lead.entry, lead.exit):
        points = dense(each, 50)
        away = points[distances(points, track) > 1e-3]
        assert len(away)
        found = shapely.contains_xy(inside, away.real, away.imag)
        assert np.all(found == ((path.area > 0.0) == (free > 0)))


@pytest.mark.parametrize("room", [0.05, 0.5, 1.2, 5.0, 30.0])
def test_lead_stays_in_the_slot(room: float) -> None:
    path, lead = join_leads(SLOT, room, LeadSpec(free=1, usual=0.5))
    checked(path, lead, 1)
    off = distances(np.array([lead.exit.end, lead.entry.start]), Track.line(-10 - 1j, 10 - 1j))
    if abs(path.vertices[0].imag) == HALF_WIDTH and path.vertices[0].imag < 0:
        # As far off as the room says, halved until it fits into the width of the slot.
        assert np.all(off > min(room, 2.0 * HALF_WIDTH) / 2.0 - 1e-12)
        assert np.all(off <= room + 1e-12)
    for end in (lead.entry.start, lead.exit.end):
        assert abs(end.imag) <= HALF_WIDTH


@pytest.mark.parametrize("room", [0.1, 3.0, 12.0])
@pytest.mark.parametrize("climb", [True, False])
@pytest.mark.parametrize("name", ["swallow tail", "cut-off lobe"])
def test_leads_outside_a_disc(name: str, climb: bool, room: float) -> None:
    path = {"swallow tail": swallow_tail, "cut-off lobe": cut_off_lobe}[name]()
    contour = CurveBoundary("outline", hole=False, path=path).offset(3.0).arcs(0.01).contour
    contour = contour.reversed() if climb else contour
    free = 1 if climb else -1
    for straight in (False, True):
        begun_there, lead = join_leads(
            contour, room, LeadSpec(free=free, usual=3.0, straight=straight)
        )
        checked(begun_there, lead, free)
        assert len(lead.exit) == (2 if straight else 1)
        # It joins at a place flatter than most.
        bends = np.where(contour.radii > 0.0, 1.0 / np.maximum(contour.radii, 1e-9), 0.0)
        own = 1.0 / begun_there.radii[0] if begun_there.radii[0] else 0.0
        assert own <= np.quantile(bends, 0.5)


def wavy(count: int, two: float, three: float, phase: float) -> Contour:
    """Round a curve of radius 30 (1 + two cos 2 a + three cos (3 a + phase)) [mm], in tangent arcs,
    counter-clockwise.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, count + 1)
    waves = 30.0 * two * np.exp(2j * angles), 30.0 * three * np.exp(1j * (3.0 * angles + phase))
    radii = 30.0 + waves[0].real + waves[1].real
    slopes = -2.0 * waves[0].imag - 3.0 * waves[1].imag
    points, ways = radii * np.exp(1j * angles), (slopes + 1j * radii) * np.exp(1j * angles)
    points[-1], ways[-1] = points[0], ways[0]
    track = biarcs(points, ways / np.abs(ways))
    return Contour(track.starts, track.sweeps, track.centres)


@settings(max_examples=40, deadline=None)
@given(
    path=st.one_of(
        st.builds(
            wavy,
            st.integers(9, 40),
            st.floats(0.0, 0.12),
            st.floats(0.0, 0.06),
            st.floats(0.0, 2.0 * math.pi),
        ),
        st.floats(6.0, 20.0).map(
            lambda scale: Contour(scale * SLOT.vertices, SLOT.sweeps, scale * SLOT.centres)
        ),
    ),
    place=st.floats(0.0, 1.0),
    room=st.floats(0.05, 2.0),
    usual=st.floats(1.0, 6.0),
    free=st.sampled_from((1, -1)),
    straight=st.booleans(),
)
def test_leads_end_as_far_off_the_path_as_the_room_is(
    path: Contour, place: float, room: float, usual: float, free: int, straight: bool
) -> None:
    """Whatever pieces the path has there, of one bend or of several."""
    there = begin_at_distance(path, place * path.length)
    lead = fit_leads(there, room, LeadSpec(free=free, usual=usual, straight=straight, least=room))
    assert lead is not None
    checked(there, lead, free)
    off = distances(np.array([lead.entry.start, lead.exit.end]), Track.around(there))
    assert np.max(np.abs(off - room)) <= CLOSE + ROUNDING


@pytest.mark.parametrize("straight", [False, True])
@pytest.mark.parametrize("joint", range(4))
def test_each_end_goes_by_its_own_side_of_a_joint(joint: int, straight: bool) -> None:
    """Outside, between a line and a round: with one bend for both sides one end is far off."""
    path, room = SLOT.reversed().rolled(joint), 0.2
    lead = fit_leads(path, room, LeadSpec(free=1, usual=3.0, straight=straight))
    assert lead is not None
    checked(path, lead, 1)
    off = distances(np.array([lead.entry.start, lead.exit.end]), Track.around(path))
    assert off == pytest.approx(room, abs=CLOSE)


def test_leads_of_a_controller_that_offsets_end_where_the_cutter_does() -> None:
    """Beside the programmed line by the cutter's radius, and as far off the path as the room is."""
    circle, room, aside = Contour.circle(20.0).reversed(), 4.0, 1.0
    lead = fit_leads(circle, room, LeadSpec(free=1, usual=2.0, straight=True, aside=aside))
    assert lead is not None
    for end in (lead.entry.start, lead.exit.end):
        assert abs(end) - 20.0 == pytest.approx(room, abs=CLOSE)


def test_no_lead_ends_in_what_is_left_on_the_wall() -> None:
    """Half as large ones fit between two obstacles; the cutter would come down into material."""
    path = begin_in_piece(SLOT, 0)
    track = Track.around(path)
    body = Track.line(-10 - 0.75j, 10 - 0.75j)
    beside = LeadSpec(free=1, usual=0.1, avoid=((body, 0.1),))
    place = 0.5 * float(SLOT.lengths[0])
    _, lead = join_leads(SLOT, 0.2, beside, place=place)
    assert distances(np.array([lead.exit.end]), track)[0] == pytest.approx(0.1)
    with pytest.raises(GeometryError, match="no room for a tangential lead-in"):
        join_leads(SLOT, 0.2, replace(beside, least=0.18), place=place)


def test_leads_keep_off_what_they_must() -> None:
    circle = Contour.circle(20.0).reversed()
    _, lead = join_leads(circle, 5.0, LeadSpec(free=1, usual=5.0))
    body = Track.around(Contour.circle(1.0, lead.exit.end))
    path, other = join_leads(circle, 5.0, LeadSpec(free=1, usual=5.0, avoid=((body, 3.0),)))
    checked(path, other, 1)
    assert min(least_distance(each, body) for each in (other.entry, other.exit)) >= 3.0


def test_no_room_is_refused() -> None:
    narrow = Contour(SLOT.vertices.real + 1e-3j * SLOT.vertices.imag, SLOT.sweeps, SLOT.centres)
    room = 2.1 * HALF_WIDTH * 1e-3 / SMALLEST_SHARE
    assert fit_leads(begin_in_piece(narrow, 0), room, LeadSpec(free=1, usual=room)) is None
    with pytest.raises(GeometryError, match="no room for a tangential lead-in"):
        join_leads(narrow, 1.1 * room, LeadSpec(free=1, usual=room))
