"""Answer of `camgeo check`: a design compared with its limits, the real discs, and remedies."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Final

from camgeo.app.answers.answer import (
    FEATURE,
    FINDING,
    SCENE,
    Answer,
    Key,
    Keys,
    exit_code,
    finding_lines,
)
from camgeo.app.cli.command import SCENE_FILE, opened, show
from camgeo.check.finding import FINDINGS, RETURN, Finding, forbidding
from camgeo.design.judged_part import PartAssessment, PartBody
from camgeo.design.product import with_pair
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import Joint, joints
from camgeo.scene.formats.format import find_format
from camgeo.units import clock

if TYPE_CHECKING:
    from camgeo.cam.cam import Disc
    from camgeo.check.cures.remedies import Cure
    from camgeo.design.design import Design
    from camgeo.design.machining import Machining
    from camgeo.geometry.outline.outline import Outline
    from camgeo.geometry.outline.path import Path, Pivot
    from camgeo.milling.machining_time import OperationTime
    from camgeo.scene.scene import Scene


FORMAT: Final = "format"
"""Name of the findings that say what a scene lacks for a format."""

PROGRAM: Final = "gcode"
"""The format of milling programs."""

OF_PART: Final = f"{FINDINGS}part"
OF_MILLING: Final = f"{FINDINGS}milling"
"""Names under which a ledger records the findings on parts and on milling."""


@dataclass(frozen=True, slots=True)
class Remains:
    """What is left of a flank on the real disc; areas are computed on demand.

    Attributes
    ----------
    outline : of the real disc.
    """

    outline: Outline

    @property
    def area(self) -> float:
        """Area inside the outline [mm^2]."""
        return _size(self.outline.path)

    @property
    def corners(self) -> tuple[Pivot, ...]:
        """Corners of the outline."""
        return tuple(pivot for pivot in self.outline.path.pivots if pivot.distance == 0.0)

    @property
    def lobes(self) -> tuple[float, ...]:
        """Areas of what is cut off and falls away [mm^2]."""
        return tuple(_size(lobe) for lobe in self.outline.lobes)


@dataclass(frozen=True, slots=True)
class Check(Answer):
    """The findings on a scene.

    Attributes
    ----------
    scene : that was checked.
    findings : all of them, good and bad, worst first.
    curves : the discs by their names, the main one first; empty without a follower.
    cures : remedies for undercut, transmission angle and radius ratio, fault by fault, the cheapest
        first, then the changes that do not help.
    effects : findings of each effect named by the scene; empty if there is no such mechanism.
    parts : the part of each disc by names, the main one first, and of a pair in one piece; empty
        if there is no disc.
    machining : the milling programs; None if the scene states no milling, or lacks what that
        needs, or if there is no disc.
    formats : what the scene lacks for the formats that it names, "broken", and for a program if it
        states how to mill, "ok" if it does not name that format.
    """

    scene: Scene
    findings: tuple[Finding, ...]
    curves: Mapping[str, Disc]
    cures: tuple[Cure, ...]
    effects: Mapping[str, tuple[Finding, ...]]
    parts: Mapping[str, PartAssessment]
    machining: Machining | None = None
    formats: tuple[Finding, ...] = ()

    @property
    def discs(self) -> dict[str, dict[str, Remains | None]]:
        """What is left of each flank in use, by the names of disc and flank; None if nothing is
        left, or if that is not known.

        Computed on demand, because outlines take long near a dead centre.
        """
        return {
            name: {flank: _remains(disc, flank) for flank, _ in disc.flanks}
            for name, disc in self.curves.items()
        }

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Where the segments of the motion meet, by ascending cam angle."""
        return joints(self.scene.plan)

    @property
    def exit_code(self) -> int:
        """2 if there is no such mechanism or part or no program of it can be planned, 1 if a limit
        is broken, there is no such disc, a program must not be run, or a format lacks what it
        needs.
        """
        return exit_code(self.everything)

    @property
    def everything(self) -> tuple[Finding, ...]:
        """All findings: on the cam, on effects, parts, programs and formats."""
        milling = () if self.machining is None else self.machining.findings
        parts = (part.findings for part in self.parts.values())
        groups = (*self.effects.values(), *parts, milling, self.formats)
        return tuple(chain(self.findings, *groups))


def check(design: Design, *, machining: bool = True) -> Check:
    """Compare a design with its limits; without its milling programs if not `machining`."""
    # A single disc has no second cam, and a scene without a follower none at all.
    cams = zip((design.name, f"{design.name}-{RETURN}"), design.judgement.cams, strict=False)
    findings = design.findings
    wrong = any(finding.severity == "invalid" for finding in findings)
    # No effect can be computed without a mechanism.
    named = () if wrong else design.scene.effects
    parts = _parts(design) if design.judgement.cams and not forbidding(findings) else {}
    milled = machining and design.scene.milling is not None and not forbidding(findings)
    milled = milled and not design.scene.lacking([find_format(PROGRAM)])
    return Check(
        design.scene,
        findings,
        {name: cam.disc for name, cam in cams},
        design.judgement.cures,
        {name: design.effects.findings(name) for name in named},
        parts,
        _machining(design) if milled else None,
        tuple(_lacking(design.scene)),
    )


