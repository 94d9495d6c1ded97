"""Designs for the tests of effects: a fixture scene with tables of effects added to it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Kind, Only, Subject
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.kinematics.time_course import TimeCourse
from camgeo.scene.scene import parse_scene

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"


def changed(text: str, *changes: tuple[str, str]) -> str:
    """Each of the changes is a text that is there once, and what stands in its place."""
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def design(scene: str, effects: str, *changes: tuple[str, str]) -> Design:
    """The fixture scene `scene` with the TOML text `effects` added, and `changes` made before."""
    text = changed((SCENES / f"{scene}.toml").read_text("utf-8"), *changes)
    if effects:
        text += f"\n{effects}\n"
    return Design(parse_scene(text, str(SCENES / f"{scene}.toml")))


def course_of(made: Design | Subject) -> TimeCourse:
    """How the cam turns by its scene, which has a speed or a curve of it."""
    course = made.drive.time_course
    assert course is not None
    return course


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


LOCKED: Final = (
    ("crank = 42.0", "crank = 100"),
    ("coupler = 75.38", "coupler = 60"),
    ("crank_deflection = 6.3", "crank_deflection = 0"),
    ('stroke_direction = "left"', 'stroke_direction = "right"'),
    ("to = 5.5", "to = 155"),
    ('direction = "outward"', 'direction = "inward"'),
)
"""Changes of schnitt, whose rocker comes to where it cannot move its slider: the coupler hangs
straight down from the pin at X = -sqrt(100^2 - 40^2), a stroke of 60 + 91.65 mm to the right."""
