"""The segments of a turn in a ring, with the joints between them, which planning works on.

Segment k lies between joint k and joint k + 1; the last joint is the first. What is known of a
joint is filled in step by step, by the modules of this package in turn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import ENDS, Boundary, End
from camgeo.motion.laws import FAMILIES
from camgeo.motion.plan import Dwell
from camgeo.motion.planning.request import (
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)

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
