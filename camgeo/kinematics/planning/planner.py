"""From requests to a motion plan: the ring of segments, classes, values and laws, in this order."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, find_family
from camgeo.kinematics.motion import FREE, NAMES, TASKS, Boundary, End, end_class
from camgeo.kinematics.plan import Dwell, MotionPlan, Segment, SplineMove, sum_spans
from camgeo.kinematics.planning.build import build_move, settle_reversals, tied_reversals
from camgeo.kinematics.planning.requests import (
    AUTO,
    STRAIGHT,
    TAKE_JERK,
    Link,
    MoveRequest,
    PointsRequest,
    PositionUnit,
    Request,
    RingJoint,
    TableRequest,
)
from camgeo.kinematics.splines import MOST_UNEQUAL, FitReport, Spline, smoothest_values
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, ascending

PLAIN: Final = PositionUnit()
"""No unit: messages state values as they are, per radian."""

MOMENT: Final = Dwell(Decimal(0))
"""A rest of zero length: no link of the ring, but a segment of the plan."""


def plan_motion(requests: Sequence[Request], unit: PositionUnit = PLAIN) -> MotionPlan:
    """The motion plan of `requests`, in the order of the cam angle, over one turn.

    Joints get the stated values; beside a rest or a straight line, these determine the others. At a
    reversal the acceleration is that which a neighbouring law without a free parameter requires, or
    that suits the laws on both sides. What is still open is chosen as smooth as possible. The
    sections below do this, one after the other.

    Segment k of the plan belongs to request k, even where a rest has no length. `unit` is the unit
    of positions in messages.

    Raises
    ------
    GeometryError
        With the key of the segment, if laws cannot join, if no law exists with the required values,
        or if the segments do not fill a turn (see `MotionPlan`).
    """
    _check_spans(requests)
    links = build_ring(requests, unit)
    settle_straight_lines(links)
    settle_tables(links)
    settle_tasks(links)
    settle_values(links)
    segments = {link.number: _segment(link) for link in links}
    return MotionPlan(tuple(segments.get(number, MOMENT) for number in range(len(requests))))


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
    sum_spans(request.span for request in requests)


def _segment(link: Link) -> Segment:
    match link.request:
        case Dwell():
            return link.request
        case MoveRequest():
            return build_move(link)
        case PointsRequest():
            return _spline_move(link, link.request)
        case TableRequest():
            spline, report = _fitted(link, link.request)
            shift = link.start.position - float(link.request.lifts[0])
            end = link.start.position + link.stroke
            return SplineMove(link.request.span, end, spline, report, shift)


def _spline_move(link: Link, request: PointsRequest) -> SplineMove:
    start, length = link.start.position, link.length
    inner = {
        index + 1: _normalised_boundary(values, length)
        for index, values in request.boundaries.items()
    }
    try:
        spline = Spline.clamped(
            np.concatenate(([0.0], request.shares, [1.0])),
            np.concatenate(([0.0], request.positions - start, [link.stroke])),
            _normalised_boundary(link.start.values, length),
            _normalised_boundary(link.end.values, length),
            inner,
        )
    except GeometryError as error:
        raise GeometryError(error.message, f"{link.key}.points", error.value) from error
    return SplineMove(request.span, start + link.stroke, spline)


def _normalised_boundary(values: Boundary, length: float) -> Boundary:
    """`values` per rad, restated as derivatives over the normalised span of `length` [rad]."""
    velocity, acceleration = values
    return (
        None if velocity is None else velocity * length,
        None if acceleration is None else acceleration * length**2,
    )


# -- ring -----------------------------------------------------------------------------------------
# The segments and joints of a turn, with what the designer states.


ROUNDING: Final = 1e-12
"""Fraction of a table's largest lift below which its last position counts as 0."""


