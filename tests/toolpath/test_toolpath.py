"""Cutter paths along whole and trimmed flanks: at the tool's radius from them, with tangential
leads, and round their corners on arcs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.milling import plan
from camgeo.milling.cut import ContourCut, PointCut
from camgeo.milling.machine import load
from camgeo.milling.milling import Heights, Holding, MillingSpec, Stock
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Stop
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.planned import plan_sequence
from camgeo.milling.strategies import STRATEGIES
from camgeo.milling.walk import ToolpathBuilder
from camgeo.part.assembly import build_part
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Layer, Part
from camgeo.part.spec import PartSpec
from tests.contour.cams import dense
from tests.contour.paths import cut_off_lobe, dense_path, shocks, swallow_tail
from tests.measuring import DensePath, Outline
from tests.part.parts import refused
from tests.toolpath.cutting import steps_of
from tests.toolpath.milled import PITCH, ROLLER, tool

TOLERANCE = 0.001

SAGITTA = 5e-6
"""Sagitta of the chords of the dense curves [mm]: h = 5e-3 mm, kappa < 1/mm."""

LIMITS = load("linuxcnc").arcs

HEIGHTS = Heights(7.0, 7.0)

FLANKS = {
    "inner": whole(WorkingCurve(PITCH, -ROLLER)),
    "outer": whole(WorkingCurve(PITCH, ROLLER)),
}

BOTH = (FLANKS["inner"], FLANKS["outer"])

DISC = PartSpec(thickness=10.0, rim=200.0)

GROOVE = PartSpec(thickness=10.0, rim=200.0, groove_depth=6.0)


def finishes(part: Part, diameter: float) -> tuple[ContourCut, ...]:
    """The planned cuts that make the walls themselves, in one round."""
    milling = MillingSpec(
        tools=(tool(diameter, stepdown=50.0),), stock=Stock(), holding=Holding(kind="fixture")
    )
    cuts = plan_sequence(part, milling, HEIGHTS).cuts
    return tuple(
        replace(cut, springs=0) for cut in cuts if isinstance(cut, ContourCut) and not cut.allowance
    )


def planned(
    contact: str, inner: Path, outer: Path, diameter: float, spec: PartSpec = DISC
) -> dict[str, Operation]:
    cuts = finishes(build_part(Contact(contact), inner, outer, spec, 0.01), diameter)
    found = plan_toolpath(cuts, HEIGHTS, LIMITS, TOLERANCE).operations
    return {operation.name: operation for operation in found}


def outline_of(operation: Operation) -> Outline:
    """Its cuts in the plane, with the leads."""
    steps = [step for step in steps_of(operation.moves) if step.high == step.low]
    return Outline(*(np.array([getattr(step, key) for step in steps])
                     for key in ("start", "end", "sweep", "centre")))  # fmt: skip


def without_leads(path: Outline) -> Outline:
    return Outline(path.starts[1:-1], path.ends[1:-1], path.sweeps[1:-1], path.centres[1:-1])


WALLS: dict[str, tuple[str, Path, tuple[float, ...]]] = {
    "inner": ("inner", FLANKS["inner"], (2.0, 6.0, 11.0)),
    "outer": ("outer", FLANKS["outer"], (2.0, 6.0, 11.0)),
    "swallow tail": ("inner", swallow_tail(), (1.0, 6.0, 25.0)),
    "cut-off lobe": ("inner", cut_off_lobe(), (1.0, 6.0, 25.0)),
    # Tools up to the roller's size reach into the turn of the roller.
    "shocks": ("inner", shocks(-1, 1), (4.0, 16.0)),
    "shocks of a hole": ("outer", shocks(1, 1), (4.0, 16.0)),
}
"""Contact and path of walls, and the cutters that run along it."""


@cache
def dense_wall(name: str) -> tuple[np.ndarray[Any, Any], DensePath]:
    points = dense_path(WALLS[name][1])
    return points, DensePath(points)


@pytest.mark.parametrize(
    ("name", "diameter"), [(name, each) for name, (*_, sizes) in WALLS.items() for each in sizes]
)
def test_a_path_is_the_tool_radius_from_its_wall(name: str, diameter: float) -> None:
    contact, wall, _ = WALLS[name]
    path = outline_of(planned(contact, wall, wall, diameter)["outline"])
    points, flank = dense_wall(name)
    radius = 0.5 * diameter
    # Leads and all never nearer; the round itself never farther, from either side.
    assert np.min(flank.distances(path.dense(5_000))) >= radius - TOLERANCE - SAGITTA
    loop = without_leads(path)
    for apart in (flank.distances(loop.dense(5_000)), loop.distances(points[::20])):
        assert np.max(np.abs(apart - radius)) <= TOLERANCE + SAGITTA
    assert abs(loop.starts[0] - loop.ends[-1]) == 0.0
    # Climbing, clockwise spindle: the material on the right of the cutter's way.
    assert (loop.area < 0.0) == (contact == "inner")
    # No corner is left, but those of the pitch curve: each piece leaves as the one before it
    # arrives, where none is tiny.
    arm = 1j * np.sign(path.sweeps) * (path.starts - path.centres)
    first = np.where(path.sweeps != 0.0, arm, path.ends - path.starts)
    last = first * np.exp(1j * path.sweeps)
    long = np.abs(path.ends - path.starts) > 1e-3
    turns = np.abs(np.angle(first[1:] * np.conj(last[:-1])))
    # Lines stand for arcs with a sagitta of up to 1e-10 mm: 4e-10 over a length of 1e-3 mm.
    if not (name.startswith("shocks") and diameter == 2.0 * ROLLER):
        assert np.max(turns[long[1:] & long[:-1]]) < 1e-6
    # Rounding of a point, 1e-14 mm, over the smaller radius, 0.1 mm at least.
    assert max(turns[0], turns[-1]) < 1e-11
    # No more than a quarter turn; less in a slot that is only wider by an allowance.
    for sweep in (path.sweeps[0], path.sweeps[-1]):
        assert 0.2 < abs(sweep) <= math.pi / 2.0 * (1.0 + 1e-12)
    for corner in wall.pivots if len(wall.pivots) == 1 else ():  # rolled round on one arc
        about = np.flatnonzero(path.centres == corner.centre)
        assert np.sum(path.sweeps[about]) == pytest.approx(-abs(corner.sweep), rel=1e-12)
        assert np.abs(path.starts[about] - corner.centre) == pytest.approx(radius, rel=1e-12)


@pytest.mark.parametrize("diameter", [8.0, 10.0, 15.9])
def test_groove_in_two_rounds(diameter: float) -> None:
    operations = planned("groove", *BOTH, diameter, GROOVE)
    cleared = []
    for side in FLANKS:
        path = outline_of(operations[f"{side} flank"])
        for other in FLANKS:  # leads too stay off both flanks
            apart = dense_wall(other)[1].distances(path.dense(4_000))
            assert np.min(apart) >= diameter / 2.0 - TOLERANCE - SAGITTA
        loop = without_leads(path)
        apart = dense_wall(side)[1].distances(loop.dense(4_000))
        assert np.max(np.abs(apart - diameter / 2.0)) <= TOLERANCE + SAGITTA
        assert (loop.area < 0.0) == (side == "inner")
        cleared.append(loop)
    # No wall is left between the two rounds: half way along the pitch curve the nearer is in reach.
    middle = PITCH.point(np.linspace(0.0, 2.0 * math.pi, 1000))
    reach = np.minimum(*(loop.distances(middle) for loop in cleared))
    assert np.max(reach) <= diameter / 2.0 + TOLERANCE


@pytest.mark.parametrize(
    ("inner", "outer"), [BOTH, (shocks(-1, 1), shocks(1, 1))], ids=["", "shocks"]
)
def test_groove_with_a_tool_like_the_roller(inner: Path, outer: Path) -> None:
    """Along the pitch curve, with its corners, and the outer flank on the right."""
    operation = planned("groove", inner, outer, 2.0 * ROLLER, GROOVE)["groove"]
    path, pitch = outline_of(operation), inner.stretches[0].curve.pitch
    points = dense(WorkingCurve(pitch, 0.0))
    assert np.max(DensePath(points).distances(path.dense(4_000))) <= TOLERANCE + SAGITTA
    assert abs(path.starts[0] - path.ends[-1]) == 0.0
    assert path.area > 0.0
    # It plunges on the path itself from pass to pass and goes up once, at the end.
    assert sum(isinstance(move, Rapid) for move in operation.travel) == 2
    for place in pitch.point(np.radians([40.0, 180.0])) if inner is not FLANKS["inner"] else ():
        assert np.min(np.abs(path.starts - place)) == 0.0


def test_groove_with_side_clearance() -> None:
    """The groove counts, 16 mm wide, and not the roller in it, 15.7 mm."""
    played = replace(PITCH, follower=TranslatingRoller(40.0, ROLLER - 0.15, 6.0))
    flanks = whole(WorkingCurve(played, -ROLLER)), whole(WorkingCurve(played, ROLLER))
    assert "groove" in planned("groove", *flanks, 2.0 * ROLLER, GROOVE)
    assert "groove" not in planned("groove", *flanks, 15.7, GROOVE)
    with pytest.raises(GeometryError, match=r"larger than the groove.* from 8 to 16 mm"):
        planned("groove", *flanks, 16.001, GROOVE)


def test_a_trimmed_groove_takes_a_tool_like_the_roller_alone() -> None:
    """Where a flank is trimmed, the roller's way is wider than two rounds along the flanks."""
    inner = swallow_tail()
    curve = inner.stretches[0].curve
    roller = -curve.distance
    flanks = (
        CurveBoundary("inner flank", hole=False, path=inner),
        CurveBoundary("outer flank", hole=True, path=whole(WorkingCurve(curve.pitch, roller))),
    )
    rim = ExactBoundary("rim", hole=False, exact=Contour.circle(100.0))
    part = Part((Layer(-10.0, -6.0, (rim,)), Layer(-6.0, 0.0, (rim, *flanks), "groove")))
    (cut,) = finishes(part, 2.0 * roller)
    assert isinstance(cut.centre, CurveBoundary)
    assert cut.centre.path == whole(WorkingCurve(curve.pitch, 0.0))
    assert cut.strategy == "slot"
    with refused("tool", "only a cutter like the roller"):
        finishes(part, 1.5 * roller)


