"""The setup sheet of a program: what the machinist sets up, with the program simulated."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Final

from camgeo.answers.answer import BROKEN, FINE, Answer
from camgeo.design import Design
from camgeo.errors import GeometryError
from camgeo.product.milled import compared
from camgeo.product.product import Product, programs_of, sides_of
from camgeo.scene.scene import Scene
from camgeo.toolpath.blank import described
from camgeo.toolpath.compensation import limits_of
from camgeo.toolpath.engaged import Engaged
from camgeo.toolpath.features import Feature
from camgeo.toolpath.holding import CLAMPS, FIXTURE, ONION_SKIN, SCREWS, TABS, Clamp, Holding
from camgeo.toolpath.machine import Machine, load
from camgeo.toolpath.machining_time import OperationTime, times_on
from camgeo.toolpath.moves import Heights, Operation, Stop, Toolpath
from camgeo.toolpath.sequence import SEQUENCE
from camgeo.toolpath.stages import Flaw
from camgeo.toolpath.tool import Tool
from camgeo.toolpath.turning import HOW
from camgeo.toolpath.zero import Zero
from camgeo.units import MM_PER, LengthUnit

DECIMALS: Final[dict[LengthUnit, int]] = {"mm": 4, "inch": 6}
"""Of lengths in words."""


@dataclass(frozen=True, slots=True)
class Step:
    """One operation, in its order.

    Attributes
    ----------
    operation : that is run.
    seconds : its machining time; None where the machine's dynamics are not known.
    engaged : how its cutter is engaged, if it clears an area.
    compensation : what the offset of its tool holds, and how far it may be off; or empty.
    base : Z of the program's zero above the upper face of the part [mm].
    """

    operation: Operation
    seconds: float | None
    engaged: Engaged | None = None
    compensation: str = ""
    base: float = 0.0

    @property
    def name(self) -> str:
        """Of the operation."""
        return self.operation.name

    @property
    def tool(self) -> Tool:
        """With the feeds and the speed of this operation."""
        return self.operation.tool

    @property
    def number(self) -> int:
        """Of the tool."""
        return self.tool.number

    @property
    def lowest(self) -> float:
        """Z of the tip at its deepest, from the program's zero [mm]."""
        return min(move.end[2] for move in self.operation.travel) - self.base

    @property
    def stops(self) -> tuple[str, ...]:
        """What the operator does at each halt."""
        return tuple(move.note for move in self.operation.moves if isinstance(move, Stop))

    @property
    def note(self) -> str:
        """For the operator; may be empty."""
        return self.operation.cut.note


@dataclass(frozen=True, slots=True)
class SetupSheet(Answer):
    """A setup sheet.

    Attributes
    ----------
    scene : whose main disc is milled.
    machine : the controller.
    work_offset : as the scene states it; empty for the machine's first.
    blank, holding, zero, traverses : in words; lengths in the unit of the scene.
    tools : each once, in the order in which they are called.
    steps : the operations.
    told : of the sequence, a sentence each: what is not milled, and what is left to be done.
    flaws : of the simulated program, with what is to be watched.
    features : of the part, with the operations of all its sides; empty of a second side.
    side : which side this is, and how the work lies, in words; None if there is but one.
    second : the sheet of the second side; None if there is none, or if this is it.
    """

    command: ClassVar[str] = "setup"

    scene: Scene
    machine: str
    work_offset: str
    blank: str
    holding: str
    zero: str
    traverses: str
    tools: tuple[Tool, ...]
    steps: tuple[Step, ...]
    told: tuple[str, ...]
    flaws: tuple[Flaw, ...]
    features: tuple[Feature, ...] = ()
    side: str | None = None
    second: SetupSheet | None = None

    @property
    def sheets(self) -> tuple[SetupSheet, ...]:
        """Of each side, the first one first."""
        return (self,) if self.second is None else (self, self.second)

    @property
    def seconds(self) -> float | None:
        """Machining time of all operations; None where it is not known."""
        times = [step.seconds for step in self.steps]
        return None if None in times else math.fsum(time for time in times if time is not None)

    @property
    def exit_code(self) -> int:
        """1 if the program must not be run."""
        watched = (flaw.watched for sheet in self.sheets for flaw in sheet.flaws)
        spoilt = any(each.severity == "broken" for each in self.features)
        return FINE if all(watched) and not spoilt else BROKEN


def setup_sheet(design: Design, tolerance: float | None = None) -> SetupSheet:
    """The sheet of the main disc's program, within `tolerance` [mm] or the scene's, and that of its
    second side with it.

    Raises
    ------
    GeometryError
        With the key of the scene, if it has no program.
    """
    if not design.scene.states_milling:
        raise GeometryError("is not stated: there is no program to set up", key="tool")
    tolerance = design.scene.output.tolerance if tolerance is None else tolerance
    first, *others = sides_of(design.disc)
    sheet = _sheet(design, first, tolerance)
    if not others:
        return sheet
    (second,) = others
    about = second.milled.zero.turned
    return replace(
        sheet,
        side="first side",
        second=replace(
            _sheet(design, second, tolerance), side=f"second side, the work {HOW[about]}"
        ),
    )


