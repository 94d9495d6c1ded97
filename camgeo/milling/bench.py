"""Part, blank, holding and tools: which tool reaches what, how deep cuts go, and the cuts that are
made of walls, tools and heights.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np
import shapely

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.envelope import Envelope
from camgeo.geometry.outline.path import Path, Stretch
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.milling.cut import (
    MOST_SLACK,
    AreaCut,
    ContourCut,
    Cut,
    LetterCut,
    LineCut,
    PointCut,
    roughing_slack,
)
from camgeo.milling.milling import COMPUTED, CONTROL, END_MILL, MillingSpec, Tool, ToolError
from camgeo.milling.polygons import Area, grown, polygon
from camgeo.milling.strategies import unfit_for_letters
from camgeo.numeric.checked import positive
from camgeo.part.boundaries import CurveBoundary, ExactBoundary, largest_radius
from camgeo.part.part import Boundary, Part, Wall
from camgeo.part.spec import text_name
from camgeo.units import TURN, at_cam_angles

SAME: Final = 2.0**-48
"""Radii that differ by less, relative to them, are equal: the rounding of a sum of two lengths."""

BORE: Final = "bore"
"""Name of the boundary about the cam axis."""

COARSE: Final = 0.01
"""Tolerance [mm] of contours that are compared: what lies over what, and clamps, against which it
counts; around the disc more is cleared than that."""

STRIP_WIDTH: Final = 0.1
"""Width [mm] of the strip beside a wall that must be free for tools to reach it."""

ALLOWANCE_SHARE: Final = 0.05
LARGEST_ALLOWANCE: Final = 0.5
"""Allowance that a planned roughing leaves: as a share of the cutter's diameter, and at most
[mm]."""


class Reason(str):
    """Why a tool cannot do something.

    Attributes
    ----------
    field : attribute of the tool that is at fault.
    """

    __slots__ = ("field",)
    field: str

    def __new__(cls, sentence: str, field: str) -> Self:
        reason = super().__new__(cls, sentence)
        reason.field = field
        return reason


Unfit = Callable[[Tool], str]
"""Function that says why a tool cannot do something, as a `Reason` if one of its attributes is at
fault; an empty text if it can."""


@dataclass(frozen=True, slots=True)
class Bench:
    """The part to be milled, with its blank, its holding and the tools.

    Attributes
    ----------
    part : with its heights.
    milling : the scene's statements.
    compensation : of finishes that do not state theirs.
    """

    part: Part
    milling: MillingSpec
    compensation: str = COMPUTED

    @property
    def walls(self) -> dict[str, Wall]:
        """The walls of the part, by the names of their boundaries."""
        return {wall.boundary.name: wall for wall in self.part.walls}

    @property
    def lower_face(self) -> float:
        """Z of the lower face of the part [mm]."""
        return self.part.layers[0].z0

    @property
    def bosses(self) -> tuple[Wall, ...]:
        """The walls around the bosses on the upper face of the disc."""
        above = self.part.disc[-1].z1
        stand = [layer.boundaries[0] for layer in self.part.layers if layer.z0 >= above]
        return tuple(wall for wall in self.part.walls if wall.boundary in stand)

    @property
    def holes(self) -> tuple[Wall, ...]:
        """The walls of round holes beside the bore, and of marks."""
        return tuple(
            wall
            for wall in self.part.walls
            if isinstance(wall.boundary, ExactBoundary)
            and wall.boundary.hole
            and wall.boundary.name != BORE
        )

    def wall(self, name: str, key: str) -> Wall:
        """The wall of the boundary `name`; GeometryError with the `key` if the part has none, or if
        tools do not reach it from this side.
        """
        walls = self.walls
        message = ""
        if name not in walls:
            names = dict.fromkeys(text_name(wall_name) or wall_name for wall_name in walls)
            known = ", ".join(f'"{wall_name}"' for wall_name in names)
            message = f"the part has no such wall; it has {known}"
        elif not is_open(self.part, walls[name]):
            message = f"it is not open on the {self.milling.top_face} face: the part lies over it"
        if message:
            raise GeometryError(message, key, f'"{name}"')
        return walls[name]

    def is_through(self, wall: Wall) -> bool:
        """Whether the wall reaches the lower face of the part."""
        return wall.z0 == self.lower_face

    def pierces(self, wall: Wall) -> bool:
        """Whether the wall reaches the lower face of the disc, perhaps beside a hub on it."""
        return wall.z0 <= self.part.disc[0].z0

    def mouth(self, wall: Wall) -> float:
        """Z from which a round hole is drilled [mm]: of the face on which it opens, above a
        counterbore if it has one.
        """
        middle = exact_boundary(wall).exact.centres[0]
        upper_ends = (
            hole.z1
            for hole in self.holes
            if hole.z0 == wall.z1 and exact_boundary(hole).exact.centres[0] == middle
        )
        return max(upper_ends, default=wall.z1)

    def bottom(self, wall: Wall) -> float:
        """Z at which cuts along the wall end [mm]: below the part, at its skin, or at a floor."""
        holding = self.milling.holding
        if not self.is_through(wall) or holding is None:
            return wall.z0
        return wall.z0 - holding.through if holding.skin is None else wall.z0 + holding.skin

    def choose(self, what: str, unfit: Unfit, kinds: Iterable[str] = (END_MILL,)) -> Tool:
        """The first tool of one of the `kinds` that fits.

        Raises
        ------
        GeometryError
            With key "tool", and the reason why each tool does not fit.
        """
        reasons = []
        for tool in self.milling.tools:
            if tool.kind not in kinds:
                continue
            reason = unfit(tool)
            if not reason:
                return tool
            reasons.append(f"tool {tool.number}: {reason}")
        message = f"no tool fits the {what}: {'; '.join(reasons) or f'no {END_MILL} is stated'}"
        if len(reasons) == len(self.milling.tools) == 1:
            raise ToolError(message, self.milling.tools[0], getattr(reason, "field", ""))
        raise GeometryError(message, key="tool")

    def allowance(self, tool: Tool, wall: Wall) -> float:
        """Allowance [mm] that a planned roughing with `tool` leaves on a wall.

        At most half of the play that the cutter has in the tightest place.
        """
        usual = min(ALLOWANCE_SHARE * tool.diameter, LARGEST_ALLOWANCE)
        place = tightest(wall.boundary)
        return usual if place is None else min(usual, 0.5 * (place.radius - tool.radius))

    def room_outside(self, tool: Tool, compensation: str) -> float:
        """Room for the leads of a finish beside which everything is cleared [mm]: more where the
        controller takes up the cutter's radius in them.
        """
        return (3.0 if compensation == CONTROL else 1.0) * tool.radius

    # Why tools do not fit -----------------------------------------------------------------------

    def too_short(self, tool: Tool, bottom: float, top: float = 0.0) -> str:
        """Why the tool is too short for a cut from `top` to `bottom` [mm]; empty if edges, shank
        and holder allow it. The holder stays above the upper face of the part.
        """
        depth, reach = top - bottom, max(top, 0.0) - bottom
        if tool.flute_length is not None and tool.flute_length < depth:
            return Reason(
                f"its cutting edges, {tool.flute_length:g} mm, are shorter than {depth:g} mm",
                "flute_length",
            )
        if tool.stick_out is not None and tool.stick_out < reach:
            return Reason(
                f"it sticks out {tool.stick_out:g} mm, less than {reach:g} mm", "stick_out"
            )
        wide = tool.shank_diameter
        if wide is not None and wide > tool.diameter and tool.flute_length is None:
            return Reason(
                f"its shank is wider than its edges, whose length is not stated for {depth:g} mm",
                "shank_diameter",
            )
        return ""

    def too_large(self, tool: Tool, boundary: Boundary) -> str:
        """Why the cutter does not reach all of the boundary; empty if it does."""
        place = tightest(boundary)
        if place is None or tool.radius < place.radius:
            return ""
        if isinstance(boundary, ExactBoundary):
            size = 2.0 * place.radius
            return Reason(
                f"the cutter must be smaller than the {boundary.name}, {size:g} mm", "diameter"
            )
        return Reason(
            f"the cutter is too large for the {boundary.name}: {place.sentence};"
            f" the largest that fits has {largest_diameter(place):g} mm",
            "diameter",
        )

    def unfit(self, wall: Wall, *, top: float = 0.0) -> Unfit:
        """The function that says why a tool cannot finish a wall at full depth from `top` [mm]."""
        bottom = self.bottom(wall)
        return lambda tool: self.too_large(tool, wall.boundary) or self.too_short(tool, bottom, top)


def largest_diameter(place: Tightest) -> float:
    """Diameter of the largest cutter that fits [mm], rounded down to a whole hundredth."""
    return math.floor(200.0 * place.radius) / 100.0


def is_open(part: Part, wall: Wall) -> bool:
    """Whether tools from above reach the wall: no higher layer lies over where they run."""
    higher = [layer for layer in part.layers if layer.z0 >= wall.z1]
    if not higher:
        return True
    inside = coarse(wall.boundary)
    hole = wall.boundary.hole
    strip = grown(inside, STRIP_WIDTH)
    strip = inside.difference(grown(inside, -STRIP_WIDTH)) if hole else strip.difference(inside)
    for layer in higher:
        shared = shapely.intersection(strip, coarse(*layer.boundaries)).area
        # Contours of touching bodies may overlap along the whole wall, each by its tolerance.
        if shared > 2.0 * COARSE * inside.length:
            return False
    return True


def coarse(*boundaries: Boundary) -> Area:
    """The area that boundaries enclose, within `COARSE`."""
    return polygon([boundary.arcs(COARSE, "fast").contour for boundary in boundaries], COARSE)


def letter_walls(bench: Bench, text: str) -> tuple[Wall, ...]:
    """The walls of the letters of `text`; empty if the part has no such text."""
    return tuple(wall for name, wall in bench.walls.items() if text_name(name) == text != "")


def as_wide(tool: Tool, half: float) -> bool:
    """Whether a tool is as wide as a groove, a mark or a hole of twice `half` [mm]."""
    return abs(tool.radius - half) <= SAME * half


def flank_curve(wall: Wall) -> WorkingCurve:
    """The working curve of a flank's wall."""
    assert isinstance(wall.boundary, CurveBoundary)  # as every flank is
    return wall.boundary.path.stretches[0].curve


