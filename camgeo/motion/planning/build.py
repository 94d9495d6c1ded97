"""From settled joints to segments: the law that each move requests, normalised and built."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

from camgeo.errors import GeometryError
from camgeo.motion.laws import find_family, law_of
from camgeo.motion.laws.family import Family
from camgeo.motion.laws.law import Law
from camgeo.motion.laws.sine_straight import LEAST
from camgeo.motion.laws.two_point import ORDERS, law_of_boundary_values
from camgeo.motion.planning.chain import TAKE_JERK, Chain, Link
from camgeo.motion.planning.request import AUTO, MoveRequest
from camgeo.motion.planning.tasks import task_of

MISSED = 1e-9
"""Relative error of a stated value that counts as rounding."""

GENTLEST = 1.0 - 1e-9
"""c of a sine-straight combination, which may turn slightly more gently still, by rounding."""


def named_law(chain: Chain, number: int, task: str) -> Law:
    """The law that a move names, for `task`, with what is known of its joints.

    Raises
    ------
    GeometryError
        With the key of the segment, if there is no such law; it states which value would do.
    """
    link = chain.links[number]
    request = link.request
    assert isinstance(request, MoveRequest)
    family = find_family(request.law)
    if task not in family.parameters:
        task = family.tasks[0]  # the polynomial of what is given has but one
    with keyed(link):
        given = dict(request.parameters)
        known = normalised(chain, number)
        given |= {key: known[key] for key in _needed(chain, number, family.parameters[task], known)}
        if request.balance:
            from camgeo.motion.laws.balance import balanced

            given["inflection"] = balanced(family.name, task, request.balance, given)
        wrong = None
        try:
            law = law_of(family.name, task, given)
        except GeometryError:
            wrong = _out_of_reach(chain, number, family, task, given)
            if wrong is None:
                raise
    if wrong is not None:
        raise wrong
    _check_stated(chain, number, law)
    return law


def own_law(chain: Chain, number: int, task: str) -> Law:
    """The law that a move names, with the parameters that are not stated chosen for it alone.

    The inflection point lies where the accelerations of both parts are equally large, or in the
    middle if there is no such place; a sine-straight combination turns as gently as it can.
    """
    link = chain.links[number]
    request = link.request
    assert isinstance(request, MoveRequest)
    family = find_family(request.law)
    taken = family.parameters[task]
    known = normalised(chain, number)
    given = {"curved": GENTLEST} if "curved" in taken else {}
    given |= {key: known[key] for key in ("v0", "v1") if key in taken and key in known}
    with keyed(link):
        given |= {key: value for key, value in request.parameters.items() if key in taken}
        if "inflection" in taken and "inflection" not in given:
            given["inflection"] = _balanced(family.name, task, given)
        return law_of(family.name, task, given)


def _balanced(name: str, task: str, given: dict[str, float]) -> float:
    from camgeo.motion.laws.balance import equal_accelerations  # few plans need it

    try:
        return equal_accelerations(name, task, given)
    except GeometryError:
        return 0.5


def normalised(chain: Chain, number: int) -> dict[str, float]:
    """Known values at both ends, "v0" to "j1", normalised (VDI 2143-1, eqs. (136) to (141))."""
    link = chain.links[number]
    return _scaled(chain, number, link.stroke)


def _scaled(chain: Chain, number: int, unit: float) -> dict[str, float]:
    link = chain.links[number]
    found = {}
    for end, joint in (("0", chain.before(number)), ("1", chain.after(number))):
        for key, value in zip("vaj", (*joint.values, joint.jerk), strict=True):
            if value is not None:
                found[key + end] = value * link.length ** ORDERS[key] / unit
    return found


def _needed(
    chain: Chain, number: int, taken: tuple[str, ...], known: dict[str, float]
) -> list[str]:
    """The boundary values that a law is given, of those it takes."""
    request = chain.links[number].request
    assert isinstance(request, MoveRequest)
    ends = {"0": chain.before(number), "1": chain.after(number)}
    keys = [key for key in taken if key in known]
    accelerations = [key for key in keys if key[0] == "a"]
    accelerations.sort(key=lambda key: "acceleration" not in ends[key[1]].stated)
    if "inflection" not in taken:
        return keys
    # A turn is met by the place of the inflection point (and by c, where there is one).
    free = 2 if "curved" in taken else 1
    free -= len({"inflection", "curved"} & request.shaped_by)
    dropped = accelerations[max(free, 0) :]
    return [key for key in keys if key not in dropped]


def _check_stated(chain: Chain, number: int, law: Law) -> None:
    """What a designer states is met, or refused: a law that has no freedom left may have another
    value, as the simple sine from rest to rest has.
    """
    link = chain.links[number]
    for joint, end in ((chain.before(number), law.start), (chain.after(number), law.end)):
        for order, name in enumerate(("velocity", "acceleration"), start=1):
            if name not in joint.stated:
                continue
            unit = link.stroke / link.length**order
            wanted, found = getattr(joint, name), getattr(end, name) * unit
            if abs(found - wanted) > MISSED * max(abs(found), abs(wanted), abs(unit)):
                raise GeometryError(
                    f"cannot be met by {law.name} for {law.task} of {link.key}, whose {name} there"
                    f" is {chain.unit.text(found, order)}; polynomial-5 and auto meet any",
                    key=f"{joint.key}.{name}",
                    value=chain.unit.text(wanted, order),
                )


def law_without_stroke(chain: Chain, number: int) -> Law | None:
    """The law of a move that ends where it starts, a polynomial whose scale is its own [mm or rad].

    None if velocity, acceleration and the stated jerk are 0 at both ends: the move rests.
    """
    link = chain.links[number]
    assert isinstance(link.request, MoveRequest)
    name = "polynomial-5" if link.request.law == AUTO else find_family(link.request.law).name
    values = _scaled(chain, number, 1.0)
    if name not in TAKE_JERK:
        values = {key: value for key, value in values.items() if key[0] != "j"}
    if not any(values.values()):
        return None
    if name == "polynomial-7":
        values = {"j0": 0.0, "j1": 0.0, **values}
    with keyed(link):
        return law_of_boundary_values(name, task_of(chain, number), values, {}, rise=0.0)


@contextmanager
def keyed(link: Link) -> Iterator[None]:
    """Errors get the key of the segment that requests the law; "law" where they have none."""
    try:
        yield
    except GeometryError as error:
        key = error.key or "law"
        known = {"a0": "law", "a1": "law", "v0": "law", "v1": "law", "task": "law"}
        raise GeometryError(
            error.message, key=f"{link.key}.{known.get(key, key)}", value=error.value
        ) from error


def _out_of_reach(
    chain: Chain, number: int, family: Family, task: str, given: dict[str, float]
) -> GeometryError | None:
    """The reason why a law cannot have the acceleration a0 or a1 of `given`; None if it can, or
    takes neither.

    The acceleration at a turn runs from a bound, which it has where the other part of the law takes
    no time, to infinity, where its own part takes none (see `camgeo.motion.laws.two_pulses`).
    """
    ends: dict[str, float] = {key: given[key] for key in ("a0", "a1") if key in given}
    if family.parts is None or not ends:
        return None
    if len(ends) == 2:
        key, bound, above = _of_both(ends["a0"], ends["a1"])
    else:
        key = next(iter(ends))
        rest = {name: value for name, value in given.items() if name not in ends}
        parts = family.parts(task, rest)
        bound, above = parts.reach()
        if key == "a0":  # of the mirror image, whose acceleration has the other sign
            bound, above = parts.mirrored.reach()
            bound, above = -bound, not above
        if family.name == "sine-straight" and "inflection" in given:
            inflection = given["inflection"]
            bound = LEAST / inflection if key == "a0" else -LEAST / (1.0 - inflection)
    if not key or (ends[key] > bound if above else ends[key] < bound):
        return None
    link = chain.links[number]
    joint = chain.before(number) if key == "a0" else chain.after(number)
    physical = link.stroke / link.length**2
    text = chain.unit.text
    side = "above" if above == (link.stroke > 0.0) else "below"
    place = "starts" if key == "a0" else "ends"
    message = (
        f"over {math.degrees(link.length):.6g} degrees and {text(link.stroke)},"
        f" {family.name} for {task} {place} with an acceleration {side}"
        f" {text(bound * physical, 2)}, but {text(ends[key] * physical, 2)} is needed here;"
        " polynomial-5 and auto meet any"
    )
    stated = "acceleration" in joint.stated
    return GeometryError(
        message,
        key=f"{joint.key}.acceleration" if stated else f"{link.key}.law",
        value=text(ends[key] * physical, 2) if stated else family.name,
    )


def _of_both(a0: float, a1: float) -> tuple[str, float, bool]:
    """Which of the two a sine-straight combination cannot have, its bound, and if it lies above."""
    if not a0 > LEAST:
        return "a0", LEAST, True
    if not -a1 > LEAST:
        return "a1", -LEAST, False
    least = LEAST * a0 / (a0 - LEAST)
    return "a1", -least, False
