"""Lines and arcs each for itself: places on them, their parts, and chords within a sagitta."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour, Pieces
from camgeo.milling.track import Track, chained
from camgeo.numeric.arrays import taken
from tests.toolpath.plane.tracks import any_track, scattered

SEEDS = range(10)


def any_pieces(seed: int) -> Pieces:
    """Lines, arcs up to half a turn, and one of nearly a whole turn."""
    track = any_track(np.random.default_rng(seed), 8)
    return chained((track, Track.arc(track.end, track.end + 2.0, -6.0))).pieces


@pytest.mark.parametrize("seed", SEEDS)
def test_places_follow_the_length(seed: int) -> None:
    """Equal shares of the length are equally far apart, and the ends are those stated."""
    pieces = any_pieces(seed)
    count = 2001
    places = np.array(
        [pieces.at(np.full(len(pieces), share)) for share in np.linspace(0, 1, count)]
    )
    assert np.all(places[0] == pieces.starts)
    assert np.all(places[-1] == pieces.ends)
    steps = np.abs(np.diff(places, axis=0))
    # A chord of the angle t is shorter than its arc by the share t^2 / 24.
    assert np.max(np.abs(steps * (count - 1) / pieces.lengths - 1.0)) < 1e-6
    ways = np.diff(places, axis=0) / steps
    for k in (0, 700, 1999):
        middle = pieces.at(np.full(len(pieces), (k + 0.5) / (count - 1)))
        assert np.abs(pieces.tangents(middle) - ways[k]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_part_is_the_same_curve(seed: int) -> None:
    pieces, rng = any_pieces(seed), np.random.default_rng(seed)
    first, last = np.sort(rng.uniform(0.0, 1.0, (2, len(pieces))), axis=0)
    part = pieces.between(first, last)
    assert part.lengths == pytest.approx((last - first) * pieces.lengths)
    inner = rng.uniform(0.0, 1.0, len(pieces))
    same = pieces.at(first + inner * (last - first))
    assert np.abs(part.at(inner) - same) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_halves_turn_by_half_a_turn_at_most(seed: int) -> None:
    pieces = any_pieces(seed)
    index, first, last = pieces.halves()
    assert np.bincount(index).tolist() == [1] * (len(pieces) - 1) + [2]
    parts = taken(pieces, index).between(first, last)
    assert np.max(np.abs(parts.sweeps)) <= np.pi
    joined = index[1:] == index[:-1]
    assert np.all(parts.starts[1:][joined] == parts.ends[:-1][joined])


@pytest.mark.parametrize("sagitta", [1.0, 1e-3, 1e-7])
@pytest.mark.parametrize("seed", SEEDS)
def test_chords_keep_the_sagitta(seed: int, sagitta: float) -> None:
    pieces = any_pieces(seed)
    index, ends = pieces.chords(sagitta)
    first = np.diff(index, prepend=-1) > 0
    starts = np.where(first, pieces.starts[index], np.roll(ends, 1))
    assert np.all(ends[np.append(first[1:], True)] == pieces.ends)
    radii, half = pieces.radii[index], 0.5 * np.abs(ends - starts)
    off = radii - np.sqrt(np.maximum(radii**2 - half**2, 0.0))
    assert np.max(off) <= sagitta * (1.0 + 1e-9) + 1e-14
    assert np.all(np.bincount(index)[pieces.sweeps == 0.0] == 1)


def test_a_huge_arc_has_finitely_many_chords() -> None:
    huge = Track.arc(1e9 + 0j, 0j, 0.5 * np.pi).pieces
    assert len(huge.chords(1e-12)[0]) <= 500_000


@pytest.mark.parametrize("seed", SEEDS)
def test_distances_against_dense_places(seed: int) -> None:
    pieces, rng = any_pieces(seed), np.random.default_rng(seed)
    shares = np.linspace(0.0, 1.0, 2001)
    for place in scattered(rng, 20, 15.0):
        dense = np.array([pieces.at(np.full(len(pieces), share)) for share in shares[::20]])
        sampled = np.min(np.abs(dense - place), axis=0)
        exact = pieces.apart(np.full(len(pieces), place))
        assert np.all(exact <= sampled + 1e-12)
        assert np.all(exact >= sampled - pieces.lengths / 200.0 - 1e-12)


def test_contours_are_cut_into_half_turns() -> None:
    slotted = Contour(np.array([3.0 + 0j, 5.0, 3.0j]), np.array([0.0, 0.0, 1.5 * np.pi]),
                      np.array([0j, 0j, 0j]))  # fmt: skip
    pieces = Pieces.around([slotted, Contour.circle(9.0)])
    assert len(pieces) == 6
    assert np.max(pieces.sweeps) <= np.pi
    assert np.sum(pieces.lengths) == pytest.approx(slotted.length + 18.0 * np.pi)
    assert len(Pieces.around([])) == 0
