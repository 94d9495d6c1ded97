"""Findings on the flights of a follower: from its only flank, or across its clearance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Final

import numpy as np

from camgeo.check.finding import STATED, Finding
from camgeo.dynamics.effects.contact import FLANKS, holds_both_ways, side_names
from camgeo.dynamics.effects.effect import Bound, Subject
from camgeo.dynamics.effects.lift_off.flank import Flank
from camgeo.dynamics.effects.lift_off.flight import (
    MOST_REBOUNDS,
    ElasticFollower,
    Flight,
    FreeFollower,
    Leaving,
    Wall,
)
from camgeo.dynamics.effects.results import ContactForce, Inertia
from camgeo.dynamics.effects.wording import N_M, at_angle, degrees, over_range, placed
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.extremes import Extreme, piecewise_highest, piecewise_lowest
from camgeo.units import TURN, counted, listed

ANGLE_SHOWN: Final = math.radians(5e-5)
"""Half of the last digit with which sentences give cam angles [rad]."""

RIGID: Final = '; [state] output = "rigid" gives the flights with a rigid train'

NOTHING: Final = 1e-9
"""A mass in front of an elastic train below this share of all masses is rounding of their
difference."""


@dataclass(frozen=True, slots=True)
class FlightReport:
    """The flights with their findings and the errors of these.

    Attributes
    ----------
    turns : after which the flights repeat.
    """

    flights: tuple[Flight, ...] = ()
    turns: int = 1
    findings: tuple[Finding, ...] = ()
    errors: Mapping[str, Bound] = field(default_factory=dict)

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Over which the follower is free, with flights that follow at once as one; a turn at
        most each.
        """
        spans: list[tuple[float, float]] = []
        for flight in self.flights:
            if spans and spans[-1][1] == flight.leaving:
                spans[-1] = (spans[-1][0], flight.landing)
            else:
                spans.append((flight.leaving, flight.landing))
        return tuple((start % TURN, start % TURN + min(end - start, TURN)) for start, end in spans)


@dataclass(frozen=True, slots=True)
class FlightWording:
    """The words for the flights of one design.

    Attributes
    ----------
    who : flies: "roller", "face" or "follower".
    names : of the sides.
    noun : what the sides are: "flank" or "disc".
    clearance : between them, in words; None on a single flank.
    """

    who: str
    names: Mapping[int, str]
    noun: str
    clearance: str | None = None

    def side(self, sense: int) -> str:
        """The side `sense` in words."""
        return f"the {self.names[sense]} {self.noun}"

    def flight(
        self, flight: Flight, bounces: Sequence[Flight], subject: Subject
    ) -> tuple[Finding, ...]:
        """The findings on one flight: its range and its gap, its landing, and the bounces
        after it.
        """
        start, end = flight.leaving % TURN, flight.landing % TURN
        then = ""
        if bounces:
            fastest = max(bounce.speed for bounce in bounces)
            then = f", and bounces {counted(len(bounces), 'time')}, at up to {fastest:.6g} mm/s,"
            then += f" until {degrees(bounces[-1].landing)}"
        if self.clearance is not None:
            begins = "rebounds from" if flight.rebound else "leaves"
            again = "" if flight.crossed else " again, because it has not crossed the clearance"
            sentence = (
                f"after it {begins} {self.side(flight.left)} at {degrees(start)} the {self.who}"
                f" hits {self.side(flight.met)}{again} at {degrees(end)} at {flight.speed:.6g} mm/s"
                f"{then}"
            )
            return (self._impact(flight, sentence),)
        factor, unit = STATED[subject.cam.lift_unit]
        gap = factor * flight.gap
        begins = "rebounds from" if flight.rebound else "is off"
        later = int((flight.landing - flight.leaving) / TURN)
        where = over_range((start, end)) + (f", {counted(later, 'turn')} later" if later else "")
        return (
            Finding(
                name="flight",
                severity="warning",
                sentence=(
                    f"the {self.who} {begins} {self.side(flight.left)} {where}, up to {gap:.6g}"
                    f" {unit} of lift beyond it"
                ),
                value=gap,
                limit=0.0,
                unit=unit,
                cam_angle=start,
                cam_range=(start, end),
            ),
            self._impact(flight, f"it lands {at_angle(end)}, at {flight.speed:.6g} mm/s{then}"),
        )

    @staticmethod
    def _impact(flight: Flight, sentence: str) -> Finding:
        return Finding(
            name="impact-speed",
            severity="ok",
            sentence=sentence,
            value=flight.speed,
            unit="mm/s",
            cam_angle=flight.landing % TURN,
        )

    def fastest(self, flights: tuple[Flight, ...], tail: str) -> Finding:
        """The finding on the fastest impact."""
        fastest = max(flights, key=lambda flight: flight.speed)
        end = Extreme(fastest.speed, fastest.landing % TURN)
        how = f"lands at up to {end.value:.6g} mm/s"
        if self.clearance is not None:
            how = (
                f"crosses its clearance of {self.clearance} and hits the {self.noun} at up to"
                f" {end.value:.6g} mm/s"
            )
        sentence = f"the {self.who} {how}, {at_angle(end.place)}{tail}"
        return placed("largest-impact-speed", sentence, end, "mm/s", severity="warning")


