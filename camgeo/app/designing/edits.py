"""Changes of a scene's text: a request becomes values, which are written into the text.

Comments and order are preserved. A text can be changed whether its scene is valid or not, as long
as it is TOML.
"""

from __future__ import annotations

import functools
import math
import pathlib
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, ROUND_HALF_EVEN, Decimal, localcontext
from functools import cached_property
from typing import Any, Final, TypeGuard

import numpy as np

from camgeo.app.designing.form import (
    Fields,
    is_angular,
    is_fixed,
    is_length,
    is_number,
    key_title,
    least_span,
    motion_spans,
    neighbour_span,
    segment_span,
    span_key,
    styled,
)
from camgeo.app.designing.handles import dragged
from camgeo.check.cures.remedies import cure_edits
from camgeo.design.design import COMMON_KEYS, Design
from camgeo.dynamics.effects.effect import Effect
from camgeo.dynamics.effects.registry import effect_names, find_effect
from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError, UnknownNameError
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.plan import EXACT, FULL_TURN
from camgeo.reading import SCENE
from camgeo.scene.keys import KeyPath, parse_path, spelled, tree_value
from camgeo.scene.scene import Scene
from camgeo.scene.schema import EFFECTS_KEY, Node
from camgeo.scene.toml import template, written_into
from camgeo.scene.values import (
    Source,
    Tree,
    ValidValues,
    document,
    document_of_tree,
    encode_scene,
    with_edits,
    without,
    written,
)
from camgeo.units import MM_PER, TURN

MOST: Final = 1_000
"""Most keys of one change."""

LONGEST: Final = 1_000
"""Most characters of a key."""


@dataclass(frozen=True, slots=True)
class Changed:
    """A text after a change.

    Attributes
    ----------
    text : the new TOML.
    label : names the change in the undo history.
    scene : the new scene, if it is valid and the previous one is known; it shares with that one
        what the change does not affect.
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
    """The `text` after the change that `arguments` request.

    Parameters
    ----------
    file, folder : where the text comes from, as of `camgeo.scene.scene.Scene.from_text`.
    arguments : the data of one kind of change under its name, a key of `CHANGES`.
    design : the design of the text, if it is known.

    Raises
    ------
    SceneError
        If the text is not TOML, if the change is impossible in it, or if a handle is dropped where
        it cannot be; nothing is changed then.
    UnknownNameError
        If there is no such handle, kind or effect.
    """
    kinds = [name for name in CHANGES if name in arguments]
    if len(kinds) != 1:
        raise refusal(f"a change is one of {', '.join(CHANGES)}")
    try:
        values = document(encode_scene(text)) if design is None else design.scene.stated.scene
    except SceneError as error:
        raise SceneError(error.faults, file) from error
    original = Original(text, values.exact, file, folder, design)
    tree, label = CHANGES[kinds[0]](original, arguments)
    return _written(original, tree, label, valid=kinds[0] in VALID)


def _written(original: Original, tree: Tree, label: str, *, valid: bool) -> Changed:
    """The text with the values `tree`; SceneError if they have to be valid and are not."""
    # Faults that the text has already do not prevent a change.
    known = {fault.key for fault in document_of_tree(original.tree).faults}
    values = document_of_tree(tree)
    impossible = [fault for fault in values.faults if fault.key not in known]
    if impossible:
        raise SceneError(impossible)
    text = written_into(original.text, tree)
    if len(text.encode()) > SCENE.size:
        raise refusal(f"the scene would be larger than {SCENE.size:,} bytes")
    if original.known is None and not valid:
        return Changed(text, label)
    earlier = original.design.scene
    try:
        return Changed(
            text, label, Scene.from_document(values, replace(earlier.source, text=text), earlier)
        )
    except SceneError:
        if valid:
            raise
    return Changed(text, label)


# -- kinds of changes ------------------------------------------------------------------------------


def _by_keys(original: Original, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`edits`: values by key, None to remove the key.

    If the span of one segment changes, its neighbour changes by the opposite amount, so that the
    spans still add up to a turn. Choices are made with their companions.
    """
    edits = _edits(arguments["edits"])
    tree = with_companions(original, with_edits(original.tree, edits), edits)
    return _whole_turn(original.tree, tree), change_label(edits, _units(tree, edits))


