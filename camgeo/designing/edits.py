"""Changes of a scene's text: what is asked becomes values, which are written into the text.

Comments and order stay. A text is changed whether its scene is valid or not, as long as it is TOML.
"""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from camgeo.check.cures.task import edits_of
from camgeo.design import Design
from camgeo.designing.companions import with_companions
from camgeo.designing.fields import Fields
from camgeo.designing.given import Given, refusal
from camgeo.designing.handles import dragged
from camgeo.designing.labels import label_of
from camgeo.designing.mechanisms import other_table
from camgeo.designing.segments import changed_segments
from camgeo.designing.snapping import styled
from camgeo.designing.spans import Neighbours, is_fixed, span_key, spans_of, total
from camgeo.designing.switching import switched
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.motion.spans import FULL_TURN
from camgeo.reading import SCENE
from camgeo.scene.document import data_of, document, document_of_tree
from camgeo.scene.keys import path_of
from camgeo.scene.scene import Scene
from camgeo.scene.toml import written_into
from camgeo.scene.tree import Tree, edited

MOST: Final = 1_000
"""Keys of one change."""

LONGEST: Final = 1_000
"""Characters of a key."""


@dataclass(frozen=True, slots=True)
class Changed:
    """A text after a change.

    Attributes
    ----------
    text : the new TOML.
    label : names the change, for undo.
    scene : the new scene, if it is valid and the one before is known; it shares with that what the
        change does not touch.
    """

    text: str
    label: str
    scene: Scene | None = None


def changed(
    text: str,
    file: str,
    folder: str | pathlib.Path | None,
    arguments: Mapping[str, Any],
    design: Design | None = None,
) -> Changed:
    """The `text` with one change, which `arguments` ask for.

    Parameters
    ----------
    file, folder : where the text comes from, as of `camgeo.scene.scene.Scene.from_text`.
    arguments : one of the kinds of changes, `CHANGES`, by its name, with what it takes.
    design : that of the text, if it is known.

    Raises
    ------
    SceneError
        If the text is not TOML, or has no place for what is asked, or if a handle is dropped where
        it cannot be; nothing is changed then.
    UnknownNameError
        If there is no such handle, kind or effect.
    """
    asked = [name for name in CHANGES if name in arguments]
    if len(asked) != 1:
        raise refusal(f"a change is one of {', '.join(CHANGES)}")
    try:
        found = document(data_of(text)) if design is None else design.scene.stated.scene
    except SceneError as error:
        raise SceneError(error.faults, file) from error
    given = Given(text, found.exact, file, folder, design)
    after, label = CHANGES[asked[0]](given, arguments)
    return _written(given, after, label, valid=asked[0] in VALID)


def _written(given: Given, after: Tree, label: str, *, valid: bool) -> Changed:
    """The text with the values `after`; SceneError if they are not valid, but have to be."""
    known = {fault.key for fault in document_of_tree(given.tree).faults}
    found = document_of_tree(after)
    impossible = [fault for fault in found.faults if fault.key not in known]
    if impossible:
        raise SceneError(impossible)
    text = written_into(given.text, after)
    if len(text.encode()) > SCENE.size:
        raise refusal(f"the scene would be larger than {SCENE.size:,} bytes")
    if given.known is None and not valid:
        return Changed(text, label)
    before = given.design.scene
    try:
        return Changed(text, label, Scene.of(found, replace(before.source, text=text), before))
    except SceneError:
        if valid:
            raise
    return Changed(text, label)


# -- kinds of changes ------------------------------------------------------------------------------


def _by_keys(given: Given, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`edits`: values by key, None to remove the key.

    A segment whose span changes takes from the next one, or gives to it, so that the turn stays
    whole; choices come with what goes with them.
    """
    edits = _edits(arguments["edits"])
    after = with_companions(given, edited(given.tree, edits), edits)
    return _whole_turn(given.tree, after), label_of(edits, _units(after, edits))


def _dragged(given: Given, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`handle`: the name of one, dropped at `to`, in steps of `step`."""
    name = arguments["handle"]
    handle, edits = dragged(given.design, name, arguments.get("to"), arguments.get("step"))
    after = edited(given.tree, edits)
    # What a joint takes from the segment behind it goes without saying.
    told = {key: edits[key] for key in handle.keys if key in edits}
    return after, label_of(told, _units(after, told)) if told else handle.label


def _cured(given: Given, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`cure`: the position of a cure among those of the design's judgement, from 0."""
    number, cures = arguments["cure"], given.design.judgement.cures
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < len(cures):
        raise refusal("there is no such cure")
    if not cures[number].works:
        raise refusal(cures[number].sentence)
    edits = given.design.edits(edits_of(cures[number]))
    return edited(given.tree, edits), label_of(edits, _units(given.tree, edits))


def _sized(given: Given, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`sized`: values by key, as of `camgeo.answers.size.writing.edits_with`."""
    edits = _edits(arguments["sized"])
    return edited(given.tree, edits), f"sized: {label_of(edits, _units(given.tree, edits))}"


CHANGES: Final[Mapping[str, Callable[[Given, Mapping[str, Any]], tuple[Tree, str]]]] = {
    "edits": _by_keys,
    "handle": _dragged,
    "segment": lambda given, arguments: changed_segments(given, arguments["segment"]),
    "table": lambda given, arguments: other_table(given, arguments["table"]),
    "effect": lambda given, arguments: switched(given, arguments["effect"]),
    "cure": _cured,
    "sized": _sized,
}
"""Kinds of changes by the names of their arguments; each gives the values after it and a label."""

VALID: Final = ("handle",)
"""Those that are refused if the scene would not be valid: a handle stays where it last could be."""


# -- what goes with a change -----------------------------------------------------------------------


def _edits(asked: Any) -> dict[str, Any]:
    if not isinstance(asked, Mapping) or not 0 < len(asked) <= MOST:
        raise refusal(f"an edit has 1 to {MOST} values by key")
    if not all(isinstance(key, str) and len(key) <= LONGEST for key in asked):
        raise refusal(f"a key is text of at most {LONGEST} characters")
    return dict(asked)


def _units(tree: Tree, edits: Mapping[str, Any]) -> dict[str, str]:
    """The unit of each key."""
    fields = Fields(document_of_tree(tree))
    return {key: fields.unit(path_of(key) or ()) for key in edits}


def _whole_turn(before: Tree, after: Tree) -> Tree:
    """The motion after an edit, its turn as whole as before if the span of one segment changed."""
    old, new = spans_of(before.get("motion")), spans_of(after.get("motion"))
    if old is None or new is None or len(old) != len(new) or total(old) != FULL_TURN:
        return after
    changed = [index for index, (one, two) in enumerate(zip(old, new, strict=True)) if one != two]
    if len(changed) != 1 or len(old) == 1:
        return after
    at = changed[0]
    motion = after["motion"]
    beside = [each for each in (at + 1, at - 1) if 0 <= each < len(motion)]
    taker = next((each for each in beside if not is_fixed(motion[each])), None)
    if taker is None:
        return after
    try:
        _, span = Neighbours(before["motion"][at], motion[taker]).with_first(new[at])
    except GeometryError as error:
        key = f"motion[{at + 1}].{span_key(motion[at])}"
        raise SceneError([Fault(key, "", error.message)]) from error
    key = span_key(motion[taker])
    made = {**motion[taker], key: styled(span, motion[taker][key])}
    return {**after, "motion": [*motion[:taker], made, *motion[taker + 1 :]]}
