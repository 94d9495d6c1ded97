"""From requests to a motion plan: classes, values and laws, in this order."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence, Set
from decimal import Decimal
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import find_family, make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import FREE, Boundary, over_span
from camgeo.kinematics.plan import SNAP, Dwell, MotionPlan, Move, Segment, SplineMove, joints_of
from camgeo.kinematics.planning.build import (
    keyed,
    law_without_stroke,
    named_law,
    normalised,
    own_law,
)
from camgeo.kinematics.planning.requests import (
    AUTO,
    STRAIGHT,
    Chain,
    Joint,
    Link,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
    chain_of,
    is_auto,
    is_law,
    settle_straight_lines,
    settle_tasks,
    task_of,
)
from camgeo.kinematics.splines import (
    FitReport,
    Spline,
    clamped_spline,
    periodic_spline,
    report,
    smooth_clamped_spline,
    smooth_periodic_spline,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, ascending

RESOLVED: Final = 4.0 * SNAP
"""Shortest part of a law [rad]; two cam angles closer than `SNAP` are the same."""

PLAIN: Final = Unit()
"""No unit: messages state values as they are, per radian."""

MOMENT: Final = Dwell(Decimal(0))
"""A rest of zero length: no link of a chain, but a segment of the plan."""


def plan_motion(requests: Sequence[Request], unit: Unit = PLAIN) -> MotionPlan:
    """The motion plan of `requests`, in the order of the cam angle, over one turn.

    Joints get the values that are stated; a rest or a straight line on one side decides the rest.
    A turn has the acceleration that a neighbouring law requires, where there is no choice, or that
    suits the laws on both sides, see `camgeo.kinematics.planning.planner`. What is still open is
    chosen as smooth as possible, see `camgeo.kinematics.planning.planner`.

    Segment k of the plan is that of request k, also where a rest has no length.

    `unit` is the unit of positions in messages.

    Raises
    ------
    GeometryError
        With the key of the segment: if the laws cannot join, no law exists with the required
        values, or the segments do not make a turn (see `MotionPlan`).
    """
    _check_spans(requests)
    chain = chain_of(requests, unit)
    settle_straight_lines(chain)
    if any(isinstance(request, TableRequest) for request in requests):
        settle_tables(chain)
    settle_tasks(chain)
    settle_values(chain)
    made = {link.number: _segment(chain, index) for index, link in enumerate(chain.links)}
    numbers = range(len(requests))
    return MotionPlan(tuple(made.get(number, MOMENT) for number in numbers))


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


def _segment(chain: Chain, number: int) -> Segment:
    link = chain.links[number]
    match link.request:
        case Dwell():
            return link.request
        case MoveRequest():
            return _move(chain, number, link.request)
        case PointsRequest():
            return _spline_move(chain, number, link.request)
        case TableRequest():
            return fit(chain, number)


def _move(chain: Chain, number: int, request: MoveRequest) -> Move:
    link, task = chain.links[number], task_of(chain, number)
    if link.straight:
        return Move(request.span, request.to, make_law(STRAIGHT, "G-G"))
    if link.stroke == 0.0:
        moving = law_without_stroke(chain, number)
        law = moving or make_law("polynomial-345")
        return Move(request.span, request.to, law, scale=1.0 if moving else None)
    if request.law == AUTO:
        from camgeo.kinematics.planning.build import best_law

        with keyed(link):
            law = best_law(task, normalised(chain, number), request.parameters, request.optimise)
    else:
        law = named_law(chain, number, task)
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


def _spline_move(chain: Chain, number: int, request: PointsRequest) -> SplineMove:
    link, start, end = chain.links[number], chain.before(number), chain.after(number)
    length = link.length
    inner = {index + 1: over_span(values, length) for index, values in request.given.items()}
    from camgeo.kinematics.splines import clamped_spline

    try:
        spline = clamped_spline(
            np.concatenate(([0.0], request.shares, [1.0])),
            np.concatenate(([0.0], request.positions - start.position, [link.stroke])),
            over_span(start.values, length),
            over_span(end.values, length),
            inner,
        )
    except GeometryError as error:
        raise GeometryError(error.message, f"{link.key}.points", error.value) from error
    return SplineMove(request.span, start.position + link.stroke, spline)


# -- values ---------------------------------------------------------------------------------------
# Velocity and acceleration of every joint: stated, fixed by a neighbour, or the smoothest.
#
# Turns between laws are settled by these (`camgeo.kinematics.planning.planner`). What nothing fixes
# is chosen to minimise the integral of s''' squared over the surrounding moves: the motion then has
# four continuous derivatives wherever its laws can follow. A turn is made at least as sharp as a
# neighbouring law requires, and such that a law with one choice meets both its turns; the rest is
# then chosen anew.


def settle_values(chain: Chain) -> None:
    """Give every joint of `chain` a velocity and an acceleration [per rad^k].

    Raises
    ------
    GeometryError
        If a law cannot have the values at one end that it needs at the other, or the motion
        continues at a joint where the laws on both sides turn back.
    """
    undecided, gentlest = settle_turns(chain)
    known = [joint.values for joint in chain.joints]
    while True:
        _smoothest(chain)
        decided = {
            number: turn
            for number, turn in gentlest.items()
            if (chain.joints[number].acceleration or 0.0) * turn < turn * turn
        }
        if not decided:
            decided = tied_turns(chain, undecided)
            undecided -= decided.keys()
        if not decided:
            return
        for number, turn in decided.items():
            known[number] = known[number][0], turn
            gentlest.pop(number, None)
        for joint, values in zip(chain.joints, known, strict=True):
            joint.velocity, joint.acceleration = values


def _smoothest(chain: Chain) -> None:
    """Fill in the remaining values, run by run between fully known joints."""
    count = len(chain.joints)
    open_links = [_is_open(chain, number) for number in range(count)]
    if not any(open_links):
        return
    if all(open_links):
        _fill(chain, range(count), ring=True)
        return
    first = open_links.index(False)
    run: list[int] = []
    for step in range(1, count + 1):
        number = (first + step) % count
        if open_links[number]:
            run.append(number)
        elif run:
            _fill(chain, run, ring=False)
            run = []


def _is_open(chain: Chain, number: int) -> bool:
    """Whether a value at one of the ends of a move is unknown."""
    return not (chain.before(number).settled and chain.after(number).settled)


def _fill(chain: Chain, run: Sequence[int], *, ring: bool) -> None:
    """A run of moves between two fully known joints, or a turn without any such joint."""
    nodes = _Nodes()
    for number in run:
        nodes.add(chain.before(number), chain.links[number])
    if not ring:
        nodes.close(chain.after(run[-1]))
    nodes.fill(nodes.end if ring else None)


class _Nodes:
    """Points that a motion passes: joints, and the inner points of moves through points."""

    def __init__(self) -> None:
        self.end = 0.0
        self.places: list[float] = []
        self.positions: list[float] = []
        self.given: dict[int, Boundary] = {}
        self.joints: dict[int, Joint] = {}
        self.links: list[Link] = []

    def add(self, joint: Joint, link: Link) -> None:
        """The joint at the start of a link, and the points inside the link."""
        self.close(joint)
        self.links.append(link)
        request = link.request
        if isinstance(request, PointsRequest):
            for index, share in enumerate(request.shares):
                given = request.given.get(index, FREE)
                self._node(self.end + float(share) * link.length, request.positions[index], given)
        self.end += link.length

    def close(self, joint: Joint) -> None:
        """A joint without a link after it."""
        self.joints[len(self.places)] = joint
        self._node(self.end, joint.position, joint.values)

    def _node(self, place: float, position: float, given: Boundary) -> None:
        self.given[len(self.places)] = given
        self.places.append(place)
        self.positions.append(float(position))

    def fill(self, period: float | None) -> None:
        """Give the joints the smoothest values."""
        from camgeo.kinematics.splines import smoothest_values  # most plans have no open values

        self._check_distances()
        values = smoothest_values(
            np.array(self.places), np.array(self.positions), self.given, period
        )
        for index, joint in self.joints.items():
            joint.velocity, joint.acceleration = (float(value) for value in values[index])

    def _check_distances(self) -> None:
        """GeometryError if the distances are so unequal that values would lose their digits."""
        from camgeo.kinematics.splines import MOST_UNEQUAL

        steps = np.diff(ascending(np.array([*self.places, self.end])))
        ratio = float(np.max(steps)) / float(np.min(steps))
        if ratio <= MOST_UNEQUAL:
            return
        ends = np.cumsum([link.length for link in self.links])
        place = float(np.sum(steps[: int(np.argmin(steps))]) + 0.5 * np.min(steps))
        link = self.links[min(int(np.searchsorted(ends, place)), len(ends) - 1)]
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


SHAPES = frozenset({"inflection", "curved"})
"""Parameters with which a law meets turns."""

POWERS = {"velocity": (1, 1), "acceleration": (2, 1), "jerk": (3, 1), "moment": (3, 2)}
"""Powers of 1/span and stroke in each quantity that "auto" can keep small."""

TRIED = 3
"""Turns that are compared between the best ones of two moves, these included; with spans of 40 and
150 degrees the jerk is then 12 % above the least."""

SAME = 1e-12
"""Relative difference of accelerations that counts as rounding."""


def settle_turns(chain: Chain) -> tuple[set[int], dict[int, float]]:
    """Give turns of `chain` the acceleration that the laws beside them decide.

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
    turns = [number for number, joint in enumerate(chain.joints) if joint.end == "U"]
    gentlest = {number: _gentlest(chain, number) for number in turns}
    _decide(chain, gentlest)
    undecided = {number for number in turns if chain.joints[number].acceleration is None}
    suited = {number: _suited(chain, number) for number in undecided}
    for number, turn in suited.items():
        chain.joints[number].acceleration = turn
    return undecided, {
        number: turn
        for number in undecided
        if suited[number] is None and (turn := gentlest[number]) is not None
    }