@pytest.mark.parametrize(
    ("name", "fits", "too_large", "message", "key"),
    [
        ("shocks", 16.0, 16.1, "a concave part", "tool"),
        ("shocks of a hole", 16.0, 16.1, "a concave part", "tool"),
        # Beyond the roller's size the way round a lobe's foot may cross itself.
        ("cut-off lobe", 32.0, 40.0, "", "tool.diameter"),
    ],
)
def test_larger_cutters_cross_and_are_refused(
    name: str, fits: float, too_large: float, message: str, key: str
) -> None:
    contact, wall, _ = WALLS[name]
    planned(contact, wall, wall, fits)
    match = f"too large for the outline: {message}"
    with refused(key, match):
        planned(contact, wall, wall, too_large)


@pytest.mark.parametrize(
    ("contact", "diameter", "distance"),
    [("inner", 6.0, -5.0), ("inner", 16.0, 0.0), ("inner", 20.0, 2.0), ("outer", 6.0, 5.0)],
)
def test_path_along_a_whole_flank_is_one_parallel(
    contact: str, diameter: float, distance: float
) -> None:
    cut = planned(contact, *BOTH, diameter)["outline"].cut
    assert isinstance(cut, ContourCut)
    assert isinstance(cut.centre, CurveBoundary)
    assert cut.centre.path == whole(WorkingCurve(PITCH, distance))


