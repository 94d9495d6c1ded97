"""Cutter paths of trimmed outlines: round their corners on arcs, never nearer than the tool."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.milling.cut import ContourCut
from camgeo.milling.holding import Holding
from camgeo.milling.machine import load
from camgeo.milling.milling import MillingSpec, Stock
from camgeo.milling.moves import ArcFeed, Heights, Operation, Rapid, Toolpath
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.planned import sequence_of
from camgeo.milling.tool import Tool
from camgeo.part.assembly import build_part
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Layer, Part
from camgeo.part.spec import PartSpec
from tests.contour.cams import dense, dwell, move, translating
from tests.contour.paths import SAGITTA, cut_off_lobe, dense_path, shocks, swallow_tail
from tests.measuring import DensePath, Outline

TOLERANCE = 0.001

PART = PartSpec(thickness=10.0)

GROOVE = PartSpec(thickness=10.0, rim=200.0, groove_depth=6.0)


def _toolpath(
    contact: Contact, inner: Path, outer: Path, tool: float, part: PartSpec = PART
) -> Toolpath:
    limits = load("linuxcnc").arcs
    return plan_toolpath(
        _cuts_of(contact, inner, outer, tool, part), Heights.of(5.0), limits, TOLERANCE
    )


def _cuts_of(
    contact: Contact, inner: Path, outer: Path, tool: float, part: PartSpec = PART
) -> tuple[ContourCut, ...]:
    built = build_part(contact, inner, outer, part, 0.01)
    return _finishes(built, tool)


def _finishes(part: Part, diameter: float) -> tuple[ContourCut, ...]:
    """The planned cuts that make the walls themselves."""
    tool = Tool(
        number=1, diameter=diameter, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0,
        stepdown=50.0,
    )  # fmt: skip
    holding = Holding(kind="fixture")
    milling = MillingSpec(tools=(tool,), stock=Stock(), holding=holding)
    cuts = sequence_of(part, milling, Heights.of(5.0)).cuts
    return tuple(
        replace(cut, springs=0) for cut in cuts if isinstance(cut, ContourCut) and not cut.allowance
    )


def _cuts(operation: Operation) -> Outline:
    """The cuts in the plane, of one pass, with the leads."""
    found: list[tuple[complex, complex, float, complex]] = []
    for before, after in pairwise(operation.travel):
        if isinstance(after, Rapid) or before.end[2] != after.end[2]:
            continue
        at, end = complex(*before.end[:2]), complex(*after.end[:2])
        sweep, centre = 0.0, 0j
        if isinstance(after, ArcFeed):
            centre = complex(*after.centre)
            turned = float(np.angle((end - centre) / (at - centre)))
            sweep = turned % (2.0 * math.pi) if after.ccw else -((-turned) % (2.0 * math.pi))
        found.append((at, end, sweep, centre))
    starts, ends, sweeps, centres = zip(*found, strict=True)
    return Outline(np.array(starts), np.array(ends), np.array(sweeps), np.array(centres))


def _loop(cuts: Outline) -> Outline:
    """Without the leads."""
    return Outline(cuts.starts[1:-1], cuts.ends[1:-1], cuts.sweeps[1:-1], cuts.centres[1:-1])


DISCS = {"swallow tail": swallow_tail, "cut-off lobe": cut_off_lobe}


@pytest.mark.parametrize("tool", [1.0, 6.0, 25.0])
@pytest.mark.parametrize("name", DISCS)
def test_disc_is_cut_at_the_tool_radius(name: str, tool: float) -> None:
    path = DISCS[name]()
    (operation,) = _toolpath(Contact.INNER, path, path, tool).operations
    cuts = _cuts(operation)
    flank = dense_path(path)
    # Leads and all never nearer; the round itself never farther, from either side.
    assert np.min(DensePath(flank).distances(cuts.dense(8_000))) >= (
        tool / 2.0 - TOLERANCE - SAGITTA
    )
    loop = _loop(cuts)
    there = DensePath(flank).distances(loop.dense(8_000))
    back = loop.distances(flank[::20])
    for distances in (there, back):
        assert np.max(np.abs(distances - tool / 2.0)) <= TOLERANCE + SAGITTA
    assert loop.area < 0.0


@pytest.mark.parametrize("tool", [1.0, 6.0, 25.0])
@pytest.mark.parametrize("name", DISCS)
def test_corner_is_rolled_round_on_one_arc(name: str, tool: float) -> None:
    path = DISCS[name]()
    (corner,) = path.pivots
    (operation,) = _toolpath(Contact.INNER, path, path, tool).operations
    cuts = _cuts(operation)
    about = np.flatnonzero(cuts.centres == corner.centre)
    assert np.sum(cuts.sweeps[about]) == pytest.approx(-abs(corner.sweep), rel=1e-12)
    radii = np.abs(cuts.starts[about] - corner.centre)
    assert radii == pytest.approx(np.full(len(about), tool / 2.0), rel=1e-12)
    # No corner is left: each piece leaves as the one before it arrives, where none is tiny.
    arm = np.where(cuts.sweeps != 0.0, 1j * np.sign(cuts.sweeps) * (cuts.starts - cuts.centres), 0)
    first = np.where(cuts.sweeps != 0.0, arm, cuts.ends - cuts.starts)
    last = first * np.exp(1j * cuts.sweeps)
    long = np.abs(cuts.ends - cuts.starts) > 1e-3
    turns = np.abs(np.angle(first[1:] * np.conj(last[:-1])))
    # Lines stand for arcs with a sagitta of up to 1e-10 mm: 4e-10 over a length of 1e-3 mm.
    assert np.max(turns[long[1:] & long[:-1]]) < 1e-6


@pytest.mark.parametrize(("flank", "contact"), [(-1, "inner"), (1, "outer")])
def test_shocks(flank: int, contact: Contact) -> None:
    """Tools up to the roller's size reach into the turn of the roller, larger ones do not."""
    path = shocks(flank, 1)
    part = PartSpec(thickness=10.0, rim=150.0)
    for tool in (4.0, 16.0):
        (operation,) = _toolpath(contact, path, path, tool, part).operations
        loop = _loop(_cuts(operation))
        distances = DensePath(dense_path(path)).distances(loop.dense(8_000))
        assert np.max(np.abs(distances - tool / 2.0)) <= TOLERANCE + SAGITTA
        assert (loop.area < 0.0) == (contact == "inner")
    with pytest.raises(GeometryError, match="too large for the outline: a concave part") as caught:
        _toolpath(contact, path, path, 16.1, part)
    assert caught.value.key == "tool"


