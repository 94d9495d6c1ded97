"""The laws of moves: which reversals they determine, which law "auto" chooses, how each is built.

A reversal is a joint of the class U of VDI 2143-1: momentary rest with an acceleration.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from decimal import localcontext
from functools import lru_cache, partial
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import BALANCES, FAMILIES, LARGEST, build_law, find_family, make_law
from camgeo.kinematics.laws.family import COUNTED_FROM_END, Family, LawParameters
from camgeo.kinematics.laws.law import Characteristic, Law, acceleration_jumps, characteristic
from camgeo.kinematics.laws.polynomials import ORDERS, law_of_boundary_values
from camgeo.kinematics.laws.pulse import DIGITS
from camgeo.kinematics.laws.sine_straight import LEAST
from camgeo.kinematics.plan import SNAP, Move
from camgeo.kinematics.planning.requests import (
    AUTO,
    CRITERIA,
    STRAIGHT,
    TAKE_JERK,
    Link,
    RingJoint,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import bracketed_roots

MISSED = 1e-9
"""Relative error of a stated value that counts as rounding."""

GENTLEST = 1.0 - 1e-9
"""c of the gentlest sine-straight combination, a little below 1, so that rounding still permits a
reversal that is slightly gentler."""


RESOLVED: Final = 4.0 * SNAP
"""Length [rad] of the shortest part that a law may have; two cam angles closer than `SNAP` are the
same."""


def build_move(link: Link) -> Move:
    """The move by the requested law; the values of both its joints must be settled."""
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
    """Raise GeometryError if cam angles cannot distinguish the ends of a part of the law."""
    if law.inflection is None:
        return
    curved = law.parameters.get("curved", 1.0)
    shorter = curved * min(law.inflection, 1.0 - law.inflection) * link.length
    if shorter < RESOLVED:
        raise GeometryError(
            f"would speed up or slow down within {math.degrees(shorter):.2g} degrees of its"
            f" {math.degrees(link.length):.6g}, too few for cam angles to distinguish from a jump;"
            f" allowed: {math.degrees(RESOLVED):.2g} or more. A longer span beside a sharp"
            " reversal, a dwell there, even dwell = 0, or a larger inflection or curved part makes"
            " it possible",
            key=f"{link.key}.law",
            value=law.name,
        )


def named_law(link: Link) -> Law:
    """The law that a move names, for its task, with the known values of its joints.

    Raises
    ------
    GeometryError
        With the key of the segment, if there is no such law; the message states which values are
        possible.
    """
    request, family, task = link.move, find_family(link.law), link.task
    if task not in family.parameters:
        # The free polynomial has one task, B-B, which covers all classes of joints.
        task = family.tasks[0]
    with keyed(link):
        parameters = dict(request.parameters)
        known = normalised(link)
        parameters |= {key: known[key] for key in _needed(link, family.parameters[task], known)}
        if request.balance:
            parameters["inflection"] = balanced(family.name, task, request.balance, parameters)
        wrong = None
        try:
            law = build_law(family.name, task, parameters)
        except GeometryError:
            wrong = _unreachable_error(link, family, task, parameters)
            if wrong is None:
                raise
    if wrong is not None:
        raise wrong
    _check_stated(link, law)
    return law


def preferred_law(link: Link) -> Law:
    """The law that a move names, with its free parameters chosen regardless of the neighbours.

    The inflection point lies where the accelerations of both parts are equally large, or in the
    middle if there is no such place; a sine-straight combination reverses as gently as it can.
    """
    family, task = find_family(link.law), link.task
    accepted = family.parameters[task]
    known = normalised(link)
    parameters = {"curved": GENTLEST} if "curved" in accepted else {}
    parameters |= {key: known[key] for key in ("v0", "v1") if key in accepted and key in known}
    with keyed(link):
        parameters |= {key: value for key, value in link.move.parameters.items() if key in accepted}
        if "inflection" in accepted and "inflection" not in parameters:
            try:
                parameters["inflection"] = equal_accelerations(family.name, task, parameters)
            except GeometryError:
                parameters["inflection"] = 0.5
        return build_law(family.name, task, parameters)


def normalised(link: Link, unit: float | None = None) -> dict[str, float]:
    """Known boundary values of a move by name, "v0" to "j1", normalised.

    As multiples of the stroke, or of another `unit` [mm or rad] (VDI 2143-1, eqs. (136) to (141)).
    """
    unit, values = unit or link.stroke, {}
    for end, joint in (("0", link.start), ("1", link.end)):
        for key, value in zip("vaj", (*joint.values, joint.jerk), strict=True):
            if value is not None:
                values[key + end] = value * link.length ** ORDERS[key] / unit
    return values


def _needed(link: Link, taken: tuple[str, ...], known: dict[str, float]) -> list[str]:
    """Names of the boundary values that are passed to the law of a move, of those it takes."""
    ends = {"0": link.start, "1": link.end}
    keys = [key for key in taken if key in known]
    accelerations = [key for key in keys if key[0] == "a"]
    accelerations.sort(key=lambda key: "acceleration" not in ends[key[1]].stated)
    if "inflection" not in taken:
        return keys
    # An acceleration at a reversal is met by placing the inflection point (and by c, if there is
    # one), so a law can meet only as many accelerations as it has such parameters free. Stated
    # accelerations come first.
    free = 2 if "curved" in taken else 1
    free -= len({"inflection", "curved"} & link.move.stated_parameters)
    dropped = accelerations[max(free, 0) :]
    return [key for key in keys if key not in dropped]


def _check_stated(link: Link, law: Law) -> None:
    """Raise GeometryError if the law does not meet a value that the designer states.

    A law without a free parameter may have another value, as the simple sine from rest to rest has.
    """
    text = link.unit.text
    for joint, end in ((link.start, law.start), (link.end, law.end)):
        for order, name in enumerate(("velocity", "acceleration"), start=1):
            if name not in joint.stated:
                continue
            unit = link.stroke / link.length**order
            wanted, actual = getattr(joint, name), getattr(end, name) * unit
            if abs(actual - wanted) > MISSED * max(abs(actual), abs(wanted), abs(unit)):
                raise GeometryError(
                    f"cannot be met by {law.name} for {law.task} of {link.key}, whose {name} there"
                    f" is {text(actual, order)}; polynomial-5 and auto meet any value",
                    key=f"{joint.key}.{name}",
                    value=text(wanted, order),
                )


def law_without_stroke(link: Link) -> Law | None:
    """The law of a move that ends where it starts: a polynomial in mm or rad, as there is no stroke
    to normalise it by.

    None if velocity, acceleration and the stated jerk are 0 at both ends: the move is a rest.
    """
    name = "polynomial-5" if link.law == AUTO else find_family(link.law).name
    values = normalised(link, 1.0)
    if name not in TAKE_JERK:
        values = {key: value for key, value in values.items() if key[0] != "j"}
    if not any(values.values()):
        return None
    if name == "polynomial-7":
        values = {"j0": 0.0, "j1": 0.0, **values}
    with keyed(link):
        return law_of_boundary_values(name, link.task, values, {}, rise=0.0)


@contextmanager
def keyed(link: Link) -> Iterator[None]:
    """A context in which a GeometryError gets the key of the segment that requests the law.

    Errors without a key of their own, or about boundary values, get its key "law".
    """
    try:
        yield
    except GeometryError as error:
        key = error.key or "law"
        known = {"a0": "law", "a1": "law", "v0": "law", "v1": "law", "task": "law"}
        raise GeometryError(
            error.message, key=f"{link.key}.{known.get(key, key)}", value=error.value
        ) from error


def _unreachable_error(
    link: Link, family: Family, task: str, parameters: dict[str, float]
) -> GeometryError | None:
    """The error that says why a law cannot have the acceleration a0 or a1 of `parameters`; None if
    it can, or takes neither.

    The acceleration at a reversal ranges from a bound, reached if the other part of the law has no
    length, to infinity, if its own part has none (see `camgeo.kinematics.laws.pulse`).
    """
    ends: dict[str, float] = {key: parameters[key] for key in ("a0", "a1") if key in parameters}
    if family.parts is None or not ends:
        return None
    if len(ends) == 2:
        key, bound, above = _unreachable_end(ends["a0"], ends["a1"])
    else:
        key = next(iter(ends))
        rest = {name: value for name, value in parameters.items() if name not in ends}
        parts = family.parts(task, rest)
        bound, above = parts.reach()
        if key == "a0":  # the end of the mirror image, where the acceleration has the opposite sign
            bound, above = parts.mirrored.reach()
            bound, above = -bound, not above
        if family.name == "sine-straight" and "inflection" in parameters:
            inflection = parameters["inflection"]
            # With lambda stated, c alone is free: lambda C_a >= pi^2/4, see
            # `sine_straight.curved_for`.
            bound = LEAST / inflection if key == "a0" else -LEAST / (1.0 - inflection)
    if not key or (ends[key] > bound if above else ends[key] < bound):
        return None
    joint = link.start if key == "a0" else link.end
    physical = link.unit_acceleration
    text = link.unit.text
    # A negative stroke reverses the sign of physical accelerations.
    side = "above" if above == (link.stroke > 0.0) else "below"
    place = "starts" if key == "a0" else "ends"
    message = (
        f"over {math.degrees(link.length):.6g} degrees and {text(link.stroke)},"
        f" {family.name} for {task} {place} with an acceleration {side}"
        f" {text(bound * physical, 2)}, but {text(ends[key] * physical, 2)} is needed here;"
        " polynomial-5 and auto meet any value"
    )
    stated = "acceleration" in joint.stated
    return GeometryError(
        message,
        key=f"{joint.key}.acceleration" if stated else f"{link.key}.law",
        value=text(ends[key] * physical, 2) if stated else family.name,
    )


def _unreachable_end(a0: float, a1: float) -> tuple[str, float, bool]:
    """The name of the acceleration that a sine-straight combination cannot have, its bound, and
    whether it must lie above the bound.
    """
    if not a0 > LEAST:
        return "a0", LEAST, True
    if not -a1 > LEAST:
        return "a1", -LEAST, False
    # From a0 |a1|/(a0 + |a1|) >= pi^2/4, solved for |a1|.
    least = LEAST * a0 / (a0 - LEAST)
    return "a1", -least, False


# -- reversals ------------------------------------------------------------------------------------
# The acceleration at reversals, where the neighbouring laws determine it.


SHAPES: Final = frozenset({"inflection", "curved"})
"""Parameters by which a law meets the accelerations at its reversals."""

POWERS: Final = {"velocity": (1, 1), "acceleration": (2, 1), "jerk": (3, 1), "moment": (3, 2)}
"""Exponents of 1/span and of the stroke in each quantity that "auto" can keep small."""

TRIED: Final = 3
"""Number of accelerations compared from the best one of a move to that of the other move, both
included; with spans of 40 and 150 degrees the jerk is then 12 % above the smallest one possible."""

SAME: Final = 1e-12
"""Relative difference of accelerations that counts as rounding."""


def settle_reversals(links: Sequence[Link]) -> tuple[set[RingJoint], dict[RingJoint, float]]:
    """Give reversals the acceleration that the neighbouring laws determine.

    A law without a free parameter determines its reversals. Each other law prefers one
    acceleration: a law whose inflection point is not stated that with equally large accelerations
    in both its parts; "auto" that of its best law. A law meets any reversal that is sharper than
    the preferred one, so between two such laws the sharper one counts. Between two "auto" moves
    that keep the jerk small, which grows with the sharpness, the acceleration lies between the
    preferred ones.

    Returns
    -------
    The joints of the reversals that no law without a free parameter determines; and for those that
    remain open because one side meets any acceleration, the gentlest acceleration [mm or rad, per
    rad^2] that the law on the other side can have.

    Raises
    ------
    GeometryError
        If a law that meets the values at one end cannot meet those at the other, or the motion
        continues in the same direction at a joint where both laws have a reversal.
    """
    reversals = [link.start for link in links if link.start.kind == "U"]
    gentlest = {joint: _gentlest(joint) for joint in reversals}
    _decide(links, gentlest)
    undecided = [joint for joint in reversals if joint.acceleration is None]
    suited = {joint: _suited(joint) for joint in undecided}
    for joint, acceleration in suited.items():
        joint.acceleration = acceleration
    return set(undecided), {
        joint: acceleration
        for joint in undecided
        if suited[joint] is None and (acceleration := gentlest[joint]) is not None
    }


def tied_reversals(links: Sequence[Link], undecided: Set[RingJoint]) -> dict[RingJoint, float]:
    """The accelerations at both ends of a move between two reversals, by joint, if its law cannot
    meet them as they are: with one free parameter, one acceleration determines the other.

    A reversal that is not `undecided` determines the other one; if both are undecided, the gentler
    one does, as a multiple of the gentlest that the law can have, or the sharper one if the
    neighbour could not meet what follows. Empty if there is no such move, or neither of its
    reversals is open.
    """
    for link in links:
        ends = link.start, link.end
        is_open = [end in undecided for end in ends]
        adjustable, stated = _choices(link)
        ties = link.task == "U-U" and adjustable == SHAPES and len(stated) == 1
        if not ties or not any(is_open):
            continue
        accelerations = [end.acceleration or 0.0 for end in ends]
        size = [
            abs(acceleration / preferred)
            for acceleration, preferred in zip(
                accelerations, _preferred_reversals(link), strict=True
            )
        ]
        follows = int(size[0] <= size[1]) if all(is_open) else is_open.index(True)
        wanted = _following(link, follows)
        if all(is_open) and abs(wanted) < abs(_neighbour_reversal(ends[follows], link)):
            follows = 1 - follows
            wanted = _following(link, follows)
        if abs(wanted - accelerations[follows]) > SAME * abs(wanted):
            return {ends[follows]: wanted, ends[1 - follows]: accelerations[1 - follows]}
    return {}


def _following(link: Link, at_end: int) -> float:
    """The acceleration at one end of a move that its law determines from that at the other."""
    joint = link.end if at_end else link.start
    # Without a value here, the law follows from the other end alone.
    saved, joint.acceleration = joint.acceleration, None
    law = named_law(link)
    joint.acceleration = saved
    return (law.end if at_end else law.start).acceleration * link.stroke / link.length**2


def _neighbour_reversal(joint: RingJoint, link: Link) -> float:
    """The gentlest acceleration at a joint that the law on the side opposite to `link` can have; 0
    if that side has no named law.
    """
    return next(
        (acceleration for side, acceleration in _reversals_of_sides(joint) if side is not link), 0.0
    )


def _reversals_of_sides(joint: RingJoint) -> Iterator[tuple[Link, float]]:
    """The named laws before and after a joint, each with the acceleration that it prefers there."""
    for link, at_end in _sides(joint):
        if link.is_named and link.stroke:
            yield link, _preferred_reversals(link)[at_end]


def _sides(joint: RingJoint) -> tuple[tuple[Link, int], tuple[Link, int]]:
    """The links before and after a joint, each with the number of its end that the joint is: 0 for
    its start, 1 for its end.
    """
    return (joint.previous, 1), (joint.following, 0)


def _choices(link: Link) -> tuple[frozenset[str], frozenset[str]]:
    """The parameters by which a named law can meet reversals, and those of them that are stated."""
    if not link.is_named:
        return frozenset(), frozenset()
    adjustable = SHAPES & {*find_family(link.law).parameters.get(link.task, ())}
    return adjustable, adjustable & link.move.stated_parameters


def _decides_reversal(link: Link) -> bool:
    """Whether the parameters of a law determine the acceleration at its reversals."""
    if not link.is_named or "U" not in link.task:
        return False
    adjustable, stated = _choices(link)
    # A law with one parameter can meet the acceleration of one of two reversals only.
    return stated == adjustable or (link.task == "U-U" and len(adjustable) == 1)


def _decide(links: Sequence[Link], gentlest: Mapping[RingJoint, float | None]) -> None:
    """Give the reversals of laws without a free parameter their acceleration; fully stated laws
    come first.

    A law that can meet one of its two reversals meets the one at which the neighbour needs a
    sharper reversal than this law prefers; `gentlest` gives the needed accelerations by joint.
    """
    deciding = [link for link in links if link.stroke and _decides_reversal(link)]
    # A law meets any reversal that is sharper than the preferred one, so the sharpest come first.
    deciding.sort(
        key=lambda link: (
            not link.move.stated_parameters,
            -max(map(abs, _preferred_reversals(link))),
        )
    )
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


def _choose_sharper(link: Link, gentlest: Mapping[RingJoint, float | None]) -> None:
    """Give one reversal of a law the acceleration that the neighbour there needs, if that is
    sharper than the preferred one.
    """
    adjustable, stated = _choices(link)
    if adjustable == stated:
        return
    ends = link.start, link.end
    needed = [gentlest[end] or 0.0 for end in ends]
    sizes = [
        acceleration / preferred
        for acceleration, preferred in zip(needed, _preferred_reversals(link), strict=True)
    ]
    sharper = sizes.index(max(sizes))
    if sizes[sharper] > 1.0:
        ends[sharper].acceleration = needed[sharper]


def _gentlest(joint: RingJoint) -> float | None:
    """The gentlest acceleration at a reversal that the named laws beside it can meet; None if there
    are no such laws.
    """
    accelerations = [acceleration for _, acceleration in _reversals_of_sides(joint)]
    if len(accelerations) == 2 and accelerations[0] * accelerations[1] < 0.0:
        raise GeometryError(
            "would stop for a moment at its end and then continue in the same direction: this law"
            " decelerates up to there, the next one accelerates from there, and their accelerations"
            " have opposite signs; polynomial-5 and auto pass with a velocity",
            key=f"{joint.previous.key}.law",
        )
    return max(accelerations, key=abs, default=None)


def _suited(joint: RingJoint) -> float | None:
    """The acceleration at a reversal that suits the laws on both sides; None if one side meets any
    acceleration, or if neither law prefers its own acceleration to a sharper one.
    """
    candidates, prefers = [], False
    for link, at_end in _sides(joint):
        accelerations = _preferred_reversals(link) if link.is_named else _best_reversals(link)
        if not link.stroke or accelerations is None:
            return None
        candidates.append(accelerations[at_end])
        prefers |= _choices(link)[0] != SHAPES
    if not prefers or candidates[0] * candidates[1] <= 0.0:
        return None
    links = joint.previous, joint.following
    if not any("jerk" in link.move.optimise for link in links):
        return max(candidates, key=abs)
    # A reversal sharper than the preferred one costs a law more jerk.
    return _compromise(joint, candidates) if all(link.law == AUTO for link in links) else None


def _compromise(joint: RingJoint, candidates: list[float]) -> float:
    """The acceleration at a reversal between two "auto" moves that keeps small what both optimise.

    `candidates` are the accelerations that each of them prefers.
    """
    gentler, sharper = sorted(candidates, key=abs)
    accelerations = gentler * np.geomspace(1.0, sharper / gentler, TRIED)
    weights: Counter[str] = Counter()
    sizes = {name: np.zeros(TRIED) for name in POWERS}
    for link, at_end in _sides(joint):
        request, both = link.move, _best_reversals(link)
        assert both is not None
        weights.update(request.optimise or DEFAULT)
        unit = link.unit_acceleration
        known = {
            f"a{end}": acceleration / unit for end, acceleration in enumerate(both) if acceleration
        }
        known |= normalised(link)
        for place, acceleration in enumerate(accelerations):
            criteria = criterion_sizes(
                link.task, known | {f"a{at_end}": acceleration / unit}, request.optimise
            )
            for name, (spans, strokes) in POWERS.items():
                size = criteria[name] * abs(link.stroke) ** strokes / link.length**spans
                sizes[name][place] = max(sizes[name][place], size)
    costs = [weight * sizes[name] / np.min(sizes[name]) for name, weight in weights.items()]
    return float(accelerations[int(np.argmin(np.sum(costs, axis=0)))])


def _preferred_reversals(link: Link) -> tuple[float, float]:
    """The accelerations at both ends of the `preferred_law` of a link; the law cannot reverse more
    gently than with these.
    """
    law = preferred_law(link)
    unit = link.unit_acceleration
    return law.start.acceleration * unit, law.end.acceleration * unit


def _best_reversals(link: Link) -> tuple[float, float] | None:
    """The accelerations at both ends of the best law for "auto"; None if there is no best one."""
    if link.law != AUTO or not link.stroke or "B" in link.task or link.move.parameters:
        return None
    known = normalised(link)
    optimise = tuple(sorted(link.move.optimise.items()))
    accelerations = best_reversal(link.task, known["v0"], known["v1"], optimise)
    unit = link.unit_acceleration
    return accelerations and (accelerations[0] * unit, accelerations[1] * unit)


# -- auto -----------------------------------------------------------------------------------------
# `law = "auto"`: the law of a move, chosen by its task and the quantities to keep small.


DEFAULT: Mapping[str, float] = {"acceleration": 1.0}

SUBSTITUTES = {"velocity": "moment"}

GENTLEST_SHIFT, SHARPEST = 0.5, 4.0
"""Range of accelerations that are tried, as multiples of the gentlest one of a law with equally
large accelerations in both its parts."""

STEPS = 12
"""Steps of the search in this range; they leave 1 % of the acceleration."""

GAIN = 1e-3
"""Fraction of the cost that an acceleration from this search must save to replace one of the
preferred accelerations."""

Rated = tuple[Law, Characteristic]

SLACK = 1e-9
"""A boundary value is met if its error is at most this fraction of the largest one."""

TIE = 1e-9
"""Costs that differ by less than this fraction are equal: where a reversal determines the largest
acceleration, many laws share it."""

RUNS_BACK = 1e-9
"""A law overshoots if it leaves [0, 1] by more than this."""


def best_law(
    task: str,
    known: Mapping[str, float],
    parameters: Mapping[str, float],
    optimise: Mapping[str, float],
) -> Law:
    """The law for `task` that is best by `optimise` among those without jerk or shock.

    Parameters
    ----------
    task : "R-R" to "B-B".
    known : boundary values, normalised, "v0" to "a1".
    parameters : parameters stated by the designer; a family that does not take them is skipped.
    optimise : weights of velocity, acceleration, jerk, moment; each value counts as a multiple of
        the smallest that any law has. If empty, the acceleration alone.

    A law that overshoots is chosen only if all do. Of equal laws the first registered wins.
    """
    laws = [law for name in FAMILIES for law in _candidates(name, task, known, parameters)]
    rated: Sequence[Rated] = [(law, characteristic(law)) for law in laws]
    if not rated:
        stated = ", ".join(f"{key} = {value:g}" for key, value in parameters.items())
        raise GeometryError(
            f"no law for {task} with {stated or 'no stated parameter'} meets velocity and"
            " acceleration at both its ends; leave those parameters out, or name a law, which then"
            " determines how sharply the motion reverses",
            key=next(iter(parameters), "law"),
            value="auto",
        )
    rated = [pair for pair in rated if not _overshoots(pair[1])] or rated
    costs = _costs(rated, optimise or DEFAULT)
    nearly = min(costs) * (1.0 + TIE)
    return next(law for (law, _), cost in zip(rated, costs, strict=True) if cost <= nearly)


@lru_cache(maxsize=64)
def best_reversal(
    task: str, v0: float = 0.0, v1: float = 0.0, optimise: tuple[tuple[str, float], ...] = ()
) -> tuple[float, float] | None:
    """f'' at both ends of the law that is best by `optimise` with a reversal of any sharpness.

    Parameters
    ----------
    task : a task with a reversal and without a general motion.
    v0, v1 : f' at the ends.
    optimise : as for `best_law`, in pairs. The moment replaces the velocity, which is smallest at a
        limit of the range, with a reversal as gentle or as sharp as it can be.

    Returns
    -------
    None if no law for the task has equally large accelerations in both its parts, from which the
    search starts. For U-U both values are equal except for the sign.
    """
    if task[0] == "U" and task != "U-U":  # the mirror image
        mirrored = best_reversal(f"{task[-1]}-U", v1, v0, optimise)
        return mirrored and (-mirrored[1], -mirrored[0])
    known = {"v0": v0, "v1": v1}
    preferred = [
        acceleration
        for name in FAMILIES
        if (acceleration := _preferred_reversal(name, task, known))
    ]
    if not preferred:
        return None
    middle = min(preferred, key=abs)
    weights: dict[str, float] = {}
    for name, weight in optimise or DEFAULT.items():
        weights[SUBSTITUTES.get(name, name)] = (
            weights.get(SUBSTITUTES.get(name, name), 0.0) + weight
        )

    def rated(name: str, acceleration: float) -> Sequence[Rated]:
        ends = {"a1": acceleration, **({"a0": -acceleration} if task == "U-U" else {})}
        return [(law, characteristic(law)) for law in _candidates(name, task, known | ends, {})]

    scale = _least([pair for name in FAMILIES for pair in rated(name, middle)], weights)

    def cost(name: str, acceleration: float) -> float:
        tame = [pair for pair in rated(name, acceleration) if not _overshoots(pair[1])]
        return min(_costs(tame, weights, scale), default=math.inf)

    best = min(
        (cost(name, acceleration), acceleration) for name in FAMILIES for acceleration in preferred
    )
    for name in FAMILIES:
        if task in FAMILIES[name].tasks:
            acceleration = _lowest(partial(cost, name), GENTLEST_SHIFT * middle, SHARPEST * middle)
            lowest = cost(name, acceleration)
            if lowest < best[0] * (1.0 - GAIN):
                best = lowest, acceleration
    acceleration = best[1]
    return (-acceleration if task == "U-U" else 0.0), acceleration


def _preferred_reversal(name: str, task: str, known: Mapping[str, float]) -> float | None:
    """f'' at the end of the law with equally large accelerations in both its parts; None if there
    is no such law.
    """
    family = FAMILIES[name]
    if family.parts is None or task not in family.tasks:
        return None
    parameters = {key: value for key, value in known.items() if key in family.parameters[task]}
    try:
        place = equal_accelerations(name, task, parameters)
        return build_law(name, task, {**parameters, "inflection": place}).end.acceleration
    except GeometryError:
        return None


def _lowest(cost: Callable[[float], float], low: float, high: float) -> float:
    """The argument with the lowest `cost` between `low` and `high`, by golden-section search."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    inner = [high - ratio * (high - low), low + ratio * (high - low)]
    costs = [cost(place) for place in inner]
    for _ in range(STEPS):
        if costs[0] <= costs[1]:
            high = inner[1]
            inner, costs = [high - ratio * (high - low), inner[0]], [0.0, costs[0]]
            # Golden section: one of the two inner places and its cost carry over, so that each step
            # needs one new cost.
            costs[0] = cost(inner[0])
        else:
            low = inner[0]
            inner, costs = [inner[1], low + ratio * (high - low)], [costs[1], 0.0]
            costs[1] = cost(inner[1])
    return inner[0] if costs[0] <= costs[1] else inner[1]


