"""Designs for the tests of effects: a fixture scene with tables of effects added to it."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.graph import Effects
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.rules import Kind, Only
from camgeo.errors import GeometryError, SceneError
from camgeo.lazy import Ledger
from camgeo.scene.scene import parse_scene

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"


def design(scene: str, effects: str, *changes: tuple[str, str]) -> Design:
    """The fixture scene `scene` with the TOML text `effects` added, and `changes` made before.

    Each of the changes is a text that the scene has once, and what stands in its place.
    """
    text = (SCENES / f"{scene}.toml").read_text("utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    if effects:
        text += f"\n{effects}\n"
    return Design(parse_scene(text, str(SCENES / f"{scene}.toml")))


def only_for(kind: Kind) -> tuple[tuple[str, str], ...]:
    """Effects of camgeo for machines of a `kind` alone, with the key if it is but that."""
    found = (
        (name, key)
        for name in EFFECTS
        for rule in find_effect(name).rules
        if isinstance(rule, Only) and rule.kind is kind
        for key in rule.keys or ("",)
    )
    return tuple(dict.fromkeys(found))


def assert_refused(scene: str, effect: str, text: str, key: str, words: str = "") -> None:
    """The fault that `key` of an effect's table does not apply, reported by scene and design."""
    with pytest.raises(SceneError) as stated:
        design(scene, f"[effects.{effect}]\n{text}\n")
    (fault,) = (each for each in stated.value.faults if each.key == f"effects.{effect}.{key}")
    assert words in fault.message
    subject = design(scene, "").effects.subject
    with pytest.raises(GeometryError) as error:
        Effects(subject, {effect: tomllib.loads(text)}, Ledger()).result(effect)
    assert error.value.key.startswith(f"effects.{effect}.")
    assert words in error.value.message