def tied_turns(chain: Chain, undecided: Set[int]) -> dict[int, float]:
    """The accelerations of both turns of a move, by joint, if its law does not meet both as they
    are: with one parameter left to choose, one turn determines the other.

    A turn whose joint is not `undecided` decides; else the gentler one, as a multiple of the
    gentlest that the law can have, or the other one if the neighbour there cannot turn so gently.
    Empty if there is no such move, or neither of its turns is open.
    """
    for number, link in enumerate(chain.links):
        ends = number, (number + 1) % len(chain.joints)
        is_open = [end in undecided for end in ends]
        if not _ties_turns(link, task_of(chain, number)) or not any(is_open):
            continue
        turns = [chain.joints[end].acceleration or 0.0 for end in ends]
        size = [abs(turn / own) for turn, own in zip(turns, _own_turns(chain, number), strict=True)]
        follows = int(size[0] <= size[1]) if all(is_open) else is_open.index(True)
        wanted = _following(chain, number, follows)
        if all(is_open) and abs(wanted) < abs(_beside(chain, ends[follows], number)):
            follows = 1 - follows
            wanted = _following(chain, number, follows)
        if abs(wanted - turns[follows]) > SAME * abs(wanted):
            return {ends[follows]: wanted, ends[1 - follows]: turns[1 - follows]}
    return {}


