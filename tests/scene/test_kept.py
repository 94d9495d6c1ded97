"""Whole messages of scenes that are not valid, and valid ones as they are understood."""

from __future__ import annotations

import math
from collections.abc import Iterator
from decimal import Decimal
from typing import Final

from camgeo.errors import SceneError
from camgeo.scene.scene import Scene, load_scene, parse_scene
from tests import kept
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, leaves, refusal_of, spoilt
from tests.scene.test_messages import FAULTS

NEAR: Final = 1e-6
"""Relative distance of values on both sides of a limit."""

USUAL: Final = (-1.0, 0.0, 1e-10, 1e-9, 90.0, 180.0, 360.0, 1e9, 1e10)
"""Values that are tried of every number."""

HUBBED: Final = {
    "part.hub.height": 8,
    "part.set_screw": {"diameter": 4, "height": 4},
    "part.bolt_circle.counterbore": {"diameter": 8, "depth": 3},
    "part.engraving": [{"text": "A", "height": 4, "radius": 20, "depth": 0.2}],
    "part.keyway": {"width": 5, "depth": 2.3, "angle": 90},
    "limits.mass": 2,
    "part.density": 7850,
}
"""Edits of a scene with a hub."""


def test_messages_are_as_kept() -> None:
    def messages() -> Iterator[tuple[str, str]]:
        for scene, changes, _ in FAULTS:
            head = "; ".join(f"{old!r} is {new!r}" for old, new in changes)
            yield head[:200], str(refusal_of(spoilt(scene, *changes)))

    kept.compare("scene/messages.txt", messages())


def verdicts(scene: Scene, key: str) -> Iterator[str]:
    """From which value to which one a number may be changed, and what is said where it may not."""
    table = key.partition(".")[0]
    numbers = {
        float(value)
        for name, value in leaves(scene.values).items()
        if type(value) in (int, Decimal) and name.partition(".")[0] == table
    }
    near = (number * (1.0 + side * NEAR) for number in numbers for side in (-1.0, 0.0, 1.0))
    halves = (0.5 * number for number in numbers)
    runs: list[tuple[float, float, str]] = []
    for value in sorted({*near, *halves, *USUAL}):
        whole = type(leaves(scene.values)[key]) is int and value == math.floor(value)
        try:
            scene.with_values({key: int(value) if whole else value})
            said = "allowed"
        except SceneError as error:
            faults = [
                f"{'it' if each.key == key else each.key} {each.message}" for each in error.faults
            ]
            said = "; ".join(faults).replace(f" {value:g}", " it")
        if runs and runs[-1][2] == said:
            runs[-1] = (runs[-1][0], value, said)
        else:
            runs.append((value, value, said))
    return (f"{kept.short(low)} to {kept.short(high)}: {said}" for low, high, said in runs)


def test_limits_of_each_number_are_as_kept() -> None:
    """Just below, at and just above each number of the same table, and its half."""

    def limits() -> Iterator[tuple[str, str]]:
        for scene, tables in (
            (load_scene(FIXTURES / "hub_and_holes.toml").with_values(HUBBED), ("part", "follower")),
            (parse_scene(GROOVE), ("part", "follower")),
            (parse_scene(LINKED), ("linkage", "follower", "limits")),
        ):
            for key, value in leaves(scene.values).items():
                if type(value) in (int, Decimal) and key.startswith(tables):
                    yield f"{scene.name}: {key} = {value}", "\n".join(verdicts(scene, key))

    kept.compare("scene/limits.txt", limits())