def _lacking(scene: Scene) -> Iterator[Finding]:
    """One finding for each thing that the scene lacks for the formats that it names, and for a
    milling program if it states anything about milling.
    """
    named: list[str] = scene.stated.get("output", "formats") or []
    names = dict.fromkeys((*named, PROGRAM) if scene.states_milling else named)
    for name in names:
        for fault in scene.lacking([find_format(name)]):
            yield Finding(FORMAT, "broken" if name in named else "ok", str(fault))


def _parts(design: Design) -> dict[str, PartAssessment]:
    with design.ledger.entry(OF_PART):
        return {disc.name: PartAssessment.from_disc(disc) for disc in with_pair(design.discs)}


def _machining(design: Design) -> Machining:
    from camgeo.design.machining import plan_machining  # few scenes are milled

    with design.ledger.entry(OF_MILLING):
        return plan_machining(design.discs)


def _remains(disc: Disc, flank: str) -> Remains | None:
    try:
        return Remains(disc.outline(flank))
    except GeometryError:
        return None


def _size(path: Path) -> float:
    from camgeo.geometry.outline.path import area  # only JSON shows areas

    return abs(area(path))


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


SEGMENT: Final[Keys] = {
    "span_deg": "Span of the cam angle.",
    "to": Key(
        "Position at its end, in mm, or in rad where the demanded motion turns; a dwell has none.",
        optional=True,
    ),
    "law": Key(
        "Law of the segment; a dwell and motion by data have none.",
        {
            "name": "Name of the law, as in scenes.",
            "task": 'Motion task, e.g. "R-R".',
            "parameters": "Parameters of the law, by name.",
        },
        optional=True,
    ),
    "report": Key(
        "For a lift table, the deviation of the motion from its rows.",
        {
            "largest_deviation": "Largest deviation, in the unit of `to`.",
        },
        optional=True,
    ),
}

JOINT: Final[Keys] = {
    "cam_angle_deg": "Cam angle of the joint.",
    "before": Key(
        "Class of the end of the segment before, as in motion tasks: R, U, ...", type=str
    ),
    "after": Key("Class of the start of the segment after.", type=str),
    "continuous_derivatives": Key(
        "Order of the highest derivative that is continuous, -1 (none) to 3.", of="order"
    ),
    "left": "Position and three derivatives by the cam angle in rad, before the joint.",
    "right": "Position and three derivatives by the cam angle in rad, after the joint.",
}

OUTLINE: Final[Keys] = {
    "area_mm2": "Area inside the outline.",
    "left_out_deg": Key("Ranges of the cam angle that it leaves out.", of="outline.dropped"),
    "corners": Key(
        "Corners of the outline.",
        {
            "point_mm": Key("x, y.", of="centre"),
            "from_deg": Key("Cam angle at which the outline before ends.", of="phi_start"),
            "to_deg": Key("Cam angle at which it continues.", of="phi_end"),
            "turn_deg": Key(
                "Angle by which the normal turns, counter-clockwise positive.", of="sweep"
            ),
        },
    ),
    "lobes_mm2": "Areas of the pieces that are cut off.",
}

CHANGE: Final[Keys] = {
    "key": "Path of the key in the scene.",
    "from": Key(
        "The present value, in the unit of the scene or in degrees, or the name of a law.",
        of="old_value",
    ),
    "to": Key("The other value.", of="new_value"),
}

CURE: Final[Keys] = {
    "fault": (
        'The fault that it removes: "undercut", "radius ratio", "transmission angle" or'
        ' "convexity".'
    ),
    "knob": (
        'The parameter that is changed: "base radius", "roller radius", "offset", "arm", "longer'
        ' segment" or "other law".'
    ),
    "key": "Path of its key in the scene; empty if no single key is at fault.",
    "from": Key("The present value, in `unit`, or the name of a law.", of="old_value"),
    "to": Key(
        "The nearest value that removes the fault and breaks no limit that holds, or else the"
        " nearest that removes it; null if there is none.",
        of="new_value",
    ),
    "unit": 'Unit of both: that of the scene for a length, "deg" or empty.',
    "cost": "Fraction of the present value by which it changes; null without a remedy.",
    "also": Key("The other keys that change with it.", CHANGE),
    "breaks": "Names of the findings on limits that hold now and that it breaks.",
    "sentence": "The remedy in words.",
}

