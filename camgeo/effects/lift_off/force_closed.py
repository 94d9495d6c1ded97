"""A roller on one flank: where contact is lost, from which speed, and the spring that keeps it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.holding import least_spring, scale_of
from camgeo.effects.lift_off.sizing import lift_off_speed
from camgeo.effects.lost_contact import Range
from camgeo.effects.results import Leaving, Spring
from camgeo.effects.touching import FLANKS, TOUCH, lost_contact
from camgeo.effects.wording import angles, at, by_place, degrees, placed
from camgeo.motion.time_course import TimeCourse, period
from camgeo.numeric.extremes import Extreme
from camgeo.units import RPM, TURN

if TYPE_CHECKING:
    from camgeo.effects.lift_off.elastic_speed import ElasticSpeed
    from camgeo.effects.lift_off.flown import Flight


@dataclass(frozen=True, slots=True, eq=False)
class ForceClosed(Leaving):
    """The contact of a roller on one flank.

    Attributes
    ----------
    lowest : smallest force [N] on the flank.
    lost : ranges where it is below the margin.
    speed : at which this first happens, as a factor of the speed in the scene; infinite if it never
        happens; None if the scene gives no speed, or if none was found for an elastic train.
    preload, stiffness : least values [N, N/mm or N mm, N mm/rad]; infinite if no value is enough;
        None without a spring.
    flights : off the flank, with their rebounds, as far as they can be computed.
    """

    lowest: Extreme
    lost: tuple[Range, ...]
    speed: Extreme | None
    preload: Extreme | None
    stiffness: Extreme | None
    flights: tuple[Flight, ...] = ()


def of_flank(flank: Flank, spring: Spring | None, near: ForceClosed | None = None) -> ForceClosed:
    """The findings for `flank`, with the spring of the scene if it has one; `near` those of one
    that hardly differs.
    """
    edges, course = flank.contact.edges, flank.subject.state.course
    lowest, least = flank.lowest, TOUCH * flank.contact.extremes.magnitude
    if abs(lowest.value) <= least:
        lowest = Extreme(0.0, lowest.place)
    contact = flank.contact
    off = lost_contact(
        flank.subject, contact.normal, contact.extremes, edges, contact.struck, flank.margin
    )
    lost, leaps = off.ranges, off.leaps
    found = [_lost(flank, each) for each in lost] + [_leap(flank, each) for each in by_place(leaps)]
    if not found:
        found.append(_kept(flank, lowest))
    if not lost and flank.margin == 0.0 and lowest.value <= least:
        found.append(_touching(lowest, flank.toucher))
    speed, errors = None, {}
    if course is not None:
        rigid = Extreme(0.0, leaps[0]) if leaps else lift_off_speed(flank, edges)
        speed = rigid
        if contact.behind is None or leaps:
            found.append(_speed(flank, rigid, course, bool(lost or leaps)))
        else:
            from camgeo.effects.lift_off.elastic_speed import (
                ElasticSpeed,
                elastic_speed,  # few trains are elastic
            )

            if near is not None and near.speed is None:  # so no more is known of this one
                searched = ElasticSpeed(why="nor is one given for a train that hardly differs")
            else:
                beside = None if near is None else near.speed
                searched = elastic_speed(
                    flank, contact.behind, flank.base_edges, rigid.value, beside
                )
            speed = searched.speed
            found.append(_elastic(flank, searched, rigid, course, bool(lost)))
            if speed is not None:
                mean = _mean(course)
                errors = {"lift-off-speed": Bound(searched.error * mean, speed.value * mean)}
    preload = stiffness = None
    if spring is not None:
        kept, rate = flank.toucher, spring.stiffness
        preload, stiffness = least_spring(flank, spring, leaps)
        found.append(
            _least("preload", preload, spring.preload, spring.unit_of_preload, "stiffness", kept)
        )
        found.append(
            _least("stiffness", stiffness, rate, spring.unit_of_stiffness, "preload", kept)
        )
    return ForceClosed(
        lowest, lost, speed, preload, stiffness, findings=tuple(found), errors=errors
    )


def _leaves(flank: Flank) -> str:
    return f"leaves the {FLANKS[flank.sense]} flank"


def _short(flank: Flank) -> str:
    """What the roller does where less than the margin remains."""
    if not flank.margin:
        return _leaves(flank)
    return f"keeps less than {flank.margin:g} N on the {FLANKS[flank.sense]} flank"


def _lost(flank: Flank, stretch: Range) -> Finding:
    low = stretch.lowest
    whole = stretch.end - stretch.start == TURN
    where = (
        "over the whole turn"
        if whole
        else f"from cam angle {degrees(stretch.start)} to {degrees(stretch.end)}"
    )
    lost = _leaves(flank) if low.value < 0.0 else _short(flank)
    return Finding(
        name="lift-off",
        severity="broken",
        sentence=(
            f"the {flank.toucher} {lost} {where}: the contact force falls to"
            f" {low.value:.6g} N at {degrees(low.place)}"
        ),
        value=low.value,
        limit=flank.margin,
        unit="N",
        cam_angle=low.place,
        cam_range=(stretch.start, stretch.end if whole else stretch.end % TURN),
    )


def _leap(flank: Flank, places: Sequence[float]) -> Finding:
    return Finding(
        name="lift-off",
        severity="broken",
        sentence=(
            f"the {flank.toucher} {_leaves(flank)} {angles(places)}: the velocity jumps away from"
            " it, and no force can hold it at that instant"
        ),
        limit=flank.margin,
        unit="N",
        cam_angle=places[0],
    )


def _kept(flank: Flank, low: Extreme) -> Finding:
    sentence = (
        f"the {flank.toucher} stays on the {FLANKS[flank.sense]} flank: smallest contact force"
        f" {low.value:.6g} N {at(low.place)}, at least {flank.margin:g} N"
    )
    return placed("lift-off", sentence, low, "N", flank.margin)


def _touching(low: Extreme, what: str) -> Finding:
    sentence = (
        f"the contact force falls to 0 N {at(low.place)} and not below: nothing holds the {what}"
        " there"
    )
    return placed("contact-touches-zero", sentence, Extreme(0.0, low.place), "N", 0.0, "warning")


def _mean(course: TimeCourse) -> float:
    """The mean speed [rev/min] over a turn."""
    return TURN / period(course) / RPM


def _elastic(
    flank: Flank, found: ElasticSpeed, rigid: Extreme, course: TimeCourse, lost: bool
) -> Finding:
    """The lift-off speed with an elastic train, or how far it was searched for."""
    mean = _mean(course)
    if found.speed is not None:
        own = _speed(flank, found.speed, course, lost)
        there = "at no speed"
        if not math.isinf(rigid.value):
            there = f"at {rigid.value * mean:.6g} rev/min"
        return replace(own, sentence=f"{own.sentence}; with a rigid train {there}")
    until = f"the {flank.toucher} keeps its flank up to {found.kept * mean:.6g} rev/min"
    if not found.why:
        return Finding(
            name="lift-off-speed",
            severity="ok",
            sentence=f"{until}, the highest speed searched",
            limit=mean,
            unit="rev/min",
        )
    known = f"{until}; beyond, " if found.kept > 0.0 else ""
    return Finding(
        name="lift-off-speed",
        severity="warning",
        sentence=f"{known}no lift-off speed is given for the elastic train: {found.why}",
        limit=mean,
        unit="rev/min",
    )


def _speed(flank: Flank, found: Extreme, course: TimeCourse, lost: bool) -> Finding:
    """The lift-off speed compared with the speed of the scene, both as means over a turn."""
    mean = _mean(course)
    if math.isinf(found.value):
        massless = flank.contact.struck is None
        why = ", as the scene states no mass that its speed could throw off" if massless else ""
        return Finding(
            name="lift-off-speed",
            severity="ok",
            sentence=f"there is no speed at which the {flank.toucher} {_short(flank)}{why}",
            limit=None if massless else mean,
            unit="rev/min",
        )
    value = found.value * mean
    if value == 0.0:
        sentence = f"the {flank.toucher} {_short(flank)} at any speed,"
    else:
        sentence = f"the {flank.toucher} first {_short(flank)} at {value:.6g} rev/min,"
    early = found.value <= 1.0
    tail = f"; the cam turns at {mean:.6g} rev/min"
    if early and not lost:
        tail += ", above a range of speeds in which contact is lost"
    return placed(
        "lift-off-speed",
        f"{sentence} {at(found.place)}{tail}",
        Extreme(value, found.place),
        "rev/min",
        mean,
        "broken" if lost else "warning" if early else "ok",
    )


def _least(what: str, least: Extreme, now: float, unit: str, other: str, kept: str) -> Finding:
    scale = scale_of(unit)
    given = scale * now
    if math.isinf(least.value):
        return Finding(
            name=f"least-{what}",
            severity="warning",
            sentence=(
                f"no {what} of the spring keeps the {kept} on its flank {at(least.place)} with the"
                f" given {other}"
            ),
            limit=given,
            unit=unit,
            cam_angle=least.place,
        )
    value = scale * least.value
    short = least.value > now + TOUCH * max(abs(now), abs(least.value))
    return Finding(
        name=f"least-{what}",
        severity="broken" if short else "ok",
        sentence=(
            f"least {what} of the spring {value:.6g} {unit}, needed"
            f" {at(least.place)}; it has {given:.6g} {unit}"
            if value > 0.0
            else f"the {kept} stays on its flank even without {what} of the spring; it has"
            f" {given:.6g} {unit}"
        ),
        value=value,
        limit=given,
        unit=unit,
        cam_angle=least.place if value > 0.0 else None,
    )
