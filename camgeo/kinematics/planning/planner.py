"""From requests to a motion plan: the ring of segments, classes, values and laws, in this order."""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from decimal import Decimal
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, find_family, make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import FREE, NAMES, TASKS, Boundary, End, end_of
from camgeo.kinematics.plan import SNAP, Dwell, MotionPlan, Move, Segment, SplineMove, joints_of
from camgeo.kinematics.planning.build import (
    DEFAULT,
    best_law,
    best_turn,
    keyed,
    law_without_stroke,
    named_law,
    normalised,
    own_law,
    sizes_at,
)
from camgeo.kinematics.planning.requests import (
    AUTO,
    STRAIGHT,
    TAKE_JERK,
    Joint,
    Link,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)
from camgeo.kinematics.splines import (
    MOST_UNEQUAL,
    FitReport,
    Spline,
    clamped_spline,
    periodic_spline,
    report,
    smooth_clamped_spline,
    smooth_periodic_spline,
    smoothest_values,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, ascending

RESOLVED: Final = 4.0 * SNAP
"""Shortest part of a law [rad]; two cam angles closer than `SNAP` are the same."""

PLAIN: Final = Unit()
"""No unit: messages state values as they are, per radian."""

MOMENT: Final = Dwell(Decimal(0))
"""A rest of zero length: no link of the ring, but a segment of the plan."""


def plan_motion(requests: Sequence[Request], unit: Unit = PLAIN) -> MotionPlan:
    """The motion plan of `requests`, in the order of the cam angle, over one turn.

    Joints get the values that are stated; a rest or a straight line on one side decides the rest.
    A turn has the acceleration that a neighbouring law requires, where there is no choice, or that
    suits the laws on both sides. What is still open is chosen as smooth as possible. The sections
    below do this, one after the other.

    Segment k of the plan is that of request k, also where a rest has no length.

    `unit` is the unit of positions in messages.

    Raises
    ------
    GeometryError
        With the key of the segment: if the laws cannot join, no law exists with the required
        values, or the segments do not make a turn (see `MotionPlan`).
    """
    _check_spans(requests)
    links = ring_of(requests, unit)
    settle_straight_lines(links)
    settle_tables(links)
    settle_tasks(links)
    settle_values(links)
    made = {link.number: _segment(link) for link in links}
    return MotionPlan(tuple(made.get(number, MOMENT) for number in range(len(requests))))


def _check_spans(requests: Sequence[Request]) -> None:
    """The checks of `MotionPlan` on spans, before anything is planned with them."""
    kinds = (Dwell, MoveRequest, PointsRequest, TableRequest)
    for number, request in enumerate(checked.instances("motion", requests, kinds, "requests")):
        if request.span == 0 and not isinstance(request, Dwell):
            raise GeometryError(
                "a move of zero length cannot change the position (infinite velocity)",
                key=f"motion[{number + 1}].span",
                value=str(request.span),
            )
    joints_of(request.span for request in requests)


def _segment(link: Link) -> Segment:
    match link.request:
        case Dwell():
            return link.request
        case MoveRequest():
            return _move(link)
        case PointsRequest():
            return _spline_move(link, link.request)
        case TableRequest():
            spline, found = _fitted(link, link.request)
            shift = link.start.position - float(link.request.lifts[0])
            end = link.start.position + link.stroke
            return SplineMove(link.request.span, end, spline, found, shift)


def _move(link: Link) -> Move:
    request = link.move
    if link.law == STRAIGHT:
        return Move(request.span, request.to, make_law(STRAIGHT, "G-G"))
    if link.stroke == 0.0:
        moving = law_without_stroke(link)
        law = moving or make_law("polynomial-345")
        return Move(request.span, request.to, law, scale=1.0 if moving else None)
    if link.law == AUTO:
        with keyed(link):
            law = best_law(link.task, normalised(link), request.parameters, request.optimise)
    else:
        law = named_law(link)
    _check_resolved(link, law)
    return Move(request.span, request.to, law)


def _check_resolved(link: Link, law: Law) -> None:
    """GeometryError if a part of a law is too short for cam angles to distinguish its ends.

    The least allowed is a millionth of the shortest span.
    """
    if law.inflection is None:
        return
    curved = law.parameters.get("curved", 1.0)
    shorter = curved * min(law.inflection, 1.0 - law.inflection) * link.length
    if shorter < RESOLVED:
        raise GeometryError(
            f"would speed up or slow down within {math.degrees(shorter):.2g} degrees of its"
            f" {math.degrees(link.length):.6g}, too few for cam angles to distinguish from a jump;"
            f" allowed: {math.degrees(RESOLVED):.2g} or more. A longer span beside a sharp turn, a"
            " dwell there, even dwell = 0, or a larger inflection or curved part makes it possible",
            key=f"{link.key}.law",
            value=law.name,
        )


def _spline_move(link: Link, request: PointsRequest) -> SplineMove:
    start, length = link.start.position, link.length
    inner = {index + 1: _over_span(values, length) for index, values in request.given.items()}
    try:
        spline = clamped_spline(
            np.concatenate(([0.0], request.shares, [1.0])),
            np.concatenate(([0.0], request.positions - start, [link.stroke])),
            _over_span(link.start.values, length),
            _over_span(link.end.values, length),
            inner,
        )
    except GeometryError as error:
        raise GeometryError(error.message, f"{link.key}.points", error.value) from error
    return SplineMove(request.span, start + link.stroke, spline)


def _over_span(values: Boundary, length: float) -> Boundary:
    """Values per rad as derivatives over the normalised span, which is `length` [rad] long."""
    velocity, acceleration = values
    return (
        None if velocity is None else velocity * length,
        None if acceleration is None else acceleration * length**2,
    )


# -- ring -----------------------------------------------------------------------------------------
# The segments and joints of a turn, with what the designer states.


ROUNDING: Final = 1e-12
"""Fraction of a table's largest lift below which its last position counts as 0."""


def ring_of(requests: Sequence[Request], unit: Unit) -> tuple[Link, ...]:
    """The segments of `requests` that have a length, in the order of the cam angle; a rest of zero
    length keeps its joint at rest.

    Raises
    ------
    GeometryError
        If a joint is given impossible values, a velocity at a rest or a jerk that the law does not
        meet; if the last position is not the first one.
    """
    moving: list[int] = []
    joints: list[Joint] = []
    resting: set[int] = set()  # joints at which a rest of zero length lies
    position = 0.0
    for number, request in enumerate(requests):
        before = position
        if isinstance(request, TableRequest):
            position = _after_table(before, request)
        elif not isinstance(request, Dwell):
            position = request.to
        if request.span != 0:
            moving.append(number)
            joints.append(Joint(before))
        elif isinstance(request, Dwell):
            resting.add(len(moving))
    if position != 0.0:
        raise GeometryError(
            f"the motion starts at 0 and ends at {unit.text(position)}, it does not close after one"
            " turn; the last move must return to 0",
            key="motion",
        )
    links = []
    for place, number in enumerate(moving):
        start, end = joints[place], joints[(place + 1) % len(joints)]
        length = math.radians(float(requests[number].span))
        stroke = end.position - start.position
        link = Link(number, requests[number], length, start, end, stroke, unit)
        start.after = end.before = link
        links.append(link)
    for link in links:
        if isinstance(link.request, MoveRequest | PointsRequest):
            _state(link.end, link, link.request)
    for place, joint in enumerate(joints):
        if place in resting or joint.before.rests or joint.after.rests:
            _rest(joint, unit)
    if len(links) in resting and joints:
        _rest(joints[0], unit)
    return tuple(links)


def _after_table(start: float, request: TableRequest) -> float:
    """The position at the end of a table; 0 where it is mere rounding."""
    end = start + request.rise
    size = float(np.max(np.abs(request.lifts)))
    return 0.0 if abs(end) <= ROUNDING * size else end


def _state(joint: Joint, link: Link, request: MoveRequest | PointsRequest) -> None:
    joint.key = link.key
    joint.velocity, joint.acceleration = request.velocity, request.acceleration
    joint.jerk = request.jerk if isinstance(request, MoveRequest) else None
    if joint.jerk is not None and link.law not in TAKE_JERK:
        raise GeometryError(
            f"is met by {' and '.join(TAKE_JERK)} only; leave it out or name one of them",
            key=f"{link.key}.jerk",
            value=f"{joint.jerk:g}",
        )
    names = ("velocity", "acceleration", "jerk")
    joint.stated.update(name for name in names if getattr(joint, name) is not None)


def _rest(joint: Joint, unit: Unit) -> None:
    """A rest on one side: the motion stands still there."""
    for order, name in enumerate(("velocity", "acceleration"), start=1):
        if getattr(joint, name):
            raise GeometryError(
                "must be 0 at the end of a move that meets a rest (or be left out)",
                key=f"{joint.key}.{name}",
                value=unit.text(getattr(joint, name), order),
            )
    joint.rests = True
    joint.velocity = joint.acceleration = 0.0
    joint.classes = {"R"}


def settle_straight_lines(links: Sequence[Link]) -> None:
    """Give the joints of a straight line its velocity; a rest next to one stays a rest.

    Raises
    ------
    GeometryError
        If a value stated there contradicts it.
    """
    for joint in (link.start for link in links):
        straight = [link for link in (joint.before, joint.after) if link.law == STRAIGHT]
        if straight and not joint.rests:
            _on_straight_line(joint, straight[0])
        elif joint.before in straight and joint.before.stroke and "velocity" in joint.stated:
            speed = joint.before.unit.text(joint.before.speed, 1)
            raise _contradiction(joint, "velocity", speed)


def _on_straight_line(joint: Joint, link: Link) -> None:
    for order, (name, wanted) in enumerate(
        (("velocity", link.speed), ("acceleration", 0.0)), start=1
    ):
        stated = getattr(joint, name) if name in joint.stated else None
        if stated is not None and abs(stated - wanted) > 1e-9 * max(abs(stated), abs(wanted)):
            raise _contradiction(joint, name, link.unit.text(wanted, order))
    joint.velocity, joint.acceleration = link.speed, 0.0


def _contradiction(joint: Joint, name: str, has: str) -> GeometryError:
    return GeometryError(
        f"contradicts the straight line at this joint, whose {name} is {has}; leave it out",
        key=f"{joint.key}.{name}",
        value=f"{getattr(joint, name):g}",
    )


# -- tables ---------------------------------------------------------------------------------------
# Lift tables in a plan: the spline of each, and the values it gives to its joints.


CLOSED: Final = 1e-9
"""Fraction of the largest lift by which the last row of a turn may miss the first one."""


def settle_tables(links: Sequence[Link]) -> None:
    """Give the joints of every table its own velocity and acceleration where none is stated."""
    for link in links:
        if not isinstance(link.request, TableRequest) or link.start is link.end:
            continue
        spline, _ = _fitted(link, link.request)
        values = spline.values(np.array([0.0, 1.0]), 2, "left")
        for joint, column in ((link.start, 0), (link.end, 1)):
            if joint.velocity is None:
                joint.velocity = float(values[1, column]) / link.length
            if joint.acceleration is None:
                joint.acceleration = float(values[2, column]) / link.length**2


def _fitted(link: Link, request: TableRequest) -> tuple[Spline, FitReport]:
    """The spline over the normalised span, and its deviation from the rows."""
    shares, lifts = request.shares, request.lifts - request.lifts[0]
    try:
        if link.start is link.end and not link.start.rests:
            if request.smoothing is None:
                gap = CLOSED * float(np.max(np.abs(lifts)))
                spline = periodic_spline(shares, lifts, 1.0, gap=gap)
                return spline, report(spline, shares, lifts)
            return smooth_periodic_spline(
                shares, lifts, 1.0, largest_deviation=request.smoothing, gap=request.smoothing
            )
        if link.start is link.end:
            shares, lifts = _closed(shares, lifts)
        start, end = (_over_span(joint.values, link.length) for joint in (link.start, link.end))
        if request.smoothing is None:
            spline = clamped_spline(shares, lifts, start, end)
            return spline, report(spline, shares, lifts)
        return smooth_clamped_spline(shares, lifts, start, end, largest_deviation=request.smoothing)
    except GeometryError as error:
        raise GeometryError(error.message, key=f"{link.key}.file", value=error.value) from error


def _closed(shares: FloatArray, lifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The rows of a turn, with the closing one added if missing."""
    if shares[-1] < 1.0:
        return np.append(shares, 1.0), np.append(lifts, 0.0)
    gap = CLOSED * float(np.max(np.abs(lifts)))
    if abs(lifts[-1]) > gap:
        raise GeometryError(
            f"the last row lies {lifts[-1]:g} off the first one; allowed: up to {gap:g}",
            value=f"{lifts[-1]:g}",
        )
    return shares, np.append(lifts[:-1], 0.0)


# -- tasks ----------------------------------------------------------------------------------------
# The motion task of each move: the class of every joint, from stated values and allowed laws.
#
# A law family is made for some pairs of classes; a joint's class must suit both sides. Classes that
# do not fit are eliminated until nothing changes. Where several remain, the one that demands least
# of the designer is chosen. Between segments that join to anything it is a turn where the motion
# turns back, and a general motion where it continues. Beside a named law it is a rest, except
# between two laws, one of which may be "auto", that turn back: without the drop of the acceleration
# to 0 that a rest has, both need less (VDI 2143-1, sections 6.3 and 6.6). The sharpest turns choose
# first.


ORDER: Final[tuple[End, ...]] = ("R", "U", "G", "B")

LEGEND: Final = ", ".join(f"{end} {NAMES[end]}" for end in ORDER)


def settle_tasks(links: Sequence[Link]) -> None:
    """Give every joint one class, and velocity or acceleration 0 where the class requires it.

    Raises
    ------
    GeometryError
        If the named laws cannot join; the message names laws that could.
    """
    joints = [link.start for link in links]
    for joint in joints:
        _from_values(joint)
    possible = _Possible(links)
    possible.strike_out(links)
    for joint in sorted(joints, key=lambda each: -_turning(each)):
        possible.choose(joint)
    for joint in joints:
        if joint.kind in ("R", "U"):
            joint.velocity = 0.0
        if joint.kind in ("R", "G"):
            joint.acceleration = 0.0


def _from_values(joint: Joint) -> None:
    """Eliminate the classes that known values exclude."""
    if joint.classes == {"R"}:
        return
    velocity, acceleration = joint.values
    if velocity is not None:
        joint.classes &= {"R", "U"} if velocity == 0.0 else {"G", "B"}
    else:
        joint.classes -= {"G"}  # a constant velocity that is stated nowhere
    if acceleration is not None:
        joint.classes &= {"R", "G"} if acceleration == 0.0 else {"U", "B"}
    if velocity is not None and acceleration is not None:
        joint.classes = {end_of(velocity, acceleration)}
    elif velocity is None and joint.classes >= {"U", "B"} and joint.turns:
        joint.classes -= {"B"}  # it turns back here, so it is momentarily at rest


def _tasks(link: Link) -> set[str] | None:
    """The tasks that a segment can have; None if it can have any."""
    if not link.is_named:
        return None
    tasks = set(find_family(link.law).tasks)
    if link.stroke:
        return tasks
    if "R-R" not in tasks:
        raise GeometryError(
            "has no shape for a move that ends where it starts; polynomial-5 and auto have, and a"
            " dwell stands still",
            key=f"{link.key}.law",
            value=link.law,
        )
    return {"R-R"}


class _Possible:
    """The tasks that each link can still have, by number; None where it can have any."""

    def __init__(self, links: Sequence[Link]) -> None:
        self.links = {link.number: link for link in links}
        self.tasks = {link.number: _tasks(link) for link in links}

    def strike_out(self, links: Iterable[Link]) -> None:
        """Keep the tasks and classes that fit together, from `links` on, until nothing changes. If
        a link is left without a task, everything is as it was, and its error is raised.
        """
        struck: list[tuple[Joint, set[End]]] = []
        lost: list[tuple[int, set[str]]] = []
        due, later = sorted({link.number for link in links}), set[int]()  # of this round, the next
        while due or later:
            if not due:
                due, later = sorted(later), set()
            number = heapq.heappop(due)
            tasks = self.tasks[number]
            if tasks is None:
                continue
            start, end = self.links[number].start, self.links[number].end
            kept = {task for task in tasks if task[0] in start.classes and task[-1] in end.classes}
            if not kept:
                error = _no_task(self.links[number])
                for joint, classes in reversed(struck):
                    joint.classes = classes
                self.tasks.update(reversed(lost))
                raise error
            if len(kept) < len(tasks):
                lost.append((number, tasks))
                self.tasks[number] = kept
            for joint, other, ends in (
                (start, start.before, {task[0] for task in kept}),
                (end, end.after, {task[-1] for task in kept}),
            ):
                fitting = joint.classes & ends
                if len(fitting) < len(joint.classes):
                    struck.append((joint, joint.classes))
                    joint.classes = fitting
                    if other.number > number:
                        heapq.heappush(due, other.number)
                    else:
                        later.add(other.number)

    def choose(self, joint: Joint) -> None:
        """Give a joint the first of its classes, by preference, with which the others still have
        one.

        A ring in which one class is settled is none any more, so what fits together pair by pair
        fits together as a whole.
        """
        order = [each for each in dict.fromkeys(_preferences(joint)) if each in joint.classes]
        for attempt, wanted in enumerate(order, start=1):
            joint.classes = {wanted}
            try:
                return self.strike_out((joint.before, joint.after))
            except GeometryError:
                if attempt == len(order):
                    raise
        return None


def _preferences(joint: Joint) -> tuple[End, ...]:
    links = joint.before, joint.after
    if all(link.is_free for link in links):
        return ("U", "B", "R", "G") if joint.turns else ("B", "U", "R", "G")
    # A simple sine is free of jerk steps from turn to turn, but not from rest to rest.
    turns = _turning(joint) or any(link.law == "simple-sine" for link in links)
    return ("U", *ORDER) if turns else ORDER


def _turning(joint: Joint) -> float:
    """How sharply a motion turns back at a joint between two laws: the change of its mean velocity
    over the spans [mm or rad, per rad^2]; 0 at other joints.
    """
    before, after = joint.before, joint.after
    laws = (link.is_named or link.law in (AUTO, STRAIGHT) for link in (before, after))
    if before.speed * after.speed >= 0.0 or not all(laws):
        return 0.0
    return abs(before.speed) / before.length + abs(after.speed) / after.length


def _no_task(link: Link) -> GeometryError:
    """The error for a law that does not fit between its joints, with those that would."""
    starts, ends = link.start.classes, link.end.classes
    here = [task for task in TASKS if task[0] in starts and task[-1] in ends]
    names = [
        name
        for name, family in FAMILIES.items()
        if name not in ("straight-line", "polynomial") and set(family.tasks) & set(here)
    ]
    family = find_family(link.law)
    words = " to ".join(
        " or ".join(NAMES[each] for each in ORDER if each in classes) for classes in (starts, ends)
    )
    return GeometryError(
        f"is made for {', '.join(family.tasks)} ({LEGEND}); here the move goes from {words}"
        f" ({', '.join(here)}), for which there are {', '.join(names)}, auto",
        key=f"{link.key}.law",
        value=family.name,
    )


# -- values ---------------------------------------------------------------------------------------
# Velocity and acceleration of every joint: stated, fixed by a neighbour, or the smoothest.
#
# Turns between laws are settled first, see below. What nothing fixes is chosen to minimise the
# integral of s''' squared over the surrounding moves: the motion then has four continuous
# derivatives wherever its laws can follow. A turn is made at least as sharp as a neighbouring law
# requires, and such that a law with one choice meets both its turns; the rest is then chosen anew.


def settle_values(links: Sequence[Link]) -> None:
    """Give every joint a velocity and an acceleration [per rad^k].

    Raises
    ------
    GeometryError
        If a law cannot have the values at one end that it needs at the other, or the motion
        continues at a joint where the laws on both sides turn back.
    """
    undecided, gentlest = settle_turns(links)
    known = {link.start: link.start.values for link in links}
    while True:
        _settle_smoothest(links)
        decided = {
            joint: turn
            for joint, turn in gentlest.items()
            if (joint.acceleration or 0.0) * turn < turn * turn
        }
        if not decided:
            decided = tied_turns(links, undecided)
            undecided -= decided.keys()
        if not decided:
            return
        for joint, turn in decided.items():
            known[joint] = known[joint][0], turn
            gentlest.pop(joint, None)
        for joint, values in known.items():
            joint.velocity, joint.acceleration = values


def _settle_smoothest(links: Sequence[Link]) -> None:
    """Fill in the remaining values, run by run between fully known joints."""
    known = [link.start.settled and link.end.settled for link in links]
    if not any(known):
        _fill(links, ring=True)
        return
    first = known.index(True)
    run: list[Link] = []
    for place in (*range(first, len(links)), *range(first + 1)):
        if not known[place]:
            run.append(links[place])
        elif run:
            _fill(run, ring=False)
            run = []


def _fill(links: Sequence[Link], *, ring: bool) -> None:
    """The smoothest values for the joints of a run of moves between two fully known joints, or of a
    turn without any such joint; the motion passes the inner points of moves through points, too.
    """
    nodes: list[tuple[float, float, Boundary, Joint | None]] = []
    end = 0.0
    for link in links:
        nodes.append((end, link.start.position, link.start.values, link.start))
        request = link.request
        if isinstance(request, PointsRequest):
            for index, (share, position) in enumerate(
                zip(request.shares, request.positions, strict=True)
            ):
                given = request.given.get(index, FREE)
                nodes.append((end + float(share) * link.length, float(position), given, None))
        end += link.length
    if not ring:
        last = links[-1].end
        nodes.append((end, last.position, last.values, last))
    places, positions = (np.array([node[column] for node in nodes]) for column in (0, 1))
    _check_distances(ascending(np.append(places, end)), links)
    prescribed = {index: node[2] for index, node in enumerate(nodes)}
    values = smoothest_values(places, positions, prescribed, end if ring else None)
    for (*_, joint), (velocity, acceleration) in zip(nodes, values.tolist(), strict=True):
        if joint is not None:
            joint.velocity, joint.acceleration = velocity, acceleration


def _check_distances(places: FloatArray, links: Sequence[Link]) -> None:
    """GeometryError if the distances are so unequal that values would lose their digits."""
    steps = np.diff(places)
    ratio = float(np.max(steps)) / float(np.min(steps))
    if ratio <= MOST_UNEQUAL:
        return
    ends = np.cumsum([link.length for link in links])
    place = float(np.sum(steps[: int(np.argmin(steps))]) + 0.5 * np.min(steps))
    link = links[min(int(np.searchsorted(ends, place)), len(ends) - 1)]
    inside = isinstance(link.request, PointsRequest)
    raise GeometryError(
        f"{'has points too near to each other' if inside else 'is too short'} beside the moves"
        f" that it joins without a rest: the longest way from one joint or point to the next is"
        f" {ratio:.3g} times the shortest; allowed: up to {MOST_UNEQUAL:g}",
        key=f"{link.key}.{'points' if inside else 'span'}",
        value="" if inside else f"{link.request.span}",
    )


# -- turns ----------------------------------------------------------------------------------------
# The acceleration of turns, where the laws beside them decide it.


SHAPES: Final = frozenset({"inflection", "curved"})
"""Parameters with which a law meets turns."""

POWERS: Final = {"velocity": (1, 1), "acceleration": (2, 1), "jerk": (3, 1), "moment": (3, 2)}
"""Powers of 1/span and stroke in each quantity that "auto" can keep small."""

TRIED: Final = 3
"""Turns that are compared between the best ones of two moves, these included; with spans of 40 and
150 degrees the jerk is then 12 % above the least."""

SAME: Final = 1e-12
"""Relative difference of accelerations that counts as rounding."""


def settle_turns(links: Sequence[Link]) -> tuple[set[Joint], dict[Joint, float]]:
    """Give turns the acceleration that the laws beside them decide.

    A law without a choice decides its turns. Each law with a choice has a turn that suits it best:
    for a law whose inflection point is not stated, the one with equally large accelerations in both
    its parts; for "auto", that of its best law. A law meets any turn that is sharper than its own,
    so between two such laws the sharper one decides. Between two "auto" moves that keep the jerk
    small, which grows with the sharpness of a turn, the turn lies between their own.

    Returns
    -------
    The joints of the turns that no law decides; and of those that remain open because something on
    one side joins to any, the gentlest acceleration [mm or rad, per rad^2] that a law on the other
    side can have.

    Raises
    ------
    GeometryError
        If a law cannot have the values at one end that it needs at the other, or the motion
        continues at a joint where the laws on both sides turn back.
    """
    turns = [link.start for link in links if link.start.kind == "U"]
    gentlest = {joint: _gentlest(joint) for joint in turns}
    _decide(links, gentlest)
    undecided = [joint for joint in turns if joint.acceleration is None]
    suited = {joint: _suited(joint) for joint in undecided}
    for joint, turn in suited.items():
        joint.acceleration = turn
    return set(undecided), {
        joint: turn
        for joint in undecided
        if suited[joint] is None and (turn := gentlest[joint]) is not None
    }


def tied_turns(links: Sequence[Link], undecided: Set[Joint]) -> dict[Joint, float]:
    """The accelerations of both turns of a move, by joint, if its law does not meet both as they
    are: with one parameter left to choose, one turn determines the other.

    A turn whose joint is not `undecided` decides; else the gentler one, as a multiple of the
    gentlest that the law can have, or the other one if the neighbour there cannot turn so gently.
    Empty if there is no such move, or neither of its turns is open.
    """
    for link in links:
        ends = link.start, link.end
        is_open = [end in undecided for end in ends]
        taken, stated = _choices(link)
        ties = link.task == "U-U" and taken == SHAPES and len(stated) == 1
        if not ties or not any(is_open):
            continue
        turns = [end.acceleration or 0.0 for end in ends]
        size = [abs(turn / own) for turn, own in zip(turns, _own_turns(link), strict=True)]
        follows = int(size[0] <= size[1]) if all(is_open) else is_open.index(True)
        wanted = _following(link, follows)
        if all(is_open) and abs(wanted) < abs(_beside(ends[follows], link)):
            follows = 1 - follows
            wanted = _following(link, follows)
        if abs(wanted - turns[follows]) > SAME * abs(wanted):
            return {ends[follows]: wanted, ends[1 - follows]: turns[1 - follows]}
    return {}


def _following(link: Link, at_end: int) -> float:
    """The acceleration that the law of a move has at one end, from the one at its other end."""
    joint = link.end if at_end else link.start
    kept, joint.acceleration = joint.acceleration, None
    law = named_law(link)
    joint.acceleration = kept
    return (law.end if at_end else law.start).acceleration * link.stroke / link.length**2


def _beside(joint: Joint, link: Link) -> float:
    """The gentlest acceleration at a joint of the law on the other side than `link`."""
    return next((turn for side, turn in _turns_of_sides(joint) if side is not link), 0.0)


def _turns_of_sides(joint: Joint) -> Iterator[tuple[Link, float]]:
    """The named laws before and after a joint, each with its own acceleration there."""
    for link, at_end in _sides(joint):
        if link.is_named and link.stroke:
            yield link, _own_turns(link)[at_end]


def _sides(joint: Joint) -> tuple[tuple[Link, int], tuple[Link, int]]:
    """The links before and after a joint, each with which of its ends the joint is."""
    return (joint.before, 1), (joint.after, 0)


def _choices(link: Link) -> tuple[frozenset[str], frozenset[str]]:
    """The parameters of a named law with which it can meet turns, and which of them are stated."""
    if not link.is_named:
        return frozenset(), frozenset()
    taken = SHAPES & {*find_family(link.law).parameters.get(link.task, ())}
    return taken, taken & link.move.shaped_by


def _decides_turn(link: Link) -> bool:
    """Whether the parameters of a law fix the acceleration with which it turns."""
    if not link.is_named or "U" not in link.task:
        return False
    taken, stated = _choices(link)
    # A law with one parameter can meet one of two turns.
    return stated == taken or (link.task == "U-U" and len(taken) == 1)


def _decide(links: Sequence[Link], gentlest: Mapping[Joint, float | None]) -> None:
    """Turns whose acceleration a neighbouring law fixes; fully stated laws come first.

    A law that chooses one of its two turns chooses the one for which a neighbour needs a sharper
    turn than its own, according to `gentlest`, by joint.
    """
    deciding = [link for link in links if link.stroke and _decides_turn(link)]
    # A law meets any turn that is sharper than its own, so the sharper one decides.
    deciding.sort(key=lambda link: (not link.move.shaped_by, -max(map(abs, _own_turns(link)))))
    for link in deciding:
        start, end = link.start, link.end
        if start.velocity is None or end.velocity is None:
            continue  # polynomials meet general motions and decide nothing
        if link.task == "U-U" and start.acceleration is end.acceleration is None:
            _choose_sharper(link, gentlest)
        law = named_law(link)
        for joint, boundary in ((start, law.start), (end, law.end)):
            if joint.kind == "U" and joint.acceleration is None:
                joint.acceleration = boundary.acceleration * link.stroke / link.length**2


def _choose_sharper(link: Link, gentlest: Mapping[Joint, float | None]) -> None:
    """Give one turn of a law what the neighbour there needs, if that is sharper than its own."""
    taken, stated = _choices(link)
    if taken == stated:
        return
    ends = link.start, link.end
    needed = [gentlest[end] or 0.0 for end in ends]
    sizes = [turn / own for turn, own in zip(needed, _own_turns(link), strict=True)]
    sharper = sizes.index(max(sizes))
    if sizes[sharper] > 1.0:
        ends[sharper].acceleration = needed[sharper]


def _gentlest(joint: Joint) -> float | None:
    """The gentlest acceleration of a turn that suits the named laws beside it; None without any."""
    found = [turn for _, turn in _turns_of_sides(joint)]
    if len(found) == 2 and found[0] * found[1] < 0.0:
        raise GeometryError(
            "would stop for a moment at its end and then go on in the same direction: this law"
            " slows down to there, the next one speeds up from there, and their accelerations have"
            " opposite signs; polynomial-5 and auto pass with a velocity",
            key=f"{joint.before.key}.law",
        )
    return max(found, key=abs, default=None)


def _suited(joint: Joint) -> float | None:
    """The acceleration of a turn that suits the laws on both sides; None if one side joins to any,
    or neither law prefers a turn to a sharper one.
    """
    found, prefers = [], False
    for link, at_end in _sides(joint):
        turns = _own_turns(link) if link.is_named else _best_turns(link)
        if not link.stroke or turns is None:
            return None
        found.append(turns[at_end])
        prefers |= _choices(link)[0] != SHAPES
    if not prefers or found[0] * found[1] <= 0.0:
        return None
    links = joint.before, joint.after
    if not any("jerk" in link.move.optimise for link in links):
        return max(found, key=abs)
    # A turn sharper than its own costs a law more jerk.
    return _compromise(joint, found) if all(link.law == AUTO for link in links) else None


def _compromise(joint: Joint, own: list[float]) -> float:
    """The turn between two "auto" moves that keeps small what both optimise, given their `own`."""
    gentler, sharper = sorted(own, key=abs)
    turns = gentler * np.geomspace(1.0, sharper / gentler, TRIED)
    weights: Counter[str] = Counter()
    sizes = {name: np.zeros(TRIED) for name in POWERS}
    for link, at_end in _sides(joint):
        request, both = link.move, _best_turns(link)
        assert both is not None
        weights.update(request.optimise or DEFAULT)
        unit = link.unit_acceleration
        known = {f"a{end}": turn / unit for end, turn in enumerate(both) if turn}
        known |= normalised(link)
        for place, turn in enumerate(turns):
            found = sizes_at(link.task, known | {f"a{at_end}": turn / unit}, request.optimise)
            for name, (spans, strokes) in POWERS.items():
                size = found[name] * abs(link.stroke) ** strokes / link.length**spans
                sizes[name][place] = max(sizes[name][place], size)
    costs = [weight * sizes[name] / np.min(sizes[name]) for name, weight in weights.items()]
    return float(turns[int(np.argmin(np.sum(costs, axis=0)))])


def _own_turns(link: Link) -> tuple[float, float]:
    """The accelerations at both ends of a named law with equally large ones in both its parts, and
    as gentle as it can be; a law must not turn more gently.
    """
    law = own_law(link)
    unit = link.unit_acceleration
    return law.start.acceleration * unit, law.end.acceleration * unit


def _best_turns(link: Link) -> tuple[float, float] | None:
    """The accelerations at both ends of the best law for "auto"; None without a best one."""
    if link.law != AUTO or not link.stroke or "B" in link.task or link.move.parameters:
        return None
    known = normalised(link)
    optimise = tuple(sorted(link.move.optimise.items()))
    found = best_turn(link.task, known["v0"], known["v1"], optimise)
    unit = link.unit_acceleration
    return found and (found[0] * unit, found[1] * unit)
