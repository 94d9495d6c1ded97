"""What `camgeo check` finds, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from camgeo.answers.answer import finding_lines
from camgeo.answers.check import Check
from camgeo.product.judged_part import Body, PartFound
from camgeo.wording import clock

if TYPE_CHECKING:
    from camgeo.product.machining import Machining
    from camgeo.toolpath.machining_time import OperationTime

LOST: Final = 0.01
"""Share of the cutting time by which an operation may miss its feeds without a word."""

CURES: Final = "Each of these cures the fault that it names; check again, for the effects as well:"


def text(answer: Check) -> str:
    """The findings, what would cure them, and the findings of the effects."""
    lines = finding_lines(answer.findings)
    if answer.cures:
        lines += ["", CURES]
        lines += [f"  {cure.statement}" for cure in answer.cures]
    for name, found in answer.effects.items():
        lines += ["", f"{name}:", *finding_lines(found)]
    several = len(answer.parts) > 1
    for name, part in answer.parts.items():
        lines += ["", f"part of {name}:" if several else "part:", *_part(part)]
    if answer.machining is not None:
        lines += _machining(answer.machining)
    if answer.formats:
        lines += ["", "formats:", *finding_lines(answer.formats)]
    return "\n".join(lines)


def _part(found: PartFound) -> list[str]:
    """Size, mass and moments of inertia of a part."""
    told = [f"section through the {each.name} {each.area:.6g} mm^2" for each in found.layers]
    if found.body is not None:
        told += _body(found.body)
    return [*finding_lines(found.findings), *(f"{'':8}{line}" for line in told)]


def _body(body: Body) -> list[str]:
    centre = ", ".join(_shown(each, body.solid.centre_error) for each in body.solid.centre)
    lines = [f"volume {body.solid.volume:.6g} mm^3, centre of mass ({centre}) mm"]
    if body.axial_inertia is None or body.inertia is None:
        return [*lines, "no mass: the scene states no density"]
    about = ", ".join(f"{each:.6g}" for each in body.inertia.diagonal())
    axial = f"moment of inertia about the cam axis {body.axial_inertia:.6g} kg mm^2"
    return [*lines, f"{axial}; about x, y, z through the centre of mass {about} kg mm^2"]


def _shown(value: float, error: float) -> str:
    """A coordinate that its error may be all of is 0."""
    return "0" if abs(value) <= error else f"{value:.6g}"


def _machining(found: Machining) -> list[str]:
    """What is found on each program; the time of each operation, with what the controller loses."""
    lines: list[str] = []
    several = len(found.programs) > 1
    for name, program in found.programs.items():
        head = f"milling of {name}:" if several else "milling:"
        told = finding_lines(program.findings)
        lines += ["", head, *told] if told else ["", f"{head} simulated, nothing found"]
        lines += [f"{'':8}{each.operation}: {each.sentence}" for each in program.roughing]
    timed = {name: each for name, each in found.programs.items() if each.operations is not None}
    if not timed:
        return lines
    total = clock(math.fsum(each.seconds or 0.0 for each in timed.values()))
    lines += ["", f"machining on {found.machine}: {total}, tool changes left out"]
    for name, program in timed.items():
        times = program.operations or ()
        lines += [f"  {name}: {clock(program.seconds or 0.0)}"] if several else []
        width = max((len(each.name) for each in times), default=0)
        lead = "    " if several else "  "
        lines += [f"{lead}{each.name:{width}}  {_time(each)}" for each in times]
    return lines


def _time(found: OperationTime) -> str:
    slowed = f", {100.0 * found.slowed:.0f} % lost below the feed" if found.slowed > LOST else ""
    rapid = f", of which traverses {clock(found.traverses)}" if found.traverses >= 0.5 else ""
    return f"{clock(found.seconds):>8}{rapid}{slowed}"