def test_arcs_are_divided_as_the_machine_wants() -> None:
    limits = replace(LIMITS, largest_sweep=10.0)
    cuts = finishes(build_part(Contact.INNER, *BOTH, DISC, 0.01), 6.0)
    found = [plan_toolpath(cuts, HEIGHTS, each, TOLERANCE).operations for each in (LIMITS, limits)]
    for whole_arcs, parts in zip(*found, strict=True):
        one, other = outline_of(whole_arcs), outline_of(parts)
        assert np.max(np.abs(one.sweeps)) <= math.pi * (1.0 + 1e-12)
        assert np.max(np.abs(other.sweeps)) <= math.radians(10.0) * (1.0 + 1e-9)
        assert np.sum(np.abs(other.sweeps)) == pytest.approx(np.sum(np.abs(one.sweeps)), rel=1e-12)


def test_a_new_strategy_is_a_function_and_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plan asks the registry alone; nothing else has to know of it."""

    def drill(walk: ToolpathBuilder, tolerance: float, effort: Effort) -> None:
        walk.traverse(0j)
        walk.lower(walk.cut.bottom)

    monkeypatch.setitem(STRATEGIES, "drill", drill)
    cut = PointCut(
        name="hole", strategy="drill", tool=tool(6.0), top=0.0, depths=(-8.0,), points=(0j,)
    )
    (operation,) = plan_toolpath((cut,), HEIGHTS, LIMITS, TOLERANCE).operations
    assert operation.travel[1] == Feed((0.0, 0.0, -8.0), 100.0)


def test_a_divided_helix_keeps_its_pitch_and_halts_stay() -> None:
    helix = ArcFeed((-3.0, 0.0, -1.0), (0.0, 0.0), True, 100.0)
    halt = Stop("turn it over")
    parts = list(plan.divide_arcs((Rapid((3.0, 0.0, 1.0)), halt, helix), math.pi / 4.0))
    assert parts[:2] == [Rapid((3.0, 0.0, 1.0)), halt]
    assert len(parts) == 2 + 4
    for count, part in enumerate(parts[2:], start=1):
        assert isinstance(part, ArcFeed)
        end = 3.0 * np.exp(0.25j * math.pi * count)
        assert part.end == pytest.approx((end.real, end.imag, 1.0 - 0.5 * count), abs=1e-14)
        assert (part.centre, part.ccw, part.feed) == (helix.centre, True, 100.0)
