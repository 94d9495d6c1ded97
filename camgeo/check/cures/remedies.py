"""All cures of the faults of a cam, or of a conjugate pair."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Final

from camgeo.check.cures.conditions import Angle, Bend, Condition, Convex, Discs, Ratio
from camgeo.check.cures.cure import Cure
from camgeo.check.cures.laws import other_law
from camgeo.check.cures.sizes import base_radius, face_out, offset_or_arm, roller_radius
from camgeo.check.cures.spans import longer_segment
from camgeo.check.cures.task import Edits, Task
from camgeo.check.finding import BROKEN, RETURN, Finding
from camgeo.units import LengthUnit

OF_MOTION: Final = (longer_segment, other_law)

CONDITIONS: Final[Mapping[str, Callable[[float, float], dict[str, Condition]]]] = {
    "roller": lambda angle, ratio: {
        "undercut": Bend(),
        "radius ratio": Ratio(ratio),
        "transmission angle": Angle(angle),
    },
    "face": lambda angle, _: {"convexity": Convex(), "transmission angle": Angle(angle)},
}
"""What must hold, by the fault where it does not, and by what touches the cam."""

KNOBS: Final = {
    ("roller", Bend): (base_radius, roller_radius, offset_or_arm, *OF_MOTION),
    ("roller", Ratio): (base_radius, roller_radius, offset_or_arm, *OF_MOTION),
    ("roller", Angle): (base_radius, offset_or_arm, *OF_MOTION),
    ("face", Convex): (face_out,),
    ("face", Angle): OF_MOTION,
}
"""What may be changed against a fault, by what touches the cam."""


def remedies(
    discs: Discs,
    angle: float,
    ratio: float,
    findings: Iterable[Finding],
    unit: LengthUnit,
    judged: Callable[[Discs, Edits], tuple[Iterable[Finding], Iterable[Finding]]],
) -> tuple[Cure, ...]:
    """The nearest cure of each fault by each knob with all others unchanged.

    Fault by fault, the cheapest first. Lengths are rounded in `unit`. Knobs that have no cure come
    last and say why. Empty if there is nothing to cure, or if there is no mechanism.

    Parameters
    ----------
    angle, ratio : the least transmission angle [rad] and the largest r_R/r_K that are allowed.
    findings : on the discs.
    judged : see `Task`.
    """
    found = [*findings]
    bad = [each for each in found if each.severity in BROKEN]
    names = [each.name.removeprefix(f"{RETURN}: ") for each in bad]
    if any(each.severity == "invalid" for each in bad):
        return ()
    touching = discs[0].follower.touching
    conditions = CONDITIONS[touching](angle, ratio)
    broken = {
        fault: each
        for fault, each in conditions.items()
        if any(name.startswith(each.names) for name in names)
    }
    free = [each.name for each in found if each.limit is None]  # a limit that does not apply
    held = tuple(
        each
        for fault, each in conditions.items()
        if fault not in broken and not any(name.startswith(each.names) for name in free)
    )
    if "undercut" in broken and ratio == 1.0:
        broken.pop("radius ratio", None)  # it is the same
    before = frozenset(each.name for each in bad)
    cures: list[Cure] = []
    for fault, condition in broken.items():
        task = Task(fault, condition, held, discs, unit, before, judged)
        own = [knob(task) for knob in KNOBS[touching, type(condition)]]
        cures += sorted(own, key=lambda cure: math.inf if cure.cost is None else cure.cost)
    return tuple(cures)