def _least(rated: Sequence[Rated], weights: Mapping[str, float]) -> dict[str, float]:
    """The smallest value of each quantity of `weights` among the `rated` laws."""
    return {name: min(criterion_size(values, name) for _, values in rated) for name in weights}


def _costs(
    rated: Sequence[Rated],
    weights: Mapping[str, float],
    least: Mapping[str, float] | None = None,
) -> list[float]:
    """Weighted sum, for each law, of its values as multiples of the `least` ones; by default the
    smallest values among the `rated` laws.
    """
    least = least or _least(rated, weights)
    return [
        sum(
            weight * criterion_size(values, name) / least[name] if least[name] else 0.0
            for name, weight in weights.items()
        )
        for _, values in rated
    ]


def criterion_sizes(
    task: str, known: Mapping[str, float], optimise: Mapping[str, float]
) -> dict[str, float]:
    """The value of each of `CRITERIA` for the `best_law` with these boundary values."""
    values = characteristic(best_law(task, known, {}, optimise))
    return {name: criterion_size(values, name) for name in CRITERIA}


def criterion_size(values: Characteristic, name: str) -> float:
    """Largest magnitude of a quantity: "velocity", "acceleration", "jerk" or "moment"."""
    high, low = {
        "velocity": (values.velocity, values.least_velocity),
        "acceleration": (values.largest_acceleration, values.least_acceleration),
        "jerk": (values.largest_jerk, values.least_jerk),
        "moment": (values.largest_moment, values.least_moment),
    }[name]
    return max(abs(high.value), abs(low.value))


