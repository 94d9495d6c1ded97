"""A product whose boundaries are exact circles: what writers need of a design, without the engine.

Its fits are off on purpose: the arcs of a "fit" bulge by most of the tolerance they are given, so
that a writer which spends more than its share is found out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any, cast

import numpy as np

from camgeo.cam.cam import Cam, Drive
from camgeo.check.finding import Finding, Limits
from camgeo.check.judge import Judgement
from camgeo.design.drawn import DrawnDisc, PrintedDisc
from camgeo.design.milled import MilledDisc
from camgeo.design.product import Product
from camgeo.design.value_table import Table, TabulatedCam
from camgeo.dynamics.effects.effect import Column
from camgeo.geometry.contour.contour import Contour, Effort, Fit
from camgeo.geometry.contour.spline import SplineContour
from camgeo.kinematics import plan
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.milling import machine
from camgeo.milling.cut import ContourCut
from camgeo.milling.milling import GcodeSpec, MillingSpec, Stock, Tool
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Rapid, Toolpath, Zero
from camgeo.milling.plan import divide_arcs
from camgeo.milling.planned import CutSequence
from camgeo.milling.walk import centre_feed
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Layer, Part
from camgeo.part.spec import PartSpec
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.scene.formats.format import Options, Values
from camgeo.scene.formats.step import StepSpec
from camgeo.scene.scene import Scene
from camgeo.scene.values import Document, ValidValues
from camgeo.units import MM_PER, LengthUnit

SPEND = 0.99
"""Share of the tolerance by which the fits are off."""

PIECES = 12

PROBES = np.linspace(0.0, 1.0, 33)


def bulged(radius: float, centre: complex, tolerance: float) -> Contour:
    """Circle of arcs between points of the circle, each `tolerance` off in its middle."""
    step = 2.0 * math.pi / PIECES
    vertices = centre + radius * np.exp(1j * step * np.arange(PIECES))
    half_chord = radius * math.sin(step / 2.0)
    signs = np.where(np.arange(PIECES) % 2 == 0, 1.0, -1.0)
    sagitta = radius * (1.0 - math.cos(step / 2.0)) + signs * SPEND * tolerance
    return Contour.through(vertices, 4.0 * np.arctan(sagitta / half_chord))


def off_circle(contour: Contour, radius: float, centre: complex) -> float:
    """Largest distance [mm] of `contour` from a circle, probed at 33 points a piece."""
    start = contour.vertices[:, None]
    turned = np.exp(1j * contour.sweeps[:, None] * PROBES)
    arc = contour.centres[:, None] + (start - contour.centres[:, None]) * turned
    line = start + (contour.ends[:, None] - start) * PROBES
    points = np.where(contour.sweeps[:, None] != 0.0, arc, line)
    return float(abs(abs(points - centre) - radius).max())


class CircleBoundary(ExactBoundary):
    """A circle, followed no better than the tolerance asks for."""

    def __init__(self, name: str, hole: bool, radius: float, centre: complex = 0j) -> None:
        super().__init__(name, hole, Contour.circle(radius, centre))

    def __reduce__(self) -> tuple[Any, ...]:
        return CircleBoundary, (self.name, self.hole, self.radius, self.centre)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CircleBoundary) and self.__reduce__() == other.__reduce__()

    def __hash__(self) -> int:
        return hash(self.__reduce__())

    @property
    def radius(self) -> float:
        return self.round_radius

    @property
    def centre(self) -> complex:
        return complex(self.exact.centres[0])

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        contour = bulged(self.radius, self.centre, tolerance)
        return Fit(contour, SPEND * tolerance, tolerance)

    def distance_fit(self, tolerance: float) -> Fit:
        return super().arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        sagitta = SPEND * tolerance
        count = math.ceil(math.pi / (2.0 * math.asin(math.sqrt(sagitta / self.radius / 2.0))))
        points = self.centre + self.radius * np.exp(2j * math.pi * np.arange(count) / count)
        return Fit(Contour(points, np.zeros(count), np.zeros_like(points)), sagitta, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        assert isinstance(contour, Contour)
        return off_circle(contour, self.radius, self.centre)

    def offset(self, distance: float) -> CircleBoundary:
        return self.inset(-distance, self.name)

    def inset(self, distance: float, name: str) -> CircleBoundary:
        radius = self.radius + (distance if self.hole else -distance)
        return CircleBoundary(name, self.hole, radius, self.centre)


def there_and_back(stroke: float) -> plan.MotionPlan:
    """By `stroke` [mm or rad] in half a turn, and back in the other half."""
    law = make_law("simple-sine")
    return plan.MotionPlan(tuple(plan.Move(Decimal(180), to, law) for to in (stroke, 0.0)))


@dataclass(frozen=True, slots=True)
class StubScene:
    drawing: DrawingSpec = field(default_factory=DrawingSpec)
    limits: Limits = field(default_factory=Limits)
    part: PartSpec | None = None
    states_milling: bool = True


NO_SCENE: Any = StubScene()

TOOL = Tool(
    number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0, plunges=True
)

SECOND_TOOL = replace(
    TOOL, number=2, diameter=8.0, spindle_speed=2500.0, feed=250.0, plunge_feed=80.0
)

CAM = Cam(
    Drive(there_and_back(10.0)), TranslatingRoller(base_radius=35.0, roller_radius=8.0), rotation=-1
)
"""Of what pictures show besides the disc."""


@dataclass(frozen=True)
class StubProduct(Product):
    """An eccentric disc; with `groove`, a groove of eccentric flanks in a round blank; or a `given`
    part and nothing else.
    """

    scene: Scene = NO_SCENE
    cam: Cam = CAM
    judgement: Judgement = NO_SCENE
    others: tuple[Product, ...] = ()
    columns: Callable[[], tuple[Column, ...]] = tuple
    name: str = "eccentric"
    position: int = 0
    unit: LengthUnit = "mm"
    effort: Effort = "fewest"
    groove: bool = False
    given: Part | None = None
    dxf: DxfSpec = field(default_factory=DxfSpec)
    step: StepSpec = field(default_factory=StepSpec)
    gcode: GcodeSpec = field(default_factory=GcodeSpec)
    tool: Tool = TOOL
    thickness: float | None = 8.0
    zero: Zero = field(default_factory=Zero)
    notes: tuple[str, ...] = ()
    whole: None = None
    first: None = None
    second: None = None
    scale: float = 1.0
    scene_hash: str = "0123456789abcdef" * 4
    version: str = "0.0.test"
    second_tool: Tool | None = None
    has_pitch_curve: bool = True
    findings: tuple[Finding, ...] = field(
        default=(Finding("transmission-angle", "ok", "fine", 70.0, 60.0, "deg"),)
    )

    @property
    def scene_files(self) -> dict[str, str]:
        return {}

    @property
    def options(self) -> Options:
        return Options({"dxf": self.dxf, "gcode": self.gcode, "step": self.step})

    @property
    def values(self) -> Values:
        numbers = {"spindle_speed": 1, "feed": 1, "plunge_feed": 1, "stepdown": 1}
        given = {
            "follower": {"kind": "plate"},
            "tool": [{"diameter": self.tool.diameter, **numbers}],
            "holding": {"kind": "fixture", "through": 0},
            "part": {"thickness": self.thickness} if self.thickness else {},
        }
        return ValidValues(Document.from_values(given))

    @property
    def drawn(self) -> DrawnDisc:
        return cast("DrawnDisc", self)

    @property
    def printed(self) -> PrintedDisc:
        return PrintedDisc(lambda _: self.part, PartSpec(), None)

    @property
    def milled(self) -> MilledDisc:
        return cast("MilledDisc", self)

    @property
    def spec(self) -> MillingSpec:
        tools = {tool.number: tool for tool in self.tools}
        return MillingSpec(tools=tuple(tools.values()), stock=Stock())

    @property
    def tabulated(self) -> TabulatedCam:
        return cast("TabulatedCam", self)

    @property
    def centre(self) -> complex:
        return complex(0.0, -5.0) * self.scale

    @property
    def pitch_radius(self) -> float:
        return 40.0 * self.scale

    @property
    def roller_radius(self) -> float:
        return 8.0 * self.scale

    @property
    def base_radius(self) -> float:
        return 35.0 * self.scale

    @property
    def part(self) -> Part:
        if self.given is not None:
            return self.given
        inner = self.pitch_radius - self.roller_radius
        outer = self.pitch_radius + self.roller_radius
        bore = CircleBoundary("bore", True, 10.0 * self.scale)
        bottom = -(self.thickness or 0.0)
        if not self.groove:
            outline = CircleBoundary("outline", False, inner, self.centre)
            return Part((Layer(bottom, 0.0, (outline, bore)),))
        rim = CircleBoundary("rim", False, 60.0 * self.scale)
        flanks = (
            CircleBoundary("inner flank", False, inner, self.centre),
            CircleBoundary("outer flank", True, outer, self.centre),
        )
        body = (rim, bore)
        return Part((Layer(bottom, -3.0, body), Layer(-3.0, 0.0, body + flanks, "groove")))

    untrimmed = part

    def pitch_contour(self, tolerance: float) -> Fit:
        contour = bulged(self.pitch_radius, self.centre, tolerance)
        return Fit(contour, SPEND * tolerance, tolerance)

    def pitch_deviation(self, contour: Contour) -> float:
        return off_circle(contour, self.pitch_radius, self.centre)

    @property
    def tools(self) -> tuple[Tool, Tool]:
        """Of the bore and of the outline."""
        return self.tool, self.second_tool or self.tool

    @property
    def cuts(self) -> tuple[ContourCut, ...]:
        outline, bore = replace(self, groove=False).part.boundaries
        return tuple(
            ContourCut(
                name=each.name,
                strategy="profile",
                tool=tool,
                top=0.0,
                depths=DEPTHS,
                centre=each.offset(tool.radius),
                right=each.name,
                room=1.0,
                cleared=True,
            )
            for each, tool in zip((bore, outline), self.tools, strict=True)
        )

    contour_cuts = cuts

    @property
    def sequence(self) -> CutSequence:
        return CutSequence(self.cuts, (), is_cut_free=False)

    @property
    def programs(self) -> tuple[Product, ...]:
        return (cast("Product", self),)

    def flaws(self, *_: object) -> tuple[()]:
        """None; nor is anything roughed or hit."""
        return ()

    engaged = safe = flaws

    def toolpath(self, tolerance: float) -> Toolpath:
        largest = machine.load(self.gcode.machine).arcs.largest_turn
        operations = []
        for cut in self.cuts:
            contour = cut.centre.arcs(tolerance).contour
            if cut.name == "outline":
                contour = contour.reversed()
            assert isinstance(cut.centre, CircleBoundary)
            moves = _moves(cut, contour, cut.centre.centre, self.gcode.clearance_height)
            operations.append(Operation(cut, tuple(divide_arcs(moves, largest))))
        return Toolpath(self.gcode.heights, tuple(operations))

    def table(self) -> Table:
        phi = np.linspace(0.0, 2.0 * math.pi, 73)
        radius = self.pitch_radius - self.roller_radius
        points = self.centre + radius * np.exp(1j * (phi + 0.5 * math.pi))
        lift = 5.0 * self.scale * (1.0 - np.cos(phi))
        lengths = np.column_stack((lift, points.real, points.imag)) / MM_PER[self.unit]
        names = ("phi [deg]", *(f"{what} [{self.unit}]" for what in ("s", "inner x", "inner y")))
        return Table(names, np.column_stack((np.degrees(phi), lengths)))

    stated = written = table
    value_table = property(table)


DEPTHS = (-4.0, -8.0)


def _moves(
    cut: ContourCut, contour: Contour, centre: complex, safe_height: float
) -> Iterator[Move]:
    """Two passes along `contour`, entered and left tangentially on quarter circles."""
    tool = cut.tool
    start = complex(contour.vertices[0])
    inwards = (centre - start) / abs(centre - start)
    ccw = bool(contour.sweeps[0] > 0.0)
    ahead = inwards * (-1j if ccw else 1j)
    # The leads lie on the side of the waste: inside a bore, outside an outline.
    inside = cut.centre.hole
    reach = (0.4 if inside else -0.1) * abs(centre - start)
    hinge = start + inwards * reach
    entry, leave = hinge - ahead * abs(reach), hinge + ahead * abs(reach)
    turn = ccw if inside else not ccw
    for depth in cut.depths:
        yield Rapid((entry.real, entry.imag, safe_height))
        yield Feed((entry.real, entry.imag, depth), tool.plunge_feed)
        yield _arc(start, hinge, depth, turn, tool)
        pieces = zip(contour.ends, contour.centres, contour.sweeps, strict=True)
        for end, hub, sweep in pieces:
            yield _arc(complex(end), complex(hub), depth, bool(sweep > 0.0), tool)
        yield _arc(leave, hinge, depth, turn, tool)
        yield Rapid((leave.real, leave.imag, safe_height))


def _arc(end: complex, hub: complex, depth: float, ccw: bool, tool: Tool) -> ArcFeed:
    """In climb milling, with the wall around an arc that turns counter-clockwise."""
    feed = centre_feed(tool.feed, abs(end - hub), tool.radius, inside=ccw)
    return ArcFeed((end.real, end.imag, depth), (hub.real, hub.imag), ccw, feed)
