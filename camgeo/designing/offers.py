"""What the designer offers: laws that fit a segment, scenes to start from, and effects."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from camgeo.answers.report.readings import shown
from camgeo.designing.arguments import Arguments
from camgeo.designing.job import Job, JobError
from camgeo.designing.recent import Recent
from camgeo.effects.registry import effect_names, find_effect
from camgeo.errors import SceneError
from camgeo.figure import laws as picture
from camgeo.figure.model import data_of
from camgeo.figure.thinned import thinned
from camgeo.motion.boundary import ends_of
from camgeo.motion.joints import joints
from camgeo.motion.laws import FAMILIES, OPTIONS
from camgeo.motion.laws.comparison import entry_of
from camgeo.motion.laws.law import Law
from camgeo.motion.plan import MotionPlan
from camgeo.motion.spans import FULL_TURN
from camgeo.scene.new import KINDS, template

FACTS: Final = {
    "C_v": (("velocity",), ("velocity",)),
    "C_a": (("least_acceleration", "largest_acceleration"), ("acceleration", "deceleration")),
    "C_j": (("least_jerk", "largest_jerk"), ("jerk", "braking_jerk")),
}
"""By its symbol what is shown of a law: its extremes over the whole move, which are those of the
motion, whatever parts the law has, and the characteristic values that are unbounded if they are."""


def laws(job: Job, recent: Recent) -> dict[str, Any]:
    """The laws that the segment can have in a valid scene, with the `edits` for each.

    Argument `segment`: its position, from 0. The scene itself may have faults; SceneError if its
    text is not TOML.
    """
    segment = Arguments(job).index("segment")
    motion = recent.document(job).at(("motion",))
    if not isinstance(motion, list) or segment >= len(motion):
        raise JobError("segment must be one of the motion")
    stated = motion[segment]
    if not isinstance(stated, dict) or "dwell" in stated:
        raise JobError("segment must be a move: a dwell has no law")
    found = []
    for name in FAMILIES:
        for edits in _edits(name, stated, f"motion[{segment + 1}]"):
            law = _law(job, recent, edits, segment)
            if law is not None:
                found.append(_told(name, law, edits))
                break
    return {"laws": found, "law": stated.get("law")}


def _edits(name: str, stated: Any, key: str) -> Iterator[dict[str, Any]]:
    """Edits that give the segment that law: first with its parameters as they are, then without
    those that only other laws have.
    """
    yield {f"{key}.law": name}
    own = {option.name for option in FAMILIES[name].options}
    others = [each for each in stated if each in OPTIONS and each not in own]
    if others:
        yield {f"{key}.law": name} | {f"{key}.{each}": None for each in others}


def _law(job: Job, recent: Recent, edits: dict[str, Any], segment: int) -> Law | None:
    try:
        plan = recent.edited(job, edits).plan
    except SceneError:
        return None
    law = getattr(plan.segments[segment], "law", None)
    return _in_place(law, plan, segment) if isinstance(law, Law) else None


def _in_place(law: Law, plan: MotionPlan, segment: int) -> Law:
    """The law for the task that it has in the plan: from or to a rest where the velocity jumps."""
    ends = []
    for class_, angle in zip(ends_of(law.task), plan.joints_deg[segment:], strict=False):
        place = math.radians(float(angle % FULL_TURN))
        joint = min(joints(plan), key=lambda each: abs(each.cam_angle - place))
        ends.append("R" if joint.order < 1 else class_)
    return replace(law, task="-".join(ends))


def _told(name: str, law: Law, edits: dict[str, Any]) -> dict[str, Any]:
    entry = entry_of(law)
    facts = []
    for symbol, (names, quantities) in FACTS.items():
        extremes = dict.fromkeys(shown(getattr(entry.values, name).value) for name in names)
        bounded = entry.unbounded.isdisjoint(quantities)
        facts.append({"name": symbol, "value": " to ".join(extremes) if bounded else "∞"})
    return {
        "name": name,
        "title": name.replace("-", " "),
        "figure": data_of(thinned(picture.figure((entry,)))),
        "facts": facts,
        "edits": edits,
    }


def templates(_: Job, __: Recent) -> dict[str, Any]:
    """Scenes to start from."""
    return {
        "templates": [
            {"name": name, "title": name.replace("-", " "), "text": template(name)}
            for name in KINDS
        ]
    }


def effects(_: Job, __: Recent) -> dict[str, Any]:
    """What can be computed beyond the geometry."""
    found = [find_effect(name) for name in effect_names()]
    return {
        "effects": [
            {"name": each.name, "title": each.title, "sentence": each.schema["description"]}
            for each in found
        ]
    }
