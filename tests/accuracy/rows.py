"""Measurements made up for tests."""

from __future__ import annotations

from camgeo.geometry.contour.contour import Effort, Form
from camgeo.studies.accuracy.contours import ContourRow, Count, FileCost

DECIMALS = 4


def count(pieces: int, tolerance: float = 1e-3) -> Count:
    return Count(pieces, 2, 0.9 * (pieces - 2), 0.98 * tolerance, 0.01, 0.005)


def file(size: int, **facts: int | float | str) -> FileCost:
    return FileCost(size, 1e-4, 0.1, 0.05, dict(facts))


def row(
    form: Form,
    tolerance: float,
    pieces: int,
    *,
    effort: Effort = "fewest",
    size: int = 10_000,
    seconds: float | None = None,
    decimals: int | None = None,
    ripple: float | None = None,
) -> ContourRow:
    """A row; with `decimals` a program of so many."""
    program = None if decimals is None else file(500, decimals=decimals)
    return ContourRow(
        form, effort, tolerance, count(pieces, tolerance), file(size), program, seconds, ripple,
        decimals=decimals,
    )  # fmt: skip


def missing(form: Form, tolerance: float) -> ContourRow:
    return ContourRow(form, "fewest", tolerance, fault="cannot be reached")
