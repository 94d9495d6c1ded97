"""A product whose boundaries are exact circles: what writers need of a design, without the engine.

Its fits are off on purpose: the arcs of a "fit" bulge by most of the tolerance they are given, so
that a writer which spends more than its share is found out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal, Self, cast

import numpy as np

from camgeo.cam.contact import Contact
from camgeo.check.finding import Finding
from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort, Fit
from camgeo.contour.spline import Arc, SplineContour, SplineFit
from camgeo.effects.effect import Column
from camgeo.files.drawn import DrawnDisc
from camgeo.files.milled import MilledDisc
from camgeo.files.pictured import PicturedCam
from camgeo.files.sketch import CutOff, FollowerSketch, PlanSegment, PlanSketch
from camgeo.files.table import Table
from camgeo.files.tabulated import TabulatedCam
from camgeo.formats.dxf import DxfSpec
from camgeo.formats.format import Options, Values
from camgeo.lazy import Ledger
from camgeo.mechanism.sketch import Guide, MechanismSketch
from camgeo.motion.joints import Joint
from camgeo.numeric.arrays import FloatArray
from camgeo.part.part import Layer, Part
from camgeo.scene.document import document
from camgeo.scene.sound import SoundValues
from camgeo.toolpath import machine
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Operation, Rapid, Toolpath
from camgeo.toolpath.plan import divided
from camgeo.toolpath.spec import GcodeSpec
from camgeo.toolpath.tool import Tool
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.chain import chain

SPEND = 0.99
"""Share of the tolerance by which the fits are off."""

PIECES = 12

PROBES = np.linspace(0.0, 1.0, 33)

QUANTITIES = ("s", "s1", "s2", "s3")


def bulged(radius: float, centre: complex, tolerance: float) -> Contour:
    """Circle of arcs between points of the circle, each `tolerance` off in its middle."""
    step = 2.0 * math.pi / PIECES
    vertices = centre + radius * np.exp(1j * step * np.arange(PIECES))
    half_chord = radius * math.sin(step / 2.0)
    signs = np.where(np.arange(PIECES) % 2 == 0, 1.0, -1.0)
    sagitta = radius * (1.0 - math.cos(step / 2.0)) + signs * SPEND * tolerance
    return chain(vertices, 4.0 * np.arctan(sagitta / half_chord))


def off_circle(contour: Contour, radius: float, centre: complex) -> float:
    """Largest distance [mm] of `contour` from a circle, probed at 33 points a piece."""
    start = contour.vertices[:, None]
    turned = np.exp(1j * contour.sweeps[:, None] * PROBES)
    arc = contour.centres[:, None] + (start - contour.centres[:, None]) * turned
    line = start + (contour.ends[:, None] - start) * PROBES
    points = np.where(contour.sweeps[:, None] != 0.0, arc, line)
    return float(abs(abs(points - centre) - radius).max())


@dataclass(frozen=True, slots=True)
class CircleBoundary:
    name: str
    hole: bool
    radius: float
    centre: complex = 0j

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        contour = bulged(self.radius, self.centre, tolerance)
        return Fit(contour, SPEND * tolerance, tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        sagitta = SPEND * tolerance
        count = math.ceil(math.pi / (2.0 * math.asin(math.sqrt(sagitta / self.radius / 2.0))))
        points = self.centre + self.radius * np.exp(2j * math.pi * np.arange(count) / count)
        return Fit(Contour(points, np.zeros(count), np.zeros_like(points)), sagitta, tolerance)

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        ends = (self.centre + self.radius, self.centre - self.radius)
        halves = (Arc(a, b, math.pi, self.centre) for a, b in (ends, ends[::-1]))
        return SplineFit(SplineContour(tuple(halves)), 0.0, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        assert isinstance(contour, Contour)
        return off_circle(contour, self.radius, self.centre)

    def beside(self, distance: float) -> CircleBoundary:
        return replace(self, radius=self.radius + (-distance if self.hole else distance))


@dataclass(frozen=True, slots=True)
class StubProduct:
    """An eccentric disc; with `groove`, a groove of eccentric flanks in a round blank."""

    name: str = "eccentric"
    unit: LengthUnit = "mm"
    effort: Effort = "fewest"
    groove: bool = False
    dxf: DxfSpec = field(default_factory=DxfSpec)
    gcode: GcodeSpec = field(default_factory=GcodeSpec)
    thickness: float | None = 8.0
    scale: float = 1.0
    scene_hash: str = "0123456789abcdef" * 4
    scene_files: dict[str, str] = field(default_factory=dict)
    version: str = "0.0.test"
    rotation: int = -1
    joints: tuple[float, ...] = (0.0, math.pi)
    lift_unit: Literal["mm", "rad"] = "mm"
    contact: Contact = Contact.INNER
    cut_off: tuple[CutOff, ...] = ()
    effect_columns: tuple[Column, ...] = ()
    second_tool: Tool | None = None
    ledger: Ledger = field(default_factory=Ledger, compare=False)
    findings: tuple[Finding, ...] = field(
        default=(Finding("transmission-angle", "ok", "fine", 70.0, 60.0, "deg"),)
    )

    @property
    def options(self) -> Options:
        return Options({"dxf": self.dxf, "gcode": self.gcode})

    @property
    def values(self) -> Values:
        keys = [
            "follower.kind = 'plate'",
            f"output.gcode.tool_diameter = {self.gcode.tool.diameter}",
        ]
        keys += [f"part.thickness = {self.thickness}"] if self.thickness else []
        text = "\n".join(keys)
        return SoundValues(document(text.encode()))

    @property
    def discs(self) -> tuple[Self, ...]:
        return (self,)

    @property
    def drawn(self) -> DrawnDisc:
        return cast("DrawnDisc", self)

    @property
    def milled(self) -> MilledDisc:
        return cast("MilledDisc", self)

    @property
    def tabulated(self) -> TabulatedCam:
        return cast("TabulatedCam", self)

    @property
    def pictured(self) -> PicturedCam:
        return cast("PicturedCam", self)

    @property
    def has_pitch_curve(self) -> bool:
        return True

    @property
    def centre(self) -> complex:
        return complex(0.0, -5.0) * self.scale

    @property
    def pitch_radius(self) -> float:
        return 40.0 * self.scale

    @property
    def flank_distance(self) -> float:
        return self.roller_radius

    @property
    def roller_radius(self) -> float:
        return 8.0 * self.scale

    @property
    def base_radius(self) -> float:
        return 35.0 * self.scale

    @property
    def follower_sketch(self) -> FollowerSketch:
        return FollowerSketch("guide", 60j * self.scale)

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """A rod in a guide, with the roller on the base circle all the time."""
        roller = 1j * self.base_radius
        return MechanismSketch(
            links=((roller, 2.0 * roller),),
            guides=(Guide(1.8 * roller, 1j, block=False),),
            rollers=((roller, self.roller_radius),),
        )

    @property
    def far_angle(self) -> float:
        return self.joints[-1]

    @property
    def plan_sketch(self) -> PlanSketch:
        """From joint to joint by a harmonic, turn to turn."""
        found = []
        for angle in self.joints:
            jet = np.array([self.quantity(what, np.array([angle]))[0] for what in QUANTITIES])
            found.append(Joint(angle, float(jet[0]), "U", "U", 3, jet, jet))
        ends = (*self.joints[1:], 2.0 * math.pi)
        segments = tuple(
            PlanSegment(start, end, "simple-sine")
            for start, end in zip(self.joints, ends, strict=True)
        )
        return PlanSketch("follower", self.lift_unit, tuple(found), tuple(found), segments)

    @property
    def part(self) -> Part:
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

    def pitch_contour(self, tolerance: float) -> Fit:
        contour = bulged(self.pitch_radius, self.centre, tolerance)
        return Fit(contour, SPEND * tolerance, tolerance)

    def pitch_deviation(self, contour: Contour) -> float:
        return off_circle(contour, self.pitch_radius, self.centre)

    @property
    def tools(self) -> tuple[Tool, Tool]:
        """Of the bore and of the outline."""
        return self.gcode.tool, self.second_tool or self.gcode.tool

    @property
    def cuts(self) -> tuple[Cut, ...]:
        bore, outline = self.tools
        radius = self.pitch_radius - self.roller_radius
        made = (
            (CircleBoundary("bore", True, 10.0 * self.scale), bore),
            (CircleBoundary("outline", False, radius, self.centre), outline),
        )
        return tuple(
            Cut(each.name, "profile", tool, each.beside(tool.radius), each.name, "", DEPTHS, 1.0)
            for each, tool in made
        )

    def toolpath(self, tolerance: float) -> Toolpath:
        largest = machine.load(self.gcode.machine).arcs.largest_turn
        operations = []
        for cut in self.cuts:
            contour = cut.centre.arcs(tolerance).contour
            if cut.name == "outline":
                contour = contour.reversed()
            assert isinstance(cut.centre, CircleBoundary)
            moves = _moves(cut, contour, cut.centre.centre, self.gcode.safe_height)
            operations.append(Operation(cut, tuple(divided(moves, largest))))
        return Toolpath(self.gcode.safe_height, tuple(operations))

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        offset = {"pitch": 0.0, "inner": -self.roller_radius, "outer": self.roller_radius}[what]
        points = self.centre + (self.pitch_radius + offset) * np.exp(1j * (phi + 0.5 * math.pi))
        return np.column_stack((points.real, points.imag))

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        if what == "curvature":
            return np.full_like(phi, 1.0 / self.pitch_radius)
        if what == "transmission_angle":
            return np.radians(80.0 - 10.0 * np.cos(phi))
        order = {"s": 0, "s1": 1, "s2": 2, "s3": 3}[what]
        mean = 5.0 * self.scale if order == 0 else 0.0
        return mean - 5.0 * self.scale * np.cos(phi + 0.5 * math.pi * order)

    def table(self) -> Table:
        phi = np.linspace(0.0, 2.0 * math.pi, 73)
        points = self.curve("inner", phi) / MM_PER[self.unit]
        lift = self.quantity("s", phi) / MM_PER[self.unit]
        names = ("phi [deg]", *(f"{what} [{self.unit}]" for what in ("s", "inner x", "inner y")))
        return Table(names, np.column_stack((np.degrees(phi), lift, points)))


DEPTHS = (-4.0, -8.0)


def _moves(cut: Cut, contour: Contour, centre: complex, safe_height: float) -> Iterator[Move]:
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
        yield _arc(start, hinge, depth, turn, tool.feed)
        pieces = zip(contour.ends, contour.centres, contour.sweeps, strict=True)
        for end, hub, sweep in pieces:
            yield _arc(complex(end), complex(hub), depth, bool(sweep > 0.0), tool.feed)
        yield _arc(leave, hinge, depth, turn, tool.feed)
        yield Rapid((leave.real, leave.imag, safe_height))


def _arc(end: complex, hub: complex, depth: float, ccw: bool, feed: float) -> ArcFeed:
    return ArcFeed((end.real, end.imag, depth), (hub.real, hub.imag), ccw, feed)
