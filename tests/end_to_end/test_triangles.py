"""Solids of the fixture scenes have hardly more triangles than any body within the tolerance.

A closed body of V vertices with g holes through it has 2V - 4 + 4g triangles, by Euler's formula,
however its faces are divided: two for each chord of a wall, and n - 2 + 2h for a flat face of n
corners with h holes. Where all vertices are ends of walls, V is twice the number of their chords,
and of chords there is a fewest.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo.studies.accuracy.contours import CHORD, least_chords
from tests.end_to_end.built import Built

MOST = 1.05
"""Triangles as a multiple of the limit."""

LEAST = 0.99
"""The count of chords is that for small tolerances: a circle within 0.01 mm has a little fewer."""

ROUND = 4
"""Chords of a circle at least."""


def _fewest(boundary: Boundary, tolerance: float) -> float:
    """Chords of a boundary; those of a flank are a real number."""
    if isinstance(boundary, CurveBoundary):
        return least_chords(boundary.path, tolerance)
    assert isinstance(boundary, ExactBoundary)
    return _of_arcs(boundary.exact, tolerance)


def _of_arcs(exact: Contour, tolerance: float) -> int:
    """Each line is a chord, each arc at least one; pieces of one circle count together."""
    turns = np.abs(exact.sweeps) * np.sqrt(exact.radii * CHORD / tolerance)
    if exact.arc_count == len(exact) and np.all(exact.centres == exact.centres[0]):
        return max(ROUND, math.ceil(float(np.sum(turns))))
    return int(np.sum(np.where(exact.sweeps == 0.0, 1, np.maximum(1, np.ceil(turns)))))


def _limit(built: Built) -> float:
    """Triangles of the fewest chords."""
    walls = built.design.disc.drawn.part.walls
    chords = sum(_fewest(wall.boundary, built.tolerance) for wall in walls)
    through = sum(span.hole and span.high - span.low == built.height for span in built.spans)
    return 4.0 * chords - 4.0 + 4.0 * through


@pytest.mark.parametrize("suffix", [".stl", ".3mf"])
def test_triangles_are_few(built: Built, suffix: str) -> None:
    (found,) = (
        record["triangles"]
        for record in built.certificate["files"]
        if record["file"] == built.file(suffix).name
    )
    limit = _limit(built)
    assert LEAST * limit <= found <= MOST * limit
