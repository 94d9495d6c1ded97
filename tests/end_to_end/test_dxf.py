"""The drawing of each fixture scene, read by ezdxf and measured against the exact curves."""

from __future__ import annotations

import numpy as np
import pytest
from ezdxf.entities.lwpolyline import LWPolyline

from camgeo.units import MM_PER
from tests.end_to_end.built import CHORDS, Built, paired
from tests.end_to_end.features import DENSE, Exact
from tests.measuring import DensePath, Outline

POINTS = 10_000

SHARP = 0.05
"""A vertex at which the tangent turns by more [rad] is a corner: those of the scenes turn by more
than 0.1, joints between pieces of a fit by the square root of 8 tolerance kappa at most."""

ROUNDING = 1e-9
"""Rounding of coordinates, bulges and of centres computed from them [mm]."""


def _outlines(built: Built, layer: str) -> list[Outline]:
    """Closed polylines of `layer` in mm, largest first."""
    scale = MM_PER[built.design.scene.unit]
    found = []
    for entity in built.drawing.modelspace().query(f'*[layer=="{layer}"]'):
        assert isinstance(entity, LWPolyline)
        assert entity.closed
        rows = np.array(entity.get_points("xyb"))
        outline = Outline.through(
            (rows[:, 0] + 1j * rows[:, 1]) * scale, 4.0 * np.arctan(rows[:, 2])
        )
        found.append(outline)
    return sorted(found, key=lambda outline: -abs(outline.area))


def _turns(outline: Outline) -> np.ndarray:
    """(n,) angle [rad] by which the tangent jumps at the start of each piece."""
    chords = np.angle(outline.ends - outline.starts)
    first, last = chords - 0.5 * outline.sweeps, chords + 0.5 * outline.sweeps
    return np.asarray(np.angle(np.exp(1j * (first - np.roll(last, 1)))))


def _layers(built: Built) -> dict[str, list[Exact]]:
    """The layers of the part, of what is cut through, sunk or raised, with what is on each."""
    scale = MM_PER[built.design.scene.unit]
    found: dict[str, list[Exact]] = {}
    for span in built.spans:
        found.setdefault(span.layer.format(span.away / scale), []).append(span.exact)
    return found


def _part(built: Built) -> list[tuple[Outline, Exact]]:
    """The polylines of the part with their exact outlines, layer by layer."""
    found = []
    for layer, wanted in _layers(built).items():
        found += paired(_outlines(built, layer), wanted)
    return found


def test_cut_layer(built: Built) -> None:
    worst = 0.0
    for outline, exact in _part(built):
        assert np.max(np.abs(outline.sweeps)) <= np.pi * (1.0 + 1e-12)
        there = np.max(outline.distances(exact.points[:: len(exact.points) // POINTS]))
        back = np.max(exact.path.distances(outline.dense(POINTS)))
        worst = max(worst, float(there), float(back))
        # An outline within the tolerance all along encloses the area to tolerance x length.
        slack = built.tolerance * exact.length
        assert abs(outline.area) == pytest.approx(exact.area, abs=slack)
    assert worst <= built.tolerance
    assert built.deviation(".dxf") >= worst - CHORDS - ROUNDING


def test_each_corner_is_a_vertex_once(built: Built) -> None:
    """The corner itself, to the rounding of coordinates; its two pieces turn as the flank does."""
    for outline, exact in _part(built):
        turns = _turns(outline)
        for corner in exact.corners:
            near = np.flatnonzero(np.abs(outline.starts - corner) < 2.0 * built.tolerance)
            assert len(near) == 1
            assert abs(outline.starts[near[0]] - corner) <= ROUNDING
        # Nowhere else is there a corner, but in the keyway.
        sharp = outline.starts[np.abs(turns) > SHARP]
        if exact.name != "bore":
            assert len(sharp) == len(exact.corners)


def test_pitch_curve_and_base_circle(built: Built) -> None:
    if built.design.cam.follower.rolls:
        (pitch,) = _outlines(built, "PITCH_CURVE")
        points = built.pitch.dense(DENSE)
        assert np.max(pitch.distances(points[::3])) <= built.tolerance
        assert np.max(DensePath(points).distances(pitch.dense(POINTS))) <= built.tolerance + CHORDS
    scale = MM_PER[built.design.scene.unit]
    (circle,) = built.drawing.modelspace().query("CIRCLE")
    assert circle.dxf.radius * scale == pytest.approx(
        built.design.cam.follower.base_radius, rel=1e-15
    )