def exact_boundary(wall: Wall) -> ExactBoundary:
    """The boundary of a bore, a hole, a mark or a rim, which consists of lines and arcs."""
    assert isinstance(wall.boundary, ExactBoundary)  # as of all of these
    return wall.boundary


# -- fitting --------------------------------------------------------------------------------------
# Which cutters reach all of a wall, and where the tightest place is.


@dataclass(frozen=True, slots=True)
class Tightest:
    """The smallest concave radius of a wall.

    Attributes
    ----------
    radius : of the wall [mm], seen from the side without material; that of the largest cutter that
        fits.
    cam_angle : where [rad]; None for a wall that is the same all round.
    """

    radius: float
    cam_angle: float | None = None

    @property
    def sentence(self) -> str:
        """The smallest radius in words, with its cam angle."""
        where = "" if self.cam_angle is None else f" {at_cam_angles(self.cam_angle, form='.4f')}"
        return f"its smallest concave radius is {self.radius:.6g} mm{where}"


def tightest(boundary: Boundary) -> Tightest | None:
    """The place of a wall that limits the cutter's radius most; None if the wall is convex all
    round.

    Of a flank it follows from the extremes of the pitch curve's curvature: the parallel on which
    the cutter's centre runs is regular while 1 + d kappa > 0, with d its distance from the curve.
    """
    if isinstance(boundary, ExactBoundary):
        return Tightest(boundary.round_radius) if boundary.hole else None
    if not isinstance(boundary, CurveBoundary):
        return None
    candidates = [
        _tightest_on_stretch(stretch, hole=boundary.hole) for stretch in boundary.path.stretches
    ]
    places = (place for place in candidates if place is not None)
    return min(places, key=lambda place: place.radius, default=None)


