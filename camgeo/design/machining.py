"""The milling programs of a design's discs: their running times and the findings on them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding, findings_in_unit
from camgeo.design.product import product_sides
from camgeo.errors import FileError, GeometryError, SceneError, ToleranceError, UndercutError
from camgeo.milling.machine import load
from camgeo.milling.machining_time import OperationTime, machine_times
from camgeo.scene.formats.gcode import FORMAT

if TYPE_CHECKING:
    from camgeo.design.product import Product
    from camgeo.errors import Fault
    from camgeo.milling.judged import Feature
    from camgeo.milling.machine import Machine
    from camgeo.milling.plan import OperationEngagement

MILLING: Final = "milling"
"""Name of the findings on programs that cannot be planned."""


@dataclass(frozen=True, slots=True)
class SideProgram:
    """The milling program of one side of a disc.

    Attributes
    ----------
    findings : findings of its sequence and its simulation; if it cannot be planned, the reasons:
        "broken" for a key that the scene lacks, "invalid" for a wrong one.
    operations : time of each operation; None if the machine's dynamics are unknown, or if there is
        no program.
    faults : faults of the scene for which it cannot be planned.
    roughing : engagement of the cutter in operations that clear an area.
    features : features of the part, with the operations of all its sides; empty for a second side.
    """

    findings: tuple[Finding, ...]
    operations: tuple[OperationTime, ...] | None = None
    faults: tuple[Fault, ...] = ()
    roughing: tuple[OperationEngagement, ...] = ()
    features: tuple[Feature, ...] = ()

    @property
    def seconds(self) -> float | None:
        """Time of the whole program without tool changes and dwells [s]; None if it is unknown."""
        return None if self.operations is None else _total(self.operations)


@dataclass(frozen=True, slots=True)
class Machining:
    """The milling programs of all discs, as their controller runs them.

    Attributes
    ----------
    machine : name of the controller.
    programs : the programs by the names of the discs, the main one first, each followed by its
        second side.
    """

    machine: str
    programs: Mapping[str, SideProgram]

    @property
    def seconds(self) -> float | None:
        """Time of all programs [s]; None if that of one is unknown."""
        times = [program.seconds for program in self.programs.values()]
        return (
            None
            if None in times
            else math.fsum(seconds for seconds in times if seconds is not None)
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The findings on all programs."""
        return tuple(chain.from_iterable(program.findings for program in self.programs.values()))


def plan_machining(discs: Iterable[Product]) -> Machining:
    """Plan, time and simulate the programs of discs whose scene states milling."""
    sides = [side for disc in discs for side in product_sides(disc)]
    machine = _machine(sides[0])
    return Machining(machine.name, {side.name: _program(side, machine) for side in sides})


def machining_time(discs: Iterable[Product]) -> float:
    """Time of all programs of discs whose scene states milling [s]; nothing is simulated.

    Raises
    ------
    SceneError
        If a program cannot be planned.
    GeometryError
        If the dynamics of the machine are not known.
    ToleranceError
        If the tolerance of the scene cannot be kept.
    """
    durations = []
    for side in (side for disc in discs for side in product_sides(disc)):
        machine, tolerance = _machine(side), side.scene.output.tolerance
        times = machine_times(machine, side.milled.toolpath(tolerance), tolerance)
        if times is None:
            message = "has a profile without [dynamics]: how fast it runs a program is not known"
            raise GeometryError(message, "output.gcode.machine", f'"{machine.name}"')
        durations.append(_total(times))
    return math.fsum(durations)


def _total(times: Iterable[OperationTime]) -> float:
    return math.fsum(operation.seconds for operation in times)


def _machine(side: Product) -> Machine:
    return load(side.scene.output.options[FORMAT].machine)


def _program(disc: Product, machine: Machine) -> SideProgram:
    """The program of one side of a disc at the scene's tolerance, with time and findings."""
    from camgeo.design.milled import compared
    from camgeo.scene.milling import is_missing

    output, milled = disc.scene.output, disc.milled
    try:
        toolpath = milled.toolpath(output.tolerance)
        findings = milled.findings(toolpath, output.tolerance)
        times = machine_times(machine, toolpath, output.tolerance)
        roughing = milled.engaged(toolpath)
    except SceneError as error:
        where, stated = f"{error.file}: " if error.file else "", disc.scene.stated
        return SideProgram(
            tuple(
                Finding(
                    MILLING,
                    "broken" if is_missing(stated, fault) else "invalid",
                    f"{where}{fault}",
                )
                for fault in error.faults
            ),
            faults=error.faults,
        )
    except (ToleranceError, FileError, UndercutError) as error:
        disc.scene.restate(error)
        return SideProgram((Finding(MILLING, "invalid", str(error)),))
    findings = findings_in_unit(
        disc.unit, (*findings, *filter(None, (engaged.finding for engaged in roughing)))
    )
    timed = None if times is None else tuple(times)
    return SideProgram(findings, timed, roughing=roughing, features=compared(milled))