def _following(chain: Chain, number: int, at_end: int) -> float:
    """The acceleration that the law of a move has at one end, from the one at its other end."""
    link = chain.links[number]
    joint = chain.after(number) if at_end else chain.before(number)
    kept, joint.acceleration = joint.acceleration, None
    law = named_law(chain, number, task_of(chain, number))
    joint.acceleration = kept
    boundary = law.end if at_end else law.start
    return boundary.acceleration * link.stroke / link.length**2


def _beside(chain: Chain, joint: int, number: int) -> float:
    """The gentlest acceleration at a joint of the law on the other side than that link."""
    found = [
        _own_turns(chain, side)[at_end]
        for side, at_end in _sides(chain, joint)
        if side != number and _is_named(chain.links[side]) and chain.links[side].stroke
    ]
    return found[0] if found else 0.0


def decides_turn(link: Link, task: str) -> bool:
    """Whether the parameters of a law fix the acceleration with which it turns."""
    if not _is_named(link) or "U" not in task:
        return False
    taken, stated = _choices(link, task)
    # A law with one parameter can meet one of two turns.
    return stated == taken or (task == "U-U" and len(taken) == 1)


def _is_named(link: Link) -> bool:
    return is_law(link) and not is_auto(link) and not link.straight


def _choices(link: Link, task: str) -> tuple[frozenset[str], frozenset[str]]:
    """The parameters of a named law with which it can meet turns, and which of them are stated."""
    if not _is_named(link):
        return frozenset(), frozenset()
    assert isinstance(link.request, MoveRequest)
    taken = SHAPES & {*find_family(link.request.law).parameters.get(task, ())}
    return taken, taken & link.request.shaped_by


def _ties_turns(link: Link, task: str) -> bool:
    """Whether a law can choose one of its two turns, which then decides the other."""
    taken, stated = _choices(link, task)
    return task == "U-U" and taken == SHAPES and len(stated) == 1


