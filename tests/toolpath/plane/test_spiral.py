"""The roughing spiral: between its curves, its engagement as dense points find it, its arcs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.milling.clear import Morph, Star, biarcs, engagements, fit_spiral, shortest_spiral
from camgeo.milling.track import Track, chain_tracks
from camgeo.numeric.arrays import BoolArray, ComplexArray
from camgeo.part.boundaries import CurveBoundary
from tests.contour.cams import dwell, flank, move, translating
from tests.part.parts import refused
from tests.toolpath.plane.tracks import any_track, dense

RADIUS = 5.0

LIMIT = np.radians(50.0)

BLANK = 62.0


def star(contour: Contour) -> Star:
    found = Star.from_contour(contour)
    assert found is not None
    return found


@cache
def cam() -> Star:
    """The centre's path along a disc with a lobe, with hollow flanks."""
    curve = translating(dwell(60), move(120, 20.0), dwell(40), move(140, 0.0))
    outline = CurveBoundary("outline", hole=False, path=whole(curve))
    return star(outline.offset(RADIUS).arcs(0.01, "fast").contour)


def outside() -> Morph:
    blank = star(Contour.circle(BLANK + RADIUS))
    return shortest_spiral(
        blank, cam(), sense=-1, side=-1, finish=0.4, radius=RADIUS, limit=LIMIT, step=2.0
    )


def inside() -> Morph:
    """From a hole of 12 mm to a bore of 50 mm."""
    hole, bore = star(Contour.circle(6.0 - RADIUS)), star(Contour.circle(25.0 - RADIUS))
    return shortest_spiral(
        hole, bore, sense=1, side=-1, finish=0.4, radius=RADIUS, limit=LIMIT, step=2.0
    )


MORPHS = {"outside": outside, "inside": inside}


def in_stock(name: str, points: ComplexArray) -> BoolArray:
    return np.abs(points) < BLANK if name == "outside" else np.abs(points) > 6.0