def build_ring(requests: Sequence[Request], unit: PositionUnit) -> tuple[Link, ...]:
    """The segments of `requests` that have a length, in the order of the cam angle.

    A rest of zero length is no segment of the ring, but sets its joint to rest.

    Raises
    ------
    GeometryError
        If impossible values are stated for a joint, such as a velocity at a rest or a jerk that the
        law does not meet; if the last position is not the first one.
    """
    moving: list[int] = []
    joints: list[RingJoint] = []
    resting: set[int] = set()  # joints at which a rest of zero length lies
    position = 0.0
    for number, request in enumerate(requests):
        previous = position
        if isinstance(request, TableRequest):
            position = _table_end(previous, request)
        elif not isinstance(request, Dwell):
            position = request.to
        if request.span != 0:
            moving.append(number)
            joints.append(RingJoint(previous))
        elif isinstance(request, Dwell):
            # The rest lies at the start of the next segment that has a length.
            resting.add(len(moving))
    if position != 0.0:
        raise GeometryError(
            f"the motion starts at 0 and ends at {unit.text(position)}, so it does not close after"
            " one turn; the last move must return to 0",
            key="motion",
        )
    links = []
    for place, number in enumerate(moving):
        start, end = joints[place], joints[(place + 1) % len(joints)]
        length = math.radians(float(requests[number].span))
        stroke = end.position - start.position
        link = Link(number, requests[number], length, start, end, stroke, unit)
        start.following = end.previous = link
        links.append(link)
    for link in links:
        if isinstance(link.request, MoveRequest | PointsRequest):
            _state(link.end, link, link.request)
    for place, joint in enumerate(joints):
        if place in resting or joint.previous.rests or joint.following.rests:
            _rest(joint, unit)
    # A rest of zero length after the last segment lies at cam angle 0, where the ring closes.
    if len(links) in resting and joints:
        _rest(joints[0], unit)
    return tuple(links)


def _table_end(start: float, request: TableRequest) -> float:
    """The position [mm or rad] at the end of a table; 0 where it is only rounding."""
    end = start + request.rise
    size = float(np.max(np.abs(request.lifts)))
    return 0.0 if abs(end) <= ROUNDING * size else end


def _state(joint: RingJoint, link: Link, request: MoveRequest | PointsRequest) -> None:
    joint.key = link.key
    joint.velocity, joint.acceleration = request.velocity, request.acceleration
    joint.jerk = request.jerk if isinstance(request, MoveRequest) else None
    if joint.jerk is not None and link.law not in TAKE_JERK:
        raise GeometryError(
            f"is met only by {' and '.join(TAKE_JERK)}; leave it out or name one of them",
            key=f"{link.key}.jerk",
            value=f"{joint.jerk:g}",
        )
    names = ("velocity", "acceleration", "jerk")
    joint.stated.update(name for name in names if getattr(joint, name) is not None)


def _rest(joint: RingJoint, unit: PositionUnit) -> None:
    """Give a joint beside a rest the velocity and acceleration 0; GeometryError if other ones are
    stated.
    """
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
    """Give the joints of each straight line its velocity, unless they are at rest.

    Raises
    ------
    GeometryError
        If a value stated there contradicts the straight line.
    """
    for joint in (link.start for link in links):
        straight = [link for link in (joint.previous, joint.following) if link.law == STRAIGHT]
        if straight and not joint.rests:
            _apply_straight_line(joint, straight[0])
        elif joint.previous in straight and joint.previous.stroke and "velocity" in joint.stated:
            speed = joint.previous.unit.text(joint.previous.speed, 1)
            raise _contradiction(joint, "velocity", speed)


def _apply_straight_line(joint: RingJoint, link: Link) -> None:
    for order, (name, wanted) in enumerate(
        (("velocity", link.speed), ("acceleration", 0.0)), start=1
    ):
        stated = getattr(joint, name) if name in joint.stated else None
        if stated is not None and abs(stated - wanted) > 1e-9 * max(abs(stated), abs(wanted)):
            raise _contradiction(joint, name, link.unit.text(wanted, order))
    joint.velocity, joint.acceleration = link.speed, 0.0


