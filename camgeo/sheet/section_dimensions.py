"""The dimensions of the section: heights above and below it, diameters beside it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import count, islice
from typing import Final

import numpy as np

from camgeo.sheet.bevels import NEAR, corners_of
from camgeo.sheet.dimensions import (
    EXACT,
    FARTHER,
    FINER,
    STEP,
    Bench,
    Turned,
    fit,
    in_section,
    with_datum,
)
from camgeo.sheet.front import SMALL_BEYOND
from camgeo.sheet.marks import DIAMETER, Chain, Distance, Mark, line
from camgeo.sheet.placing import Options, placed
from camgeo.sheet.shape import COARSE, Shape, crossings

PLACES: Final = 24
"""Distances from the section that are tried."""


def diameters(rounds: Sequence[Turned], thickness: float, bench: Bench) -> Iterator[Options]:
    """The diameters that the section shows, the smallest first, which stands nearest; the datum A
    is at that of the bore.
    """
    for each in rounds:
        if in_section(each):
            yield _diameter(each, thickness, bench)


def hole_centres(shape: Shape, scale: float) -> Iterator[Mark]:
    """Centre lines of the holes off the cam axis whose middles are in the plane."""
    base, far = shape.part.layers[0].z0, SMALL_BEYOND / scale
    for wall in shape.part.walls:
        circle = shape.edge(wall.boundary).circle
        if circle is not None and abs(circle[0].real) <= 1e-9 * shape.size < abs(circle[0]):
            level = 1j * circle[0].imag
            yield line(wall.z0 - base - far + level, wall.z1 - base + far + level, "CENTRE")


def _diameter(each: Turned, thickness: float, bench: Bench) -> Options:
    height = 1j * each.radius
    for price, place in _places(thickness, bench):
        mark = Distance(each.z1 - height, each.z1 + height, complex(place), 0.5 * math.pi,
                        DIAMETER, fit(each, bench.spec), EXACT[bench.unit])  # fmt: skip
        for more, marks in placed(mark, bench.scale, bench.unit, 1j):
            if each.is_bore and bench.spec.flank_tolerance is not None:
                yield from with_datum((price + more, marks), "A", bench.scale)
            else:
                yield price + more, marks


def _places(start: float, bench: Bench) -> Iterator[tuple[float, float]]:
    """Distances beyond an edge of the section [mm of the part], and what they cost."""
    steps = islice(count(STEP, FINER), PLACES)
    return ((FARTHER * (each - STEP), start + each / bench.scale) for each in steps)


def heights(
    shape: Shape, drawn: Sequence[Mark], box: tuple[complex, complex], bench: Bench
) -> Iterator[Options]:
    """The thickness below the section `drawn` with sharp edges, and above it the heights of its
    walls, the smallest first; that of the whole part is not among them, nor those of letters, of
    which notes speak. Their points are on the faces, beside chamfers.
    """
    layers, thickness = shape.part.layers, shape.part.thickness
    corners = corners_of(shape)

    def on_faces(ends: tuple[complex, complex]) -> tuple[complex, complex]:
        one, other = (
            next((each.on_face for each in corners if each.has(end, NEAR * shape.size)), end)
            for end in ends
        )
        return one, other

    base = layers[0].z0
    ends = (complex(0.0, _lowest(drawn, 0.0, layers[0].z1 - base)),
            complex(thickness, _lowest(drawn, layers[-1].z0 - base, thickness)))  # fmt: skip
    yield _height(on_faces(ends), -1j, -box[0].imag, bench)
    tops: dict[tuple[float, float], float] = {}
    for wall in shape.part.walls:
        edge = shape.edge(wall.boundary)
        if edge.is_letter:
            continue
        ring = edge.contour.points(COARSE * shape.size)
        cut = crossings(1j * ring.conj(), 0.0)
        span = wall.z0 - base, wall.z1 - base
        if len(cut) and span != (0.0, thickness):
            tops[span] = max(float(np.max(cut)), tops.get(span, -math.inf))
    for span in sorted(tops, key=lambda each: (each[1] - each[0], each[0])):
        ends = complex(span[0], tops[span]), complex(span[1], tops[span])
        yield _height(on_faces(ends), 1j, box[1].imag, bench)


def _height(ends: tuple[complex, complex], way: complex, edge: float, bench: Bench) -> Options:
    for price, place in _places(edge, bench):
        mark = Distance(*ends, way * place, decimals=EXACT[bench.unit])
        for more, marks in placed(mark, bench.scale, bench.unit, -1.0):
            yield price + more, marks


def _lowest(drawn: Sequence[Mark], z0: float, z1: float) -> float:
    """Lowest y [mm] of the edges of a section along the layer from `z0` to `z1`."""
    found = []
    for mark in drawn:
        if isinstance(mark, Chain) and mark.vertices[0].imag == mark.vertices[1].imag:
            start, end = sorted(mark.vertices.real.tolist())
            if start <= z0 and end >= z1:
                found.append(float(mark.vertices[0].imag))
    return min(found, default=0.0)
