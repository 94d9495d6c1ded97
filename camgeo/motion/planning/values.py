"""Velocity and acceleration of every joint: stated, fixed by a neighbour, or the smoothest.

What nothing fixes is chosen to minimise the integral of s''' squared over the surrounding moves:
the motion then has four continuous derivatives wherever its laws can follow. A turn is made at
least as sharp as a neighbouring law requires; the rest is then chosen anew.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE, Boundary
from camgeo.motion.laws import find_family
from camgeo.motion.planning.build import middle_law, named_law
from camgeo.motion.planning.chain import Chain, Joint, Link
from camgeo.motion.planning.request import MoveRequest, PointsRequest
from camgeo.motion.planning.tasks import is_free, task_of
from camgeo.numeric.arrays import ascending


def settle_values(chain: Chain) -> None:
    """Give every joint of `chain` a velocity and an acceleration [per rad^k].

    Raises
    ------
    GeometryError
        If a law cannot have the values at one end that it needs at the other, or the motion
        continues at a joint where the laws on both sides turn back.
    """
    asked_turns = {
        number: asked
        for number, joint in enumerate(chain.joints)
        if joint.end == "U" and (asked := _asked_turn(chain, number)) is not None
    }
    _from_laws(chain)
    known = [joint.values for joint in chain.joints]
    turns = {
        number: asked
        for number, asked in asked_turns.items()
        if chain.joints[number].acceleration is None
    }
    while True:
        _smoothest(chain)
        sharper = {
            number: asked
            for number, asked in turns.items()
            if (chain.joints[number].acceleration or 0.0) * asked < asked * asked
        }
        if not sharper:
            return
        for number, asked in sharper.items():
            known[number] = known[number][0], asked
            del turns[number]
        for joint, values in zip(chain.joints, known, strict=True):
            joint.velocity, joint.acceleration = values


def decides_turn(link: Link, task: str) -> bool:
    """Whether the parameters of a law fix the acceleration with which it turns."""
    request = link.request
    if not isinstance(request, MoveRequest) or link.straight or is_free(link):
        return False
    taken = find_family(request.law).parameters.get(task, ())
    if not taken:
        return "U" in task  # the double harmonic has only one acceleration
    if "inflection" not in taken or "U" not in task:
        return False
    if "curved" in taken:
        return {"inflection", "curved"} <= request.shaped_by
    # A law with one parameter can meet one of two turns.
    return "inflection" in request.shaped_by or task == "U-U"


def _from_laws(chain: Chain) -> None:
    """Turns whose acceleration a neighbouring law fixes; fully stated laws come first."""
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
        law = named_law(chain, number, task)
        for joint, boundary, letter in ((start, law.start, task[0]), (end, law.end, task[-1])):
            if letter == "U" and joint.acceleration is None:
                joint.acceleration = boundary.acceleration * link.stroke / link.length**2


def _asked_turn(chain: Chain, number: int) -> float | None:
    """The gentlest acceleration of a turn that suits the neighbouring laws; None if any does.

    A law must not turn more gently than with its inflection point in the middle.
    """
    found = []
    before, after = chain.around(number)
    for link, at_end in ((before, True), (after, False)):
        if not isinstance(link.request, MoveRequest) or link.straight or is_free(link):
            continue
        if link.stroke:
            place = chain.links.index(link)
            law = middle_law(chain, place, task_of(chain, place))
            boundary = law.end if at_end else law.start
            found.append(boundary.acceleration * link.stroke / link.length**2)
    if len(found) == 2 and found[0] * found[1] < 0.0:
        raise GeometryError(
            "would stand still for a moment at its end and then go on the same way: this law slows"
            " down to there, the next one speeds up from there, and their accelerations have"
            " opposite signs; polynomial-5 and auto pass with a velocity",
            key=f"{before.key}.law",
        )
    return max(found, key=abs, default=None)


def _sharpness(chain: Chain, number: int) -> float:
    """The largest acceleration at its ends that a law has with its inflection in the middle."""
    link = chain.links[number]
    law = middle_law(chain, number, task_of(chain, number))
    size = max(abs(law.start.acceleration), abs(law.end.acceleration))
    return size * abs(link.stroke) / link.length**2


def _stated_in_full(link: Link) -> bool:
    return isinstance(link.request, MoveRequest) and bool(link.request.shaped_by)


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
        from camgeo.motion.points import smoothest_values  # most plans have no open values

        self._check_distances()
        values = smoothest_values(
            np.array(self.places), np.array(self.positions), self.given, period
        )
        for index, joint in self.joints.items():
            joint.velocity, joint.acceleration = (float(value) for value in values[index])

    def _check_distances(self) -> None:
        """GeometryError if the distances are so unequal that values would lose their digits."""
        from camgeo.motion.points import MOST_UNEQUAL

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
            f" {ratio:.3g} times the shortest; allowed is up to {MOST_UNEQUAL:g}",
            key=f"{link.key}.{'points' if inside else 'span'}",
            value="" if inside else f"{link.request.span}",
        )
