"""An edited scene is the one that its values make, though most of it is that of an earlier one."""

from __future__ import annotations

import ast
import random
from dataclasses import is_dataclass
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
from camgeo.errors import SceneError
from camgeo.scene import rules
from camgeo.scene.keys import spelled
from camgeo.scene.scene import Scene, load_scene
from camgeo.scene.values import Reads, changes, document_of_tree, edited, unchanged
from tests.long_form import examples
from tests.scene.scenes import values_in

ROOT: Final = Path(__file__).parents[2]

SCENES: Final = sorted(
    path
    for folder in ("scenes", "effects", "milling")
    for path in (ROOT / "fixtures" / folder).glob("*.toml")
)

ODD: Final = (0, -1, 1, 2.5, 1e9, "inner", "groove", "mm", "inch", "no such word", True, None)
"""Values that suit many keys, and none of which suits all."""

LATER: Final = {"source", "stated"}
"""Attributes that hold the values themselves."""


def shown(value: Any) -> str:
    """All that is in a value; of an object that has no fields, its type."""
    if is_dataclass(value) and not isinstance(value, type):
        inner = {name: shown(getattr(value, name)) for name in value.__dataclass_fields__
                 if value.__dataclass_fields__[name].compare}  # fmt: skip
        return f"{type(value).__name__}({inner})"
    if isinstance(value, tuple | list):
        return str([shown(each) for each in value])
    text = repr(value)
    return type(value).__name__ if " at 0x" in text else text


def all_of(scene: Scene) -> dict[str, str]:
    return {name: shown(value) for name, value in vars(scene).items() if name not in LATER}


def outcome(make: Any) -> Any:
    try:
        scene = make()
    except SceneError as error:
        return sorted((each.key, each.message, each.hint) for each in error.faults), None
    return all_of(scene), scene


def fresh(scene: Scene, edits: dict[str, Any]) -> Scene:
    """The edited scene, made of its values alone."""
    return Scene.of(document_of_tree(edited(scene.stated.scene.exact, edits)), scene.source)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_chain_of_edits_makes_the_scene_of_its_values(path: Path) -> None:
    """The same attributes or the same faults, whatever earlier scenes have in common with it."""
    rng = random.Random(path.stem)
    scene = load_scene(path)
    for _ in range(examples(12, long=60)):
        place, old = rng.choice(list(values_in(scene.stated.scene.exact)))
        number = isinstance(old, int | Decimal) and not isinstance(old, bool)
        near = [float(old) * 1.01, float(old) * 0.999] if number else []
        edits = {spelled(place): rng.choice([*near, *near, *ODD])}
        here, found = outcome(partial(scene.with_values, edits))
        there, _ = outcome(partial(fresh, scene, edits))
        assert here == there, edits
        scene = found or scene


def test_what_an_edit_does_not_concern_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def counted(rule: rules.Rule) -> rules.Rule:
        def counting(values: Any) -> Any:
            asked.append(rule.__name__)
            return rule(values)

        return counting

    monkeypatch.setattr(rules, "RULES", tuple(map(counted, rules.RULES)))
    scene = load_scene(ROOT / "fixtures" / "scenes" / "setzhub.toml").with_values(
        {"follower.base_radius": 51}
    )
    asked.clear()
    scene.with_values({"follower.base_radius": 52})
    assert set(asked) == {"followers_keep_their_own_rules", "tolerance_is_possible"}


def test_rules_read_by_what_notes_it() -> None:
    """Who looks at the document itself would not be noted."""
    folder = Path(camgeo.__file__).parent
    modules = [*(folder / "scene").glob("*_rules.py"), folder / "scene" / "rules.py"]
    modules += [folder / "scene" / name for name in ("milling.py", "effects.py")]
    for module in modules:
        for node in ast.walk(ast.parse(module.read_text("utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Attribute):
                assert node.value.attr != "scene" or node.attr == "fault", module.name


def test_what_touches_what() -> None:
    reads = Reads()
    reads.note(("a", "b"))
    reads.note_presence(("c",))
    for change in ((), ("a",), ("a", "b"), ("a", "b", 0), ("c",)):
        assert reads.touched(change)
    for change in (("a", "c"), ("b",), ("c", "d")):
        assert not reads.touched(change)
    same, then = [Decimal(1)], {"a": {"b": 1.5, "c": 2}, "d": 0}
    assert list(changes({**then, "same": same}, {**then, "same": same})) == []
    assert list(changes(then, {"a": {"b": 1.5, "c": "x"}, "e": 1})) == [("a", "c"), ("d",), ("e",)]
    assert list(changes([1, 2], [1])) == [()]
    assert unchanged({"rule": reads}, then, {"a": {"b": 1.5, "c": "x"}}) == {"rule": reads}
    assert unchanged({"rule": reads}, then, {"a": {"b": 9.5}}) == {}