def _tightest_on_stretch(stretch: Stretch, *, hole: bool) -> Tightest | None:
    curve = stretch.curve
    try:
        bends = curvature_extremes(curve.pitch)
    except GeometryError:  # a cusp, in what is trimmed away: the fit of the path decides
        return None
    # Candidates: the extremes on the stretch itself, and its ends with their one-sided curvature.
    inside = (bends.phi - stretch.start) % TURN <= stretch.end - stretch.start
    ends = np.array([stretch.start, stretch.end])
    kappa = np.concatenate(
        (
            bends.values[inside],
            curve.pitch.curvature(ends[:1], "right"),
            curve.pitch.curvature(ends[1:], "left"),
        )
    )
    phi = np.concatenate((bends.phi[inside], ends))
    # Outside, d grows with the cutter, and kappa < 0 is the limit; in a hole it is kappa > 0.
    bend = kappa if hole else -kappa
    worst = int(np.argmax(bend))
    if bend[worst] <= 0.0:
        return None
    # From the pitch curve to the wall: the radius of the wall itself is that of the parallel.
    distance = curve.distance if hole else -curve.distance
    return Tightest(float(1.0 / bend[worst] + distance), float(phi[worst]) % TURN)


# -- making ---------------------------------------------------------------------------------------
# Cuts made of a part's walls, a tool and heights.


