"""What a design answers to what is asked of it. Nothing else is computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.cam.disc import Disc
from camgeo.cam.drive import Drive
from camgeo.cam.together import discs_together, drives_together
from camgeo.check.finding import Finding, forbidding
from camgeo.check.judge import (
    linkage_findings,
    motion_findings,
    transmission_angle_limit,
    worst,
)
from camgeo.check.standstill import check_standstill
from camgeo.check.transmission_angle import (
    check_transmission_angle,
    transmission_angle_extremes,
)
from camgeo.curve.pieces import turn_enclosed
from camgeo.curve.together import Member, Together
from camgeo.errors import CamgeoError, EffectError, SceneError
from camgeo.mechanism.several import alike
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extremes, extremes_of_each, piecewise_extremes
from camgeo.numeric.many import Quantity
from camgeo.product.quantities import (
    Columns,
    of_effect,
    quantities_of_disc,
    quantities_of_drive,
)
from camgeo.product.value_table import bare
from camgeo.sweep.asked import DIAMETER, Asked, Group, hyphened
from camgeo.units import LengthUnit
from camgeo.wording import shortened

if TYPE_CHECKING:
    from camgeo.design import Design
    from camgeo.scene.scene import Scene

LONGEST_REASON: Final = 400
"""Characters of a reason; what a scene with many faults says beyond is left out."""


class NoValueError(Exception):
    """A design has no answer; the message is the reason, empty if none was to be expected."""


@dataclass(frozen=True, slots=True)
class Reading:
    """The answer of a design: a number in `unit`, or a word; None if there is none, perhaps with
    the reason.
    """

    value: float | str | None
    unit: str = ""
    reason: str = ""


def read(design: Design, asked: Asked) -> Reading:
    """What the design answers. Every error except MemoryError becomes a reason."""
    try:
        found = ANSWERS[asked.group](design, asked)
    except NoValueError as none:
        return Reading(None, reason=in_a_line(str(none)))
    except MemoryError:
        raise  # which is not the design's fault
    except Exception as error:
        return Reading(None, reason=reason_of(error))
    return _settled(found)


def _settled(found: Reading) -> Reading:
    """The same, if it is finite."""
    if isinstance(found.value, float):
        if not math.isfinite(found.value):
            return Reading(None, found.unit, found.reason or "is infinite")
        return Reading(found.value + 0.0, found.unit, in_a_line(found.reason))  # no -0.0
    return found


def read_each(designs: Sequence[Design], asked: Asked) -> list[Reading]:
    """What each of the designs answers, with the same bits as `read`: those that are alike at once.

    Where that fails, one of them has no answer: halves are tried, down to a design alone.
    """
    if len(designs) == 1:
        return [read(designs[0], asked)]
    try:
        found = TOGETHER[asked.group](designs, asked)
    except MemoryError:
        raise  # which is not the designs' fault
    except Exception:
        half = len(designs) // 2
        return read_each(designs[:half], asked) + read_each(designs[half:], asked)
    return [_settled(each) for each in found]


def alike_designs(design: Design) -> Hashable:
    """Equal for designs that differ in numbers of follower and linkage only, and in what nothing
    that is `TOGETHER` depends on.
    """
    scene = design.scene
    drive = id(scene.plan), scene.speed, id(scene.speed_curve)
    units = scene.unit, scene.lift_unit
    disc = scene.rotation, scene.contact, scene.side_clearance
    bodies = (None if body is None else alike(body) for body in (scene.linkage, scene.follower))
    return drive, units, disc, *bodies


def reason_of(error: Exception) -> str:
    """Why there is no design or no answer, in one line."""
    if isinstance(error, SceneError):
        return in_a_line("; ".join(str(fault) for fault in error.faults))
    if isinstance(error, CamgeoError):
        return in_a_line(str(error))
    return in_a_line(f"internal error: {type(error).__name__}: {error}")


def in_a_line(text: str) -> str:
    """The text in one line that is not too long."""
    return shortened(" ".join(text.split()), LONGEST_REASON)


# Findings -----------------------------------------------------------------------------------------


def _of(findings: Iterable[Finding], name: str, why: Callable[[], str] = str) -> Reading:
    """The value of the first finding of that name; NoValueError with `why` if there is none."""
    for finding in findings:
        if hyphened(finding.name) == name:
            value = finding.value
            return Reading(None if value is None else float(value), finding.unit)
    raise NoValueError(why())


def _refused(findings: Iterable[Finding]) -> str:
    """What rules out the disc, if anything does."""
    return "; ".join(finding.sentence for finding in forbidding(findings))


def _angle(design: Design, asked: Asked) -> Reading:
    """The transmission angle alone, as the findings have it."""
    cam, limits = design.cam, design.scene.limits
    if not cam.follower.has_pitch_curve:  # of an undercut flat face there is none
        return _disc(design, asked)
    before = linkage_findings(cam.drive, limits)
    if not forbidding(before):
        curve = cam.disc.pitch_curve
        before = check_standstill(curve)
        if not forbidding(before):
            found = check_transmission_angle(curve, transmission_angle_limit(cam, limits))
            return _of([found], asked.name)
    raise NoValueError(_refused(before))


def _angles(designs: Sequence[Design], asked: Asked) -> list[Reading]:
    """The same for designs that are alike: what the answer takes is computed for all at once."""
    if designs[0].cam.follower.has_pitch_curve:
        curves = [design.cam.disc.pitch_curve for design in designs]
        turn_enclosed.settle(curves)
        transmission_angle_extremes.settle(curves)
    return [read(design, asked) for design in designs]


def _linkage(design: Design, asked: Asked) -> Reading:
    scene = design.scene
    found = linkage_findings(design.drive, scene.limits)
    return _of(found, asked.name, lambda: "" if found else "the scene has no [linkage]")


def _motion(design: Design, asked: Asked) -> Reading:
    return _of(motion_findings(design.drive), asked.name)


def _disc(design: Design, asked: Asked) -> Reading:
    return _of(design.findings, asked.name, lambda: _refused(design.findings))


def _part(design: Design, asked: Asked) -> Reading:
    from camgeo.part.mass import largest_diameter, solid
    from camgeo.product.judged_part import Body, findings_on

    scene = design.scene
    if asked.name == DIAMETER:
        return Reading(largest_diameter(design.disc.drawn.part)[0], "mm")
    if scene.part is None:
        raise NoValueError("the scene has no [part]")
    if asked.name == "mass":
        mass = Body(solid(design.disc.drawn.part), scene.part.density).mass
        if mass is None:
            raise NoValueError("the scene states neither material nor density of the part")
        return Reading(mass, "kg")
    return _of(findings_on(design.disc), asked.name, lambda: _refused(design.findings))


def _verdict(design: Design, _: Asked) -> Reading:
    return Reading(worst(judged(design)))


def _machining(design: Design, _: Asked) -> Reading:
    from camgeo.product.machining import machining_time  # few are asked for it

    if forbidding(design.findings):
        raise NoValueError(_refused(design.findings))
    return Reading(machining_time(design.discs), "s")


def judged(design: Design, *, machining: bool = False) -> list[Finding]:
    """All findings on cam, effects and part, as far as there are such; with `machining` also those
    on the milling programs.
    """
    from camgeo.product.judged_part import findings_on
    from camgeo.product.product import with_pair

    found = list(design.findings)
    if not any(finding.severity == "invalid" for finding in found):
        for name in design.scene.effects:
            found += design.effects.findings(name)
    if design.scene.follower is not None and not forbidding(design.findings):
        for disc in with_pair(design.discs):
            found += findings_on(disc)
        if machining and design.scene.milling is not None:
            from camgeo.product.machining import machining_of

            found += machining_of(design.discs).findings
    return found


# Columns ------------------------------------------------------------------------------------------


def _curves(design: Design, asked: Asked) -> Reading:
    return _curves_of_each([design], asked)[0]


def _curves_of_each(designs: Sequence[Design], asked: Asked) -> list[Reading]:
    """The extreme of a column for designs that are alike."""
    first = designs[0]
    drive, scene = first.drive, first.scene
    for place, (heading, quantity) in enumerate(_of_drive(scene, drive)):
        if hyphened(bare(heading)) == asked.name:
            if all(design.drive.motion is drive.motion for design in designs):
                return [_extreme(first, asked, heading, quantity)] * len(designs)
            of_drive = partial(_quantity_of_drive, place, scene)
            found = _extremes_of_each(designs, _drives, of_drive)
            return [_read(each, asked, heading) for each in found]
    if scene.follower is not None:
        disc = first.cam.disc
        for place, (heading, _) in enumerate(quantities_of_disc(disc, scene.unit)):
            if hyphened(bare(heading)) == asked.name:
                of_disc = partial(_quantity_of_disc, place, scene.unit)
                found = _extremes_of_each(designs, _discs, of_disc)
                return [_read(each, asked, heading) for each in found]
    raise NoValueError(f'has no column "{asked.name}"')


def _of_drive(scene: Scene, drive: Drive) -> Columns:
    return quantities_of_drive(drive, scene.lift_unit, scene.unit)


def _quantity_of_drive(place: int, scene: Scene, drive: Drive) -> Quantity:
    return _of_drive(scene, drive)[place][1]


def _quantity_of_disc(place: int, unit: LengthUnit, disc: Disc) -> Quantity:
    return quantities_of_disc(disc, unit)[place][1]


def _drives(designs: Sequence[Design]) -> Together[Drive]:
    return drives_together([design.drive for design in designs])


def _discs(designs: Sequence[Design]) -> Together[Disc]:
    return discs_together([design.cam.disc for design in designs])


def _extremes_of_each(
    designs: Sequence[Design],
    together: Callable[[Sequence[Design]], Together[Member]],
    quantity: Callable[[Member], Quantity],
) -> list[Extremes]:
    """The extremes of a quantity for designs that are alike, at once for those of them whose motion
    is smooth between the same angles.
    """
    groups: dict[bytes, list[int]] = {}
    for number, design in enumerate(designs):
        groups.setdefault(design.drive.smooth_angles.tobytes(), []).append(number)
    found: dict[int, Extremes] = {}
    for numbers in groups.values():
        some = [designs[number] for number in numbers]
        with np.errstate(all="ignore"):  # a value that is not finite has a reason
            each = extremes_of_each(together(some), quantity, some[0].drive.smooth_angles)
        found |= zip(numbers, each, strict=True)
    return [found[number] for number in range(len(designs))]


def _effects(design: Design, asked: Asked) -> Reading:
    """The value of a finding of an effect, or the extreme of its column."""
    why = ""
    for name in asked.effects:
        try:
            result = design.effect(name)
        except EffectError as error:
            why = why or error.message
            for finding in design.effects.findings(name):
                if hyphened(finding.name) == asked.name and finding.value is not None:
                    return Reading(float(finding.value), finding.unit, error.message)
            continue
        if asked.how == "value":
            for finding in result.findings:
                if hyphened(finding.name) == asked.name:
                    return _of([finding], asked.name)
            continue
        for column in result.columns:
            if hyphened(column.name) == asked.name:
                heading, quantity = of_effect(design.scene.unit, column)
                return _extreme(design, asked, heading, quantity, column.borders)
    if not why and asked.how != "value":
        why = f'has no column "{asked.name}"'
    raise NoValueError(why)


def _extreme(
    design: Design,
    asked: Asked,
    heading: str,
    quantity: Quantity,
    borders: FloatArray | None = None,
) -> Reading:
    edges = design.drive.smooth_angles
    if borders is not None and len(borders):
        edges = merged(np.concatenate((edges, borders)))
    with np.errstate(all="ignore"):  # a value that is not finite has a reason
        found = piecewise_extremes(quantity, edges)
    return _read(found, asked, heading)


def _read(found: Extremes, asked: Asked, heading: str) -> Reading:
    unit = heading.rpartition(" [")[2].removesuffix("]") if heading.endswith("]") else ""
    return Reading(EXTREME[asked.how](found), unit)


EXTREME: Final[dict[str, Callable[[Extremes], float]]] = {
    "min": lambda found: found.lowest.value,
    "max": lambda found: found.highest.value,
    "peak": lambda found: found.magnitude,
}

ANSWERS: Final[dict[Group, Callable[[Design, Asked], Reading]]] = {
    "angle": _angle,
    "linkage": _linkage,
    "motion": _motion,
    "part": _part,
    "disc": _disc,
    "verdict": _verdict,
    "machining": _machining,
    "curves": _curves,
    "effects": _effects,
}

TOGETHER: Final[dict[Group, Callable[[Sequence[Design], Asked], list[Reading]]]] = {
    "angle": _angles,
    "curves": _curves_of_each,
}
"""What is answered for many designs at once, if these are alike."""
