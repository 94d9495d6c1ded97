"""What a design answers to what is asked of it. Nothing else is computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding, forbidding
from camgeo.check.judge import (
    linkage_findings,
    motion_findings,
    transmission_angle_limit,
    worst,
)
from camgeo.errors import CamgeoError, EffectError, SceneError
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.product.quantities import Quantity, of_effect, quantities
from camgeo.product.value_table import bare
from camgeo.sweep.asked import DIAMETER, Asked, Group, hyphened
from camgeo.wording import shortened

if TYPE_CHECKING:
    from camgeo.design import Design

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
    if isinstance(found.value, float):
        if not math.isfinite(found.value):
            return Reading(None, found.unit, found.reason or "is infinite")
        return Reading(found.value + 0.0, found.unit, in_a_line(found.reason))  # no -0.0
    return found


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
    from camgeo.check.standstill import check_standstill
    from camgeo.check.transmission_angle import check_transmission_angle

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

    found = list(design.findings)
    if not any(finding.severity == "invalid" for finding in found):
        for name in design.scene.effects:
            found += design.effects.findings(name)
    if design.scene.follower is not None and not forbidding(design.findings):
        for disc in design.discs:
            found += findings_on(disc)
        if machining and design.scene.milling is not None:
            from camgeo.product.machining import machining_of

            found += machining_of(design.discs).findings
    return found


# Columns ------------------------------------------------------------------------------------------


def _curves(design: Design, asked: Asked) -> Reading:
    scene = design.scene
    cam = None if scene.follower is None else design.cam
    for heading, quantity in quantities(design.drive, scene.lift_unit, cam, scene.unit):
        if hyphened(bare(heading)) == asked.name:
            return _extreme(design, asked, heading, quantity)
    raise NoValueError(f'has no column "{asked.name}"')


def _effects(design: Design, asked: Asked) -> Reading:
    """The value of a finding of an effect, or the extreme of its column."""
    why = ""
    for name in asked.effects:
        try:
            result = design.effect(name)
        except EffectError as error:
            why = why or error.message
            if hyphened(error.finding or name) == asked.name and error.value is not None:
                return Reading(float(error.value), error.unit, error.message)
            continue
        if asked.how == "value":
            for finding in (*result.findings, *design.effects.findings(name)):
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