MOST_PASSES: Final = 1_000
"""Most passes of one cut: a pass thinner than a thousandth of the depth is a typing error."""

CLEARED_DIAMETERS: Final = 1.25
"""Width that is cleared beside the disc, in diameters of the widest cutter: a slot and an
allowance."""


def rough_around(bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float) -> ContourCut:
    """A slot around a wall, in passes through full material; the cutter enters along its path."""
    boundary, slack = wall.boundary, roughing_slack(allowance)
    return ContourCut(
        name=f"rough {boundary.name}",
        strategy="slot",
        tool=tool,
        top=top,
        depths=pass_depths(tool, top, bench.bottom(wall)),
        allowance=allowance,
        centre=boundary.offset(tool.radius + allowance + slack),
        right=boundary.name,
        slack=slack,
    )


def rough_outside(
    bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float
) -> AreaCut | ContourCut:
    """Roughing around a wall that cuts the part free: of a round blank everything beside the wall
    is cleared; a slot is cut from a plate, where no spiral leads to the wall, and where tabs need a
    frame to hold on to.
    """
    holding = bench.milling.holding
    framed = holding is not None and holding.tabs is not None
    if framed or bench.milling.stock.diameter is None or wall.boundary.hole:
        return rough_around(bench, wall, tool, top, allowance)
    cleared = clear_outside(bench, wall, tool, top, allowance)
    if cleared is not None:
        return cleared
    return replace(
        rough_around(bench, wall, tool, top, allowance),
        note="no spiral clears its hollows: a slot leaves the waste in one piece",
    )


def clear_outside(
    bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float
) -> AreaCut | None:
    """Clearing of all material between a wall and the known outline of the blank; None if no spiral
    leads there.
    """
    from camgeo.milling.clear import spirals  # few outlines of blanks are known

    name, bottom = f"rough {wall.boundary.name}", bench.bottom(wall)
    area_cut = clear_area(bench, name, "rough", tool, top, bottom, (wall.boundary,), allowance)
    return area_cut if spirals(area_cut, wall.boundary, MOST_SLACK) else None


def clear_around(bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float) -> AreaCut:
    """Clearing around a boss, down to the face on which it stands: of the whole blank if its
    outline is known, else of a ring in which the cutters that cut the disc free have room.
    """
    name, bottom = f"rough {wall.boundary.name}", bench.bottom(wall)
    strategy, walls = "rough", [wall.boundary]
    if bench.milling.stock.outline is None:
        disc = bench.part.outermost.arcs(COARSE, "fast")
        widest = max(mill.diameter for mill in bench.milling.tools if mill.kind == END_MILL)
        radius = largest_radius(disc.contour) + disc.deviation + CLEARED_DIAMETERS * widest
        edge = ExactBoundary("edge of what is cleared", hole=True, exact=Contour.circle(radius))
        strategy, walls = "moat", [wall.boundary, edge]
    return clear_area(bench, name, strategy, tool, top, bottom, tuple(walls), allowance)


