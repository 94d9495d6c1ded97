"""The acceleration of turns, where the laws beside them decide it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Set

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.laws import find_family
from camgeo.motion.planning.build import named_law, normalised, own_law
from camgeo.motion.planning.chain import Chain, Link
from camgeo.motion.planning.request import MoveRequest
from camgeo.motion.planning.tasks import is_auto, is_law, task_of

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
    from camgeo.motion.planning.auto import DEFAULT, sizes_at

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
    from camgeo.motion.planning.auto import best_turn  # few plans need it

    known = normalised(chain, number)
    found = best_turn(task, known["v0"], known["v1"], tuple(sorted(request.optimise.items())))
    unit = link.stroke / link.length**2
    return found and (found[0] * unit, found[1] * unit)


def _sharpness(chain: Chain, number: int) -> float:
    """The largest acceleration that a law has at its ends where these are equally large inside."""
    return max(map(abs, _own_turns(chain, number)))


def _stated_in_full(link: Link) -> bool:
    return isinstance(link.request, MoveRequest) and bool(link.request.shaped_by)