def _sheet(design: Design, product: Product, tolerance: float) -> SetupSheet:
    """That of one side."""
    milled = product.milled
    toolpath, spec = milled.toolpath(tolerance), milled.spec
    assert spec is not None  # for there is a program
    machine, options = load(milled.gcode.machine), milled.gcode
    zero, unit = milled.zero, design.scene.unit
    told = (each.sentence for each in milled.sequence.findings if each.name != SEQUENCE)
    return SetupSheet(
        design.scene,
        machine.name,
        options.work_offset or next(iter(machine.work_offsets)),
        described(spec.stock, milled.part, zero, unit),
        _holding(spec.holding, zero, unit),
        zero.sentence,
        _traverses(options.heights, zero, unit),
        _tools(toolpath),
        _steps(
            toolpath,
            times_on(machine, toolpath, tolerance),
            milled.engaged(toolpath),
            machine,
            zero,
            unit,
        ),
        (*told, *_programs(product, machine)),
        milled.flaws(toolpath, tolerance),
        compared(milled),
    )


def _steps(
    toolpath: Toolpath,
    times: Sequence[OperationTime] | None,
    found: Sequence[Engaged],
    machine: Machine,
    zero: Zero,
    unit: LengthUnit,
) -> tuple[Step, ...]:
    seconds = {} if times is None else {each.name: each.seconds for each in times}
    engaged = {each.operation: each for each in found}
    words = machine.compensation
    told = {
        name: limit.sentence(words, lambda mm: f"{shown(mm, unit)} {unit}")
        for name, limit in limits_of(toolpath.operations).items()
        if words is not None
    }
    return tuple(
        Step(each, seconds.get(name), engaged.get(name), told.get(name, ""), zero.z)
        for name, each in ((each.name, each) for each in toolpath.operations)
    )


def _programs(side: Product, machine: Machine) -> Iterator[str]:
    """Which operations are in which file, where a machine needs a program for each tool."""
    products = programs_of(side)
    for each in products if len(products) > 1 else ():
        names = ", ".join(cut.name for cut in each.milled.cuts)
        tool = each.milled.cuts[0].tool.number
        yield f"{each.name}{machine.extension}: {names}, with tool {tool} in the spindle"


def _tools(toolpath: Toolpath) -> tuple[Tool, ...]:
    found: dict[int, Tool] = {}
    for operation in toolpath.operations:
        found.setdefault(operation.tool.number, operation.tool)
    return tuple(found.values())


def shown(mm: float, unit: LengthUnit) -> str:
    """A length in the unit of the scene, to a ten-thousandth of a millimetre."""
    return f"{round(mm / MM_PER[unit], DECIMALS[unit]) + 0.0:g}"


def _holding(holding: Holding | None, zero: Zero, unit: LengthUnit) -> str:
    """The holding in words, from the program's zero."""
    if holding is None:
        return "not stated; no cut goes through"
    length = partial(shown, unit=unit)
    tabs, skin = holding.tabs, holding.skin
    words = {
        FIXTURE: "from below: vacuum, tape, soft jaws or a chuck",
        TABS: "" if tabs is None
        else f"{tabs.count} tabs, {length(tabs.width)} x {length(tabs.height)} {unit}",
        ONION_SKIN: "" if skin is None else f"a skin of {length(skin)} {unit}",
        CLAMPS: "clamps",
        SCREWS: "screws",
    }[holding.kind]  # fmt: skip
    places = "; ".join(_clamp(each, zero, unit) for each in holding.clamps)
    through = holding.through
    below = f"; cuts go {length(through)} {unit} below the part" if through else ""
    return f"{words}{': ' if places else ''}{places}{below}"


def _clamp(clamp: Clamp, zero: Zero, unit: LengthUnit) -> str:
    """Where it stands, from the program's zero, and when."""
    length, place = partial(shown, unit=unit), zero.of(clamp.place)
    where = f"{clamp.what} at {length(place.real)}, {length(place.imag)} {unit}"
    since = f", from {clamp.since} on" if clamp.since else ""
    until = f", until {clamp.until}" if clamp.until else ""
    return f"{where}, top at Z {length(clamp.height - zero.z)}{since}{until}"


def _traverses(heights: Heights, zero: Zero, unit: LengthUnit) -> str:
    """Their heights in words, from the program's zero."""
    clearance, retract = (
        shown(each - zero.z, unit) for each in (heights.clearance, heights.retract)
    )
    if retract == clearance:
        return f"at Z {clearance}"
    return f"at Z {clearance} between operations, at Z {retract} within them"
