"""The requests for the segments of a motion plan, before the joints are settled."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import ALIASES, BALANCES, FAMILIES, LARGEST, find_family
from camgeo.kinematics.motion import ENDS, NAMES, TASKS, Boundary, End, boundaries_of, end_of
from camgeo.kinematics.plan import FULL_TURN, Dwell, MovingSpan
from camgeo.numeric import checked
from camgeo.record import Pickled

AUTO: Final = "auto"
"""The law name that lets the planner choose."""

CRITERIA: Final = ("velocity", "acceleration", "jerk", "moment")
"""The quantities that `AUTO` can keep small."""

NOTHING: Final[Mapping[str, float]] = MappingProxyType({})

SMALLEST_POSITION: Final = 1e-32
"""Smallest position [mm or rad] other than 0, a scene's 1e-30 degrees; below it, products of
velocities of up to 1e12 strokes exceed what a double can hold."""


def _position(key: str, value: Any) -> float:
    found = checked.finite(key, value)
    if 0.0 < abs(found) < SMALLEST_POSITION:
        raise GeometryError(
            f"must be 0, or at least {SMALLEST_POSITION:g} in magnitude", key, repr(found)
        )
    return found


def _weights(key: str, value: Any) -> Mapping[str, float]:
    weights = checked.by_name(key, value)
    for name, weight in weights.items():
        checked.one_of(key, name, CRITERIA)
        checked.positive(name, weight)
    return weights


Position = Annotated[float, _position]
Weights = Annotated[Mapping[str, float], _weights]
Parameters = Annotated[Mapping[str, float], partial(checked.by_name, largest=LARGEST)]
LawName = Annotated[str, partial(checked.one_of, choices=(AUTO, *FAMILIES, *ALIASES))]
Balance = Annotated[str, partial(checked.one_of, choices=("", *BALANCES))]


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit of position in messages.

    Attributes
    ----------
    name : "mm", "inch" or "deg"; empty if unknown.
    size : of one such unit [mm or rad].
    """

    name: str = ""
    size: checked.Positive = 1.0

    def __post_init__(self) -> None:
        checked.check_fields(self)

    def text(self, value: float, order: int = 0) -> str:
        """A position, or its derivative of that order, as text with its unit."""
        number = f"{value / self.size + 0.0:.6g}"
        if not order:
            return f"{number} {self.name}".strip()
        power = "rad" if order == 1 else f"rad^{order}"
        return f"{number} {self.name}/{power}" if self.name else f"{number} per {power}"


@dataclass(frozen=True, slots=True)
class MoveRequest(Pickled):
    """A move by a law.

    Attributes
    ----------
    span : degrees, exactly as written.
    to : position at the end [mm or rad].
    law : name of a family, an alias, or `AUTO`.
    parameters : of the law, normalised, without boundary values: inflection, curved, sine, cosine.
    velocity, acceleration, jerk : s', s'', s''' at the end of the move, with respect to the cam
        angle [per rad^k]; None where they follow from the neighbours.
    optimise : weights of `CRITERIA`, for `AUTO`.
    balance : the quantity that must be equally large before and after the inflection point, in
        place of the parameter inflection; see `camgeo.kinematics.planning.build`. May be empty.
    """

    span: MovingSpan
    to: Position
    law: LawName
    parameters: Parameters = field(default_factory=lambda: NOTHING)
    velocity: checked.Finite | None = None
    acceleration: checked.Finite | None = None
    jerk: checked.Finite | None = None
    optimise: Weights = field(default_factory=lambda: NOTHING)
    balance: Balance = ""

    def __post_init__(self) -> None:
        checked.check_fields(self)

    @property
    def shaped_by(self) -> frozenset[str]:
        """Names of the parameters that the designer decides."""
        return frozenset({*self.parameters, *(("inflection",) if self.balance else ())})