def flank_flights(
    flank: Flank, inertia: Inertia | None, restitution: float, tolerance: float
) -> FlightReport:
    """The flights from `flank`, which the follower leaves, at the speed of the scene; none, as a
    finding says, if they cannot be computed to the `tolerance`.
    """
    subject, contact = flank.subject, flank.contact
    why, course = _why_not(subject, contact, inertia), subject.state.course
    lost = contact.lost_contact
    if any(stretch.end - stretch.start == TURN for stretch in lost.ranges):
        why = why or f"the {flank.toucher} is off the cam over the whole turn"
    wording = FlightWording(flank.toucher, FLANKS, "flank")
    if why or inertia is None or course is None:
        return _none("flight", why)
    walls = (Wall.of_state(subject, flank.sense),)
    free = FreeFollower.with_forces(contact, inertia, course, walls, subject.state.shocks)
    leavings = [Leaving(0, angle, angle, free.jump(angle)) for angle in lost.leaps]
    for stretch in lost.ranges:
        length = (stretch.end - stretch.start) % TURN
        if length > 0.0:
            leavings.append(Leaving(0, stretch.start, stretch.start + length))
    if contact.behind is not None:
        leaps = tuple(leaving for leaving in leavings if leaving.begin == leaving.end)
        try:
            elastic = ElasticFollower.with_train(free, flank, contact.behind, leaps)
        except EffectError as error:
            return _none("flight", error.message + RIGID)
        return _report_flights(wording, subject, elastic, tuple(leavings), restitution, tolerance)
    return _report_flights(wording, subject, free, tuple(leavings), restitution, tolerance)


def clearance_flights(
    subject: Subject,
    contact: ContactForce,
    inertia: Inertia | None,
    clearance: float,
    restitution: float,
    tolerance: float,
) -> FlightReport:
    """The flights across the `clearance` [mm] of a groove or between two discs, as `flank_flights`;
    of a yoke it is the least one of the turn.
    """
    why, course = _why_not(subject, contact, inertia), subject.state.course
    if clearance < 0.0:
        why = why or "the cam squeezes the yoke"
    names, noun = side_names(subject)
    who = "roller" if subject.returning is None else "follower"
    wording = FlightWording(who, names, noun, _clearance_in_words(subject, clearance))
    if subject.state.sense:
        why = why or (
            "the contours are given as they are written, and flights between these are not"
            ' computed; [state] motion = "demanded" gives those between the exact ones'
        )
    if why or inertia is None or course is None:
        return _none("impact-speed", why)
    jumps = subject.state.shocks
    if jumps:
        why = f"the velocity jumps {at_angle(jumps[0])}, which is itself a shock"
        return _none("impact-speed", why)
    try:
        walls = Wall.with_clearance(subject, clearance)
        free = FreeFollower.with_forces(contact, inertia, course, walls)
        leavings = free.leavings()
    except GeometryError as error:
        return _none("impact-speed", error.message)
    if not leavings:
        return FlightReport()
    return _report_flights(wording, subject, free, leavings, restitution, tolerance)


def _clearance_in_words(subject: Subject, clearance: float) -> str:
    breadth = subject.cam.breadth
    widest = clearance + (0.0 if breadth is None else breadth.variation)
    return f"{clearance:g} mm" if widest == clearance else f"{clearance:g} to {widest:g} mm"


def _why_not(subject: Subject, contact: ContactForce, inertia: Inertia | None) -> str:
    """Why no landing can be computed; empty if it can."""
    if inertia is None or subject.state.course is None:
        return "it needs [effects.inertia], as without mass a landing is no impact"
    if not piecewise_lowest(inertia.to_follower, contact.edges).value > 0.0:
        return "the follower has no mass, and its landing is no impact"
    if contact.behind is not None and (why := _why_not_elastic(subject, contact, inertia)):
        return why + RIGID
    unknown = [
        force.name
        for force in contact.forces
        if force.free_force is None and force is not inertia.force and not force.present
    ]
    return (
        f"the force of {listed(unknown)} on a follower off the cam is not known" if unknown else ""
    )


