"""The one door of what the designer computes: a job to JSON data."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Final

from camgeo.app.answers.report import shown
from camgeo.app.designing import making, painting
from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.faults import faults_as_data
from camgeo.app.designing.recent import Arguments, Recent
from camgeo.dynamics.effects.registry import effect_names, find_effect
from camgeo.errors import CamgeoError, SceneError
from camgeo.kinematics.laws import FAMILIES, OPTIONS
from camgeo.kinematics.laws.comparison import entry_of
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import ends_of
from camgeo.kinematics.plan import FULL_TURN, MotionPlan, joints
from camgeo.pictures import laws as picture
from camgeo.pictures.model import figure_data
from camgeo.pictures.thinned import thinned
from camgeo.scene.toml import TEMPLATE_KINDS, template

# -- offers ---------------------------------------------------------------------------------------
# What the designer offers: laws that fit a segment, scenes to start from, and effects.


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
        "figure": figure_data(thinned(picture.figure((entry,)))),
        "facts": facts,
        "edits": edits,
    }


def templates(_: Job, __: Recent) -> dict[str, Any]:
    """Scenes to start from."""
    return {
        "templates": [
            {"name": name, "title": name.replace("-", " "), "text": template(name)}
            for name in TEMPLATE_KINDS
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


# -- work -----------------------------------------------------------------------------------------


Work = Callable[[Job, Recent], dict[str, Any]]
"""Does a job; JobError if its arguments are wrong, any other CamgeoError tells faults."""

WORK: Final[Mapping[str, Work]] = {
    "curves": painting.curves,
    "change": painting.change,
    "findings": making.findings,
    "build": making.build,
    "size": making.size,
    "solid": making.solid,
    "laws": laws,
    "templates": templates,
    "effects": effects,
}
"""What is done for each kind of job."""


def run(job: Job, recent: Recent | None = None) -> dict[str, Any]:
    """The result of a job: finite numbers, texts, lists, tables, None, True and False.

    Parameters
    ----------
    recent : what earlier jobs left to be used again; it changes the time alone.

    Returns
    -------
    With `faults`, a list that is empty if the scene is valid: what is wrong in it never raises.

    Raises
    ------
    JobError
        If there is no such kind of job, or its arguments are wrong.
    """
    if job.kind not in WORK:
        raise JobError(f"there is no job {job.kind[:60]!r}; there are {', '.join(WORK)}")
    recent = recent or Recent()
    try:
        return {"faults": [], **WORK[job.kind](job, recent)}
    except JobError:
        raise
    except CamgeoError as error:
        recent.restate(job, error)
        return {"faults": faults_as_data(error, job.text)}


def prepared() -> Callable[[Job], dict[str, Any]]:
    """What does jobs one after the other, warm: imported, and tried with a small scene."""
    text = template(TEMPLATE_KINDS[0])
    for kind in ("curves", "findings"):
        run(Job(kind, text))
    run(Job("change", text, arguments={"edits": {"name": "warm"}}))
    return partial(run, recent=Recent())
