"""How the blank is held while it is cut: clamps that come and go, tabs, and what drops loose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import shapely

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.milling.bench import SAME, Bench
from camgeo.milling.cut import AreaCut, ContourCut, Cut
from camgeo.milling.holding import CLAMPS, FIXTURE, SCREWS, Clamp, Obstacle
from camgeo.milling.moves import Heights
from camgeo.milling.stages import Area, polygon
from camgeo.milling.tool import ToolError
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Boundary

COARSE: Final = 0.01
"""Tolerance [mm] of the contours with which clamps are compared; it counts against them."""

LARGEST: Final = 1e5
"""Distance from the cam axis to which work may reach, and radius of a tool [mm]: a hundred metres,
beyond any machine. On it chords within the fineness of a simulation, 1e-3 mm, are some 20,000 a
turn, so that verdicts never rest on coarser ones."""

LOOSE_CORE: Final = "loose-core"
"""Name of findings on waste that is cut free in one piece."""


def guarded(bench: Bench, cuts: Sequence[Cut], heights: Heights) -> list[Cut]:
    """The cuts with the clamps to be cleared, the stops at which they move, and tabs.

    Raises
    ------
    GeometryError
        With the key of the scene, if a clamp stands where something is cut, traverses do not
        clear it or the blank, or nothing holds what is cut free.
    """
    holding = bench.milling.holding
    _clears_the_blank(bench, heights)
    if holding is None:
        freed = [each for each in cuts if _is_through(bench, each)]
        if freed:
            message = f"is missing: {freed[0].name} goes through, and what it cuts free drops"
            raise GeometryError(message, "holding")
        return list(cuts)
    names = [cut.name for cut in cuts]
    for clamp in holding.clamps:
        for key in ("since", "until"):
            name = getattr(clamp, key)
            if name and name not in names:
                known = ", ".join(f'"{each}"' for each in names)
                message = f"there is no such operation; there are {known}"
                raise GeometryError(message, f"holding.{_what(clamp)}.{key}", f'"{name}"')
        if clamp.height >= heights.clearance:
            raise GeometryError(
                f"must be above the {clamp.obstacle.name}, {clamp.height:g} mm high",
                "output.gcode.clearance_height", f"{heights.clearance:g}",
            )  # fmt: skip
    found = []
    for k, cut in enumerate(cuts):
        there = [each for each in holding.clamps if _is_there(each, k, names)]
        stops = [cut.stop, *_moved(holding.clamps, cut.name)]
        made = replace(
            cut,
            obstacles=tuple(each.obstacle for each in there),
            stop="; ".join(text for text in stops if text),
        )
        for obstacle in made.obstacles:
            _clears(made, obstacle)
        if _frees(bench, made):
            if holding.kind in (CLAMPS, SCREWS):
                _holds(bench, made, there)
            if holding.tabs is not None and isinstance(made, ContourCut):
                # Above the lower face; the cut may end below it.
                height = holding.tabs.height + bench.lower_face - made.bottom
                made = replace(made, tabs=replace(holding.tabs, height=height))
        found.append(made)
    return found


def require_room(bench: Bench) -> None:
    """That the blank contains the part, and the part what is left of it to hold it.

    Raises
    ------
    GeometryError
        With the key of the scene.
    """
    import shapely

    milling, layers = bench.milling, bench.part.layers
    holding, thickness = milling.holding, layers[-1].z1 - layers[0].z0
    heights = {} if holding is None else {"thickness": holding.skin}
    if holding is not None and holding.tabs is not None:
        heights["height"] = holding.tabs.height
    for key, height in heights.items():
        if height is not None and height >= thickness:
            message = f"must be less than the thickness of the part, {thickness:g} mm"
            raise GeometryError(message, f"holding.{key}", f"{height:g}")
    if (bore := milling.stock.bore) is not None:
        around = [each for each in bench.part.boundaries if each.hole and each.nearest() > 0.0]
        what = "the bore of the part" if around else "the width of the part"
        free = 2.0 * min(each.nearest() for each in around or [bench.part.outermost])
        if bore > free * (1.0 + SAME):
            message = f"must be at most {what}, {free:g} mm"
            raise GeometryError(message, "stock.bore", f"{bore:g}")
    if milling.stock.outline is None:
        return
    blank = _polygon(milling.stock.outline)
    for boundary in bench.part.boundaries:
        if not boundary.hole:
            corners = shapely.points(shapely.get_coordinates(_polygon(boundary)))
            lacking = float(max(shapely.distance(corners, blank)))
            if lacking > 2.0 * COARSE:
                raise GeometryError(
                    f"the blank is too small: {lacking:.3g} mm are missing at one side of the part",
                    "stock",
                )


def require_size(bench: Bench) -> None:
    """That nothing is larger than what programs are made and simulated for.

    Raises
    ------
    GeometryError
        With the key of the scene.
    """
    milling = bench.milling
    for tool in milling.tools:
        for field, wide in (
            ("diameter", tool.diameter),
            ("shank_diameter", tool.shank_diameter or 0.0),
        ):
            if wide > 2.0 * LARGEST:
                message = f"must be at most {2.0 * LARGEST:g} mm for a milling program"
                raise ToolError(message, tool, field)
    around = [each for each in bench.part.boundaries if not each.hole]
    blank = milling.stock.outline
    for what, key, boundaries in (
        ("part", "output.gcode", around),
        ("blank", "stock", [] if blank is None else [blank]),
    ):
        reach = max((each.farthest()[0] for each in boundaries), default=0.0)
        if reach > LARGEST:
            raise GeometryError(
                f"the {what} reaches {reach:.3g} mm from the cam axis; milling programs are made"
                f" and simulated for up to {LARGEST:g} mm",
                key,
            )


def told_of_holding(bench: Bench, cuts: Sequence[Cut]) -> Iterator[Finding]:
    """What the holding leaves to be done, or to be watched."""
    holding = bench.milling.holding
    if holding is None:
        return
    freed = [cut for cut in cuts if _frees(bench, cut)]
    for cut in freed:
        wall = bench.walls.get(cut.right) if isinstance(cut, ContourCut) else None
        if wall is None or cut.allowance:
            continue
        flank = isinstance(wall.boundary, CurveBoundary)
        if holding.tabs is not None and flank:
            yield Finding(
                "tabs-on-a-flank", "warning",
                f"{cut.name}: {holding.tabs.count} tabs of {holding.tabs.width:g} mm, up to"
                f" {holding.tabs.height:g} mm above the lower face, stand on a flank of the cam and"
                " are to be dressed to its shape",
            )  # fmt: skip
        if wall.boundary.hole and holding.kind == FIXTURE:
            yield Finding(
                LOOSE_CORE, "warning",
                f"{cut.name}: the core inside it is cut free in one piece; the fixture must hold it"
                " as well as the part",
            )  # fmt: skip
    if holding.skin is not None and freed:
        text = f"a skin of {holding.skin:g} mm is left below the part, to be removed by hand"
        yield Finding("onion-skin", "warning", text)


def is_cut_free(bench: Bench, cuts: Sequence[Cut]) -> bool:
    """Whether nothing of the blank hangs on the part when these cuts are done."""
    holding = bench.milling.holding
    through = 0.0 if holding is None else holding.through
    hangs = holding is not None and (holding.tabs is not None or holding.skin is not None)
    below = bench.milling.stock.bottom > through
    return not (hangs or below) and any(_frees(bench, cut) for cut in cuts)


def _clears_the_blank(bench: Bench, heights: Heights) -> None:
    top = bench.milling.stock.top
    for key, height in (("clearance", heights.clearance), ("retract", heights.retract)):
        if height <= top:
            message = f"must be above the blank, {top:g} mm"
            raise GeometryError(message, f"output.gcode.{key}_height", f"{height:g}")


def _is_through(bench: Bench, cut: Cut) -> bool:
    """Whether it reaches the lower face of the part, or the skin on it."""
    holding = bench.milling.holding
    skin = 0.0 if holding is None else holding.skin or 0.0
    return cut.bottom <= bench.lower_face + skin


def _frees(bench: Bench, cut: Cut) -> bool:
    """Whether it cuts part and waste apart; what it clears away inside a bore is chips."""
    if not _is_through(bench, cut):
        return False
    if isinstance(cut, AreaCut):
        return any(not wall.hole for wall in cut.walls)
    return isinstance(cut, ContourCut) and cut.right != "bore"


def _what(clamp: Clamp) -> str:
    return "screw" if clamp.round else "clamp"


def _is_there(clamp: Clamp, index: int, names: Sequence[str]) -> bool:
    """Whether a clamp is set during the operation number `index`."""
    since = names.index(clamp.since) if clamp.since else 0
    until = names.index(clamp.until) if clamp.until else len(names)
    return since <= index < until if since < until else index >= since or index < until


def _moved(clamps: Sequence[Clamp], name: str) -> Iterator[str]:
    """What the operator does before the operation `name`: sets first, then takes away."""
    for clamp in clamps:
        if clamp.since == name:
            yield f"set the {clamp.obstacle.name}"
    for clamp in clamps:
        if clamp.until == name:
            yield f"take away the {clamp.obstacle.name}"


def _clears(cut: Cut, obstacle: Obstacle) -> None:
    """GeometryError with key "holding", if the cutter runs into the obstacle."""
    body = _polygon(obstacle.outline)
    touches = False
    if isinstance(cut, ContourCut):
        ring = shapely.boundary(_polygon(cut.centre))
        touches = float(shapely.distance(ring, body)) <= cut.tool.radius + 2.0 * COARSE
    elif isinstance(cut, AreaCut):
        area = _area(cut)
        touches = area is not None and bool(shapely.intersects(area, body))
    if touches:
        raise GeometryError(
            f"{cut.name} with tool {cut.tool.number} runs into the {obstacle.name}; move it, or"
            " take it away before",
            "holding",
        )


def _area(cut: AreaCut) -> Area | None:
    """The material that an area cut removes, as a polygon."""
    area = None if cut.stock is None else _polygon(cut.stock)
    for wall in cut.walls:
        inside = _polygon(wall)
        if wall.hole:
            area = inside if area is None else area.intersection(inside)
        elif area is not None:
            area = area.difference(inside)
    return area


def _polygon(boundary: Boundary) -> Area:
    return polygon([boundary.arcs(COARSE, "fast").contour], COARSE)


def _holds(bench: Bench, cut: Cut, there: Sequence[Clamp]) -> None:
    """GeometryError with key "holding", if no clamp or screw that is set stands on the part."""
    walls = cut.walls if isinstance(cut, AreaCut) else (bench.walls[_right(cut)].boundary,)
    part = [_polygon(wall) for wall in walls]
    for clamp in there:
        foot = _polygon(clamp.obstacle.outline)
        inside = all(
            shapely.intersects(each, foot) != wall.hole
            for each, wall in zip(part, walls, strict=True)
        )
        if inside:
            return
    raise GeometryError(
        f"{cut.name} cuts the part free while nothing that is set stands on it", "holding"
    )


def _right(cut: Cut) -> str:
    return cut.right if isinstance(cut, ContourCut) else ""
