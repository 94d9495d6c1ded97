"""Other followers and linkages: what both kinds share stays, and the rest is chosen to work.

What a kind needs and the scene lacks is taken from the scene that `camgeo new` writes for it,
scaled to this one. If the unit of positions changes, they are converted to about the same travel.
Keys elsewhere that do not belong to the new mechanism go.
"""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from typing import Any, Final, TypeGuard

from camgeo.designing.fields import is_angular, is_length
from camgeo.designing.given import Given, refusal
from camgeo.designing.snapping import is_number, rounded
from camgeo.designing.switching import base_radius, suiting
from camgeo.errors import UnknownNameError
from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.scene.keys import Path, path_of
from camgeo.scene.new import template
from camgeo.scene.schema import EFFECTS, Node
from camgeo.scene.tree import Tree, without

WIDEST: Final = Decimal(60)
"""Largest swing that a rocker is given [degrees]."""

IN_POSITIONS: Final = ("to", "velocity", "acceleration", "jerk")
"""Keys of a segment, and of a point, that are in the unit of its positions."""

ELSEWHERE: Final = ("limits", "effects", "linkage", "units", "follower", "part")
"""Tables whose keys go if they do not belong to the new mechanism."""

OF_PART: Final = ("rim", "groove_depth", "pair")
"""Those keys of [part], which belong to contacts and conjugate pairs."""


def other_table(given: Given, asked: Any) -> tuple[Tree, str]:
    """The tree with another kind of follower or linkage, and a label.

    `asked` has the `key`, "follower" or "linkage", and the `kind`; None for no linkage. SceneError
    if it lacks the key, UnknownNameError if there is no such kind.
    """
    key = asked.get("key") if isinstance(asked, Mapping) else None
    kind = asked.get("kind") if isinstance(asked, Mapping) else None
    if key == "linkage" and kind is None:
        return _first_valid(given, _without_linkage(given.tree)), "linkage removed"
    if not isinstance(key, str) or key not in KINDS:
        raise refusal(f"another kind is one of {', '.join(KINDS)}")
    known, make = KINDS[key]
    if not isinstance(kind, str) or kind not in known:
        raise UnknownNameError(f"{key} kind", str(kind)[:60], known)
    return _first_valid(given, make(given.tree, kind)), f"{key} {kind}"


def _first_valid(given: Given, trees: Iterator[Tree]) -> Tree:
    """The first tree that is valid once what does not belong to it is gone; else the first."""
    required = {
        name: {*kind.schema.get("required", ()), "kind"}
        for kinds in (FOLLOWERS, LINKAGES)
        for name, kind in kinds.items()
    }
    first: Tree | None = None
    for tree in trees:
        kinds = {key: _kind(tree.get(key)) for key in ("follower", "linkage")}

        def may(path: Path, kinds: Mapping[str, str] = kinds) -> bool:
            if len(path) < 2 or path[0] not in ELSEWHERE:
                return False
            if path[0] in kinds:
                return path[1] not in required.get(kinds[str(path[0])], ())
            return path[0] != "part" or path[1] in OF_PART

        mended = _with_suiting_effects(given, given.without_misfits(tree, may))
        if not given.faults(mended):
            return mended
        first = first or mended
    assert first is not None  # every change makes one
    return first


def _with_suiting_effects(given: Given, tree: Tree) -> Tree:
    """The tree with other data for the effects whose own do not suit, or without these effects."""
    for fault in given.new_faults(tree):
        path = path_of(fault.key) or ()
        effects = tree.get(EFFECTS)
        if path[:1] != (EFFECTS,) or not isinstance(effects, dict):
            continue
        name = str(path[1]) if len(path) > 1 else ""
        if name in effects:
            bare = without(tree, (EFFECTS, name))
            tree = suiting(given, bare, name) or bare
    return tree


# -- followers -------------------------------------------------------------------------------------


def _other_follower(tree: Tree, kind: str) -> Iterator[Tree]:
    """The scene with a follower of that kind: first with its own sizes, then with all sizes new."""
    old = _table(tree, "follower")
    size = _size_of(tree)
    own = _template(kind)["follower"]
    nodes = FOLLOWERS[kind].schema["properties"]
    before = FOLLOWERS[_kind(old)].schema["properties"] if _kind(old) in FOLLOWERS else {}
    required = FOLLOWERS[kind].schema["required"]
    kept = {
        key: value
        for key, value in old.items()
        if key in nodes and (not isinstance(value, list | dict) or nodes[key] == before.get(key))
    }
    fresh = {key: _resized(nodes[key], own[key], size) for key in required}
    for table in ({**fresh, **kept, **_arm(required, kept)}, {**kept, **fresh}):
        made = {
            **tree,
            "follower": {"kind": kind, **{k: v for k, v in table.items() if k != "kind"}},
        }
        linkage = _kind(tree.get("linkage"))
        if linkage in LINKAGES and FOLLOWERS[kind].unit not in LINKAGES[linkage].members:
            made = {key: each for key, each in made.items() if key != "linkage"}
        made = _in_other_unit(tree, made)
        yield made
        if "linkage" in made and linkage in LINKAGES:  # it may have another member at its far end
            yield from _other_linkage(made, linkage)