def _decide(chain: Chain, gentlest: Mapping[int, float | None]) -> None:
    """Turns whose acceleration a neighbouring law fixes; fully stated laws come first.

    A law that chooses one of its two turns chooses the one for which a neighbour needs a sharper
    turn than its own, according to `gentlest`, by joint.
    """
    deciding = [
        number
        for number, link in enumerate(chain.links)
        if link.stroke and decides_turn(link, task_of(chain, number))
    ]
    # A law meets any turn that is sharper than its own, so the sharper one decides.
    deciding.sort(
        key=lambda number: (not _stated_in_full(chain.links[number]), -_sharpness(chain, number))
    )
    for number in deciding:
        link, task = chain.links[number], task_of(chain, number)
        start, end = chain.before(number), chain.after(number)
        if start.velocity is None or end.velocity is None:
            continue  # polynomials meet general motions and decide nothing
        if task == "U-U" and start.acceleration is end.acceleration is None:
            _choose_sharper(chain, number, gentlest)
        law = named_law(chain, number, task)
        for joint, boundary, letter in ((start, law.start, task[0]), (end, law.end, task[-1])):
            if letter == "U" and joint.acceleration is None:
                joint.acceleration = boundary.acceleration * link.stroke / link.length**2


def _choose_sharper(chain: Chain, number: int, gentlest: Mapping[int, float | None]) -> None:
    """Give one turn of a law what the neighbour there needs, if that is sharper than its own."""
    taken, stated = _choices(chain.links[number], "U-U")
    if taken == stated:
        return
    ends = number, (number + 1) % len(chain.joints)
    needed = [gentlest[end] or 0.0 for end in ends]
    sizes = [turn / own for turn, own in zip(needed, _own_turns(chain, number), strict=True)]
    sharper = sizes.index(max(sizes))
    if sizes[sharper] > 1.0:
        chain.joints[ends[sharper]].acceleration = needed[sharper]


def _gentlest(chain: Chain, number: int) -> float | None:
    """The gentlest acceleration of a turn that suits the named laws beside it; None without any."""
    found = [
        _own_turns(chain, side)[at_end]
        for side, at_end in _sides(chain, number)
        if _is_named(chain.links[side]) and chain.links[side].stroke
    ]
    if len(found) == 2 and found[0] * found[1] < 0.0:
        raise GeometryError(
            "would stop for a moment at its end and then go on in the same direction: this law"
            " slows down to there, the next one speeds up from there, and their accelerations have"
            " opposite signs; polynomial-5 and auto pass with a velocity",
            key=f"{chain.around(number)[0].key}.law",
        )
    return max(found, key=abs, default=None)


def _suited(chain: Chain, number: int) -> float | None:
    """The acceleration of a turn that suits the laws on both sides; None if one side joins to any,
    or neither law prefers a turn to a sharper one.
    """
    found, prefers = [], False
    for side, at_end in _sides(chain, number):
        link = chain.links[side]
        turns = _own_turns(chain, side) if _is_named(link) else _best_turns(chain, side)
        if not link.stroke or turns is None:
            return None
        found.append(turns[at_end])
        prefers |= _choices(link, task_of(chain, side))[0] != SHAPES
    if not prefers or found[0] * found[1] <= 0.0:
        return None
    around = chain.around(number)
    if not any(map(_minds_jerk, around)):
        return max(found, key=abs)
    # A turn sharper than its own costs a law more jerk.
    return _compromise(chain, number, found) if all(map(is_auto, around)) else None


def _minds_jerk(link: Link) -> bool:
    return isinstance(link.request, MoveRequest) and "jerk" in link.request.optimise


def _compromise(chain: Chain, number: int, own: list[float]) -> float:
    """The turn between two "auto" moves that keeps small what both optimise, given their `own`."""
    from camgeo.kinematics.planning.build import DEFAULT, sizes_at

    gentler, sharper = sorted(own, key=abs)
    turns = gentler * np.geomspace(1.0, sharper / gentler, TRIED)
    weights: Counter[str] = Counter()
    sizes = {name: np.zeros(TRIED) for name in POWERS}
    for side, at_end in _sides(chain, number):
        link, task = chain.links[side], task_of(chain, side)
        request, both = link.request, _best_turns(chain, side)
        assert isinstance(request, MoveRequest)
        assert both is not None
        weights.update(request.optimise or DEFAULT)
        unit = link.stroke / link.length**2
        known = {f"a{end}": turn / unit for end, turn in enumerate(both) if turn}
        known |= normalised(chain, side)
        for place, turn in enumerate(turns):
            found = sizes_at(task, known | {f"a{at_end}": turn / unit}, request.optimise)
            for name, (spans, strokes) in POWERS.items():
                size = found[name] * abs(link.stroke) ** strokes / link.length**spans
                sizes[name][place] = max(sizes[name][place], size)
    costs = [weight * sizes[name] / np.min(sizes[name]) for name, weight in weights.items()]
    return float(turns[int(np.argmin(np.sum(costs, axis=0)))])