def _candidates(
    name: str, task: str, known: Mapping[str, float], parameters: Mapping[str, float]
) -> list[Law]:
    family = FAMILIES[name]
    if name == "polynomial" or task not in family.tasks:
        return []
    accepted = family.parameters[task]
    if not parameters.keys() <= set(accepted):
        return []
    law_parameters = {**parameters}
    law_parameters |= {
        key: known.get(key, 0.0) for key in accepted if key[0] in "va" and key[1:] in ("0", "1")
    }
    try:
        if "inflection" in accepted and "inflection" not in law_parameters and "U" not in task:
            if task != "R-R":
                law_parameters["inflection"] = equal_accelerations(name, task, law_parameters)
        elif "inflection" in law_parameters:
            law_parameters = {key: value for key, value in law_parameters.items() if key[0] != "a"}
        law = build_law(name, task, law_parameters)
    except GeometryError:
        return []
    return [law] if _fits(law, known) else []


def _fits(law: Law, known: Mapping[str, float]) -> bool:
    """Whether a law meets the boundary values and has no jump of the acceleration inside."""
    met = {
        "v0": law.start.velocity,
        "a0": law.start.acceleration,
        "v1": law.end.velocity,
        "a1": law.end.acceleration,
    }
    size = max(map(abs, known.values()), default=1.0)
    gaps = (abs(met[key] - known.get(key, 0.0)) for key in met)
    return max(gaps) <= SLACK * size and not acceleration_jumps(law)


