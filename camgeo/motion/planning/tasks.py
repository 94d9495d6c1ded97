"""The motion task of each move: the class of every joint, from stated values and allowed laws.

A law family is made for some pairs of classes; a joint's class must suit both sides. Classes that
do not fit are eliminated until nothing changes. Where several remain, the one that demands least of
the designer is chosen. Between segments that join to anything it is a turn where the motion turns
back, and a general motion where it continues. Beside a named law it is a rest, except between two
laws, one of which may be "auto", that turn back: without the drop of the acceleration to 0 that a
rest has, both need less (VDI 2143-1, sections 6.3 and 6.6). The sharpest turns choose first.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable
from typing import Final

from camgeo.errors import GeometryError
from camgeo.motion.boundary import NAMES, TASKS, End, end_of
from camgeo.motion.laws import FAMILIES, find_family
from camgeo.motion.planning.chain import Chain, Joint, Link
from camgeo.motion.planning.request import AUTO, MoveRequest, PointsRequest

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
