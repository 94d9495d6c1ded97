"""STL and 3MF of each fixture scene: closed bodies, cut at mid height and measured."""

from __future__ import annotations

import zipfile
from itertools import pairwise
from xml.etree import ElementTree as ET

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
    """For the STL; the 3MF has the same, as the next test shows."""
    mesh = built.meshes[".stl"]
    worst = max(_worst(_section(mesh, height), built.section(height)) for height in _heights(built))
    assert worst <= built.tolerance + CHORDS
    for suffix in SUFFIXES:
        assert built.deviation(suffix) >= worst - CHORDS - _rounding(mesh)


def _rounding(mesh: trimesh.Trimesh) -> float:
    """Largest distance of the sections of an STL and a 3MF [mm]: both are rounded."""
    return 2.0 * SINGLE * float(np.max(np.abs(mesh.vertices))) + SECTION


def _apart(found: list[Outline], wanted: list[Outline]) -> float:
    """The largest distance of a corner of one from the other [mm]."""
    return max(
        float(np.max(one.distances(other.starts)))
        for pair in paired(found, wanted)
        for one, other in (pair, pair[::-1])
    )


def test_both_have_the_same_sections(built: Built) -> None:
    stl, threemf = built.meshes[".stl"], built.meshes[".3mf"]
    for height in _heights(built):
        found, wanted = _section(threemf, height), _section(stl, height)
        assert _apart(found, wanted) <= _rounding(stl)
        # The measure itself: it sees a section shifted by half the tolerance.
        shift = 0.5j * built.tolerance
        shifted = [Outline.through(one.starts + shift, one.sweeps) for one in found]
        assert _apart(shifted, wanted) > 0.4 * built.tolerance


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_each_corner_is_an_edge(built: Built, suffix: str) -> None:
    """From face to face there are vertices at the corner, to the rounding of single precision."""
    vertices = np.asarray(built.meshes[suffix].vertices)
    points = vertices[:, 0] + 1j * vertices[:, 1]
    for span in built.spans:
        for corner in span.exact.corners:
            near = vertices[np.abs(points - corner) <= SINGLE * abs(corner)]
            assert sorted(near[:, 2]) == pytest.approx([span.low, span.high], abs=built.tolerance)


def test_3mf_says_millimetres(built: Built) -> None:
    with zipfile.ZipFile(built.file(".3mf")) as package:
        root = ET.fromstring(package.read("3D/3dmodel.model"))
    assert root.get("unit") == "millimeter"
    core = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    (item,) = root.findall("m:resources/m:object", core)
    assert item.get("name") == built.design.name
    titles = [m.text for m in root.findall("m:metadata", core) if m.get("name") == "Title"]
    assert titles == [built.design.name]
