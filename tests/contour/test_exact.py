"""Outlines that are exactly lines and arcs: their chords, and the proof, which is attacked too."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.exact import chords_of, distance_between, fewest_chords_of
from camgeo.geometry.contour.hausdorff import ROUNDING, SHARPNESS
from camgeo.part.assembly import bore_outline
from camgeo.part.spec import Keyway
from tests.contour.cams import outline
from tests.long_form import examples

some = settings(max_examples=examples(12, long=40), deadline=None)

few = settings(max_examples=examples(7, long=15), deadline=None)
"""For what is measured at every size of tolerance, down to thousands of chords."""

RADIUS = 8.0

PLAIN = Contour.circle(RADIUS)

SLOTTED = bore_outline(2.0 * RADIUS, Keyway(5.0, 2.3, 0.4))

outlines = st.sampled_from([PLAIN, SLOTTED])

NOTHING = 3.0 * ROUNDING * 11.0 + 1e-14
"""No distance [mm]: the allowance for rounding, and rounding itself, 5 ulp of 11 mm."""


def _measured(exact: Contour, contour: Contour) -> float:
    """Largest distance by dense sampling with exact distances: from below, never too large."""
    a, b = outline(exact), outline(contour)
    return max(
        float(np.max(a.distances(b.dense(3_000)))), float(np.max(b.distances(a.dense(3_000))))
    )


def _caught(exact: Contour, contour: Contour) -> float:
    try:
        bound = distance_between(exact, contour)
    except GeometryError:
        return math.inf
    assert bound >= _measured(exact, contour) - 1e-12
    return bound


@few
@given(outlines, st.floats(-6.0, 0.0))
def test_chords_keep_their_tolerance(exact: Contour, size: float) -> None:
    tolerance = 10.0**size
    fit = chords_of(exact, tolerance)
    chords = fit.contour
    assert chords.arc_count == 0
    found = _measured(exact, chords)
    assert found <= fit.deviation <= 1.04 * found + NOTHING
    assert found <= tolerance * (1.0 + 1e-9) + 1e-14
    # Points between the samples lie (1/5)^2 of a sagitta further at 5 points a chord.
    assert distance_between(exact, chords) <= 1.04 * found + NOTHING
    assert distance_between(exact, chords.reversed()) >= found - 1e-14


def test_chords_are_few() -> None:
    # Sagitta 0.001 on 8 mm: step 2 arccos(1 - 0.001/8) = 0.031624 rad, 100 to each half.
    assert len(chords_of(PLAIN, 0.001).contour) == 2 * 100


def test_too_many_chords_are_refused() -> None:
    with pytest.raises(ToleranceError, match="straight pieces would be needed"):
        chords_of(PLAIN, 1e-13)


@pytest.mark.parametrize("exact", [PLAIN, SLOTTED])
def test_itself_is_no_distance(exact: Contour) -> None:
    for same in (exact, exact.reversed(), exact.split(1.0), exact.split(0.01).reversed()):
        assert distance_between(exact, same) < NOTHING


@some
@given(st.floats(-5.0, 0.7), st.floats(0.0, 6.3), st.floats(0.6, 1.2))
def test_shifted_and_scaled_circles(size: float, angle: float, factor: float) -> None:
    """Two circles: the largest distance is known, |shift| + |difference of the radii|."""
    step = 10.0**size * complex(np.cos(angle), np.sin(angle))
    circle = Contour.circle(factor * RADIUS, step)
    true = abs(step) + abs(factor - 1.0) * RADIUS
    try:
        bound = distance_between(PLAIN, circle)
    except GeometryError:
        return
    assert true - 1e-15 <= bound <= true * 1.02 + 1e-12


@some
@given(outlines, st.floats(0.005, 0.5), st.integers(0, 10**6), st.floats(-5.0, 1.0),
       st.floats(0.0, 6.3))  # fmt: skip
def test_moved_vertex(
    exact: Contour, tolerance: float, index: int, size: float, angle: float
) -> None:
    chords = chords_of(exact, tolerance).contour
    vertices = chords.vertices.copy()
    vertices[index % len(vertices)] += 10.0**size * complex(np.cos(angle), np.sin(angle))
    _caught(exact, Contour(vertices, chords.sweeps, chords.centres))


@some
@given(outlines, st.floats(0.005, 0.5), st.integers(0, 10**6), st.integers(1, 30))
def test_left_out_vertices(exact: Contour, tolerance: float, start: int, count: int) -> None:
    chords = chords_of(exact, tolerance).contour
    keep = (np.arange(len(chords)) - start) % len(chords) >= min(count, len(chords) - 3)
    _caught(exact, Contour(chords.vertices[keep], chords.sweeps[keep], chords.centres[keep]))


@some
@given(st.floats(-4.0, 0.0), st.floats(0.0, 6.3))
def test_shifted_bore_with_keyway(size: float, angle: float) -> None:
    step = 10.0**size * complex(np.cos(angle), np.sin(angle))
    arcs = SLOTTED.sweeps != 0.0
    moved = Contour(
        SLOTTED.vertices + step, SLOTTED.sweeps, np.where(arcs, SLOTTED.centres + step, 0.0)
    )
    # The whole circle has normals in all directions but those of the slot; the slot has those.
    assert _caught(SLOTTED, moved) >= 0.7 * abs(step)


@some
@given(st.floats(1.0, 7.0), st.floats(0.1, 4.0), st.floats(0.0, 6.2))
def test_another_keyway(width: float, depth: float, angle: float) -> None:
    _caught(SLOTTED, bore_outline(2.0 * RADIUS, Keyway(width, depth, angle)))


CORNERS = range(len(SLOTTED))

STEPS = (1e-12, 1e-9, 1e-6, 1e-3)


@pytest.mark.parametrize("corner", CORNERS)
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("way", [1.0, -1.0, 1j, -1j])
def test_a_moved_corner_counts_as_much_as_it_is_moved(
    corner: int, step: float, way: complex
) -> None:
    """An arc whose end passes the corner is off by no more than that."""
    arcs = SLOTTED.split(math.pi)
    vertices = arcs.vertices.copy()
    vertices[corner] += step * way
    moved = distance_between(SLOTTED, Contour.through(vertices, arcs.sweeps))
    # Half a turn on the chord moves its middle by up to as much as its end, and rounds as the
    # vertex itself does.
    assert moved <= 1.001 * step + 2.0 * NOTHING


@some
@given(outlines, st.integers(0, 10**6), st.sampled_from(STEPS), st.floats(0.0, 6.3),
       st.floats(-4.0, -0.5))  # fmt: skip
def test_the_distance_is_a_continuous_function(
    exact: Contour, index: int, step: float, angle: float, size: float
) -> None:
    """However far off the contour already is: all of its arcs, of up to half a turn, were moved."""
    arcs = exact.split(math.pi)
    rough = np.random.default_rng(index).normal(size=(3, len(arcs))) * 10.0**size
    vertices = arcs.vertices + rough[0] + 1j * rough[1]
    sweeps = np.where(arcs.sweeps == 0.0, 0.1 * rough[2], 0.99 * arcs.sweeps)
    before = distance_between(exact, Contour.through(vertices, sweeps))
    vertices[index % len(vertices)] += step * complex(np.cos(angle), np.sin(angle))
    after = distance_between(exact, Contour.through(vertices, sweeps))
    assert abs(after - before) <= 1.001 * step + SHARPNESS * after + NOTHING


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flat_arcs_are_off_by_their_sagitta(bulge: float) -> None:
    """However large the circles are."""
    straight = int(np.flatnonzero(SLOTTED.sweeps == 0.0)[0])
    sweeps = SLOTTED.sweeps.copy()
    sweeps[straight] = 4.0 * math.atan(bulge)
    sagitta = 0.5 * bulge * SLOTTED.lengths[straight]
    found = distance_between(SLOTTED, Contour.through(SLOTTED.vertices, sweeps))
    assert found == pytest.approx(sagitta, rel=2e-9, abs=NOTHING)


def test_a_bore_without_its_keyway_is_off_by_its_corners() -> None:
    """All of the circle lies on the exact bore: only the missing slot shows the fault."""
    corner = float(np.max(np.abs(SLOTTED.vertices))) - RADIUS
    for plain in (PLAIN, PLAIN.split(1.0), PLAIN.split(0.3).reversed()):
        assert distance_between(SLOTTED, plain) == pytest.approx(corner, rel=1e-8)
    for plain in (PLAIN, chords_of(PLAIN, 0.001).contour):
        assert _caught(SLOTTED, plain) > 2.0
        assert _caught(plain, SLOTTED) > 2.0


def test_circles_cut_elsewhere_agree() -> None:
    for start in np.linspace(0.0, 2.0 * np.pi, 17):
        place = RADIUS * np.exp(1j * start)
        halves = Contour(np.array([place, -place]), np.full(2, np.pi), np.zeros(2, np.complex128))
        whole = Contour(np.array([place]), np.array([2.0 * np.pi]), np.zeros(1, np.complex128))
        assert distance_between(PLAIN, halves) < NOTHING
        assert distance_between(PLAIN, whole) < NOTHING
        assert distance_between(whole, halves) < NOTHING


def test_twice_round_is_refused() -> None:
    twice = Contour(np.tile(PLAIN.vertices, 2), np.tile(PLAIN.sweeps, 2), np.tile(PLAIN.centres, 2))
    with pytest.raises(GeometryError, match="once round"):
        distance_between(PLAIN, twice)


@few
@given(outlines, st.floats(-6.0, 0.0))
def test_fewest_chords_keep_their_tolerance(exact: Contour, size: float) -> None:
    tolerance = 10.0**size
    fit = fewest_chords_of(exact, tolerance)
    chords = fit.contour
    assert chords.arc_count == 0
    found = _measured(exact, chords)
    assert found <= fit.deviation <= found * (1.0 + 1e-9) + 2.0 * NOTHING
    assert found <= tolerance * (1.0 + 1e-9) + 1e-14
    # At the vertices, which are among the samples, the distance is as large as inside the chords.
    assert distance_between(exact, chords) <= found * (1.0 + 1e-9) + 2.0 * NOTHING
    assert distance_between(exact, chords.reversed()) >= found - 1e-14
    assert len(chords) <= len(chords_of(exact, tolerance).contour)
    if exact is SLOTTED:
        assert all(np.any(chords.vertices == corner) for corner in exact.vertices)


@some
@given(outlines, st.floats(-6.0, 0.5), st.floats(0.3, 1.0))
def test_counts_never_grow_with_the_tolerance(exact: Contour, size: float, share: float) -> None:
    tolerance = 10.0**size
    tighter = fewest_chords_of(exact, share * tolerance).contour
    assert len(fewest_chords_of(exact, tolerance).contour) <= len(tighter)


def test_fewest_chords_of_a_circle() -> None:
    # (r - u)/(r + u) = cos(pi/n) with u = 0.001, r = 8: pi/n = 0.0223581, n = 140.5.
    chords = fewest_chords_of(PLAIN, 0.001).contour
    assert len(chords) == 141
    radius = float(np.abs(chords.vertices[0]))
    assert np.abs(chords.vertices) == pytest.approx(radius, rel=1e-15)
    # Halfway along a chord it is as far inside as the vertices are outside.
    inner = np.abs(0.5 * (chords.vertices + chords.ends))
    assert RADIUS - inner == pytest.approx(radius - RADIUS, rel=1e-9)
    one = fewest_chords_of(
        Contour(np.array([8.0 + 0j]), np.array([-2.0 * np.pi]), np.zeros(1, np.complex128)), 1.0
    ).contour
    assert one.area < 0.0
    assert len(one) == len(fewest_chords_of(PLAIN, 1.0).contour)


@pytest.mark.parametrize("exact", [PLAIN, SLOTTED])
def test_too_many_of_the_fewest_are_refused(exact: Contour) -> None:
    with pytest.raises(ToleranceError, match="straight pieces would be needed"):
        fewest_chords_of(exact, 1e-13)