BODY: Final[Keys] = {
    "volume_mm3": Key("Volume.", of="solid.volume"),
    "relative_error": Key(
        "Estimate of the relative error of volume and moment of inertia about the cam axis.",
        of="solid.share",
    ),
    "centre_mm": Key(
        "Centre of mass: x, y, z.", of="solid.centre", type=tuple[float, float, float]
    ),
    "density_kg_per_m3": Key(
        "Density stated by [effects.balance]; null without it, and then so are all that follow.",
        of="stated_density",
    ),
    "mass_kg": Key("Mass.", of="mass"),
    "axial_inertia_kg_mm2": Key("Moment of inertia about the cam axis.", of="axial_inertia"),
    "inertia_kg_mm2": Key(
        "Inertia tensor about the centre of mass, row by row: moments of inertia in the diagonal,"
        " products with a minus sign off it.",
        of="inertia",
        type=tuple[tuple[float, ...], ...] | None,
    ),
}

PART: Final = Key(
    "The exact part; coordinates are those of the cam, z upward and 0 on the upper face of the"
    " disc.",
    {
        "diameter_mm": (
            "Largest diameter, twice the distance of its farthest point from the cam axis; null if"
            " no such part can be made."
        ),
        "layers": Key(
            "Slices of constant section, from the lowest upward.",
            {
                "name": 'What it is for, e.g. "disc", "groove".',
                "z0_mm": "Height of its lower face.",
                "z1_mm": (
                    "Height of its upper face; that of the lower one where the scene states none."
                ),
                "area_mm2": Key("Area of the material.", of="area"),
            },
        ),
        "body": Key(
            "The part as a body of uniform density; null where the scene does not state its"
            " heights.",
            BODY,
        ),
        "findings": Key(
            "Diameter and mass compared with their limits; why there is no such part.", FINDING
        ),
    },
)

OPERATION: Final[Keys] = {
    "name": "Name of the operation.",
    "seconds": "Machining time of the operation.",
    "cutting": "Seconds at feed.",
    "traverses": "Seconds of traverses.",
    "blocks": "Number of blocks that the controller plans.",
    "slowed": "Share of the seconds at feed that exceeds length over feed.",
}

ENGAGEMENT: Final = Key(
    "Engagement of the cutter at the last depth of an operation, without the entries.",
    {
        "operation": "Name of the operation.",
        "air": "Share of the length in no material.",
        "usual_deg": "Angle that is not exceeded on 99.5 % of the length.",
        "largest_deg": "Largest angle.",
        "limit_deg": "Limit of the tool, or the angle at a straight wall with the stepover.",
    },
)

MILLED_PROGRAM: Final[Keys] = {
    "seconds": (
        "Machining time of the whole program; null if there is none, or if the dynamics of the"
        " machine are not known."
    ),
    "operations": Key("The operations, in their order; null where `seconds` is.", OPERATION),
    "findings": Key(
        "Findings on the sequence of operations and from its simulation; broken if the program"
        " must not be run, invalid if it cannot be planned.",
        FINDING,
    ),
    "faults": Key(
        "What is wrong in the scene, if there is no program.",
        {
            "key": "Path of the key or option, e.g. motion[2].span; empty for the file as a whole.",
            "value": "The given value as written; empty if there was none.",
            "message": "What is wrong, and what is allowed.",
            "hint": "A suggestion, or empty.",
            "line": "Line in the file, counted from 1; null where it is not known.",
        },
    ),
    "roughing": Key("Engagement of the cutter in the operations that clear an area.", ENGAGEMENT),
    "features": Key(
        "The part, feature by feature, with the operations of all its sides; empty of a second"
        " side, and where there is no program.",
        FEATURE,
    ),
}

MACHINING: Final[Keys] = {
    "machine": "Name of the controller.",
    "seconds": (
        "Machining time of all programs, excluding tool changes, dwells and halts; null if it is"
        " not known."
    ),
    "programs": Key(
        "The program of each disc, the main one first, named by the stem of its files; of a disc"
        " with a second side one of each.",
        MILLED_PROGRAM,
    ),
}