def _overshoots(values: Characteristic) -> bool:
    return values.lift.value > 1.0 + RUNS_BACK or values.least_lift.value < -RUNS_BACK


# -- balance --------------------------------------------------------------------------------------
# The inflection point that makes an extreme of both parts of a law equal: the inverse relations.
#
# VDI 2143-1 gives lambda for equal accelerations, equal jerks and equal dynamic moments of some
# laws as numbers (sections 6.6.1 and 6.6.2); here it is computed for each law with an inflection
# point.


NEAREST: Final = 1e-6
"""Distance from 0 and from 1 up to which an inflection point is searched."""

TINY: Final = 1e-300
"""Replaces 0, the extreme of a part without acceleration, when a logarithm is taken."""


def equal_accelerations(name: str, task: str, parameters: LawParameters) -> float:
    """lambda, as VDI 2143-1 counts it, at which |C_a| = |C_a*|, from a quadratic.

    Parameters
    ----------
    name, task : a law with an inflection point, see `camgeo.kinematics.laws.make_law`.
    parameters : its other parameters.

    Raises
    ------
    GeometryError
        If the law has no inflection point, or none makes them equal.
    """
    family = find_family(name)
    if family.parts is None:
        raise GeometryError(f"{name} has no inflection point", key="inflection")
    parts = family.parts(
        checked.one_of("task", task, family.tasks),
        checked.by_name("parameters", parameters, LARGEST),
    )
    place = parts.inflection_for_equal_accelerations()
    with localcontext(DIGITS):
        return float(1 - place if task in COUNTED_FROM_END else place)


