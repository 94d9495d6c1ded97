"""STL and 3MF of each fixture scene: closed bodies, cut at mid height and measured."""

from __future__ import annotations

import zipfile
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import trimesh

from tests.end_to_end.built import CHORDS, Built, Exact
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
    wanted = sorted(wanted, key=lambda exact: -exact.area)
    assert len(found) == len(wanted)
    worst = 0.0
    for outline, exact in zip(found, wanted, strict=True):
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
    slack = built.tolerance * built.length * built.thickness
    assert mesh.volume == pytest.approx(built.volume, abs=slack)
    assert mesh.bounds[:, 2] == pytest.approx([0.0, built.thickness], abs=built.tolerance)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_sections_lie_on_the_curves(built: Built, suffix: str) -> None:
    mesh = built.meshes[suffix]
    depth = built.spec.groove_depth or 0.0
    worst = _worst(_section(mesh, 0.5 * (built.thickness - depth)), built.through)
    if built.groove:
        above = _section(mesh, built.thickness - 0.5 * depth)
        worst = max(worst, _worst(above, built.through + built.groove))
    assert worst <= built.tolerance + CHORDS
    assert built.deviation(suffix) >= worst - CHORDS - SECTION


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_each_corner_is_an_edge(built: Built, suffix: str) -> None:
    """From face to face there are vertices at the corner, to the rounding of single precision."""
    vertices = np.asarray(built.meshes[suffix].vertices)
    points = vertices[:, 0] + 1j * vertices[:, 1]
    for exact in built.through:
        for corner in exact.corners:
            near = vertices[np.abs(points - corner) <= SINGLE * abs(corner)]
            assert sorted(near[:, 2]) == pytest.approx([0.0, built.thickness], abs=built.tolerance)


def test_3mf_says_millimetres(built: Built) -> None:
    with zipfile.ZipFile(built.file(".3mf")) as package:
        root = ET.fromstring(package.read("3D/3dmodel.model"))
    assert root.get("unit") == "millimeter"
    core = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    (item,) = root.findall("m:resources/m:object", core)
    assert item.get("name") == built.design.name
    titles = [m.text for m in root.findall("m:metadata", core) if m.get("name") == "Title"]
    assert titles == [built.design.name]