def finish_along(
    bench: Bench,
    wall: Wall,
    tool: Tool,
    top: float,
    room: float,
    *,
    rest: float = 0.0,
    depths: tuple[float, ...] = (),
    cleared: bool = True,
    springs: int = 1,
    compensation: str = "",
    note: str = "",
) -> ContourCut:
    """Finish along a roughed wall at full depth, or at `depths`.

    Parameters
    ----------
    room, rest, cleared, springs : as of `ContourCut`.
    """
    boundary = wall.boundary
    return ContourCut(
        name=boundary.name,
        strategy="profile",
        tool=tool,
        top=top,
        depths=depths or (bench.bottom(wall),),
        centre=boundary.offset(tool.radius),
        right=boundary.name,
        room=room,
        rest=rest,
        cleared=cleared,
        springs=springs,
        compensation=compensation or bench.compensation,
        note=note,
    )


def groove_slot(bench: Bench, inner: Wall, outer: Wall, tool: Tool, top: float) -> ContourCut:
    """One round between both flanks, with a cutter as wide as the groove."""
    # The cutter's centre runs on the pitch curve: the parallel at distance 0.
    path = Path(Envelope(WorkingCurve(flank_curve(outer).pitch, 0.0)).elements)
    return ContourCut(
        name="groove",
        strategy="slot",
        tool=tool,
        top=top,
        depths=pass_depths(tool, top, bench.bottom(outer)),
        centre=CurveBoundary("path of the cutter along the groove", hole=True, path=path),
        right=outer.boundary.name,
        left=inner.boundary.name,
    )


LOOPS: Final = 0.5


LARGEST_LOOPS: Final = 0.9
"""Radius of the loops of a trochoidal slot, as a share of that within which the cutter is flat:
usually, and at most, so that no core is left in them.
"""


def loops_along(
    bench: Bench, wall: Wall, other: Wall | None, tool: Tool, top: float, allowance: float
) -> AreaCut:
    """Trochoidal roughing along a wall, in a slot wider than the cutter by `LOOPS`.

    `other` is the flank across a groove: the slot is as wide as the groove, less both allowances,
    if loops can make it at once.
    """
    boundary, bottom = wall.boundary, bench.bottom(wall)
    flat = tool.radius - tool.corner_radius
    slot, walls = 2.0 * (tool.radius + LOOPS * flat), [boundary]
    if other is not None:
        groove = 2.0 * (abs(flank_curve(wall).distance) - allowance)
        if groove <= 2.0 * (tool.radius + LARGEST_LOOPS * flat):
            slot, walls = groove, [boundary, other.boundary]
    return AreaCut(
        name=f"rough {boundary.name}",
        strategy="trochoid",
        tool=tool,
        top=top,
        depths=pass_depths(tool, top, bottom),
        allowance=allowance,
        walls=tuple(walls),
        stepover=stated_stepover(tool),
        slot=slot,
    )


def clear_area(
    bench: Bench,
    name: str,
    strategy: str,
    tool: Tool,
    top: float,
    bottom: float,
    walls: tuple[Boundary, ...],
    allowance: float = 0.0,
) -> AreaCut:
    """Clearing of all material between walls and, unless a hole encloses it, the outline of the
    blank.
    """
    stock = bench.milling.stock
    # A hole encloses the area; the bore of the blank lies in it then, and in a face.
    inside = any(wall.hole for wall in walls)
    return AreaCut(
        name=name,
        strategy=strategy,
        tool=tool,
        top=top,
        depths=pass_depths(tool, top, bottom),
        allowance=allowance,
        walls=walls,
        stock=None if inside else stock.outline,
        cleared=(stock.hole,) if (stock.bore is not None and (inside or not walls)) else (),
        stepover=stated_stepover(tool),
    )


def drill_all(
    name: str, tool: Tool, top: float, bottom: float, holes: Mapping[str, complex]
) -> PointCut:
    """Drilling of the `holes`, complex places [mm] by the names of their boundaries; the point of
    the drill goes below `bottom` [mm].
    """
    depths = passes(top, bottom - tool.tip_length, tool.stepdown)
    places = tuple(holes.values())
    return PointCut(
        name=name, strategy="drill", tool=tool, top=top, depths=depths, points=places,
        holes=tuple(holes),
    )  # fmt: skip