@dataclass(frozen=True, slots=True, eq=False)
class PointsRequest(Pickled):
    """A move through points.

    Attributes
    ----------
    span, to : as of a move.
    shares : (n,) places of the inner points as parts of the span, ascending inside (0, 1).
    positions : (n,) there [mm or rad], absolute.
    given : s' and s'' [per rad^k] at inner points, by index, None where free.
    velocity, acceleration : at the end of the segment, as of a move.
    """

    span: MovingSpan
    to: Position
    shares: checked.Row
    positions: checked.Row
    given: Mapping[int, Boundary] = field(default_factory=lambda: MappingProxyType({}))
    velocity: checked.Finite | None = None
    acceleration: checked.Finite | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        count = len(self.shares)
        if len(self.positions) != count:
            raise GeometryError(
                f"must be as many as the shares, {count}", "positions", str(len(self.positions))
            )
        given = boundaries_of("given", self.given, 0, count - 1)
        checked.hold(self, given=MappingProxyType(given))


@dataclass(frozen=True, slots=True, eq=False)
class TableRequest(Pickled):
    """A move by a lift table.

    Attributes
    ----------
    span : degrees, exactly as written.
    shares : (n,) places of the rows as parts of the span, from 0 to 1.
    lifts : (n,) [mm or rad]; the first row is where the segment starts.
    smoothing : largest allowed deviation from the rows [mm or rad]; None interpolates.
    """

    span: MovingSpan
    shares: checked.Row
    lifts: checked.Row
    smoothing: checked.Positive | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        count = len(self.shares)
        if count < 2 or count != len(self.lifts):
            raise GeometryError(
                f"must be 2 or more, as many as the shares, {count}", "lifts", str(len(self.lifts))
            )

    @property
    def rise(self) -> float:
        """Lift from the start of the segment to its end [mm or rad]; a whole turn closes."""
        if self.span == FULL_TURN:
            return 0.0
        return float(self.lifts[-1] - self.lifts[0])


Request = Dwell | MoveRequest | PointsRequest | TableRequest


# -- chain ----------------------------------------------------------------------------------------
# The segments of a turn in a ring, with the joints between them, which planning works on.
#
# Segment k lies between joint k and joint k + 1; the last joint is the first. What is known of a
# joint is filled in step by step, by the modules of this package in turn.


ROUNDING = 1e-12
"""Fraction of a table's largest lift below which its last position counts as 0."""

STRAIGHT = "straight-line"

TAKE_JERK = tuple(
    name
    for name, family in FAMILIES.items()
    if any({"j0", "j1"} & {*taken} for taken in family.parameters.values())
)
"""Laws that meet a stated jerk."""


@dataclass(slots=True)
class Joint:
    """What is known of a joint so far.

    Attributes
    ----------
    position : [mm or rad].
    classes : the classes of motion task that it can still have.
    velocity, acceleration, jerk : s', s'', s''' [per rad^k]; None while unknown.
    stated : which of them the designer states.
    key : of the segment that states them, for messages.
    rests : whether the motion rests on one side, or for a moment.
    """

    position: float
    classes: set[End] = field(default_factory=lambda: set(ENDS))
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    stated: set[str] = field(default_factory=set)
    key: str = ""
    rests: bool = False

    @property
    def end(self) -> End:
        """Its class, once there is but one."""
        (found,) = self.classes
        return found

    @property
    def values(self) -> Boundary:
        """Velocity and acceleration."""
        return self.velocity, self.acceleration

    @property
    def settled(self) -> bool:
        """Whether velocity and acceleration are known."""
        return None not in self.values


@dataclass(frozen=True, slots=True)
class Link:
    """A segment of the chain.

    Attributes
    ----------
    number : of the request, from 0.
    request : of the segment.
    length : of its span [rad].
    stroke : from its start to its end [mm or rad].
    """

    number: int
    request: Request
    length: float
    stroke: float

    @property
    def key(self) -> str:
        """Key of the segment in a scene."""
        return f"motion[{self.number + 1}]"

    @property
    def rests(self) -> bool:
        return isinstance(self.request, Dwell)

    @property
    def straight(self) -> bool:
        """Whether it is a straight line, which moves with one velocity."""
        return isinstance(self.request, MoveRequest) and self.request.law == STRAIGHT

    @property
    def speed(self) -> float:
        """Mean velocity [mm or rad, per rad]."""
        return self.stroke / self.length


