"""The drawing of each fixture scene, read by ezdxf and measured against the exact curves."""

from __future__ import annotations

import numpy as np
import pytest
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.filemanagement import readfile

from tests.end_to_end.built import CHORDS, DENSE, Built
from tests.end_to_end.exact import TURN
from tests.measuring import DensePath, Outline

UNITS = {"mm": (4, 1, 1.0), "inch": (1, 0, 25.4)}
"""$INSUNITS, $MEASUREMENT and millimetres of a unit."""

POINTS = 20_000

ROUNDING = 1e-9
"""Of coordinates, bulges and of centres that are found again from them [mm]."""


def _outlines(built: Built, layer: str) -> list[Outline]:
    """Closed polylines of `layer` in mm, largest first."""
    scale = UNITS[built.design.unit][2]
    found = []
    for entity in readfile(built.file(".dxf")).modelspace().query(f'*[layer=="{layer}"]'):
        assert isinstance(entity, LWPolyline)
        assert entity.closed
        rows = np.array(entity.get_points("xyb"))
        outline = Outline.through(
            (rows[:, 0] + 1j * rows[:, 1]) * scale, 4.0 * np.arctan(rows[:, 2])
        )
        found.append(outline)
    return sorted(found, key=lambda outline: -abs(outline.area))


def test_document(built: Built) -> None:
    document = readfile(built.file(".dxf"))
    assert not document.audit().errors
    insunits, measurement, _ = UNITS[built.design.unit]
    assert document.dxfversion == "AC1024"  # R2010
    assert document.header["$INSUNITS"] == insunits
    assert document.header["$MEASUREMENT"] == measurement
    kinds = {(entity.dxf.layer, entity.dxftype()) for entity in document.modelspace()}
    # Nothing else, and no text anywhere.
    assert kinds == {
        ("CUT", "LWPOLYLINE"),
        ("PITCH_CURVE", "LWPOLYLINE"),
        ("BASE_CIRCLE", "CIRCLE"),
        ("CENTRE", "LINE"),
    }


def test_cut_layer(built: Built) -> None:
    wanted = sorted(built.through + built.groove, key=lambda exact: -exact.area)
    found = _outlines(built, "CUT")
    assert len(found) == len(wanted)
    worst = 0.0
    for outline, exact in zip(found, wanted, strict=True):
        assert np.max(np.abs(outline.sweeps)) <= np.pi * (1.0 + 1e-12)
        there = np.max(outline.distances(exact.points[:: len(exact.points) // POINTS]))
        back = np.max(exact.path.distances(outline.dense(POINTS)))
        worst = max(worst, float(there), float(back))
        # An outline within the tolerance all along encloses the area to tolerance x length.
        slack = built.tolerance * exact.length
        assert abs(outline.area) == pytest.approx(exact.area, abs=slack)
    assert worst <= built.tolerance
    assert built.deviation(".dxf") >= worst - CHORDS - ROUNDING


def test_pitch_curve_and_base_circle(built: Built) -> None:
    (pitch,) = _outlines(built, "PITCH_CURVE")
    phi = np.linspace(0.0, TURN, DENSE, endpoint=False)
    columns = built.design.pitch(phi)
    points = columns[:, 0] + 1j * columns[:, 1]
    assert np.max(pitch.distances(points[::3])) <= built.tolerance
    assert np.max(DensePath(points).distances(pitch.dense(POINTS))) <= built.tolerance + CHORDS
    scale = UNITS[built.design.unit][2]
    (circle,) = readfile(built.file(".dxf")).modelspace().query("CIRCLE")
    assert circle.dxf.radius * scale == pytest.approx(built.design.base_radius, rel=1e-15)


def test_a_moved_vertex_would_show(built: Built) -> None:
    """The measure itself: a vertex moved by ten tolerances is found."""
    outline = _outlines(built, "CUT")[0]
    exact = max(built.through + built.groove, key=lambda exact: exact.area)
    starts = outline.starts.copy()
    starts[1] += 10.0 * built.tolerance * starts[1] / abs(starts[1])
    moved = Outline.through(starts, outline.sweeps)
    found = float(np.max(exact.path.distances(moved.dense(POINTS))))
    assert found > 5.0 * built.tolerance
