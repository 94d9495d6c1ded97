"""Velocity and acceleration of every joint: stated, fixed by a neighbour, or the smoothest.

Turns between laws are settled by these (`camgeo.motion.planning.turns`). What nothing fixes is
chosen to minimise the integral of s''' squared over the surrounding moves: the motion then has four
continuous derivatives wherever its laws can follow. A turn is made at least as sharp as a
neighbouring law requires, and such that a law with one choice meets both its turns; the rest is
then chosen anew.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE, Boundary
from camgeo.motion.planning.chain import Chain, Joint, Link
from camgeo.motion.planning.request import PointsRequest
from camgeo.motion.planning.turns import settle_turns, tied_turns
from camgeo.numeric.arrays import ascending


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
            f" {ratio:.3g} times the shortest; allowed: up to {MOST_UNEQUAL:g}",
            key=f"{link.key}.{'points' if inside else 'span'}",
            value="" if inside else f"{link.request.span}",
        )
