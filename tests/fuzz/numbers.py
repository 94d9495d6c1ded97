"""Scenes of the fixtures with one number far from where its designer had it."""

from __future__ import annotations

from random import Random
from typing import Any, Final

from tests.fuzz.case import SCENE, SCENE_STEPS, Case, Path, changed, paths, toml, value_at
from tests.fuzz.scenes import accepted, fixtures, values_of

FACTORS: Final = (1e-6, 1e-3, 0.05, 20.0, 1e3, 1e6)

HUGE: Final = 1e9


def number_case(rng: Random) -> Case:
    """A scene that is accepted with one of its numbers changed; it is checked, built, verified."""
    for _ in range(20):
        path = rng.choice(fixtures())
        values = values_of(path)
        place = rng.choice([each for each in paths(values) if is_number(values, each)])
        size = value_at(values, place)
        other = rng.choice((*(size * factor for factor in FACTORS), HUGE))
        values = changed(values, place, float(f"{other:.6g}"))
        if accepted(values, path.parent):
            break
    text = toml(values)
    files = {each.name: each.read_bytes() for each in path.parent.glob("*.csv")}
    files = {name: data for name, data in files.items() if name in text}
    source = f"{path.stem}, {'.'.join(map(str, place))}"
    return Case({**files, SCENE: text.encode()}, SCENE_STEPS, source, both=False)


def is_number(values: dict[str, Any], place: Path) -> bool:
    """Whether a size is there, and not the version of the format."""
    return type(value_at(values, place)) in (int, float) and place != ("camgeo",)
