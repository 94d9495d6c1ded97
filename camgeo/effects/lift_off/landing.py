"""Findings on the flights of a follower that leaves its only flank."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from camgeo.check.finding import STATED, Finding
from camgeo.effects.effect import Bound
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.flight import MOST_REBOUNDS, Flight, FreeFollower
from camgeo.effects.results import Inertia
from camgeo.effects.touching import FLANKS
from camgeo.effects.wording import at, between, degrees, placed
from camgeo.errors import EffectError
from camgeo.numeric.extremes import Extreme, piecewise_lowest
from camgeo.units import TURN
from camgeo.wording import listed


@dataclass(frozen=True, slots=True)
class Flown:
    """The flights with their findings and the errors of these."""

    flights: tuple[Flight, ...] = ()
    findings: tuple[Finding, ...] = ()
    errors: Mapping[str, Bound] = field(default_factory=dict)

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Over which the follower is off the flank, with flights that follow at once as one."""
        found: list[tuple[float, float]] = []
        for each in self.flights:
            if found and found[-1][1] == each.leaving:
                found[-1] = (found[-1][0], each.landing)
            else:
                found.append((each.leaving, each.landing))
        return tuple(found)


def flown_from(
    flank: Flank, inertia: Inertia | None, restitution: float, tolerance: float
) -> Flown:
    """The flights from `flank`, which the follower leaves, at the speed of the scene; none, as a
    finding says, if they cannot be computed to the `tolerance`.
    """
    why = _why_not(flank, inertia)
    course = flank.subject.state.course
    if why or inertia is None or course is None:
        return _none(why)
    free = FreeFollower(flank.subject, flank.contact, inertia, course, flank.sense)
    found: list[Finding] = []
    flights: list[Flight] = []
    try:
        flown = free.flights(flank.contact.lost_contact, restitution, tolerance)
    except EffectError as error:
        return _none(error.message)
    for each in flown:
        if isinstance(each, float):
            found.append(_endless(flank, each))
        else:
            flights.append(each)
            found += _finding(flank, each)
    if not flights:
        return Flown(findings=tuple(found))
    fastest = max(flights, key=lambda flight: flight.speed)
    farthest = max(flights, key=lambda flight: flight.gap)
    tail = ""
    if restitution > 0.0 and len(flights) > MOST_REBOUNDS:
        tail = f"; of each flight {MOST_REBOUNDS} rebounds are followed"
    end = Extreme(fastest.speed, fastest.landing % TURN)
    sentence = f"the {flank.toucher} lands at up to {fastest.speed:.6g} mm/s, {at(end.place)}{tail}"
    found.append(placed("largest-impact-speed", sentence, end, "mm/s", severity="warning"))
    hits = Bound(max(each.error * each.speed for each in flights), fastest.speed)
    factor, _ = STATED[flank.subject.cam.lift_unit]
    gaps = Bound(max(each.error * each.gap for each in flights), farthest.gap).times(factor)
    speeds = dict.fromkeys(("impact-speed", "largest-impact-speed"), hits)
    return Flown(tuple(flights), tuple(found), {"flight": gaps, **speeds})


def _none(why: str) -> Flown:
    return Flown(findings=(Finding("flight", "warning", f"no landing is given: {why}"),))


def _why_not(flank: Flank, inertia: Inertia | None) -> str:
    """Why no landing can be given; empty if it can."""
    subject, contact = flank.subject, flank.contact
    if inertia is None:
        return "it needs [effects.inertia]"
    if subject.drive.linkage is not None:
        return "behind a linkage the free motion is not computed"
    if not piecewise_lowest(inertia.to_follower, contact.edges).value > 0.0:
        return "the follower has no mass"
    if any(each.end - each.start == TURN for each in contact.lost_contact.ranges):
        return f"the {flank.toucher} is off the cam over the whole turn"
    if contact.behind is not None:
        return (
            'the free motion of an elastic train is not computed; [state] output = "rigid" gives'
            " that of a rigid one"
        )
    unknown = [
        each.name for each in contact.forces if each.off is None and each is not inertia.force
    ]
    return f"{listed(unknown)} off the cam is not known" if unknown else ""


def _finding(flank: Flank, flight: Flight) -> tuple[Finding, Finding]:
    """How long and how far it flies, and how it lands."""
    start, end = flight.leaving % TURN, flight.landing % TURN
    factor, unit = STATED[flank.subject.cam.lift_unit]
    gap = factor * flight.gap
    who, side = flank.toucher, f"the {FLANKS[flank.sense]} flank"
    again = "rebounds from" if flight.rebound else "is off"
    return (
        Finding(
            name="flight",
            severity="warning",
            sentence=(
                f"the {who} {again} {side} {between((flight.leaving, flight.landing))}, up to"
                f" {gap:.6g} {unit} of lift beyond it"
            ),
            value=gap,
            limit=0.0,
            unit=unit,
            cam_angle=start,
            cam_range=(start, end),
        ),
        Finding(
            name="impact-speed",
            severity="ok",
            sentence=f"it lands {at(end)}, at {flight.speed:.6g} mm/s",
            value=flight.speed,
            unit="mm/s",
            cam_angle=end,
        ),
    )


def _endless(flank: Flank, leaving: float) -> Finding:
    return Finding(
        name="flight",
        severity="warning",
        sentence=(
            f"no landing is given for the flight from cam angle {degrees(leaving % TURN)} on: the"
            f" {flank.toucher} is still off the {FLANKS[flank.sense]} flank where the next turn's"
            " first flight begins"
        ),
        cam_angle=leaving % TURN,
    )