@dataclass(frozen=True, slots=True)
class Chain:
    """The ring of segments that have a length.

    Attributes
    ----------
    links : in the order of the cam angle.
    joints : joint k before link k.
    unit : of the messages.
    """

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    unit: Unit

    def before(self, link: int) -> Joint:
        """The joint at the start of a link."""
        return self.joints[link]

    def after(self, link: int) -> Joint:
        """The joint at the end of a link."""
        return self.joints[(link + 1) % len(self.joints)]

    def around(self, joint: int) -> tuple[Link, Link]:
        """The links before and after a joint."""
        return self.links[joint - 1], self.links[joint]

    def turns(self, joint: int) -> bool:
        """Whether the motion turns back at a joint, or stands on one side of it."""
        before, after = self.around(joint)
        return before.stroke * after.stroke <= 0.0


def chain_of(requests: Sequence[Request], unit: Unit) -> Chain:
    """The chain of `requests`; segments of zero length are dropped, but a rest of zero length keeps
    its joint at rest.

    Raises
    ------
    GeometryError
        If a joint is given impossible values, a velocity at a rest or a jerk that the law does not
        meet; if the last position is not the first one.
    """
    links: list[Link] = []
    joints: list[Joint] = []
    moments: set[int] = set()  # joints at which a rest of zero length lies
    position = 0.0
    for number, request in enumerate(requests):
        start = position
        if isinstance(request, TableRequest):
            position = _after_table(start, request)
        elif not isinstance(request, Dwell):
            position = request.to
        if request.span == 0:
            if isinstance(request, Dwell):
                moments.add(len(links))
            continue
        length = math.radians(float(request.span))
        links.append(Link(number, request, length, position - start))
        joints.append(Joint(start))
    if position != 0.0:
        raise GeometryError(
            f"the motion starts at 0 and ends at {unit.text(position)}, it does not close after one"
            " turn; the last move must return to 0",
            key="motion",
        )
    chain = Chain(tuple(links), tuple(joints), unit)
    for number, link in enumerate(links):
        if isinstance(link.request, MoveRequest | PointsRequest):
            _state(chain.after(number), link)
    for joint in range(len(joints)):
        if joint in moments or any(link.rests for link in chain.around(joint)):
            _rest(joints[joint], unit)
    if len(links) in moments and joints:
        _rest(joints[0], unit)
    return chain


def _after_table(start: float, request: TableRequest) -> float:
    """The position at the end of a table; 0 where it is mere rounding."""
    end = start + request.rise
    size = float(np.max(np.abs(request.lifts)))
    return 0.0 if abs(end) <= ROUNDING * size else end


def _state(joint: Joint, link: Link) -> None:
    request = link.request
    assert isinstance(request, MoveRequest | PointsRequest)
    joint.key = link.key
    joint.velocity, joint.acceleration = request.velocity, request.acceleration
    joint.jerk = request.jerk if isinstance(request, MoveRequest) else None
    if joint.jerk is not None and getattr(request, "law", "") not in TAKE_JERK:
        raise GeometryError(
            f"is met by {' and '.join(TAKE_JERK)} only; leave it out or name one of them",
            key=f"{link.key}.jerk",
            value=f"{joint.jerk:g}",
        )
    for name in ("velocity", "acceleration", "jerk"):
        if getattr(joint, name) is not None:
            joint.stated.add(name)


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


FREE: Final = (AUTO, "polynomial-5", "polynomial-7", "polynomial")
"""Laws that can join to anything; between two of them the joint is as smooth as possible."""

ORDER: Final[tuple[End, ...]] = ("R", "U", "G", "B")


LEGEND: Final = ", ".join(f"{end} {NAMES[end]}" for end in ORDER)


def settle_straight_lines(chain: Chain) -> None:
    """Give the joints of a straight line its velocity; a rest next to one stays a rest.

    Raises
    ------
    GeometryError
        If a value stated there contradicts it.
    """
    for number, joint in enumerate(chain.joints):
        before, after = chain.around(number)
        if joint.rests:
            if before.straight and before.stroke and "velocity" in joint.stated:
                raise _contradiction(joint, "velocity", chain.unit.text(before.speed, 1))
            continue
        for link in (before, after):
            if link.straight:
                _on_straight_line(chain, joint, link)
                break