def _dragged(original: Original, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`handle`: the name of a handle, dropped at `to`, in steps of `step`."""
    handle, edits = dragged(
        original.design, arguments["handle"], arguments.get("to"), arguments.get("step")
    )
    tree = with_edits(original.tree, edits)
    # The label leaves out the span of the following segment, which changes with any joint.
    label_edits = {key: edits[key] for key in handle.keys if key in edits}
    label = change_label(label_edits, _units(tree, label_edits)) if label_edits else handle.name
    return tree, label


def _cured(original: Original, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`cure`: the position of a cure among those of the design's judgement, from 0."""
    number, cures = arguments["cure"], original.design.judgement.cures
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < len(cures):
        raise refusal("there is no such cure")
    if not cures[number].works:
        raise refusal(cures[number].sentence)
    edits = original.design.edits(cure_edits(cures[number]))
    return with_edits(original.tree, edits), change_label(edits, _units(original.tree, edits))


def _sized(original: Original, arguments: Mapping[str, Any]) -> tuple[Tree, str]:
    """`sized`: values by key, as of `camgeo.app.answers.size.CamSize.edits`."""
    edits = _edits(arguments["sized"])
    label = change_label(edits, _units(original.tree, edits))
    return with_edits(original.tree, edits), f"sized: {label}"


CHANGES: Final[Mapping[str, Callable[[Original, Mapping[str, Any]], tuple[Tree, str]]]] = {
    "edits": _by_keys,
    "handle": _dragged,
    "segment": lambda original, arguments: changed_segments(original, arguments["segment"]),
    "table": lambda original, arguments: other_table(original, arguments["table"]),
    "effect": lambda original, arguments: switched(original, arguments["effect"]),
    "cure": _cured,
    "sized": _sized,
}
"""Kinds of changes by the names of their arguments; each returns the new values and a label."""

VALID: Final = ("handle",)
"""Changes that are refused if the scene would become invalid: a handle then stays where it is."""


# -- what goes with a change -----------------------------------------------------------------------


def _edits(request: Any) -> dict[str, Any]:
    if not isinstance(request, Mapping) or not 0 < len(request) <= MOST:
        raise refusal(f"an edit has 1 to {MOST} values by key")
    if not all(isinstance(key, str) and len(key) <= LONGEST for key in request):
        raise refusal(f"a key is text of at most {LONGEST} characters")
    return dict(request)


def _units(tree: Tree, edits: Mapping[str, Any]) -> dict[str, str]:
    """The unit of each key."""
    fields = Fields(document_of_tree(tree))
    return {key: fields.unit(parse_path(key) or ()) for key in edits}


def _whole_turn(old_tree: Tree, new_tree: Tree) -> Tree:
    """The tree after an edit; if one span has changed, a neighbour makes up for it.

    Only if the spans added up to a turn before, and a neighbour has a span that can change.
    """
    old, new = motion_spans(old_tree.get("motion")), motion_spans(new_tree.get("motion"))
    if old is None or new is None or len(old) != len(new) or total(old) != FULL_TURN:
        return new_tree
    changed = [index for index, (one, two) in enumerate(zip(old, new, strict=True)) if one != two]
    # Only for one changed span there is a neighbour that makes up for it.
    if len(changed) != 1 or len(old) == 1:
        return new_tree
    changed_index = changed[0]
    motion = new_tree["motion"]
    neighbours = [k for k in (changed_index + 1, changed_index - 1) if 0 <= k < len(motion)]
    taker = next((k for k in neighbours if not is_fixed(motion[k])), None)
    if taker is None:
        return new_tree
    try:
        # The sum of the two spans stays, so the turn stays whole.
        span = neighbour_span(old_tree["motion"][changed_index], motion[taker], new[changed_index])
    except GeometryError as error:
        key = f"motion[{changed_index + 1}].{span_key(motion[changed_index])}"
        raise SceneError([Fault(key, "", error.message)]) from error
    key = span_key(motion[taker])
    resized = {**motion[taker], key: styled(span, motion[taker][key])}
    return {**new_tree, "motion": [*motion[:taker], resized, *motion[taker + 1 :]]}


# -- labels ---------------------------------------------------------------------------------------
# Short names of changes, for undo.


NAMED: Final = 2
"""Most values that a label names; the rest is counted."""

DIGITS: Final = 6
"""Significant digits of a number in a label."""

LONGEST_LABEL: Final = 80
"""Characters of a label."""


def change_label(edits: Mapping[str, Any], units: Mapping[str, str]) -> str:
    """The label of the change that sets these values; `units` are those of their keys."""
    named = [_named(key, value, units.get(key, "")) for key, value in edits.items()]
    rest = len(named) - NAMED
    label = ", ".join(named[:NAMED]) + (f" and {rest} more" if rest > 0 else "")
    return label if len(label) <= LONGEST_LABEL else f"{label[:LONGEST_LABEL]}..."


def _named(key: str, value: Any, unit: str) -> str:
    path = parse_path(key) or ()
    title = key_title(path)
    if path[:1] == ("motion",) and len(path) > 1 and isinstance(path[1], int):
        # Paths count from 0, users from 1.
        title = f"segment {path[1] + 1} {title}"
    if value is None:
        return f"{title} removed"
    gap = "" if unit == "°" else " "
    return f"{title} {value_text(value)}{gap}{unit}".rstrip()


def value_text(value: Any) -> str:
    """A value in a label: numbers with few digits, texts without quotes."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, int | float | Decimal):
        return f"{float(value):.{DIGITS}g}"
    if isinstance(value, list | tuple):
        rest = ", ..." if len(value) > NAMED else ""
        return f"[{', '.join(map(value_text, value[:NAMED]))}{rest}]"
    return value if isinstance(value, str) else written(value)


# -- segments -------------------------------------------------------------------------------------
# Changes of a motion's segments: inserted, removed, split, moved, made a dwell or a move. The sum
# of the spans always stays exactly what it was.


LAW: Final = "polynomial-345"
"""Law of a new move."""

FALLBACK: Final = "auto"
"""Law of moves that meet without a rest between them."""

RISE: Final = Decimal(10)
"""Position of a new move in a motion that has none [mm or degrees]."""

LARGEST: Final = 10_000
"""Most segments of a motion."""

Motion = list[Any]


def changed_segments(original: Original, request: Any) -> tuple[Tree, str]:
    """The tree with one change of a segment, and its label.

    `request` has the `action`, one of `ACTIONS`, and `at`, the position of the segment, from 0.
    SceneError if it lacks one of these, or the action cannot be done.
    """
    action = request.get("action") if isinstance(request, Mapping) else None
    index = request.get("at") if isinstance(request, Mapping) else None
    motion = original.tree.get("motion")
    if not isinstance(action, str) or action not in ACTIONS:
        raise refusal(f"a segment is changed by one of {', '.join(ACTIONS)}", "motion")
    if not isinstance(motion, list) or not motion:
        raise refusal("there are no segments", "motion")
    if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(motion):
        raise refusal(f"segments are counted from 0 to {len(motion) - 1}", "motion")
    if segment_span(motion[index]) is None:
        raise refusal("has no valid span", spelled(("motion", index)))
    make, label = ACTIONS[action]
    trees = ({**original.tree, "motion": candidate} for candidate in make(motion, index))
    return _first_without(original.faults, trees), label.format(n=index + 1)


def _first_without(faults: Callable[[Tree], tuple[Fault, ...]], trees: Iterable[Tree]) -> Tree:
    """The first tree that has none of these `faults`; the first of all if each has some."""
    tried = []
    for tree in trees:
        tried.append(tree)
        if not faults(tree):
            return tree
    return tried[0]


def _insert(motion: Motion, index: int) -> Iterator[Motion]:
    """Insert a dwell after a segment, which gives half of its span to it, or else the next one
    does.
    """
    donors = [k for k in (index, index + 1) if k < len(motion) and _can_give(motion[k])]
    if not donors or len(motion) >= LARGEST:
        raise refusal("has no span to give to a new segment", spelled(("motion", index)))
    remainder, share = _halves(motion[donors[0]])
    extended = [*motion]
    extended[donors[0]] = _with_span(motion[donors[0]], remainder)
    extended.insert(index + 1, {"dwell": styled(share, 0)})
    yield extended


def _remove(motion: Motion, index: int) -> Iterator[Motion]:
    """Remove a segment; a neighbour takes its span, preferably a dwell."""
    neighbours = [k for k in (index - 1, index + 1) if 0 <= k < len(motion)]
    takers = [k for k in neighbours if not is_fixed(motion[k])]
    takers = [k for k in takers if segment_span(motion[k]) is not None]
    if not takers:
        raise refusal("no neighbouring segment can take its span", spelled(("motion", index)))
    taker = next((k for k in takers if "dwell" in motion[k]), takers[0])
    with localcontext(EXACT):
        whole = _span(motion[taker]) + _span(motion[index])
    merged = [*motion]
    merged[taker] = _with_span(motion[taker], whole)
    del merged[index]
    yield from _returning(merged)


def _split(motion: Motion, index: int) -> Iterator[Motion]:
    """Split a segment into halves; a move reaches the middle of its stroke between them."""
    segment = motion[index]
    if "points" in segment or not _can_give(segment) or len(motion) >= LARGEST:
        raise refusal("cannot be split", spelled(("motion", index)))
    first, second = _halves(segment)
    halves = [_with_span(segment, first), _with_span(segment, second)]
    if "dwell" not in segment:
        way = {key: item for key, item in halves[0].items() if key in ("law", "span")}
        halves[0] = {**way, "to": _midpoint(_level(motion, index), segment.get("to"))}
    yield [*motion[:index], *halves, *motion[index + 1 :]]
    if "dwell" not in segment:
        # The halves meet without a rest, which the law of the segment may not allow.
        halves = [{**half, "law": FALLBACK} for half in halves]
        yield [*motion[:index], *halves, *motion[index + 1 :]]


def _swap(step: int) -> Callable[[Motion, int], Iterator[Motion]]:
    def swap(motion: Motion, at: int) -> Iterator[Motion]:
        if not 0 <= at + step < len(motion):
            raise refusal("is at the end of the motion", spelled(("motion", at)))
        swapped = [*motion]
        swapped[at], swapped[at + step] = motion[at + step], motion[at]
        yield swapped
        if all(
            _moves(segment) and "to" in segment for segment in (swapped[at], swapped[at + step])
        ):
            for index in (at, at + step):  # the positions stay, and law and span change places
                swapped[index] = {**swapped[index], "to": motion[index]["to"]}
            yield swapped

    return swap


def _to_dwell(motion: Motion, index: int) -> Iterator[Motion]:
    """Replace a move by a dwell of the same span."""
    rest = {"dwell": motion[index][span_key(motion[index])]}
    yield from _returning([*motion[:index], rest, *motion[index + 1 :]])


def with_a_point(tree: Tree, index: int) -> Tree:
    """The tree with a point in the middle of a segment that goes through points but has none."""
    motion = tree["motion"]
    segment = motion[index]
    span = segment_span(segment)
    if segment.get("law") != "points" or "points" in segment or not span:
        return tree
    point = {"at": styled(span / 2, 0), "to": _midpoint(_level(motion, index), segment.get("to"))}
    return {
        **tree,
        "motion": [*motion[:index], {**segment, "points": [point]}, *motion[index + 1 :]],
    }


def _returning(motion: Motion) -> Iterator[Motion]:
    """The motion as it is, then with a last move that returns to 0."""
    yield motion
    last = max((k for k, segment in enumerate(motion) if _moves(segment)), default=None)
    if last is not None and motion[last].get("to"):
        yield [*motion[:last], {**motion[last], "to": 0}, *motion[last + 1 :]]


def _to_move(motion: Motion, index: int) -> Iterator[Motion]:
    """Replace a segment by a move of the same span; a dwell becomes a move halfway to the next
    position.

    A dwell after the last move, which returns to 0, becomes a rise and a return.
    """
    segment = motion[index]
    head = motion[:index]
    tail = motion[index + 1 :]
    span = segment[span_key(segment)]
    if "dwell" not in segment:
        yield [*head, {"law": LAW, "span": span, "to": _number(segment.get("to"))}, *tail]
        return
    level = _level(motion, index)
    following = [_number(segment.get("to")) for segment in tail if _moves(segment)]
    if following:
        # The next move may follow without a rest, which only the fallback allows.
        for law in (LAW, FALLBACK):
            end = _midpoint(level, following[0])
            yield [*head, {"law": law, "span": span, "to": end}, *tail]
        return
    if not _can_give(segment):
        raise refusal("is too short for a move", spelled(("motion", index)))
    first, second = _halves(segment)
    tops = [abs(Decimal(_number(segment.get("to")))) for segment in motion if _moves(segment)]
    top = max([position for position in tops if position] or [RISE])
    rise = {"law": LAW, "span": styled(first, 0), "to": styled(top, 0)}
    yield [*head, rise, {"law": LAW, "span": styled(second, 0), "to": 0}, *tail]


ACTIONS: Final[Mapping[str, tuple[Callable[[Motion, int], Iterator[Motion]], str]]] = {
    "insert": (_insert, "segment inserted after {n}"),
    "remove": (_remove, "segment {n} removed"),
    "split": (_split, "segment {n} split"),
    "up": (_swap(-1), "segment {n} moved up"),
    "down": (_swap(1), "segment {n} moved down"),
    "to-dwell": (_to_dwell, "segment {n} made a dwell"),
    "to-move": (_to_move, "segment {n} made a move"),
}
"""Actions on a segment, each with its label: the first valid one of the motions that it yields is
taken, or the first of all."""


def _moves(segment: Any) -> bool:
    return isinstance(segment, dict) and "dwell" not in segment


def _span(segment: Any) -> Decimal:
    span = segment_span(segment)
    assert span is not None  # it was asked
    return span


def _can_give(segment: Any) -> bool:
    """Whether a segment can give half of its span away."""
    span = segment_span(segment)
    return (
        span is not None and not is_fixed(segment) and span > 0 and span / 2 > least_span(segment)
    )


def _halves(segment: Any) -> tuple[Decimal, Decimal]:
    """The span of a segment in two parts, the second in whole degrees if it is above one."""
    span = _span(segment)
    with localcontext(EXACT):
        second = span / 2
        # Above one degree the second part is whole; the first part takes the exact remainder.
        if second > 1:
            second = second.quantize(Decimal(1), ROUND_FLOOR)
        return span - second, second


def _with_span(segment: Any, span: Decimal) -> Any:
    key = span_key(segment)
    return {**segment, key: styled(span, segment[key])}


def _level(motion: Motion, index: int) -> Any:
    """The position at the start of a segment, as it is stated."""
    ends = [segment.get("to") for segment in motion[:index] if _moves(segment)]
    return _number(ends[-1]) if ends else 0


def _number(value: Any) -> Any:
    """A position; 0 in place of anything else."""
    return value if is_number(value) else 0


def _midpoint(start: Any, end: Any) -> Any:
    """The position midway between two; one unit further if they are equal."""
    first, last = Decimal(_number(start)), Decimal(_number(end))
    middle = (first + last) / 2 if first != last else first + 1
    return styled(middle, end)


def total(spans: Sequence[Decimal]) -> Decimal:
    """The exact sum of spans, without rounding to the precision of the decimal context."""
    with localcontext(EXACT):
        return sum(spans, Decimal(0))


# -- mechanisms -----------------------------------------------------------------------------------
# Other followers and linkages: keys that both kinds share keep their values, and the others get
# values that work.
#
# They are taken from the scene that `camgeo new` writes for the new kind, scaled to the size of
# this one. If the unit of positions changes, they are converted to about the same travel. Keys
# elsewhere that do not belong to the new mechanism are removed.


WIDEST: Final = Decimal(60)
"""Largest swing of a rocker after a conversion [degrees]."""

IN_POSITIONS: Final = ("to", "velocity", "acceleration", "jerk")
"""Keys of a segment, and of a point, in the unit of positions."""

ELSEWHERE: Final = ("limits", "effects", "linkage", "units", "follower", "part")
"""Tables whose keys are removed if they do not belong to the new mechanism."""

OF_PART: Final = ("rim", "groove_depth", "pair")
"""Keys of [part] that are removed then: they belong to contacts and conjugate pairs."""


def other_table(original: Original, request: Any) -> tuple[Tree, str]:
    """The tree with another kind of follower or linkage, and a label.

    `request` has the `key`, "follower" or "linkage", and the `kind`; None for no linkage.
    SceneError if it lacks the key, UnknownNameError if there is no such kind.
    """
    key = request.get("key") if isinstance(request, Mapping) else None
    kind = request.get("kind") if isinstance(request, Mapping) else None
    if key == "linkage" and kind is None:
        bare = _convert_positions(original.tree, without(original.tree, ("linkage",)))
        return _first_valid(original, [bare]), "linkage removed"
    if not isinstance(key, str) or key not in KINDS:
        raise refusal(f"another kind is one of {', '.join(KINDS)}")
    known, make = KINDS[key]
    if not isinstance(kind, str) or kind not in known:
        raise UnknownNameError(f"{key} kind", str(kind)[:60], known)
    return _first_valid(original, make(original.tree, kind)), f"{key} {kind}"


def _first_valid(original: Original, trees: Iterable[Tree]) -> Tree:
    """The first tree that is valid once misfit keys are removed from it; else the first of all."""
    required = {
        name: {*kind.schema.get("required", ()), "kind"}
        for kinds in (FOLLOWERS, LINKAGES)
        for name, kind in kinds.items()
    }

    def mended(tree: Tree) -> Tree:
        kinds = {key: _kind(tree.get(key)) for key in ("follower", "linkage")}

        def may(path: KeyPath) -> bool:
            if len(path) < 2 or path[0] not in ELSEWHERE:
                return False
            if path[0] in kinds:
                return path[1] not in required.get(kinds[str(path[0])], ())
            return path[0] != "part" or path[1] in OF_PART

        return _with_suiting_effects(original, original.without_misfits(tree, may))

    return _first_without(original.faults, map(mended, trees))


def _with_suiting_effects(original: Original, tree: Tree) -> Tree:
    """The tree with other data for effects that have become faulty, or without these effects."""
    for fault in original.new_faults(tree):
        path = parse_path(fault.key) or ()
        effects = tree.get(EFFECTS_KEY)
        if path[:1] != (EFFECTS_KEY,) or not isinstance(effects, dict):
            continue
        name = str(path[1]) if len(path) > 1 else ""
        if name in effects:
            bare = without(tree, (EFFECTS_KEY, name))
            tree = next(_fitting(original, bare, name), bare)
    return tree


# -- followers -------------------------------------------------------------------------------------


def _other_follower(tree: Tree, kind: str) -> Iterator[Tree]:
    """The scene with a follower of that kind: first with the present sizes, then with new ones."""
    old = _table(tree, "follower")
    size = _relative_size(tree)
    defaults = _template(kind)["follower"]
    nodes = FOLLOWERS[kind].schema["properties"]
    old_nodes = FOLLOWERS[_kind(old)].schema["properties"] if _kind(old) in FOLLOWERS else {}
    required = FOLLOWERS[kind].schema["required"]
    reused = {
        key: value
        for key, value in old.items()
        if key in nodes and (not isinstance(value, list | dict) or nodes[key] == old_nodes.get(key))
    }
    fresh = {key: _resized(nodes[key], defaults[key], size) for key in required}
    for table in ({**fresh, **reused, **_arm(required, reused)}, {**reused, **fresh}):
        candidate = {
            **tree,
            "follower": {"kind": kind, **{k: v for k, v in table.items() if k != "kind"}},
        }
        linkage = _kind(tree.get("linkage"))
        if linkage in LINKAGES and FOLLOWERS[kind].unit not in LINKAGES[linkage].members:
            candidate = without(candidate, ("linkage",))
        candidate = _convert_positions(tree, candidate)
        yield candidate
        if "linkage" in candidate and linkage in LINKAGES:
            # It may have another member at its far end.
            yield from _other_linkage(candidate, linkage)


def _arm(required: list[str], reused: Mapping[str, Any]) -> dict[str, Any]:
    """The arm of a roller for a pivot that stays: as long as the pivot is away from the cam axis.

    Then roller, pivot and axis form a triangle for every base radius up to twice the arm.
    """
    pivot = reused.get("pivot")
    if "arm" not in required or "arm" in reused or not _is_point(pivot):
        return {}
    return {"arm": rounded(Decimal(math.hypot(*map(float, pivot))))}


# -- linkages --------------------------------------------------------------------------------------


def _other_linkage(tree: Tree, kind: str) -> Iterator[Tree]:
    """The scene with a linkage of that kind, and a follower that it can drive.

    The motion is kept if its unit is; otherwise its stroke becomes that of the template.
    """
    members = LINKAGES[kind].members
    follower = _kind(tree.get("follower"))
    if follower not in FOLLOWERS or FOLLOWERS[follower].unit not in members:
        touching = FOLLOWERS[follower].touching if follower in FOLLOWERS else "roller"
        fitting = [declared for declared in FOLLOWERS.values() if declared.unit in members]
        follower = next(declared.name for declared in fitting if declared.touching == touching)
        tree = next(_other_follower(tree, follower))
    unit = FOLLOWERS[follower].unit
    scenes = [_template(name) for name in LINKAGES[kind].templates]
    scene = next(
        candidate for candidate in scenes if FOLLOWERS[candidate["follower"]["kind"]].unit == unit
    )
    old, size = _table(tree, "linkage"), _relative_size(tree)
    nodes = LINKAGES[kind].schema["properties"]
    fresh = {k: _resized(nodes[k], v, size) for k, v in scene["linkage"].items() if k != "kind"}
    reused = {k: v for k, v in old.items() if k in nodes and not isinstance(v, list | dict)}
    for table, whole in (({**fresh, **reused}, True), (fresh, True), (fresh, False)):
        candidate = {**tree, "linkage": {"kind": kind, **table}}
        if not whole or is_angular(candidate) != is_angular(tree):
            yield _with_reach(candidate, _reach(scene) * (1 if is_angular(candidate) else size))
        else:
            yield candidate


KINDS: Final[Mapping[str, tuple[Mapping[str, Any], Callable[[Tree, str], Iterator[Tree]]]]] = {
    "follower": (FOLLOWERS, _other_follower),
    "linkage": (LINKAGES, _other_linkage),
}
"""Tables that have kinds, with the function that yields scenes of another kind, the best first."""


# -- motions ---------------------------------------------------------------------------------------


def _convert_positions(old_tree: Tree, new_tree: Tree) -> Tree:
    """The scene `new_tree` with positions in its own unit, if that of the scene `old_tree` is
    another.

    The end of the arm travels about as far along its arc as the slider did, or the other way round.
    """
    angular = is_angular(new_tree)
    if angular == is_angular(old_tree):
        return new_tree
    arms = [_table(tree, "follower").get("arm") for tree in (new_tree, old_tree)]
    arm = next((length for length in arms if is_number(length)), None) or base_radius(new_tree)
    # An arc of length s on the arm r is an angle s / r.
    factor = (
        Decimal(math.degrees(1.0)) / Decimal(arm)
        if angular
        else Decimal(arm) / Decimal(math.degrees(1.0))
    )
    # The swing is limited, however long the stroke was.
    reach = _reach(new_tree)
    return _with_positions(new_tree, min(factor, WIDEST / reach) if angular and reach else factor)


def _with_reach(tree: Tree, reach: Decimal) -> Tree:
    """The scene with its positions scaled so that the largest one is `reach`."""
    now = _reach(tree)
    return _with_positions(tree, reach / now) if now else tree


def _reach(tree: Tree) -> Decimal:
    """The largest magnitude of a position, as it is stated; 0 without one."""
    motion = tree.get("motion")
    ends = (
        [segment.get("to") for segment in motion if isinstance(segment, dict)]
        if isinstance(motion, list)
        else []
    )
    return max(
        (abs(Decimal(position)) for position in ends if is_number(position)), default=Decimal(0)
    )


def _with_positions(tree: Tree, factor: Decimal) -> Tree:
    """The scene with all positions times `factor`."""

    def scaled(value: Any) -> Any:
        if isinstance(value, list):
            return [scaled(item) for item in value]
        if not isinstance(value, dict):
            return value
        resized = {}
        for key, item in value.items():
            if key in IN_POSITIONS and is_number(item):
                resized[key] = rounded(Decimal(item) * factor)
            else:
                resized[key] = scaled(item) if key == "points" else item
        return resized

    motion = tree.get("motion")
    if not isinstance(motion, list):
        return tree
    return {**tree, "motion": [scaled(segment) for segment in motion]}


# -- values ----------------------------------------------------------------------------------------


@functools.cache
def _template(kind: str) -> Tree:
    parsed: Tree = tomllib.loads(template(kind), parse_float=Decimal)
    return parsed


def _table(tree: Tree, key: str) -> dict[str, Any]:
    table = tree.get(key)
    return table if isinstance(table, dict) else {}


def _kind(table: Any) -> str:
    kind = table.get("kind") if isinstance(table, dict) else None
    return kind if isinstance(kind, str) else ""


def _is_point(value: Any) -> TypeGuard[list[int | Decimal]]:
    return isinstance(value, list) and len(value) == 2 and all(map(is_number, value))


def _relative_size(tree: Tree) -> Decimal:
    """The size of a scene relative to those that `camgeo new` writes, by the base radius."""
    return base_radius(tree) / 50


def _resized(node: Node, value: Any, size: Decimal) -> Any:
    """A value of a template, times `size` if it is a length or a place."""
    if isinstance(value, list):
        return [_resized(node.get("items", {}), item, size) for item in value]
    return rounded(Decimal(value) * size) if is_length(node) and is_number(value) else value


FEW: Final = 3
"""Significant digits of a value that is computed for a scene."""


def rounded(value: Decimal) -> Any:
    """The number rounded to `FEW` significant digits."""
    if not value:
        return 0
    # adjusted() is the exponent of the first digit.
    last = Decimal(1).scaleb(value.adjusted() + 1 - FEW)
    return styled(value.quantize(last, ROUND_HALF_EVEN), 0)


# -- switching ------------------------------------------------------------------------------------
# Switching effects on and off, with initial data that suit the machine.


SPEED: Final = 60
"""Speed for a cam that has none [rev/min]."""

Table = dict[str, Any]

WIRE: Final[Mapping[str, Any]] = {
    "diameter": "0.08", "coil_diameter": "0.6", "active_coils": 6, "free_length": "2",
}  # fmt: skip
"""Wire of a helical spring; lengths as texts, in base radii."""

EXAMPLES: Final[Mapping[str, tuple[Table, ...]]] = {
    "inertia": (
        {"mass": 1, "moment_of_inertia": Decimal("0.002"), "roller_mass": Decimal("0.1")},
        {"output_moment": Decimal("0.02"), "moment_of_inertia": Decimal("0.002")},
        {"mass": 1, "roller_mass": Decimal("0.1")},
        {"mass": 1, "moment_of_inertia": Decimal("0.002")},
        {"mass": 1},
        {"moment_of_inertia": Decimal("0.002"), "roller_mass": Decimal("0.1")},
        {"moment_of_inertia": Decimal("0.002")},
    ),
    "load": ({"constant": 100},),
    "spring": (
        {"stiffness": 5, "preload": 200},
        {"kind": "torsion", "torsional_stiffness": 20, "preload_torque": 10},
        {"preload": 200, "wire": WIRE},
        {"preload": 200, "wire": WIRE, "anchor": None, "attachment": None},
    ),
    "friction": (
        {"guide": Decimal("0.1"), "guide_length": "1.8", "guide_overhang": "1.2"},
        {"guide": Decimal("0.1")},
        {"pivot": Decimal("0.1"), "pivot_diameter": "0.4"},
        {"face": Decimal("0.1")},
        {"slider": 5},
    ),
    "roller-spin": ({"moment_of_inertia": Decimal("0.00001"), "traction": Decimal("0.05")},),
    "speed-fluctuation": (
        {"moment_of_inertia": Decimal("0.1"), "no_load_speed": None, "stall_torque": 200},
    ),
    "camshaft-windup": (
        {"stiffness": 10_000, "moment_of_inertia": Decimal("0.01"), "damping": Decimal("0.04")},
    ),
    "contact-pressure": ({}, {"width": "0.2"}),
    "vibration": (
        {"natural_frequency": 100, "damping": Decimal("0.04")},
        {"torsional_stiffness": 10_000, "damping": Decimal("0.04")},
        {"stiffness": 1000, "damping": Decimal("0.04")},
    ),
}
"""Initial tables of effects, of which the first that suits the machine is taken. Lengths are texts,
in base radii; None stands for a speed somewhat above that of the cam, and for an end of a spring on
a rocker. Effects without an entry start empty."""

SPRING_ENDS: Final = {"anchor": 1.5, "attachment": 0.0}
"""Offsets of the ends of a spring on a rocker, in base radii, see `_end`."""

FASTER: Final = Decimal("1.05")
"""No-load speed of a motor, as a multiple of the cam speed."""

THICK: Final = Decimal("0.2")
"""Thickness for a part that states none, in base radii."""


def switched(original: Original, request: Any) -> tuple[Tree, str]:
    """The tree with an effect switched on or off, and a label.

    `request` has its `name`, and whether it is to be `on`. What an effect needs is switched on with
    it, and what needs it is switched off with it. SceneError if `request` lacks one of these or the
    machine cannot have the effect; UnknownNameError if there is no such effect.
    """
    name = request.get("name") if isinstance(request, Mapping) else None
    if not isinstance(name, str) or not isinstance(request.get("on"), bool):
        raise refusal("an effect has a name, and is switched on or off")
    if name not in effect_names():
        raise UnknownNameError("effect", name[:60], effect_names())
    title = name.replace("-", " ")
    effects = original.tree.get(EFFECTS_KEY)
    if request["on"]:
        if isinstance(effects, dict) and name in effects:
            raise refusal("is on already", f"{EFFECTS_KEY}.{name}")
        return _enable(original, name), f"{title} on"
    if not isinstance(effects, dict) or name not in effects:
        raise refusal("is off already", f"{EFFECTS_KEY}.{name}")
    return _disable(original, name), f"{title} off"


def _enable(original: Original, name: str) -> Tree:
    tree = original.tree
    if not isinstance(tree.get(EFFECTS_KEY, {}), dict):
        raise refusal("is no table", EFFECTS_KEY)
    wanted = []
    for need in _needs(tree, find_effect(name)):
        if need.startswith(f"{EFFECTS_KEY}."):
            wanted.append(need.partition(".")[2])
        else:
            thick = rounded(base_radius(tree) * THICK)
            tree = with_edits(tree, {need: thick if need == "part.thickness" else SPEED})
    unmet: list[Fault] = []
    for candidate in _with_examples(original, tree, (*wanted, name)):
        fault = original.unmet(_alone(candidate, name), name)
        if fault is None:
            return candidate
        unmet.append(fault)
    raise SceneError(unmet[:1])


def _alone(tree: Tree, name: str) -> Tree:
    """The tree with only the effect `name` and those that it needs: all effects together may take
    long to compute.
    """
    required, waiting = {name}, [name]
    while waiting:
        effect = find_effect(waiting.pop())
        keys = (parse_path(key) or () for keys in effect.keys for key in keys)
        needs = {*effect.needs, *(str(path[1]) for path in keys if path[:1] == (EFFECTS_KEY,))}
        waiting += needs - required
        required |= needs
    necessary = {
        effect_name: table
        for effect_name, table in tree[EFFECTS_KEY].items()
        if effect_name in required
    }
    return {**tree, EFFECTS_KEY: necessary}


def _with_examples(original: Original, tree: Tree, names: tuple[str, ...]) -> Iterator[Tree]:
    """The trees with examples of all these effects, see `_fitting`; SceneError if the machine
    cannot have one of them.
    """
    if not names:
        yield tree
        return
    fitting = list(_fitting(original, tree, names[0]))
    if not fitting:
        tried = _with_table(tree, names[0], EXAMPLES.get(names[0], ({},))[0])
        raise SceneError(
            [fault for fault in original.faults(tried) if _is_effect_key(fault.key, names[0])]
        )
    for candidate in fitting:
        yield from _with_examples(original, candidate, names[1:])


def _fitting(original: Original, tree: Tree, name: str) -> Iterator[Tree]:
    """The tree with each example of an effect that causes no new fault in its table."""
    for example in EXAMPLES.get(name, ({},)):
        candidate = _with_table(tree, name, example)
        if not any(_is_effect_key(fault.key, name) for fault in original.new_faults(candidate)):
            yield candidate


def _is_effect_key(key: str, name: str) -> bool:
    """Whether a key belongs to the table of that effect."""
    return (parse_path(key) or ())[:2] == (EFFECTS_KEY, name)


def _needs(tree: Tree, effect: Effect) -> Iterator[str]:
    """The keys that a scene lacks for an effect, in the order in which to state them."""
    seen: set[str] = set()
    waiting = [effect]
    lacking: list[str] = []
    while waiting:
        pending = waiting.pop()
        seen.add(pending.name)
        for keys in pending.keys:
            if any(tree_value(tree, parse_path(key) or ()) is not None for key in keys):
                continue
            first = next((key for key in keys if key not in lacking), None)
            # One of the `keys` suffices: nothing is added if another one is on the list already.
            if first is None or set(keys) & set(lacking) or first == f"{EFFECTS_KEY}.{effect.name}":
                continue
            lacking.insert(0, first)
            if first.startswith(f"{EFFECTS_KEY}."):
                waiting.append(find_effect(first.partition(".")[2]))
        waiting += [find_effect(name) for name in pending.needs if name not in seen]
    yield from lacking


def _with_table(tree: Tree, name: str, example: Table) -> Tree:
    table = {key: _initial(tree, key, value) for key, value in example.items()}
    return {**tree, EFFECTS_KEY: {**tree.get(EFFECTS_KEY, {}), name: table}}


def _initial(tree: Tree, key: str, value: Any) -> Any:
    """The value of an example for a key, in the scene's unit."""
    if isinstance(value, Mapping):
        return {inner: _initial(tree, inner, item) for inner, item in value.items()}
    if isinstance(value, str) and key != "kind":
        return rounded(Decimal(value) * base_radius(tree))
    if value is not None:
        return value
    if key in SPRING_ENDS:
        return _end(tree, SPRING_ENDS[key])
    speed = tree_value(tree, ("cam", "speed"))
    return rounded(Decimal(speed if is_number(speed) else SPEED) * FASTER)


def _end(tree: Tree, offset: float) -> list[Decimal]:
    """An end of a spring on a rocker [x, y], in the scene's unit.

    It lies `offset` base radii to the side of the midpoint between pivot and cam axis, on the side
    of the arm from which the spring turns it towards the axis; empty without a valid pivot.
    """
    pivot = tree_value(tree, ("follower", "pivot"))
    if not _is_point(pivot):
        return []
    pivot_place = complex(*map(float, pivot))
    # Times the direction to the pivot, 1j points to the left of it and -1j to the right.
    side = 1j if tree_value(tree, ("follower", "arm_side")) == "cw" else -1j
    end = 0.5 * pivot_place + offset * float(base_radius(tree)) * side * pivot_place / (
        abs(pivot_place) or 1.0
    )
    return [rounded(Decimal(coordinate)) for coordinate in (end.real, end.imag)]


def base_radius(tree: Tree) -> Decimal:
    """The base radius of a scene, in its unit; that of a usual cam if it has none."""
    radius = tree_value(tree, ("follower", "base_radius"))
    if is_number(radius) and radius > 0:
        return Decimal(radius)
    unit = ValidValues(document_of_tree(tree)).unit
    return Decimal(50) / Decimal(str(MM_PER[unit]))


def _disable(original: Original, name: str) -> Tree:
    """The tree without the effect, and without the effects that need it."""
    tree = original.tree

    def may(path: KeyPath) -> bool:
        return path[0] == EFFECTS_KEY and len(path) == 2

    remaining = original.without_misfits(without(tree, (EFFECTS_KEY, name)), may)
    return remaining if remaining[EFFECTS_KEY] else without(remaining, (EFFECTS_KEY,))


# -- companions -----------------------------------------------------------------------------------
# Companions of a choice: keys that it needs get initial values, keys that contradict it are
# removed.
#
# Only choices have companions: another law, another contact, another shape of a linkage. Numbers
# are set as they are.


CONTACT: Final = ("follower", "contact")

DIRECTION: Final = ("follower", "direction")
"""A key that a linkage determines."""

OF_CONTACT: Final = (
    ("part", "rim"), ("part", "groove_depth"), ("part", "bore"), ("part", "hub"),
    ("part", "keyway"), ("part", "d_shaft"), ("part", "set_screw"), ("part", "pair"),
    ("follower", "side_clearance"), ("follower", "return"), ("follower", "yoke"),
    ("limits", "closing_error"),
)  # fmt: skip
"""Keys that only some kinds of contact can have."""

SAMPLES: Final = 360
"""Points of the pitch curve from which a blank is estimated."""

BLANK_REACH: Final = 1.6
"""How far a blank extends beyond the path of the roller's centre, in roller radii."""


def with_companions(original: Original, tree: Tree, edits: Mapping[str, Any]) -> Tree:
    """The `tree` after these edits, with the companions of the choices among them."""
    paths = {parse_path(key) or (): value for key, value in edits.items()}
    for path, value in paths.items():
        if not isinstance(value, str | bool):
            continue
        if path[:1] == ("motion",) and path[2:] == ("law",):
            tree = _with_law(original, tree, path)
        elif path == CONTACT:
            tree = _with_contact(original, tree)
        elif path[:1] == ("linkage",) and DIRECTION not in paths:
            tree = original.without_misfits(tree, lambda misfit: misfit == DIRECTION)
    return tree


def _with_law(original: Original, tree: Tree, path: KeyPath) -> Tree:
    """The tree without the parameters that the law at `path` does not take; a motion through points
    gets its first point.
    """
    tree = with_a_point(tree, int(path[1]))
    segment = tree_value(tree, path[:2])
    among = [(*path[:2], key) for key in segment if key not in COMMON_KEYS]
    return original.without_misfits(tree, lambda misfit: misfit in among)


def _with_contact(original: Original, tree: Tree) -> Tree:
    """The tree with a blank around a groove or a ring, with a groove half as deep as the part is
    thick, and without the keys that a cam of that contact cannot have.
    """
    trees = _blanks(original, tree)
    mended = (original.without_misfits(tree, lambda misfit: misfit in OF_CONTACT) for tree in trees)
    return _first_without(original.new_faults, mended)


def _blanks(original: Original, tree: Tree) -> Iterator[Tree]:
    edits: dict[str, Any] = {}
    if tree_value(tree, ("part", "rim")) is None:
        edits["part.rim"] = _diameter(original)
    thick = tree_value(tree, ("part", "thickness"))
    deep = dict(edits)
    if is_number(thick) and tree_value(tree, ("part", "groove_depth")) is None:
        deep["part.groove_depth"] = rounded(Decimal(thick) / 2)
    part = tree.get("part", {})
    if isinstance(part, dict):
        yield with_edits(tree, deep) if deep else tree
        yield with_edits(tree, edits) if edits else tree
    yield tree


def _diameter(original: Original) -> Any:
    """Diameter of a blank that leaves room for the roller all around, in the scene's unit."""
    try:
        cam = original.design.cam
        phi = np.linspace(0.0, TURN, SAMPLES, endpoint=False)
        reach = float(np.max(np.abs(cam.disc.pitch_curve.point(phi))))
        reach += BLANK_REACH * cam.follower.roller_radius
        return rounded(Decimal(2.0 * reach / MM_PER[original.design.scene.unit]))
    except CamgeoError:  # no design as yet
        return 200


# -- original -------------------------------------------------------------------------------------
# The text that a change starts from, and the scenes that are tried while it is made.


ROUNDS: Final = 6
"""Rounds in which misfit keys are removed: without some, others turn out to be misfits."""


@dataclass(frozen=True)
class Original:
    """The text that a change starts from.

    Attributes
    ----------
    text : TOML.
    tree : its values.
    file, folder : its origin, as of `changed`.
    known : its design, if it has been made already.
    """

    text: str
    tree: Tree
    file: str
    folder: str | pathlib.Path | None
    known: Design | None

    @cached_property
    def source(self) -> Source:
        """The origin of the text, which locates the data files that the scene names."""
        return Source.from_file(self.file, self.folder, self.text)

    @cached_property
    def design(self) -> Design:
        """The design of the text; SceneError if the scene is not valid."""
        return self.known or Design(self.scene(self.tree))

    def scene(self, tree: Tree) -> Scene:
        """The scene with other values; SceneError if they are not valid."""
        earlier = None if self.known is None else self.known.scene
        return Scene.from_document(document_of_tree(tree), self.source, earlier)

    def faults(self, tree: Tree) -> tuple[Fault, ...]:
        """The faults of a scene with other values."""
        try:
            self.scene(tree)
        except SceneError as error:
            return error.faults
        return ()

    @cached_property
    def wrong(self) -> frozenset[str]:
        """The keys at fault in the text as it is."""
        return frozenset(fault.key for fault in self.faults(self.tree))

    def new_faults(self, tree: Tree) -> tuple[Fault, ...]:
        """The faults with other values, except those at keys that are `wrong` already."""
        return tuple(fault for fault in self.faults(tree) if fault.key not in self.wrong)

    def unmet(self, tree: Tree, name: str) -> Fault | None:
        """What the effect `name` lacks in a scene with other values, if that shows only when it is
        computed.

        None as well if the original text has no design, because then nothing can be computed.
        """
        if self.known is None:
            return None
        try:
            Design(self.scene(tree)).effect(name)
        except GeometryError as error:
            return Fault(error.key, error.value, error.message) if error.key else None
        except CamgeoError:  # faults of the scene, or no answer for this design, as findings tell
            return None
        return None

    def without_misfits(self, tree: Tree, may: Callable[[KeyPath], bool]) -> Tree:
        """The tree without those keys of the `new_faults` that `may` be removed.

        Some turn out to be faulty only when others have been removed.
        """
        for _ in range(ROUNDS):
            paths = {parse_path(fault.key) or () for fault in self.new_faults(tree)}
            misfits = [path for path in paths if path and may(path)]
            if not misfits:
                break
            # Inner keys before their tables, which may be misfits as well.
            for path in sorted(misfits, key=len, reverse=True):
                tree = without(tree, path)
        return tree


def refusal(message: str, key: str = "") -> SceneError:
    """The error for a change that cannot be made."""
    return SceneError([Fault(key, "", message)])
