"""A contour's own measures, compared with figures computed by hand and with dense polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour, winding_number
from camgeo.geometry.contour.spline import Arc, SplineContour
from camgeo.numeric.arrays import ComplexArray
from tests.contour.cams import outline, polyline
from tests.measuring import polygon


@st.composite
def stars(draw: st.DrawFn) -> Contour:
    """Counter-clockwise about 0: vertices in order of angle, lines and shallow arcs between."""
    count = draw(st.integers(3, 12))
    radii = np.array([draw(st.floats(5.0, 20.0)) for _ in range(count)])
    sweeps = np.array([draw(st.sampled_from([0.0, 0.4, -0.4, 1.0])) for _ in range(count)])
    vertices = radii * np.exp(2j * np.pi * np.arange(count) / count)
    ends = np.roll(vertices, -1)
    turned = np.where(sweeps == 0.0, 1.0, np.exp(1j * sweeps))
    safe = np.where(sweeps == 0.0, 2.0, turned)
    centres = np.where(sweeps == 0.0, 0.0, (ends - vertices * turned) / (1.0 - safe))
    return Contour(vertices, sweeps, centres)


def test_stadium() -> None:
    vertices = np.array([2 - 1j, 2 + 1j, -2 + 1j, -2 - 1j])
    contour = Contour(vertices, np.array([np.pi, 0, np.pi, 0]), np.array([2, 0, -2, 0]))
    assert len(contour) == 4
    assert contour.arc_count == 2
    assert contour.area == pytest.approx(8.0 + np.pi, rel=1e-15)
    assert contour.length == pytest.approx(8.0 + 2.0 * np.pi, rel=1e-15)
    assert contour.radii.tolist() == [1.0, 0.0, 1.0, 0.0]
    assert np.array_equal(contour.ends, np.roll(vertices, -1))


@pytest.mark.parametrize("sign", [1, -1])
def test_full_circle_as_one_piece(sign: int) -> None:
    contour = Contour(np.array([7.0 + 0j]), np.array([sign * 2.0 * np.pi]), np.array([3.0 + 0j]))
    assert contour.area == pytest.approx(sign * 16.0 * np.pi, rel=1e-15)
    assert contour.length == pytest.approx(8.0 * np.pi, rel=1e-15)
    assert winding_number(contour, 3.0 + 0j) == sign
    halves = contour.split(np.pi)
    assert halves.vertices == pytest.approx([7.0, -1.0])
    assert halves.area == pytest.approx(contour.area, rel=1e-15)


def test_arrays_cannot_be_changed() -> None:
    vertices = np.array([0, 1, 1j], dtype=np.complex128)
    contour = polyline(vertices)
    vertices[0] = 5.0
    assert contour.vertices[0] == 0
    assert not contour.vertices.flags.writeable


@settings(max_examples=40, deadline=None)
@given(stars())
def test_area_length_and_points_agree_with_dense_polygons(contour: Contour) -> None:
    shape = polygon(outline(contour).dense(60_000))
    # 5,000 chords an arc of at most 24 mm: relative error (1/5000)^2/24 a piece.
    assert contour.area == pytest.approx(shape.area, rel=1e-8)
    assert contour.length == pytest.approx(shape.length, rel=1e-8)
    sagitta = 0.01
    points = contour.points(sagitta)
    assert np.max(outline(contour).distances(points)) < 1e-12
    chords = outline(polyline(points))
    assert np.max(chords.distances(outline(contour).dense(2_000))) <= sagitta * (1.0 + 1e-9)


@settings(max_examples=40, deadline=None)
@given(stars(), st.floats(0.05, 3.0))
def test_reversed_and_split_are_the_same_outline(contour: Contour, largest: float) -> None:
    back = contour.reversed()
    assert back.area == pytest.approx(-contour.area, rel=1e-14)
    assert back.length == pytest.approx(contour.length, rel=1e-14)
    assert np.array_equal(back.reversed().vertices, contour.vertices)
    assert np.array_equal(back.reversed().sweeps, contour.sweeps)
    assert back.counter_clockwise().area > 0.0
    # An arc's end is turned from its start about a centre at most 50 mm off: some 10 ulp of that.
    arcs = back.sweeps != 0.0
    turned = back.centres + (back.vertices - back.centres) * np.exp(1j * back.sweeps)
    assert np.max(np.abs(turned - back.ends)[arcs], initial=0.0) < 1e-13
    parts = contour.split(largest)
    assert np.max(np.abs(parts.sweeps)) <= largest * (1.0 + 1e-9)
    assert parts.area == pytest.approx(contour.area, rel=1e-13)
    assert np.isin(contour.vertices, parts.vertices).all()


@settings(max_examples=40, deadline=None)
@given(stars(), st.floats(0.0, 3.0), st.floats(0.0, 6.3))
def test_winding_number(contour: Contour, share: float, angle: float) -> None:
    point = 10.0 * share * complex(np.cos(angle), np.sin(angle))
    ring = outline(contour).dense(20_000)
    if np.min(np.abs(ring - point)) < 0.01:
        return  # too near to decide
    turns = round(float(np.sum(np.angle((np.roll(ring, -1) - point) / (ring - point)))) / 6.2832)
    assert winding_number(contour, point) == turns
    assert winding_number(contour.reversed(), point) == -turns


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_the_area_beside_flat_arcs(bulge: float) -> None:
    """Each arc adds two thirds of chord times sagitta, however large its circle is."""
    square: ComplexArray = np.array([5.0, 5j, -5.0, -5j], dtype=np.complex128)
    flat = Contour.through(square, np.full(4, 4.0 * math.atan(bulge)))
    beside = 4.0 * 50.0 * bulge / 3.0
    assert flat.area - 50.0 == pytest.approx(beside, rel=1e-6, abs=1e-13)
    arcs = zip(flat.vertices, flat.ends, flat.sweeps, flat.centres, strict=True)
    spline = SplineContour(tuple(Arc(*(each.item() for each in arc)) for arc in arcs))
    assert spline.area == pytest.approx(flat.area, rel=1e-15)
