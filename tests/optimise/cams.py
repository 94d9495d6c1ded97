"""Scenes whose designs are judged quickly, and designs that are given by formulas."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

import numpy as np
import pytest

from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.optimise.optimise import Judge, RowVerdict
from camgeo.studies.sweep.family import Point
from tests.sweep.families import FIXTURES, SETZHUB

UNMADE: Final = dict.fromkeys(("part", "tool", "holding", "output"))


def bare(name: str) -> Scene:
    """A scene of the fixtures without its part."""
    return load_scene(FIXTURES / "scenes" / f"{name}.toml").with_values(UNMADE)


PLAIN: Final = SETZHUB.with_values(UNMADE)


def given(
    monkeypatch: pytest.MonkeyPatch, formula: Callable[[FloatArray], tuple[list[float], float]]
) -> None:
    """Designs answer the costs of a formula of their numbers, and keep a margin from 0 on."""

    def row(point: Point) -> RowVerdict:
        costs, margin = formula(np.array(point, dtype=float))
        broken = ("a margin",) if margin < 0.0 else ()
        return RowVerdict(
            point, tuple(costs), ("",) * len(costs), "", tuple(costs), {"a margin": margin},
            max(-margin, 0.0), broken,
        )  # fmt: skip

    def rows(_: Judge, points: Iterable[Point]) -> list[RowVerdict]:
        return [row(each) for each in points]

    monkeypatch.setattr(Judge, "rows", rows)