def balanced(name: str, task: str, quantity: str, parameters: LawParameters) -> float:
    """lambda at which both parts have the same largest acceleration, jerk or dynamic moment.

    Parameters
    ----------
    quantity : one of `BALANCES`.

    Raises
    ------
    GeometryError
        If the law has no inflection point, or none makes them equal.
    """
    if checked.one_of("quantity", quantity, BALANCES) == "acceleration":
        return equal_accelerations(name, task, parameters)

    def difference(places: FloatArray) -> FloatArray:
        laws = (build_law(name, task, {**parameters, "inflection": float(lam)}) for lam in places)
        return np.array([_log_ratio(characteristic(law), quantity) for law in laws])

    # The extreme of a part grows beyond all bounds as the part becomes short, so the range is a
    # bracket, and any place in it with equal extremes is a solution.
    ends = np.array([NEAREST, 1.0 - NEAREST])
    low, high = difference(ends)
    if low * high >= 0.0:  # without jerk both parts are alike everywhere
        raise GeometryError(
            f"no inflection point makes the {quantity} equal in both parts of {name} for {task}",
            key="inflection",
        )
    return float(bracketed_roots(difference, ends[:1], ends[1:])[0])


def _log_ratio(values: Characteristic, quantity: str) -> float:
    first, second = {
        "jerk": (values.jerk, values.braking_jerk),
        "moment": (values.moment, values.braking_moment),
    }[quantity]
    return math.log(max(abs(first.value), TINY)) - math.log(max(abs(second.value), TINY))