def unfit_for_engraving(bench: Bench, tool: Tool, walls: Sequence[Wall]) -> str:
    """Why a tool cannot engrave a mark or the letters of a text; empty if it can."""
    wall = walls[0]
    if text_name(wall.boundary.name):
        reason = "" if is_open(bench.part, wall) else "they are not open on this face"
        reason = reason or unfit_for_letters(tool, [letter.boundary for letter in walls])
        return reason or bench.too_short(tool, bench.bottom(wall), wall.z1)
    width = 2.0 * float(np.max(exact_boundary(wall).exact.radii))
    if tool.kind != END_MILL or tool.corner_radius:
        return "a mark is cut with a flat end mill"
    if not as_wide(tool, 0.5 * width):
        return f"it is not as wide as the {wall.boundary.name}, {width:g} mm"
    if exact_boundary(wall).is_round and not tool.plunges:
        return "a dot needs a tool that may plunge"
    return bench.too_short(tool, bench.bottom(wall), wall.z1)


def engraving_cut(bench: Bench, walls: Sequence[Wall], tool: Tool, top: float) -> Cut:
    """The cut of a mark as wide as the tool, a slot or a dot, or of the letters of a text."""
    wall = walls[0]
    if text := text_name(wall.boundary.name):
        return LetterCut(
            name=f"engrave {text}", strategy="letters", tool=tool, top=top,
            depths=pass_depths(tool, top, bench.bottom(wall)), stepover=stated_stepover(tool),
            walls=tuple(letter.boundary for letter in walls),
            note=f"corners keep the radius of the cutter, {tool.radius:g} mm",
        )  # fmt: skip
    boundary = exact_boundary(wall)
    ends = slot_ends(boundary)
    assert ends is not None  # as of every mark
    name, bottom = f"engrave {boundary.name}", bench.bottom(wall)
    if ends[0] == ends[1]:
        dot = drill_all(name, tool, top, bottom, {boundary.name: ends[0]})
        return replace(dot, depths=(bottom,))
    return LineCut(
        name=name, strategy="engrave", tool=tool, top=top, depths=pass_depths(tool, top, bottom),
        start=ends[0], end=ends[1], slot=boundary.name,
    )  # fmt: skip


def slot_ends(boundary: ExactBoundary) -> tuple[complex, complex] | None:
    """The ends of the centre line of a slot with round ends [mm]; of a circle, its centre twice.

    None for any other boundary.
    """
    # Both shapes have two arcs of equal radius and sweep: about two centres or about one.
    contour = boundary.exact
    bent = contour.sweeps != 0.0
    middles = np.unique(contour.centres[bent])
    radii = contour.radii[bent]
    if not len(middles) or len(middles) > 2 or np.ptp(radii) > SAME * radii[0]:
        return None
    if np.ptp(np.abs(contour.sweeps[bent])) or len(radii) != 2:
        return None
    return complex(middles[0]), complex(middles[-1])


def passes(top: float, bottom: float, largest: float | None) -> tuple[float, ...]:
    """Z of equal passes of at most `largest` [mm], the last at `bottom` exactly; one pass for None.

    Raises
    ------
    GeometryError
        With key "tool.stepdown", if that makes more than `MOST_PASSES`.
    """
    depth = positive("part", top - bottom, "mm")
    count = 1
    if largest is not None:
        # Rounding must not add a pass where the depth is a multiple of the stepdown.
        share = depth / positive("tool.stepdown", largest, "mm") * (1.0 - 1e-12)
        if share > MOST_PASSES:
            raise GeometryError(
                f"must be at least {depth / MOST_PASSES:.3g} mm, for at most {MOST_PASSES} passes",
                "tool.stepdown",
                f"{largest:g}",
            )
        count = max(1, math.ceil(share))
    return (*(top - depth * (k + 1) / count for k in range(count - 1)), bottom)


def pass_depths(tool: Tool, top: float, bottom: float) -> tuple[float, ...]:
    """Z of equal passes [mm] from `top` to `bottom`; ToolError if the tool states no stepdown."""
    if tool.stepdown is None:
        raise ToolError(
            f"tool {tool.number} states no stepdown to cut {top - bottom:g} mm deep",
            tool,
            "stepdown",
        )
    return passes(top, bottom, tool.stepdown)


def stated_stepover(tool: Tool) -> float:
    """Largest distance of neighbouring paths [mm]; ToolError if the tool does not state it."""
    if tool.stepover is None:
        raise ToolError(
            f"tool {tool.number} states no stepover, which is needed to clear an area",
            tool,
            "stepover",
        )
    return tool.stepover
