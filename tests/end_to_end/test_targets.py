"""The number of pieces on all fixture cams, compared with the limits for small tolerances."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.geometry.outline.path import Path as Outline
from camgeo.part.boundaries import CurveBoundary
from camgeo.studies.accuracy.contours import forced_pieces, least_arcs, least_chords, least_cubics
from tests.contour.paths import break_count
from tests.end_to_end.built import SCENES

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)

Least = Callable[[Outline, float], float]

TARGETS: Final[dict[str, tuple[Least, float, float, float]]] = {
    "polyline": (least_chords, 1.03, 1.0, 1 / 2),
    "arcs": (least_arcs, 1.10, 2.0, 1 / 3),
    "spline": (least_cubics, 1.10, 3.0, 1 / 4),
}
"""By form: its limit, times the limit, pieces more for each break, and the power of 1/tolerance."""

ROUGH: Final = {"measured"}
"""A lift from data: one smooth piece in which dkappa/ds changes its sign 22 times. Near such places
an arc does not follow the limit's law; what holds is that the count comes down to it."""


@lru_cache(maxsize=1)  # of a scene for all forms, one after the other
def flanks(scene: Path) -> list[CurveBoundary]:
    part = camgeo.load(scene).disc.drawn.part
    return [each for each in part.boundaries if isinstance(each, CurveBoundary)]


PAIRS: Final = [
    pytest.param(scene, form, id=f"{scene.stem}-{form}") for scene in SCENES for form in TARGETS
]


@pytest.mark.parametrize(("scene", "form"), PAIRS)
def test_few_pieces(scene: Path, form: str) -> None:
    least, times, more, power = TARGETS[form]
    for flank in flanks(scene):
        forced = 0 if form == "polyline" else forced_pieces(flank.path)
        breaks = break_count(flank.path)
        counts = []
        for tolerance in TOLERANCES:
            fit = getattr(flank, form)(tolerance)
            assert fit.deviation <= tolerance
            count = len(fit.contour) - forced
            limit = least(flank.path, tolerance)
            if scene.stem not in ROUGH:
                assert count <= times * limit + more * breaks
            counts.append(count)
        assert counts == sorted(counts)
        assert counts[-1] <= 1.25 * limit
        # Between the two finest, less what a break forces, the law of small tolerances holds: whole
        # numbers are off by one of each piece, of at least 50 in all.
        fine = np.log(np.array(counts[-2:]) - _forced_by_breaks(form, breaks, forced))
        assert (fine[1] - fine[0]) / np.log(10.0) == pytest.approx(power, abs=0.05)


def _forced_by_breaks(form: str, breaks: int, forced: int) -> float:
    """Pieces that ends of smooth pieces cost, see `camgeo.studies.accuracy.contours`."""
    return 0.0 if form == "polyline" else float(breaks - forced)
