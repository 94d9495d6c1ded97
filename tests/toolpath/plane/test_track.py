"""Chains of lines and arcs: parts of them, and biarcs."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour, distances
from camgeo.milling.track import Track, biarcs, chained
from tests.toolpath.plane.tracks import any_track, dense


@pytest.mark.parametrize("seed", range(10))
def test_parts_lie_on_the_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track = any_track(rng)
    start, end = np.sort(rng.uniform(0.0, track.length, 2))
    part = track.between(float(start), float(end))
    assert part.length == pytest.approx(end - start, rel=1e-9)
    assert np.max(distances(dense(part, 30), track)) < 1e-10
    ends, along = track.at(np.array([start, end]))
    assert np.abs(ends - [part.start, part.end]) == pytest.approx([0.0, 0.0], abs=1e-10)
    assert np.array(part.headings) == pytest.approx(along, abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_half_turns_are_the_same(seed: int) -> None:
    track = any_track(np.random.default_rng(seed))
    track = chained((track, Track.arc(track.end, track.end + 2.0, 6.0)))
    fine = track.halved()
    assert fine.length == pytest.approx(track.length, rel=1e-12)
    assert np.max(distances(dense(fine, 5), track)) < 1e-10
    assert np.max(np.abs(fine.sweeps)) <= np.pi
    back = track.reversed()
    assert back.start == track.end
    assert np.max(distances(dense(back, 5), track)) < 1e-10
    both = chained((track, back))
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
