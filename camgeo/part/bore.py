"""Outline of the bore, with its keyway."""

from __future__ import annotations

import cmath
import math

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.numeric.checked import positive
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.spec import Keyway


def bore_outline(diameter: float, keyway: Keyway | None) -> Contour:
    """The bore about the cam axis [mm], counter-clockwise: two half circles, or circle and slot.

    Raises
    ------
    GeometryError
        With key "part.keyway.width", if the slot is not narrower than the bore; with "part.bore",
        if the diameter is not above 0.
    """
    radius = positive("part.bore", diameter, "mm") / 2.0
    if keyway is None:
        return Contour.circle(radius)
    half = keyway.width / 2.0
    if half >= radius:
        raise GeometryError(
            f"the keyway must be narrower than the bore, {diameter:g} mm",
            key="part.keyway.width",
            value=f"{keyway.width:g}",
        )
    # In axes turned into the keyway's middle line: up the slot, across its bottom, down again.
    reach = math.sqrt(radius * radius - half * half)
    bottom = radius + keyway.depth
    corners = np.array(
        [reach - 1j * half, bottom - 1j * half, bottom + 1j * half, reach + 1j * half]
    )
    opening = 2.0 * math.asin(half / radius)
    vertices = corners * cmath.exp(1j * keyway.angle)
    sweeps = np.array([0.0, 0.0, 0.0, 2.0 * math.pi - opening])
    return Contour(vertices, sweeps, np.zeros(4, dtype=np.complex128))


def bore_boundary(diameter: float, keyway: Keyway | None) -> ExactBoundary:
    """The bore as boundary; raises as `bore_outline`."""
    core = None if keyway is None else Contour.circle(diameter / 2.0)
    return ExactBoundary("bore", hole=True, exact=bore_outline(diameter, keyway), core=core)


def bore_reach(diameter: float, keyway: Keyway | None) -> float:
    """Largest distance of the bore's outline from the cam axis [mm]."""
    if keyway is None:
        return diameter / 2.0
    return math.hypot(diameter / 2.0 + keyway.depth, keyway.width / 2.0)