def _why_not_elastic(subject: Subject, contact: ContactForce, inertia: Inertia) -> str:
    """Why no landing can be computed with an elastic train; empty if it can."""
    if holds_both_ways(subject):
        return "the flights of an elastic train across a clearance are not computed"
    if subject.drive.linkage is not None:
        return "the flights of an elastic train behind a linkage are not computed"
    assert contact.struck is not None  # there are masses
    front_mass = piecewise_lowest(contact.struck, contact.edges).value
    if not front_mass > NOTHING * piecewise_highest(inertia.to_follower, contact.edges).value:
        return (
            "all of its mass is behind the elastic train, and an impact needs some in"
            " front of it; [effects.vibration] masses or moments that are less in sum than"
            " [effects.inertia] leave it some"
        )
    return ""


def _none(name: str, why: str) -> FlightReport:
    return FlightReport(findings=(Finding(name, "warning", f"no landing is computed: {why}"),))


def _report_flights(
    wording: FlightWording,
    subject: Subject,
    free: FreeFollower | ElasticFollower,
    leavings: tuple[Leaving, ...],
    restitution: float,
    tolerance: float,
) -> FlightReport:
    """The flights of `free` with their findings."""
    single = wording.clearance is None
    none = partial(_none, "flight" if single else "impact-speed")
    try:
        steady = free.steady(leavings, restitution, tolerance)
    except (EffectError, GeometryError) as error:
        return none(error.message)
    if steady.unlanded is not None:
        return none(
            f"the flight that begins at cam angle {degrees(steady.unlanded)} lasts longer than"
            f" {counted(FreeFollower.most_turns, 'turn')}"
        )
    if not steady.turns:
        return none(f"the flights do not repeat within {counted(free.most_turns, 'turn')}")
    flights, turns = steady.flights, steady.turns
    if not flights:
        return FlightReport()
    findings: list[Finding] = []
    for first, *bounces in with_bounces(flights):
        findings += wording.flight(first, bounces, subject)
    tail = ""
    if restitution > 0.0 and _longest_run(flights) > MOST_REBOUNDS:
        tail = f"; only {MOST_REBOUNDS} rebounds of each flight are computed"
    findings.append(wording.fastest(flights, tail))
    energy = N_M * sum(flight.energy for flight in flights) / turns
    findings.append(
        Finding(
            name="impact-energy",
            severity="ok",
            sentence=f"the impacts take {energy:.6g} J per turn from the {wording.who}",
            value=energy,
            unit="J",
        )
    )
    late = max(flight.late for flight in flights)
    if late > ANGLE_SHOWN:
        degree = math.degrees(late)
        sentence = (
            f"the cam angles of the landings have an error of up to {degree:.2g} deg, which is more"
            " than half of the last digit shown"
        )
        limit = math.degrees(ANGLE_SHOWN)
        findings.append(Finding("landing-angle", "warning", sentence, degree, limit, "deg"))
    if turns > 1:
        sentence = (
            f"the flights of the {wording.who} differ from turn to turn and repeat after"
            f" {counted(turns, 'turn')}"
        )
        findings.append(Finding("flight-turns", "warning", sentence, float(turns)))
    return FlightReport(
        flights, turns, tuple(findings), _errors(flights, turns, subject, single=single)
    )


def with_bounces(flights: tuple[Flight, ...]) -> list[list[Flight]]:
    """Each flight, with the rebounds after it that stay behind it in speed and gap and end on the
    side where they begin.
    """
    # The first flight of the turn may be the rebound of one that has begun in the turn before.
    first = next((k for k, flight in enumerate(flights) if not flight.rebound), 0)
    groups: list[list[Flight]] = []
    for flight in (*flights[first:], *flights[:first]):
        leading = groups[-1][0] if groups else None
        if leading is None or flight.crossed or not flight.rebound or not flight.behind(leading):
            groups.append([flight])
        else:
            groups[-1].append(flight)
    return groups


def _longest_run(flights: tuple[Flight, ...]) -> int:
    """Flights that follow each other as rebounds, at most."""
    ends = [0, *(k for k, flight in enumerate(flights) if not flight.rebound), len(flights)]
    return int(np.max(np.diff(ends)))


def _errors(
    flights: tuple[Flight, ...], turns: int, subject: Subject, *, single: bool
) -> Mapping[str, Bound]:
    """The errors of the findings, by their names."""
    fastest = max(flight.speed for flight in flights)
    hits = Bound(max(flight.error * flight.speed for flight in flights), fastest)
    errors = dict.fromkeys(("impact-speed", "largest-impact-speed"), hits)
    losses = [flight.energy for flight in flights]
    lost = sum(flight.error * flight.energy for flight in flights)
    errors["impact-energy"] = Bound(lost, sum(losses)).times(N_M / turns)
    if single:
        factor, _ = STATED[subject.cam.lift_unit]
        farthest = max(flight.gap for flight in flights)
        gaps = Bound(max(flight.error * flight.gap for flight in flights), farthest)
        errors["flight"] = gaps.times(factor)
    return errors