def _arm(required: list[str], kept: Mapping[str, Any]) -> dict[str, Any]:
    """The arm of a roller for a pivot that stays: so long that roller, pivot and axis make a
    triangle for every base radius up to twice the arm.
    """
    pivot = kept.get("pivot")
    if "arm" not in required or "arm" in kept or not _is_point(pivot):
        return {}
    return {"arm": rounded(Decimal(math.hypot(*map(float, pivot))))}


# -- linkages --------------------------------------------------------------------------------------


def _without_linkage(tree: Tree) -> Iterator[Tree]:
    yield _in_other_unit(tree, {key: each for key, each in tree.items() if key != "linkage"})


def _other_linkage(tree: Tree, kind: str) -> Iterator[Tree]:
    """The scene with a linkage of that kind, and a follower that it can drive.

    The motion stays as it is if its unit does; otherwise it goes as far as that of the template.
    """
    members = LINKAGES[kind].members
    follower = _kind(tree.get("follower"))
    if follower not in FOLLOWERS or FOLLOWERS[follower].unit not in members:
        touching = FOLLOWERS[follower].touching if follower in FOLLOWERS else "roller"
        fitting = [each for each in FOLLOWERS.values() if each.unit in members]
        follower = next(each.name for each in fitting if each.touching == touching)
        tree = next(_other_follower(tree, follower))
    unit = FOLLOWERS[follower].unit
    scenes = [_template(name) for name in LINKAGES[kind].templates]
    scene = next(each for each in scenes if FOLLOWERS[each["follower"]["kind"]].unit == unit)
    old, size = _table(tree, "linkage"), _size_of(tree)
    nodes = LINKAGES[kind].schema["properties"]
    fresh = {k: _resized(nodes[k], v, size) for k, v in scene["linkage"].items() if k != "kind"}
    kept = {k: v for k, v in old.items() if k in nodes and not isinstance(v, list | dict)}
    for table, whole in (({**fresh, **kept}, True), (fresh, True), (fresh, False)):
        made = {**tree, "linkage": {"kind": kind, **table}}
        if not whole or is_angular(made) != is_angular(tree):
            yield _with_reach(made, _reach(scene) * (1 if is_angular(made) else size))
        else:
            yield made


KINDS: Final[Mapping[str, tuple[Mapping[str, Any], Callable[[Tree, str], Iterator[Tree]]]]] = {
    "follower": (FOLLOWERS, _other_follower),
    "linkage": (LINKAGES, _other_linkage),
}
"""Tables that have kinds, with what makes scenes of another kind, the best one first."""


# -- motions ---------------------------------------------------------------------------------------


def _in_other_unit(before: Tree, after: Tree) -> Tree:
    """The scene `after` with positions in its own unit, if the scene `before` has another one: a
    rocker swings by about the same travel.
    """
    angular = is_angular(after)
    if angular == is_angular(before):
        return after
    arms = [_table(tree, "follower").get("arm") for tree in (after, before)]
    arm = next((each for each in arms if is_number(each)), None) or base_radius(after)
    factor = (
        Decimal(math.degrees(1.0)) / Decimal(arm)
        if angular
        else Decimal(arm) / Decimal(math.degrees(1.0))
    )
    reach = _reach(after)
    return _with_positions(after, min(factor, WIDEST / reach) if angular and reach else factor)


def _with_reach(tree: Tree, reach: Decimal) -> Tree:
    """The scene with a motion that goes as far as `reach`."""
    now = _reach(tree)
    return _with_positions(tree, reach / now) if now else tree


def _reach(tree: Tree) -> Decimal:
    """The largest position, as it is stated; 0 without one."""
    motion = tree.get("motion")
    ends = (
        [each.get("to") for each in motion if isinstance(each, dict)]
        if isinstance(motion, list)
        else []
    )
    return max((abs(Decimal(each)) for each in ends if is_number(each)), default=Decimal(0))


def _with_positions(tree: Tree, factor: Decimal) -> Tree:
    """The scene with all positions times `factor`."""

    def scaled(value: Any) -> Any:
        if isinstance(value, list):
            return [scaled(each) for each in value]
        if not isinstance(value, dict):
            return value
        made = {}
        for key, each in value.items():
            if key in IN_POSITIONS and is_number(each):
                made[key] = rounded(Decimal(each) * factor)
            else:
                made[key] = scaled(each) if key == "points" else each
        return made

    motion = tree.get("motion")
    if not isinstance(motion, list):
        return tree
    return {**tree, "motion": [scaled(each) for each in motion]}


# -- values ----------------------------------------------------------------------------------------


@functools.cache
def _template(kind: str) -> Tree:
    found: Tree = tomllib.loads(template(kind), parse_float=Decimal)
    return found


def _table(tree: Tree, key: str) -> dict[str, Any]:
    table = tree.get(key)
    return table if isinstance(table, dict) else {}


def _kind(table: Any) -> str:
    kind = table.get("kind") if isinstance(table, dict) else None
    return kind if isinstance(kind, str) else ""


def _is_point(value: Any) -> TypeGuard[list[int | Decimal]]:
    return isinstance(value, list) and len(value) == 2 and all(map(is_number, value))


def _size_of(tree: Tree) -> Decimal:
    """How large a scene is, compared with those that `camgeo new` writes."""
    return base_radius(tree) / 50


def _resized(node: Node, value: Any, size: Decimal) -> Any:
    """A value of a template, larger by `size` if it is a length or a place."""
    if isinstance(value, list):
        return [_resized(node.get("items", {}), each, size) for each in value]
    return rounded(Decimal(value) * size) if is_length(node) and is_number(value) else value