def settle_tasks(chain: Chain) -> None:
    """Give every joint of `chain` one class, and velocity or acceleration 0 where the class
    requires it.

    Raises
    ------
    GeometryError
        If the named laws cannot join; the message names laws that could.
    """
    for number in range(len(chain.joints)):
        _from_values(chain, number)
    possible = [_tasks(link) for link in chain.links]
    _strike_out(chain, possible, range(len(chain.links)))
    for number in sorted(range(len(chain.joints)), key=lambda each: -_turning(chain, each)):
        _choose(chain, possible, number)
    for joint in chain.joints:
        if joint.end in ("R", "U"):
            joint.velocity = 0.0
        if joint.end in ("R", "G"):
            joint.acceleration = 0.0


def task_of(chain: Chain, number: int) -> str:
    """The motion task of a move, once the classes are settled."""
    return f"{chain.before(number).end}-{chain.after(number).end}"


def is_free(link: Link) -> bool:
    """Whether a segment joins to any velocity and acceleration."""
    request = link.request
    if isinstance(request, MoveRequest):
        return request.law in FREE
    return isinstance(request, PointsRequest)


def is_auto(link: Link) -> bool:
    """Whether the law of a segment is camgeo's to choose."""
    return isinstance(link.request, MoveRequest) and link.request.law == AUTO


def is_law(link: Link) -> bool:
    """Whether a segment has a law that turns no sharper than it needs, unlike a polynomial of given
    values, which goes beyond its ends to meet a turn, and unlike data.
    """
    return isinstance(link.request, MoveRequest) and (is_auto(link) or not is_free(link))


def _tasks(link: Link) -> set[str] | None:
    """The tasks that a segment can have; None if it can have any."""
    request = link.request
    if not isinstance(request, MoveRequest) or link.straight or is_free(link):
        return None
    tasks = set(find_family(request.law).tasks)
    if link.stroke:
        return tasks
    if "R-R" not in tasks:
        raise GeometryError(
            "has no shape for a move that ends where it starts; polynomial-5 and auto have, and a"
            " dwell stands still",
            key=f"{link.key}.law",
            value=request.law,
        )
    return {"R-R"}


def _from_values(chain: Chain, number: int) -> None:
    """Eliminate the classes that known values exclude."""
    joint = chain.joints[number]
    if joint.classes == {"R"}:
        return
    velocity, acceleration = joint.velocity, joint.acceleration
    if velocity is not None:
        joint.classes &= {"R", "U"} if velocity == 0.0 else {"G", "B"}
    else:
        joint.classes -= {"G"}  # a constant velocity that is stated nowhere
    if acceleration is not None:
        joint.classes &= {"R", "G"} if acceleration == 0.0 else {"U", "B"}
    if velocity is not None and acceleration is not None:
        joint.classes = {end_of(velocity, acceleration)}
    elif velocity is None and joint.classes >= {"U", "B"} and chain.turns(number):
        joint.classes -= {"B"}  # it turns back here, so it is momentarily at rest


def _on_straight_line(chain: Chain, joint: Joint, link: Link) -> None:
    for order, (name, wanted) in enumerate(
        (("velocity", link.speed), ("acceleration", 0.0)), start=1
    ):
        stated = getattr(joint, name) if name in joint.stated else None
        if stated is not None and abs(stated - wanted) > 1e-9 * max(abs(stated), abs(wanted)):
            raise _contradiction(joint, name, chain.unit.text(wanted, order))
    joint.velocity, joint.acceleration = link.speed, 0.0


def _contradiction(joint: Joint, name: str, has: str) -> GeometryError:
    return GeometryError(
        f"contradicts the straight line at this joint, whose {name} is {has}; leave it out",
        key=f"{joint.key}.{name}",
        value=f"{getattr(joint, name):g}",
    )