def _contradiction(joint: RingJoint, name: str, has: str) -> GeometryError:
    return GeometryError(
        f"contradicts the straight line at this joint, whose {name} is {has}; leave it out",
        key=f"{joint.key}.{name}",
        value=f"{getattr(joint, name):g}",
    )


# -- tables ---------------------------------------------------------------------------------------
# Lift tables in a plan: the spline of each, and the values that it determines at its joints.


CLOSED: Final = 1e-9
"""Fraction of the largest lift by which the last row of a table of a whole turn may differ from the
first one."""


def settle_tables(links: Sequence[Link]) -> None:
    """Give the joints of every table the velocity and acceleration of its spline where none are
    stated.
    """
    for link in links:
        # A table of a whole turn has one joint, at which its periodic spline closes with itself.
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
                spline = Spline.closed(shares, lifts, 1.0, gap=gap)
                return spline, FitReport.from_points(spline, shares, lifts)
            return Spline.smooth_closed(
                shares, lifts, 1.0, largest_deviation=request.smoothing, gap=request.smoothing
            )
        if link.start is link.end:
            shares, lifts = _closed(shares, lifts)
        start, end = (
            _normalised_boundary(joint.values, link.length) for joint in (link.start, link.end)
        )
        if request.smoothing is None:
            spline = Spline.clamped(shares, lifts, start, end)
            return spline, FitReport.from_points(spline, shares, lifts)
        return Spline.smooth_clamped(shares, lifts, start, end, largest_deviation=request.smoothing)
    except GeometryError as error:
        raise GeometryError(error.message, key=f"{link.key}.file", value=error.value) from error