def _sides(chain: Chain, number: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """The links before and after a joint, each with which of its ends the joint is."""
    return ((number - 1) % len(chain.links), 1), (number, 0)


def _own_turns(chain: Chain, number: int) -> tuple[float, float]:
    """The accelerations at both ends of a named law with equally large ones in both its parts, and
    as gentle as it can be; a law must not turn more gently.
    """
    link = chain.links[number]
    law = own_law(chain, number, task_of(chain, number))
    unit = link.stroke / link.length**2
    return law.start.acceleration * unit, law.end.acceleration * unit


def _best_turns(chain: Chain, number: int) -> tuple[float, float] | None:
    """The accelerations at both ends of the best law for "auto"; None without a best one."""
    link, task = chain.links[number], task_of(chain, number)
    request = link.request
    if not (is_auto(link) and link.stroke) or "B" in task:
        return None
    assert isinstance(request, MoveRequest)
    if request.parameters:
        return None
    from camgeo.kinematics.planning.build import best_turn  # few plans need it

    known = normalised(chain, number)
    found = best_turn(task, known["v0"], known["v1"], tuple(sorted(request.optimise.items())))
    unit = link.stroke / link.length**2
    return found and (found[0] * unit, found[1] * unit)


def _sharpness(chain: Chain, number: int) -> float:
    """The largest acceleration that a law has at its ends where these are equally large inside."""
    return max(map(abs, _own_turns(chain, number)))


def _stated_in_full(link: Link) -> bool:
    return isinstance(link.request, MoveRequest) and bool(link.request.shaped_by)


# -- tables ---------------------------------------------------------------------------------------
# Lift tables in a plan: the spline of each, and the values it gives to its joints.


CLOSED = 1e-9
"""Fraction of the largest lift by which the last row of a turn may miss the first one."""


def settle_tables(chain: Chain) -> None:
    """Give the joints of every table its own velocity and acceleration where none is stated."""
    for number, link in enumerate(chain.links):
        if not isinstance(link.request, TableRequest) or len(chain.links) == 1:
            continue
        spline, _ = _fitted(chain, number, link.request)
        ends = np.array([0.0, 1.0])
        values = spline.values(ends, 2, "left")
        for joint, column in ((chain.before(number), 0), (chain.after(number), 1)):
            if joint.velocity is None:
                joint.velocity = float(values[1, column]) / link.length
            if joint.acceleration is None:
                joint.acceleration = float(values[2, column]) / link.length**2


def fit(chain: Chain, number: int) -> SplineMove:
    """The segment of a table, once its joints are settled."""
    link = chain.links[number]
    assert isinstance(link.request, TableRequest)
    spline, found = _fitted(chain, number, link.request)
    start = chain.before(number).position
    shift = start - float(link.request.lifts[0])
    return SplineMove(link.request.span, start + link.stroke, spline, found, shift)


def _fitted(chain: Chain, number: int, request: TableRequest) -> tuple[Spline, FitReport]:
    """The spline over the normalised span, and its deviation from the rows."""
    link = chain.links[number]
    shares, lifts = request.shares, request.lifts - request.lifts[0]
    try:
        if len(chain.links) == 1 and not chain.joints[0].rests:
            if request.smoothing is None:
                gap = CLOSED * float(np.max(np.abs(lifts)))
                spline = periodic_spline(shares, lifts, 1.0, gap=gap)
                return spline, report(spline, shares, lifts)
            return smooth_periodic_spline(
                shares, lifts, 1.0, largest_deviation=request.smoothing, gap=request.smoothing
            )
        if len(chain.links) == 1:
            shares, lifts = _closed(shares, lifts)
        start, end = (
            over_span(joint.values, link.length)
            for joint in (chain.before(number), chain.after(number))
        )
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
