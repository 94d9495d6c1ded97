"""Measurements made up for tests."""

from __future__ import annotations

from camgeo.geometry.contour.contour import Effort, Form
from camgeo.studies.accuracy.contours import ContourRow, Count, EffectRow, FileCost

EFFECTS = (
    EffectRow("vibration", 1e-2, 0.0123, 3.2e-3, 4.44e-4, figure="vibration deflection"),
    EffectRow("vibration", 1e-4, 0.5, 1.2e-5, None),
    EffectRow("balance", 1e-2, fault="there is no disc"),
)

ROUNDED = (
    EffectRow("drive-torque", 1e-2, 0.0222, 3.3e-15, 0.0, rounded=True),
    EffectRow("lift-off", 1e-2, 0.5, None, 0.0, rounded=True),
)


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