def test_groove_takes_a_tool_like_the_roller_alone() -> None:
    """Where a flank is trimmed, the roller's way is wider than two rounds along the flanks."""
    inner = swallow_tail()
    curve = inner.stretches[0].curve
    roller = -curve.distance
    outer = whole(WorkingCurve(curve.pitch, roller))
    flanks = (
        CurveBoundary("inner flank", hole=False, path=inner),
        CurveBoundary("outer flank", hole=True, path=outer),
    )
    rim = ExactBoundary("rim", hole=False, exact=Contour.circle(100.0))
    part = Part((Layer(-10.0, -6.0, (rim,)), Layer(-6.0, 0.0, (rim, *flanks), "groove")))
    (cut,) = _finishes(part, 2.0 * roller)
    assert isinstance(cut.centre, CurveBoundary)
    assert cut.centre.path == whole(WorkingCurve(curve.pitch, 0.0))
    assert cut.strategy == "slot"
    with pytest.raises(GeometryError, match="only a cutter like the roller") as caught:
        _finishes(part, 1.5 * roller)
    assert caught.value.key == "tool"


def test_groove_with_shocks_has_the_corners_of_the_pitch_curve() -> None:
    inner, outer = shocks(-1, 1), shocks(1, 1)
    (operation,) = _toolpath(Contact.GROOVE, inner, outer, 16.0, GROOVE).operations
    cuts = _cuts(operation)
    pitch = inner.stretches[0].curve.pitch
    for place in pitch.point(np.radians([40.0, 180.0])):
        assert np.min(np.abs(cuts.starts - place)) == 0.0
    points = dense(WorkingCurve(pitch, 0.0))
    assert np.max(DensePath(points).distances(cuts.dense(4_000))) <= TOLERANCE + SAGITTA


def test_larger_cutters_still_cross_and_are_refused() -> None:
    """Beyond the roller's size the way round a lobe's foot may cross itself."""
    path = cut_off_lobe()
    _toolpath(Contact.INNER, path, path, 32.0)
    with pytest.raises(GeometryError, match="too large for the outline"):
        _toolpath(Contact.INNER, path, path, 40.0)


@pytest.mark.parametrize(
    ("contact", "tool", "distance"),
    [("inner", 6.0, -5.0), ("inner", 16.0, 0.0), ("inner", 20.0, 2.0), ("outer", 6.0, 5.0)],
)
def test_path_along_a_whole_flank_is_one_parallel(
    contact: Contact, tool: float, distance: float
) -> None:
    inner = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
    outer = WorkingCurve(inner.pitch, 8.0)
    part = PartSpec(thickness=10.0, rim=200.0)
    (cut,) = _cuts_of(contact, whole(inner), whole(outer), tool, part)
    assert isinstance(cut.centre, CurveBoundary)
    assert cut.centre.path == whole(WorkingCurve(inner.pitch, distance))