def _closed(shares: FloatArray, lifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The rows of a table of a whole turn, with the closing row added if it is missing."""
    if shares[-1] < 1.0:
        return np.append(shares, 1.0), np.append(lifts, 0.0)
    gap = CLOSED * float(np.max(np.abs(lifts)))
    if abs(lifts[-1]) > gap:
        raise GeometryError(
            f"the last row differs from the first one by {lifts[-1]:g}; allowed: up to {gap:g}",
            value=f"{lifts[-1]:g}",
        )
    return shares, np.append(lifts[:-1], 0.0)


# -- tasks ----------------------------------------------------------------------------------------
# The motion task of each move: the class of every joint, from stated values and allowed laws.
#
# A law family is made for some pairs of classes; the class of a joint must suit both sides. Classes
# that do not fit are eliminated until nothing changes. If several remain, one of them is chosen.
# Between segments that meet any values it is a reversal where the motion turns back, and a general
# motion where it continues. Beside a named law it is a rest, except where the motion turns back
# between two laws, one of which may be "auto": without the drop of the acceleration to 0 that a
# rest requires, both laws need less of it (VDI 2143-1, sections 6.3 and 6.6). The joints at which
# the motion turns back most sharply choose first.


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
    possible.eliminate(links)
    for joint in sorted(joints, key=lambda joint: -_turning(joint)):
        possible.choose(joint)
    for joint in joints:
        if joint.kind in ("R", "U"):
            joint.velocity = 0.0
        if joint.kind in ("R", "G"):
            joint.acceleration = 0.0


def _from_values(joint: RingJoint) -> None:
    """Eliminate the classes of a joint that its known values exclude."""
    if joint.classes == {"R"}:
        return
    velocity, acceleration = joint.values
    if velocity is not None:
        joint.classes &= {"R", "U"} if velocity == 0.0 else {"G", "B"}
    else:
        joint.classes -= {"G"}  # nothing determines the constant velocity
    if acceleration is not None:
        joint.classes &= {"R", "G"} if acceleration == 0.0 else {"U", "B"}
    if velocity is not None and acceleration is not None:
        joint.classes = {end_class(velocity, acceleration)}
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
            "cannot make a move that ends where it starts; polynomial-5 and auto can, and a dwell"
            " stands still",
            key=f"{link.key}.law",
            value=link.law,
        )
    # A law scales with its stroke, so without one it rests at both ends.
    return {"R-R"}


class _Possible:
    """The tasks that each link can still have, by its number; None for a link that can have any."""

    def __init__(self, links: Sequence[Link]) -> None:
        self.links = {link.number: link for link in links}
        self.tasks = {link.number: _tasks(link) for link in links}

    def eliminate(self, links: Iterable[Link]) -> None:
        """Eliminate tasks and classes that do not fit together, starting at `links`, until nothing
        changes.

        If a link is left without a task, everything is restored and the error of that link raised.
        """
        struck: list[tuple[RingJoint, set[End]]] = []
        lost: list[tuple[int, set[str]]] = []
        # Numbers of the links to look at in this round and in the next one.
        due, later = sorted({link.number for link in links}), set[int]()
        while due or later:
            if not due:
                due, later = sorted(later), set()
            number = heapq.heappop(due)
            tasks = self.tasks[number]
            if tasks is None:
                continue
            start, end = self.links[number].start, self.links[number].end
            remaining = {
                task for task in tasks if task[0] in start.classes and task[-1] in end.classes
            }
            if not remaining:
                error = _no_task(self.links[number])
                for joint, classes in reversed(struck):
                    joint.classes = classes
                self.tasks.update(reversed(lost))
                raise error
            if len(remaining) < len(tasks):
                lost.append((number, tasks))
                self.tasks[number] = remaining
            for joint, other, ends in (
                (start, start.previous, {task[0] for task in remaining}),
                (end, end.following, {task[-1] for task in remaining}),
            ):
                fitting = joint.classes & ends
                if len(fitting) < len(joint.classes):
                    struck.append((joint, joint.classes))
                    joint.classes = fitting
                    # Each round runs through the links in ascending order; those behind wait.
                    # next.
                    if other.number > number:
                        heapq.heappush(due, other.number)
                    else:
                        later.add(other.number)

    def choose(self, joint: RingJoint) -> None:
        """Give a joint the first of its classes, by preference, that leaves every other joint one.

        Once the class of one joint is fixed, the ring is open at that joint, and in an open chain
        classes that fit together pair by pair fit together as a whole.
        """
        order = [kind for kind in dict.fromkeys(_preferences(joint)) if kind in joint.classes]
        for attempt, wanted in enumerate(order, start=1):
            joint.classes = {wanted}
            try:
                return self.eliminate((joint.previous, joint.following))
            except GeometryError:
                if attempt == len(order):
                    raise
        return None


def _preferences(joint: RingJoint) -> tuple[End, ...]:
    links = joint.previous, joint.following
    if all(link.is_free for link in links):
        return ("U", "B", "R", "G") if joint.turns else ("B", "U", "R", "G")
    # A simple sine has no jump of the acceleration from reversal to reversal, but from rest to
    # rest.
    turns = _turning(joint) or any(link.law == "simple-sine" for link in links)
    return ("U", *ORDER) if turns else ORDER


def _turning(joint: RingJoint) -> float:
    """How sharply the motion turns back at a joint between two laws [mm or rad, per rad^2]: the sum
    of the mean velocities, each divided by its span; 0 at other joints.
    """
    previous, following = joint.previous, joint.following
    laws = (link.is_named or link.law in (AUTO, STRAIGHT) for link in (previous, following))
    if previous.speed * following.speed >= 0.0 or not all(laws):
        return 0.0
    return abs(previous.speed) / previous.length + abs(following.speed) / following.length


def _no_task(link: Link) -> GeometryError:
    """The error for a law that does not suit the classes of its joints; it names some that do."""
    starts, ends = link.start.classes, link.end.classes
    here = [task for task in TASKS if task[0] in starts and task[-1] in ends]
    names = [
        name
        for name, family in FAMILIES.items()
        if name not in ("straight-line", "polynomial") and set(family.tasks) & set(here)
    ]
    family = find_family(link.law)
    words = " to ".join(
        " or ".join(NAMES[end] for end in ORDER if end in classes) for classes in (starts, ends)
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
# Reversals between laws are settled first, see `build`. What nothing determines is chosen to
# minimise the integral of s''' squared over the surrounding moves: the motion then has four
# continuous derivatives wherever its laws can follow. A reversal is made at least as sharp as a
# neighbouring law requires, and such that a law with one free parameter meets both its reversals;
# the remaining values are then chosen again.


def settle_values(links: Sequence[Link]) -> None:
    """Give every joint a velocity and an acceleration [per rad^k].

    Raises
    ------
    GeometryError
        If a law that meets the values at one end cannot meet those at the other, or the motion
        continues in the same direction at a joint where both laws have a reversal.
    """
    undecided, gentlest = settle_reversals(links)
    known = {link.start: link.start.values for link in links}
    while True:
        _settle_smoothest(links)
        decided = {
            joint: acceleration
            for joint, acceleration in gentlest.items()
            # The smoothest acceleration is gentler than the law permits, or has the wrong sign.
            if (joint.acceleration or 0.0) * acceleration < acceleration * acceleration
        }
        if not decided:
            decided = tied_reversals(links, undecided)
            # Each pass settles at least one joint for good, so the loop ends.
            undecided -= decided.keys()
        if not decided:
            return
        for joint, acceleration in decided.items():
            known[joint] = known[joint][0], acceleration
            gentlest.pop(joint, None)
        for joint, values in known.items():
            joint.velocity, joint.acceleration = values


def _settle_smoothest(links: Sequence[Link]) -> None:
    """Determine the remaining values as smooth as possible, run by run between settled joints."""
    known = [link.start.settled and link.end.settled for link in links]
    if not any(known):
        _fill(links, ring=True)
        return
    first = known.index(True)
    run: list[Link] = []
    # Once around, starting and ending at a settled link, so that no run is cut at cam angle 0.
    for place in (*range(first, len(links)), *range(first + 1)):
        if not known[place]:
            run.append(links[place])
        elif run:
            _fill(run, ring=False)
            run = []


def _fill(links: Sequence[Link], *, ring: bool) -> None:
    """Give the joints of a run of moves the smoothest values that the known ones permit.

    A run lies between two settled joints; with `ring` it is a whole turn without a settled joint.
    The motion also passes through the inner points of moves through points.
    """
    nodes: list[tuple[float, float, Boundary, RingJoint | None]] = []
    end = 0.0
    for link in links:
        nodes.append((end, link.start.position, link.start.values, link.start))
        request = link.request
        if isinstance(request, PointsRequest):
            for index, (share, position) in enumerate(
                zip(request.shares, request.positions, strict=True)
            ):
                boundary = request.boundaries.get(index, FREE)
                nodes.append((end + float(share) * link.length, float(position), boundary, None))
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
    """Raise GeometryError if the distances are so unequal that values would lose their digits."""
    steps = np.diff(places)
    ratio = float(np.max(steps)) / float(np.min(steps))
    if ratio <= MOST_UNEQUAL:
        return
    ends = np.cumsum([link.length for link in links])
    place = float(np.sum(steps[: int(np.argmin(steps))]) + 0.5 * np.min(steps))
    link = links[min(int(np.searchsorted(ends, place)), len(ends) - 1)]
    inside = isinstance(link.request, PointsRequest)
    raise GeometryError(
        f"{'has points that are too close together' if inside else 'is too short'} beside the moves"
        f" that it joins without a rest: the longest distance from one joint or point to the next"
        f" is {ratio:.3g} times the shortest; allowed: up to {MOST_UNEQUAL:g}",
        key=f"{link.key}.{'points' if inside else 'span'}",
        value="" if inside else f"{link.request.span}",
    )
