"""STL and 3MF of each fixture scene: closed bodies, cut at mid height and measured."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh

from tests.end_to_end.built import CHORDS, Built, paired
from tests.end_to_end.features import Exact
from tests.measuring import DensePath, Outline

POINTS = 20_000

SUFFIXES = (".stl", ".3mf")

SINGLE = 2.0**-23
"""Rounding of both coordinates in an STL, relative; a 3MF has seven digits and more."""

SECTION = 1e-7
"""trimesh merges points of a section that agree to 8 digits of it [mm]."""


def _section(mesh: trimesh.Trimesh, height: float) -> list[Outline]:
    """Closed polygons of the section at Z `height`, largest first."""
    section = mesh.section(plane_origin=(0.0, 0.0, height), plane_normal=(0.0, 0.0, 1.0))
    assert section is not None
    found = []
    for loop in section.discrete:
        assert np.array_equal(loop[0], loop[-1])
        points = loop[:-1, 0] + 1j * loop[:-1, 1]
        found.append(Outline.through(points, np.zeros(len(points))))
    return sorted(found, key=lambda outline: -abs(outline.area))


def _worst(found: list[Outline], wanted: list[Exact]) -> float:
    worst = 0.0
    for outline, exact in paired(found, wanted):
        there = DensePath(outline.starts).distances(exact.points[:: len(exact.points) // POINTS])
        back = exact.path.distances(outline.dense(POINTS))
        worst = max(worst, float(np.max(there)), float(np.max(back)))
    return worst


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_body_is_closed_and_has_its_volume(built: Built, suffix: str) -> None:
    mesh = built.meshes[suffix]
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    slack = built.tolerance * built.length * built.height
    assert mesh.volume == pytest.approx(built.volume, abs=slack)
    assert mesh.bounds[:, 2] == pytest.approx([0.0, built.height], abs=built.tolerance)


def _heights(built: Built) -> list[float]:
    """Heights at which a body is cut: between flat faces."""
    return [0.5 * (low + high) for low, high in pairwise(built.heights)]


def test_sections_lie_on_the_curves(built: Built) -> None:
    """For the STL; the 3MF has the same, see `tests/export/test_threemf.py`."""
    mesh = built.meshes[".stl"]
    rounding = 2.0 * SINGLE * float(np.max(np.abs(mesh.vertices))) + SECTION
    worst = max(_worst(_section(mesh, height), built.section(height)) for height in _heights(built))
    assert worst <= built.tolerance + CHORDS
    for suffix in SUFFIXES:
        assert built.deviation(suffix) >= worst - CHORDS - rounding


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_each_corner_is_an_edge(built: Built, suffix: str) -> None:
    """From face to face there are vertices at the corner, to the rounding of single precision."""
    vertices = np.asarray(built.meshes[suffix].vertices)
    points = vertices[:, 0] + 1j * vertices[:, 1]
    for span in built.spans:
        for corner in span.exact.corners:
            near = vertices[np.abs(points - corner) <= SINGLE * abs(corner)]
            assert sorted(near[:, 2]) == pytest.approx([span.low, span.high], abs=built.tolerance)
