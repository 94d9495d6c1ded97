"""What the designer offers: laws that fit a segment, scenes to start from, and effects."""

from __future__ import annotations

from collections.abc import Iterator
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
from camgeo.motion.laws import FAMILIES, OPTIONS
from camgeo.motion.laws.comparison import entry_of
from camgeo.motion.laws.law import Law
from camgeo.scene.new import KINDS, template

FACTS: Final = {"velocity": "C_v", "acceleration": "C_a", "deceleration": "C_a*", "jerk": "C_j"}
"""Characteristic values that are shown of a law, and their symbols."""


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
        made = recent.edited(job, edits).plan.segments[segment]
    except SceneError:
        return None
    law = getattr(made, "law", None)
    return law if isinstance(law, Law) else None


def _told(name: str, law: Law, edits: dict[str, Any]) -> dict[str, Any]:
    entry = entry_of(law)
    facts = []
    for quantity, symbol in FACTS.items():
        value = entry.bounded(quantity)
        facts.append({"name": symbol, "value": "∞" if value is None else shown(value)})
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
