"""Which accelerations a law can turn with, in words: for messages about those that it cannot.

The acceleration at a turn runs from a bound, which it has where the other part of the law takes no
time, to infinity, where its own part takes none (see `camgeo.motion.laws.two_pulses`).
"""

from __future__ import annotations

import math

from camgeo.errors import GeometryError
from camgeo.motion.laws.family import Family
from camgeo.motion.laws.sine_straight import LEAST
from camgeo.motion.planning.chain import Chain


def out_of_reach(
    chain: Chain, number: int, family: Family, task: str, given: dict[str, float]
) -> GeometryError | None:
    """Why a law cannot have the acceleration a0 or a1 of `given`; None if it can, or takes none."""
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
    told = chain.unit.told
    side = "above" if above == (link.stroke > 0.0) else "below"
    place = "starts" if key == "a0" else "ends"
    message = (
        f"over {math.degrees(link.length):.6g} degrees and {told(link.stroke)},"
        f" {family.name} for {task} {place} with an acceleration {side}"
        f" {told(bound * physical, 2)}, here it meets {told(ends[key] * physical, 2)};"
        " polynomial-5 and auto meet any"
    )
    stated = "acceleration" in joint.stated
    return GeometryError(
        message,
        key=f"{joint.key}.acceleration" if stated else f"{link.key}.law",
        value=told(ends[key] * physical, 2) if stated else family.name,
    )


def _of_both(a0: float, a1: float) -> tuple[str, float, bool]:
    """Which of the two a sine-straight combination cannot have, its bound, and if it lies above."""
    if not a0 > LEAST:
        return "a0", LEAST, True
    if not -a1 > LEAST:
        return "a1", -LEAST, False
    least = LEAST * a0 / (a0 - LEAST)
    return "a1", -least, False