DOCUMENT: Final = Key(
    "The findings on a scene.",
    {
        "scene": SCENE,
        "segments": Key(
            "Segments of the motion, in the order of the scene, a rest of zero length too.",
            SEGMENT,
            of="scene.plan.segments",
        ),
        "joints": Key("Joints between the segments, by ascending cam angle.", JOINT),
        "findings": Key("All findings, good and bad, worst first.", FINDING),
        "discs": Key(
            "For each disc, the main one first, named by the stem of its files, the outline of"
            " each flank in use; null if nothing remains of it, or if that is not known. A scene"
            " without a follower has no discs.",
            OUTLINE,
        ),
        "cures": Key(
            "Remedies for undercut and a broken transmission angle or radius ratio: for each fault"
            " the cheapest first, then the parameters that cannot remove it.",
            CURE,
        ),
        "effects": Key(
            "Findings of the effects that the scene names, by name of the effect.", FINDING
        ),
        "parts": Key(
            "The part of each disc, the main one first, named by the stem of its files, and of a"
            " conjugate pair in one piece; empty if there is no disc.",
            PART,
        ),
        "machining": Key(
            "The milling programs, as their controller runs them; null if the scene states no"
            " milling, or not all that it needs, or if there is no disc.",
            MACHINING,
        ),
        "formats": Key(
            "What the scene lacks for the formats that it names, and for a milling program if it"
            " states any of what that needs; empty if nothing.",
            FINDING,
        ),
    },
    type=Check,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo check` in words.


LOST: Final = 0.01
"""Share of the cutting time lost below the programmed feed up to which it is not mentioned."""

CURES: Final = (
    "Each of these remedies removes the fault that it names; check again, including the effects:"
)


def text(answer: Check) -> str:
    """The findings, their remedies, and the findings on effects, parts, programs and formats."""
    lines = finding_lines(answer.findings)
    if answer.cures:
        lines += ["", CURES]
        lines += [f"  {cure.statement}" for cure in answer.cures]
    for name, findings in answer.effects.items():
        lines += ["", f"{name}:", *finding_lines(findings)]
    several = len(answer.parts) > 1
    for name, part in answer.parts.items():
        lines += ["", f"part of {name}:" if several else "part:", *_part(part)]
    if answer.machining is not None:
        lines += _machining_text(answer.machining)
    if answer.formats:
        lines += ["", "formats:", *finding_lines(answer.formats)]
    return "\n".join(lines)


def _part(part: PartAssessment) -> list[str]:
    """Size, mass and moments of inertia of a part."""
    lines = [f"section through the {layer.name} {layer.area:.6g} mm^2" for layer in part.layers]
    if part.body is not None:
        lines += _body(part.body)
    return [*finding_lines(part.findings), *(f"{'':8}{line}" for line in lines)]


def _body(body: PartBody) -> list[str]:
    centre = ", ".join(
        _coordinate_text(coordinate, body.solid.centre_error) for coordinate in body.solid.centre
    )
    lines = [f"volume {body.solid.volume:.6g} mm^3, centre of mass ({centre}) mm"]
    if body.axial_inertia is None or body.inertia is None:
        return [*lines, "no mass: the scene states no density"]
    moments = ", ".join(f"{moment:.6g}" for moment in body.inertia.diagonal())
    axial = f"moment of inertia about the cam axis {body.axial_inertia:.6g} kg mm^2"
    return [*lines, f"{axial}; about x, y, z through the centre of mass {moments} kg mm^2"]


def _coordinate_text(value: float, error: float) -> str:
    """A coordinate; one no larger than its error is 0."""
    return "0" if abs(value) <= error else f"{value:.6g}"


def _machining_text(machining: Machining) -> list[str]:
    """The findings on each program, and the time of each operation with the share that is lost."""
    lines: list[str] = []
    several = len(machining.programs) > 1
    for name, program in machining.programs.items():
        head = f"milling of {name}:" if several else "milling:"
        findings = finding_lines(program.findings)
        lines += ["", head, *findings] if findings else ["", f"{head} simulated, nothing found"]
        lines += [
            f"{'':8}{engagement.operation}: {engagement.sentence}"
            for engagement in program.roughing
        ]
    timed = {
        name: timed_program
        for name, timed_program in machining.programs.items()
        if timed_program.operations is not None
    }
    if not timed:
        return lines
    total = clock(math.fsum(timed_program.seconds or 0.0 for timed_program in timed.values()))
    lines += ["", f"machining on {machining.machine}: {total}, excluding tool changes"]
    for name, program in timed.items():
        times = program.operations or ()
        lines += [f"  {name}: {clock(program.seconds or 0.0)}"] if several else []
        width = max((len(operation.name) for operation in times), default=0)
        lead = "    " if several else "  "
        lines += [f"{lead}{operation.name:{width}}  {_time(operation)}" for operation in times]
    return lines


def _time(operation: OperationTime) -> str:
    slowed = (
        f", {100.0 * operation.slowed:.0f} % lost below the programmed feed"
        if operation.slowed > LOST
        else ""
    )
    rapid = (
        f", of which traverses {clock(operation.traverses)}" if operation.traverses >= 0.5 else ""
    )
    return f"{clock(operation.seconds):>8}{rapid}{slowed}"


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo check fixtures/scenes/setzhub.toml"


ARGUMENTS: Final = (SCENE_FILE,)


def run(arguments: argparse.Namespace) -> int:
    """Print the findings and the remedies."""
    return show(check(opened(arguments)), arguments)
