"""Effect `lift-off`: where the follower leaves its flank, from which speed, and what prevents it.

In a groove, between two discs, or in a yoke: which side carries, where this changes, and the impact
after the clearance has been crossed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.contact import (
    FLANKS,
    TOUCH,
    holds_both_ways,
    lost_contact,
    runs,
    side_names,
)
from camgeo.dynamics.effects.effect import Bound, Request, Subject, build_data
from camgeo.dynamics.effects.lift_off.flank import Flank
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    INERTIA,
    SPRING,
    ContactForce,
    Flying,
    Inertia,
    LowRange,
    Spring,
)
from camgeo.dynamics.effects.wording import (
    at_angle,
    at_angles,
    by_place,
    degrees,
    placed,
    spring_scale,
)
from camgeo.errors import GeometryError
from camgeo.kinematics.time_course import TimeCourse, period
from camgeo.numeric.extremes import Extreme
from camgeo.units import RPM, TURN

if TYPE_CHECKING:
    from camgeo.dynamics.effects.lift_off.elastic_speed import ElasticSpeed
    from camgeo.dynamics.effects.lift_off.flight import Flight


NAME: Final = "lift-off"


@dataclass(frozen=True, slots=True)
class ContactMargin:
    """The contact force that must remain, the clearance of the roller, and how it rebounds.

    Attributes
    ----------
    margin : contact force that must remain [N].
    backlash : clearance of the roller in a groove or, between two discs, of the return roller along
        its normal [mm]; None for the side clearance in the scene.
    restitution : of an impact, speed after it by speed before it, 0 to 1.
    """

    margin: float = 0.0
    backlash: float | None = None
    restitution: float = 0.0


def compute(request: Request[Mapping[str, Any]]) -> ForceClosed | FormClosed:
    """Where contact is lost, or changes sides.

    Raises
    ------
    GeometryError
        If the scene gives a margin for a roller in a groove, which changes flanks in operation, a
        backlash for a roller on a single flank, or one that differs from the side clearance.
    """
    subject, data = request.subject, build_data(ContactMargin, request.data)
    contact = request.results[CONTACT_FORCE]
    inertia = request.results.get(INERTIA)
    if holds_both_ways(subject):
        if data.margin > 0.0:
            raise GeometryError(
                "a margin is for a follower on one flank; in a groove, in a yoke, or between two"
                " discs, the force changes sign",
                key=f"effects.{NAME}.margin",
                value=f"{data.margin:g}",
            )
        cam = subject.cam
        backlash = _backlash(data, cam.clearance)
        if cam.breadth is not None:
            backlash = cam.breadth.play(cam.yoke_breadth)
        return form_closed(subject, contact, inertia, backlash, data.restitution, request.tolerance)
    if data.backlash is not None:
        raise GeometryError(
            'a backlash is for a roller in a groove, contact = "groove", or between two discs',
            key=f"effects.{NAME}.backlash",
            value=f"{data.backlash:g}",
        )
    flank = Flank(subject, contact, subject.cam.contact.push, data.margin)
    closed = force_closed(flank, request.results.get(SPRING), request.near)
    if not contact.lost_contact:
        return closed
    from camgeo.dynamics.effects.lift_off.landing import (
        flank_flights,  # few followers leave the flank
    )

    report = flank_flights(flank, inertia, data.restitution, request.tolerance)
    return replace(
        closed,
        findings=(*closed.findings, *report.findings),
        flights=report.flights,
        flight_ranges=report.ranges,
        errors={**closed.errors, **report.errors},
    )


def _backlash(data: ContactMargin, side_clearance: float) -> float:
    """The clearance [mm] that the roller crosses.

    A groove as wide as the roller may still be given a backlash, e.g. for wear.
    """
    if data.backlash is None:
        return side_clearance
    if side_clearance > 0.0 and data.backlash != side_clearance:
        raise GeometryError(
            f"contradicts [follower] side_clearance, {side_clearance:g} mm: omit it or give the"
            " same value",
            key=f"effects.{NAME}.backlash",
            value=f"{data.backlash:g}",
        )
    return data.backlash


# -- force closed ---------------------------------------------------------------------------------
# A roller on one flank: where contact is lost, from which speed, and the spring that keeps it.


@dataclass(frozen=True, slots=True, eq=False)
class ForceClosed(Flying):
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
    lost: tuple[LowRange, ...]
    speed: Extreme | None
    preload: Extreme | None
    stiffness: Extreme | None
    flights: tuple[Flight, ...] = ()


def force_closed(
    flank: Flank, spring: Spring | None, near: ForceClosed | None = None
) -> ForceClosed:
    """The findings for `flank`, with the spring of the scene if it has one; `near` those of one
    that hardly differs.
    """
    edges, course = flank.contact.edges, flank.subject.state.course
    lowest, least = flank.lowest, TOUCH * flank.contact.extremes.magnitude
    if abs(lowest.value) <= least:
        lowest = Extreme(0.0, lowest.place)
    contact = flank.contact
    separation = lost_contact(
        flank.subject, contact.normal, contact.extremes, edges, contact.struck, flank.margin
    )
    lost, leaps = separation.ranges, separation.leaps
    findings = [_lost_finding(flank, place) for place in lost] + [
        _leap_finding(flank, place) for place in by_place(leaps)
    ]
    if not findings:
        findings.append(_holding_finding(flank, lowest))
    if not lost and flank.margin == 0.0 and lowest.value <= least:
        findings.append(_touching(lowest, flank.toucher))
    speed, errors = None, {}
    if course is not None:
        rigid = Extreme(0.0, leaps[0]) if leaps else flank.lift_off_speed(edges)
        speed = rigid
        if contact.behind is None or leaps:
            findings.append(_speed_finding(flank, rigid, course, bool(lost or leaps)))
        else:
            from camgeo.dynamics.effects.lift_off.elastic_speed import ElasticSpeed

            if near is not None and near.speed is None:  # so no more is known of this one
                searched = ElasticSpeed(why="nor was one found for a train that hardly differs")
            else:
                near_speed = None if near is None else near.speed
                searched = ElasticSpeed.searched(
                    flank, contact.behind, flank.base_edges, rigid.value, near_speed
                )
            speed = searched.speed
            findings.append(_elastic_speed_finding(flank, searched, rigid, course, bool(lost)))
            if speed is not None:
                mean = _mean(course)
                errors = {"lift-off-speed": Bound(searched.error * mean, speed.value * mean)}
    preload = stiffness = None
    if spring is not None:
        toucher, rate = flank.toucher, spring.stiffness
        preload, stiffness = flank.least_spring(spring, leaps)
        findings.append(
            _spring_finding(
                "preload", preload, spring.preload, spring.unit_of_preload, "stiffness", toucher
            )
        )
        findings.append(
            _spring_finding(
                "stiffness", stiffness, rate, spring.unit_of_stiffness, "preload", toucher
            )
        )
    return ForceClosed(
        lowest, lost, speed, preload, stiffness, findings=tuple(findings), errors=errors
    )


def _leaving_clause(flank: Flank) -> str:
    return f"leaves the {FLANKS[flank.sense]} flank"


def _shortfall_clause(flank: Flank) -> str:
    """What the follower does where less than the margin remains, as a clause."""
    if not flank.margin:
        return _leaving_clause(flank)
    return f"keeps less than {flank.margin:g} N on the {FLANKS[flank.sense]} flank"


def _lost_finding(flank: Flank, stretch: LowRange) -> Finding:
    low = stretch.lowest
    whole = stretch.end - stretch.start == TURN
    where = (
        "over the whole turn"
        if whole
        else f"from cam angle {degrees(stretch.start)} to {degrees(stretch.end)}"
    )
    lost = _leaving_clause(flank) if low.value < 0.0 else _shortfall_clause(flank)
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


def _leap_finding(flank: Flank, places: Sequence[float]) -> Finding:
    return Finding(
        name="lift-off",
        severity="broken",
        sentence=(
            f"the {flank.toucher} {_leaving_clause(flank)} {at_angles(places)}: the velocity jumps"
            " away from it, and no force can hold it at that instant"
        ),
        limit=flank.margin,
        unit="N",
        cam_angle=places[0],
    )


def _holding_finding(flank: Flank, low: Extreme) -> Finding:
    sentence = (
        f"the {flank.toucher} stays on the {FLANKS[flank.sense]} flank: smallest contact force"
        f" {low.value:.6g} N {at_angle(low.place)}, at least {flank.margin:g} N"
    )
    return placed("lift-off", sentence, low, "N", flank.margin)


def _touching(low: Extreme, what: str) -> Finding:
    sentence = (
        f"the contact force falls to 0 N {at_angle(low.place)} and not below: nothing holds the"
        f" {what} there"
    )
    return placed("contact-touches-zero", sentence, Extreme(0.0, low.place), "N", 0.0, "warning")


def _mean(course: TimeCourse) -> float:
    """The mean speed [rev/min] over a turn."""
    return TURN / period(course) / RPM


def _elastic_speed_finding(
    flank: Flank, search: ElasticSpeed, rigid: Extreme, course: TimeCourse, lost: bool
) -> Finding:
    """The lift-off speed with an elastic train, or how far it was searched for."""
    mean = _mean(course)
    if search.speed is not None:
        finding = _speed_finding(flank, search.speed, course, lost)
        there = "at no speed"
        if not math.isinf(rigid.value):
            there = f"at {rigid.value * mean:.6g} rev/min"
        return replace(finding, sentence=f"{finding.sentence}; with a rigid train {there}")
    until = f"the {flank.toucher} stays on its flank up to {search.safe_factor * mean:.6g} rev/min"
    if not search.why:
        return Finding(
            name="lift-off-speed",
            severity="ok",
            sentence=f"{until}, the highest speed searched",
            limit=mean,
            unit="rev/min",
        )
    known = f"{until}; beyond, " if search.safe_factor > 0.0 else ""
    return Finding(
        name="lift-off-speed",
        severity="warning",
        sentence=f"{known}no lift-off speed was found for the elastic train: {search.why}",
        limit=mean,
        unit="rev/min",
    )


def _speed_finding(flank: Flank, speed: Extreme, course: TimeCourse, lost: bool) -> Finding:
    """The lift-off speed compared with the speed of the scene, both as means over a turn."""
    mean = _mean(course)
    if math.isinf(speed.value):
        massless = flank.contact.struck is None
        why = ", as the scene states no mass that its speed could throw off" if massless else ""
        return Finding(
            name="lift-off-speed",
            severity="ok",
            sentence=(
                f"there is no speed at which the {flank.toucher} {_shortfall_clause(flank)}{why}"
            ),
            limit=None if massless else mean,
            unit="rev/min",
        )
    value = speed.value * mean
    if value == 0.0:
        sentence = f"the {flank.toucher} {_shortfall_clause(flank)} at any speed,"
    else:
        sentence = f"the {flank.toucher} first {_shortfall_clause(flank)} at {value:.6g} rev/min,"
    early = speed.value <= 1.0
    tail = f"; the cam turns at {mean:.6g} rev/min"
    if early and not lost:
        tail += ", above a range of speeds in which contact is lost"
    return placed(
        "lift-off-speed",
        f"{sentence} {at_angle(speed.place)}{tail}",
        Extreme(value, speed.place),
        "rev/min",
        mean,
        "broken" if lost else "warning" if early else "ok",
    )


def _spring_finding(
    what: str, least: Extreme, now: float, unit: str, other: str, kept: str
) -> Finding:
    scale = spring_scale(unit)
    stated = scale * now
    if math.isinf(least.value):
        return Finding(
            name=f"least-{what}",
            severity="warning",
            sentence=(
                f"no {what} of the spring keeps the {kept} on its flank {at_angle(least.place)}"
                f" with the given {other}"
            ),
            limit=stated,
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
            f" {at_angle(least.place)}; it has {stated:.6g} {unit}"
            if value > 0.0
            else f"the {kept} stays on its flank even without {what} of the spring; it has"
            f" {stated:.6g} {unit}"
        ),
        value=value,
        limit=stated,
        unit=unit,
        cam_angle=least.place if value > 0.0 else None,
    )


# -- form closed ----------------------------------------------------------------------------------
# A follower held in both directions: where the contact changes sides, and its flights between.


@dataclass(frozen=True, slots=True, eq=False)
class FormClosed(Flying):
    """The contact of a roller in a groove, or of a follower between two discs or in a yoke.

    Attributes
    ----------
    first : side that carries first in the turn, +1 inner, -1 outer or return, 0 if none does.
    changes : changes of side.
    flights : across the clearance, with their rebounds, as far as they can be computed.
    """

    first: int
    changes: tuple[Change, ...]
    flights: tuple[Flight, ...]


def form_closed(
    subject: Subject,
    contact: ContactForce,
    inertia: Inertia | None,
    backlash: float,
    restitution: float,
    tolerance: float,
) -> FormClosed:
    """The findings for a groove, pair or yoke; impact speeds to the relative `tolerance`."""
    who, (names, noun) = "roller" if subject.returning is None else "follower", side_names(subject)
    first, changes = flank_changes(contact)
    findings = [_change_finding(change, who, names, noun) for change in changes]
    if not changes:
        steady = f"there is no force on either {noun}"
        if first:
            steady = f"the {names[first]} {noun} carries over the whole turn"
        findings.append(Finding("flank-change", "ok", steady, 0.0))
    if not changes or backlash == 0.0:
        return FormClosed(first, changes, (), findings=tuple(findings))
    from camgeo.dynamics.effects.lift_off.landing import (
        clearance_flights,  # many grooves are stated without play
    )

    report = clearance_flights(subject, contact, inertia, backlash, restitution, tolerance)
    return FormClosed(
        first,
        changes,
        report.flights,
        findings=(*findings, *report.findings),
        flight_ranges=report.ranges,
        errors=report.errors,
    )


def _change_finding(change: Change, who: str, names: Mapping[int, str], noun: str) -> Finding:
    """The finding that the roller or follower, `who`, changes sides, each of which is a `noun`."""
    free = change.leaving != change.carrying
    until = f", with no force on either until {degrees(change.carrying)}" if free else ""
    return Finding(
        name="flank-change",
        severity="ok",
        sentence=(
            f"at cam angle {degrees(change.leaving)} the {who} moves from the"
            f" {names[change.sense]} to the {names[-change.sense]} {noun}{until}"
        ),
        cam_angle=change.leaving,
        cam_range=(change.leaving, change.carrying) if free else None,
    )


# -- crossing -------------------------------------------------------------------------------------
# Where the roller of a groove changes flanks, or the follower of a pair its disc.


@dataclass(frozen=True, slots=True)
class Change:
    """The roller leaves one flank for the other.

    Attributes
    ----------
    leaving : cam angle [rad] in [0, 2 pi) up to which the first flank carries.
    carrying : from which the other one does; the same unless there is a range without force.
    sense : of the flank left behind, +1 for the inner one, -1 for the outer one.
    """

    leaving: float
    carrying: float
    sense: int


def flank_changes(contact: ContactForce) -> tuple[int, tuple[Change, ...]]:
    """The flank that carries first, 0 if none does, and the changes over a turn.

    `contact.edges` has all angles at which the force changes sign. Ranges without force belong to
    no flank.
    """
    edges = contact.edges
    # The force keeps its sign between edges, so that in the middle is that of the piece.
    sign = np.sign(contact.normal(0.5 * (edges[:-1] + edges[1:]), "right")).astype(int)
    both = [(pieces, sense) for sense in (1, -1) for pieces in runs(sign == sense)]
    if not both:
        return 0, ()
    both.sort(key=lambda run: run[0][0])
    changes = []
    for (pieces, sense), (others, other) in zip(both, both[1:] + both[:1], strict=True):
        if sense != other:
            leaving, carrying = edges[pieces[-1] + 1], edges[others[0]]
            changes.append(Change(float(leaving % edges[-1]), float(carrying), sense))
    changes.sort(key=lambda change: change.leaving)
    return both[0][1], tuple(changes)