@pytest.mark.parametrize("name", MORPHS)
def test_engagement_is_that_of_dense_points(name: str) -> None:
    """The share of the front of the cutter's circle that no earlier place of it has swept."""
    morph = MORPHS[name]()
    found = engagements(morph, RADIUS)
    assert np.max(found) <= LIMIT
    turn = np.arange(0.0, morph.turns + 1.0, 1.0 / 1440.0)
    path, along = morph.points_and_tangents(turn)
    front = np.radians(np.arange(0.0, 180.0, 0.5) + 0.25)
    for k in range(5, len(turn) - 720, 997):
        rim = path[k] - 1j * along[k] * RADIUS * np.exp(1j * front)
        swept = np.min(np.abs(rim[:, None] - path[max(0, k - 4320) : k]), axis=1) < RADIUS - 1e-9
        left = in_stock(name, rim) & ~swept
        # Half a degree is a step on the rim; the point at the wall is new, or swept to rounding.
        assert np.sum(left) * 0.5 == pytest.approx(np.degrees(found[k // 2]), abs=2.0)


@pytest.mark.parametrize("name", MORPHS)
def test_it_is_no_longer_than_the_limit_asks(name: str) -> None:
    morph = MORPHS[name]()
    assert np.degrees(np.max(engagements(morph, RADIUS))) > 49.0
    assert np.mean(engagements(morph, RADIUS)[: int(720 * morph.turns)] == 0.0) < 0.02


def test_the_pace_slows_where_the_end_limits_it() -> None:
    """A disc with hollow flanks: the spiral is shorter than one of an even pace."""
    path = CurveBoundary("outline", hole=False, path=whole(flank("setzhub", -1))).offset(RADIUS)
    disc = star(path.arcs(0.01, "fast").contour)
    blank, way = star(Contour.circle(46.0 + RADIUS)), {"sense": -1, "side": -1}
    morph = shortest_spiral(blank, disc, **way, finish=0.4, radius=RADIUS, limit=LIMIT, step=9.0)
    assert np.max(engagements(morph, RADIUS)) <= LIMIT
    even = replace(morph, slowing=0.0)
    assert morph.slowing > 0.0
    assert np.max(engagements(even, RADIUS)) > LIMIT


@pytest.mark.parametrize("slowing", [0.0, 0.3, 0.7])
def test_the_share_grows_from_0_to_1_without_a_jump(slowing: float) -> None:
    morph = replace(inside(), slowing=slowing, turns=6.3)
    turn = np.linspace(-0.5, 7.0, 5_001)
    share, slope = morph.share(turn)
    assert np.all(np.diff(share) >= 0.0)
    assert share[0] == 0.0
    assert share[-1] == 1.0
    assert np.max(np.diff(share)) <= 1.01 * morph.rate * (turn[1] - turn[0])
    inner = (turn > 0.01) & (turn < 6.29)
    assert np.gradient(share, turn)[inner] == pytest.approx(slope[inner], abs=1e-3)


@pytest.mark.parametrize("name", MORPHS)
def test_neighbouring_turns_are_no_farther_apart_than_the_step(name: str) -> None:
    morph = MORPHS[name]()
    turn = np.linspace(0.0, morph.turns, 2000)
    points, ahead = morph.points_and_tangents(turn)[0], morph.points_and_tangents(turn + 1.0)[0]
    assert np.max(np.abs(np.abs(ahead) - np.abs(points))) <= 2.0 * (1.0 + 1e-9)


@pytest.mark.parametrize("tolerance", [0.1, 0.01])
@pytest.mark.parametrize("name", MORPHS)
def test_arcs(name: str, tolerance: float) -> None:
    morph = MORPHS[name]()
    track = fit_spiral(morph, tolerance)
    dense = morph.points_and_tangents(np.linspace(0.0, morph.turns, 5000))[0]
    assert np.max(distances(dense, track)) <= tolerance
    assert len(track) < 45 * morph.turns
    assert track.start == pytest.approx(morph.points_and_tangents(np.zeros(1))[0][0])
    # It joins the curve on which it ends along its tangent.
    end, along = morph.b.points(np.array([0.4]))[0], track.headings[1]
    assert track.end == pytest.approx(end)
    r, slope = morph.b.radii_and_slopes(np.array([0.4]))
    tangent = np.exp(0.4j) * complex(slope[0], r[0]) * morph.sense
    assert along == pytest.approx(tangent / abs(tangent), abs=1e-9)


def test_a_square_blank() -> None:
    """The first curve may have corners: round ones, of the cutter about the blank's."""
    corners = 60.0 * np.array([1 - 1j, 1 + 1j, -1 + 1j, -1 - 1j])
    out = RADIUS * np.array([-1j, 1 + 0j, 1j, -1 + 0j])
    vertices = np.column_stack((corners + out, corners + out * 1j)).ravel()
    sweeps = np.tile([0.5 * np.pi, 0.0], 4)
    centres = [centre for corner in corners for centre in (complex(corner), 0j)]
    blank = Contour(vertices, sweeps, np.array(centres))
    assert Track.around(blank).length == pytest.approx(480.0 + 10.0 * np.pi)
    morph = shortest_spiral(
        star(blank), cam(), sense=-1, side=-1, finish=0.4, radius=RADIUS, limit=LIMIT, step=3.0
    )
    assert np.max(engagements(morph, RADIUS)) <= LIMIT
    assert fit_spiral(morph, 0.05).length > 2000.0


def test_steps_too_small_are_refused() -> None:
    blank = star(Contour.circle(BLANK + RADIUS))
    with refused("tool.stepover", "roughing spiral would need more than"):
        shortest_spiral(
            blank, cam(), sense=-1, side=-1, finish=0.0, radius=RADIUS, limit=LIMIT, step=1e-3
        )


# -- star ------------------------------------------------------------------------------------------
# Contours seen from a pole.


SLOT = Contour(
    np.array([-10 - 1j, 10 - 1j, 10 + 1j, -10 + 1j]),
    np.array([0.0, np.pi, 0.0, np.pi]),
    np.array([0j, 10.0, 0j, -10.0]),
)

WAISTED = Contour(
    np.array([4 - 3j, 4 + 3j, -4 + 3j, -4 - 3j]),
    np.array([0.0, -1.0, 0.0, -1.0]),
    np.array([0j, 3j + 4j / np.tan(0.5), 0j, -3j - 4j / np.tan(0.5)]),
)
"""Two sides bent inward."""


POLES = [(SLOT, 2 + 0.1j), (WAISTED, 0.3j), (SLOT.reversed(), 0j)]


@pytest.mark.parametrize(("contour", "pole"), POLES)
def test_rays_meet_the_contour(contour: Contour, pole: complex) -> None:
    star = Star.from_contour(contour, pole)
    assert star is not None
    rays = np.linspace(-7.0, 9.0, 700)
    r, slope = star.radii_and_slopes(rays)
    assert np.max(distances(star.points(rays), Track.around(contour))) < 1e-12
    step = 1e-6
    ahead, behind = (star.radii_and_slopes(rays + each)[0] for each in (step, -step))
    # Apart from kinks and jumps of curvature within a step of a ray.
    assert np.quantile(np.abs((ahead - behind) / (2.0 * step) - slope), 0.98) < 1e-6
    assert np.all(r > 0.0)


@pytest.mark.parametrize("pole", [0.95j, 10.95 + 0j, 20 + 0j])
def test_steep_or_outside_is_none(pole: complex) -> None:
    assert Star.from_contour(SLOT, pole) is None


def test_what_turns_back_is_none() -> None:
    hook = np.array([0j, 10 + 0j, 10 + 10j, 5 + 10j, 5 + 4j, 4 + 4j, 4 + 10j, 0 + 10j])
    assert Star.from_contour(Contour.polygon(hook), 2 + 2j) is None


@pytest.mark.parametrize(("contour", "pole"), POLES)
def test_nothing_is_nearer_or_farther_than_its_distances(contour: Contour, pole: complex) -> None:
    star, other = (
        Star.from_contour(contour, pole),
        Star.from_contour(Contour.circle(30.0, pole + 1.0), pole),
    )
    assert star is not None
    assert other is not None
    rays = np.linspace(0.0, 2.0 * np.pi, 100_001)
    own = star.radii_and_slopes(rays)[0]
    for found, values in (
        (star.distances(), own),
        (star.distances(beyond=other), own - other.radii_and_slopes(rays)[0]),
    ):
        for end, sign in ((found.lowest, -1.0), (found.highest, 1.0)):
            most = float(np.max(sign * values))
            assert most - 1e-9 <= sign * end.value <= most + 1e-3


def test_the_distances_of_a_square_that_lies_askew() -> None:
    square = Star.from_contour(
        Contour.polygon(10.0 * np.exp(1j * (0.1003 + 0.5 * np.pi * np.arange(4))))
    )
    assert square is not None
    found = square.distances()
    assert found.highest.value == pytest.approx(10.0, abs=1e-12)
    assert found.lowest.value == pytest.approx(np.sqrt(50.0), abs=1e-12)


# -- track -----------------------------------------------------------------------------------------
# Chains of lines and arcs: parts of them, and biarcs.


@pytest.mark.parametrize("seed", range(10))
def test_parts_lie_on_the_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track = any_track(rng)
    start, end = np.sort(rng.uniform(0.0, track.length, 2))
    part = track.section(float(start), float(end))
    assert part.length == pytest.approx(end - start, rel=1e-9)
    assert np.max(distances(dense(part, 30), track)) < 1e-10
    ends, along = track.points_and_tangents(np.array([start, end]))
    assert np.abs(ends - [part.start, part.end]) == pytest.approx([0.0, 0.0], abs=1e-10)
    assert np.array(part.headings) == pytest.approx(along, abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_half_turns_are_the_same(seed: int) -> None:
    track = any_track(np.random.default_rng(seed))
    track = chain_tracks((track, Track.arc(track.end, track.end + 2.0, 6.0)))
    fine = track.halved()
    assert fine.length == pytest.approx(track.length, rel=1e-12)
    assert np.max(distances(dense(fine, 5), track)) < 1e-10
    assert np.max(np.abs(fine.sweeps)) <= np.pi
    back = track.reversed()
    assert back.start == track.end
    assert np.max(distances(dense(back, 5), track)) < 1e-10
    both = chain_tracks((track, back))
    assert both.end == track.start
    assert both.length == pytest.approx(2.0 * track.length)


def test_once_round_a_contour() -> None:
    circle = Track.around(Contour.circle(3.0, 1j))
    assert circle.start == circle.end == 3.0 + 1j
    assert circle.length == pytest.approx(6.0 * np.pi)
    assert circle.headings[0] == pytest.approx(1j)


def test_biarcs_are_tangential_and_exact_on_circles() -> None:
    turn = np.linspace(0.0, 2.0, 5)
    track = biarcs(4.0 * np.exp(1j * turn), 1j * np.exp(1j * turn))
    assert np.abs(track.centres) == pytest.approx(np.zeros(8), abs=1e-12)
    assert np.sum(track.sweeps) == pytest.approx(2.0)


def test_biarcs_join_without_a_corner() -> None:
    t = np.linspace(0.0, 6.0, 40)
    points, along = t + 1j * np.sin(t), 1.0 + 1j * np.cos(t)
    track = biarcs(points, along / np.abs(along))
    out = np.where(track.sweeps == 0.0, track.ends - track.starts,
                   1j * np.sign(track.sweeps) * (track.ends - track.centres))  # fmt: skip
    into = np.where(track.sweeps == 0.0, track.ends - track.starts,
                    1j * np.sign(track.sweeps) * (track.starts - track.centres))  # fmt: skip
    assert np.max(np.abs(np.angle(into[1:] * np.conj(out[:-1])))) < 1e-7
    assert np.max(distances(t + 1j * np.sin(t), track)) < 1e-12
    fine = np.linspace(0.0, 6.0, 1000)
    assert np.max(distances(fine + 1j * np.sin(fine), track)) < 1e-3
