"""Scenes of the fixtures with one number far from where its designer had it."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any, Final

from tests.fuzz.case import SCENE, SCENE_STEPS, Case, toml
from tests.fuzz.scenes import accepted, fixtures, values_of

FACTORS: Final = (1e-6, 1e-3, 0.05, 20.0, 1e3, 1e6)

HUGE: Final = 1e9

Place = tuple[str | int, ...]


def number_case(rng: Random) -> Case:
    """A scene that is accepted with one of its numbers changed; it is checked, built, verified."""
    for _ in range(20):
        path = rng.choice(fixtures())
        values = values_of(path)
        place, size = rng.choice([each for each in numbers(values) if each[0] != ("camgeo",)])
        changed = rng.choice((*(size * factor for factor in FACTORS), HUGE))
        _set(values, place, float(f"{changed:.6g}"))
        if accepted(values, path.parent):
            break
    text = toml(values)
    files = {each.name: each.read_bytes() for each in path.parent.glob("*.csv")}
    files = {name: data for name, data in files.items() if name in text}
    source = f"{path.stem}, {'.'.join(map(str, place))}"
    return Case({**files, SCENE: text.encode()}, SCENE_STEPS, source, both=False)


def numbers(values: Any, place: Place = ()) -> Iterator[tuple[Place, float]]:
    """All numbers of a scene, with their places."""
    if isinstance(values, dict):
        for key, value in values.items():
            yield from numbers(value, (*place, key))
    elif isinstance(values, list):
        for index, value in enumerate(values):
            yield from numbers(value, (*place, index))
    elif isinstance(values, int | float) and not isinstance(values, bool):
        yield place, float(values)


def _set(values: Any, place: Place, value: float) -> None:
    for key in place[:-1]:
        values = values[key]
    values[place[-1]] = value