def _strike_out(chain: Chain, possible: list[set[str] | None], numbers: Iterable[int]) -> None:
    """Keep the tasks and classes that fit together, from the links `numbers` on, until nothing
    changes. If a link is left without a task, everything is as it was, and its error is raised.
    """
    struck: list[tuple[Joint, set[End]]] = []
    lost: list[tuple[int, set[str]]] = []
    due, later = sorted(set(numbers)), set[int]()  # of this round and of the next, each in order
    while due or later:
        if not due:
            due, later = sorted(later), set()
        number = heapq.heappop(due)
        tasks = possible[number]
        if tasks is None:
            continue
        start, end = chain.before(number), chain.after(number)
        kept = {task for task in tasks if task[0] in start.classes and task[-1] in end.classes}
        if not kept:
            error = _no_task(chain, number)
            for joint, classes in reversed(struck):
                joint.classes = classes
            for each, before in reversed(lost):
                possible[each] = before
            raise error
        if len(kept) < len(tasks):
            lost.append((number, tasks))
            possible[number] = kept
        for joint, step, ends in (
            (start, -1, {t[0] for t in kept}),
            (end, 1, {t[-1] for t in kept}),
        ):
            fitting = joint.classes & ends
            if len(fitting) < len(joint.classes):
                struck.append((joint, joint.classes))
                joint.classes = fitting
                other = (number + step) % len(possible)
                if other > number:
                    heapq.heappush(due, other)
                else:
                    later.add(other)


def _choose(chain: Chain, possible: list[set[str] | None], number: int) -> None:
    """Give a joint the first of its classes, by preference, with which the others still have one.

    A chain in which one class is settled has no ring left, so what fits together pair by pair fits
    together as a whole.
    """
    joint = chain.joints[number]
    order = [each for each in dict.fromkeys(_preferences(chain, number)) if each in joint.classes]
    for attempt, wanted in enumerate(order, start=1):
        joint.classes = {wanted}
        try:
            return _strike_out(chain, possible, ((number - 1) % len(possible), number))
        except GeometryError:
            if attempt == len(order):
                raise
    return None


def _preferences(chain: Chain, number: int) -> tuple[End, ...]:
    links = chain.around(number)
    if all(is_free(link) for link in links):
        return ("U", "B", "R", "G") if chain.turns(number) else ("B", "U", "R", "G")
    turns = _turning(chain, number) or any(map(_jerks_from_rest, links))
    return ("U", *ORDER) if turns else ORDER


def _jerks_from_rest(link: Link) -> bool:
    """Whether a law is free of jerk steps from turn to turn, but not from rest to rest."""
    return isinstance(link.request, MoveRequest) and link.request.law == "simple-sine"


def _turning(chain: Chain, number: int) -> float:
    """How sharply a motion turns back at a joint between two laws: the change of its mean velocity
    over the spans [mm or rad, per rad^2]; 0 at other joints.
    """
    before, after = chain.around(number)
    if before.speed * after.speed >= 0.0 or not (is_law(before) and is_law(after)):
        return 0.0
    return abs(before.speed) / before.length + abs(after.speed) / after.length


def _no_task(chain: Chain, number: int) -> GeometryError:
    """The error for a law that does not fit between its joints, with those that would."""
    link = chain.links[number]
    assert isinstance(link.request, MoveRequest)
    starts, ends = (joint.classes for joint in (chain.before(number), chain.after(number)))
    here = [task for task in TASKS if task[0] in starts and task[-1] in ends]
    names = [
        name
        for name, family in FAMILIES.items()
        if name not in ("straight-line", "polynomial") and set(family.tasks) & set(here)
    ]
    family = find_family(link.request.law)
    words = " to ".join(
        " or ".join(NAMES[each] for each in ORDER if each in classes) for classes in (starts, ends)
    )
    return GeometryError(
        f"is made for {', '.join(family.tasks)} ({LEGEND}); here the move goes from {words}"
        f" ({', '.join(here)}), for which there are {', '.join(names)}, auto",
        key=f"{link.key}.law",
        value=family.name,
    )
