"""The outlines of features: exactly lines and arcs."""

from __future__ import annotations

import cmath
import math
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.numeric.checked import positive
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.spec import DShaft, Holes, Keyway, Mark
from camgeo.units import TURN

COUNTERBORE: Final = "counterbore"
"""Name of counterbores, and of the layer that begins on their floors."""


def bore_boundary(
    diameter: float, keyway: Keyway | None, flat: DShaft | None = None
) -> ExactBoundary:
    """The bore as a boundary, with a keyway or a flat; raises like `bore_outline`."""
    if flat is not None:
        return ExactBoundary("bore", hole=True, exact=flattened(diameter, flat))
    core = None if keyway is None else Contour.circle(diameter / 2.0)
    return ExactBoundary("bore", hole=True, exact=bore_outline(diameter, keyway), core=core)


def bore_outline(diameter: float, keyway: Keyway | None) -> Contour:
    """The bore around the cam axis [mm], counter-clockwise: two half circles, or circle and slot.

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
    # In axes along the keyway's middle line: up the slot, across its bottom, down again.
    reach = math.sqrt(radius * radius - half * half)
    bottom = radius + keyway.depth
    corners = np.array(
        [reach - 1j * half, bottom - 1j * half, bottom + 1j * half, reach + 1j * half]
    )
    opening = 2.0 * math.asin(half / radius)
    vertices = corners * cmath.exp(1j * keyway.angle)
    sweeps = np.array([0.0, 0.0, 0.0, 2.0 * math.pi - opening])
    return Contour(vertices, sweeps, np.zeros(4, dtype=np.complex128))


def flattened(diameter: float, flat: DShaft) -> Contour:
    """A bore with a flat about the cam axis [mm], counter-clockwise: up the flat, and round."""
    radius = 0.5 * diameter
    away = flat.across - radius
    half = math.sqrt((radius - away) * (radius + away))
    corners = cmath.exp(1j * flat.angle) * np.array([away - 1j * half, away + 1j * half])
    opening = 2.0 * math.acos(away / radius)
    return Contour(corners, np.array([0.0, TURN - opening]), np.zeros(2, dtype=np.complex128))


def hole_boundaries(holes: Holes, name: str) -> tuple[ExactBoundary, ...]:
    """Round holes as boundaries, `name` with a number each."""
    return tuple(
        ExactBoundary(f"{name} {number}", hole=True, exact=Contour.circle(0.5 * holes.hole, middle))
        for number, middle in enumerate(holes.middles, start=1)
    )


def counterbore_boundaries(holes: Holes) -> tuple[ExactBoundary | None, ...]:
    """The counterbores of the holes, in their order, with a number each; None without any."""
    if holes.counterbore is None:
        return (None,) * holes.count
    radius = 0.5 * holes.counterbore.diameter
    return tuple(
        ExactBoundary(f"{COUNTERBORE} {number}", hole=True, exact=Contour.circle(radius, middle))
        for number, middle in enumerate(holes.middles, start=1)
    )


def mark_boundary(mark: Mark) -> ExactBoundary:
    """The outline of a timing mark."""
    return ExactBoundary("mark", hole=True, exact=mark_outline(mark))


def mark_outline(mark: Mark) -> Contour:
    """A circle, or a radial slot with round ends [mm], counter-clockwise.

    Raises
    ------
    GeometryError
        With key "part.mark.radius", if it reaches the cam axis.
    """
    half = 0.5 * mark.width
    straight = 0.0 if mark.length is None else 0.5 * mark.length - half
    if mark.radius <= half + straight:
        raise GeometryError(
            f"the mark must not reach the cam axis: more than {half + straight:.6g} mm",
            key="part.mark.radius",
            value=f"{mark.radius:g}",
        )
    along = cmath.exp(1j * mark.angle)
    if not straight:
        return Contour.circle(half, mark.radius * along)
    # In axes along the ray: outward on its right, round the outer end, and back on its left.
    near, far = mark.radius - straight, mark.radius + straight
    corners = np.array([near - 1j * half, far - 1j * half, far + 1j * half, near + 1j * half])
    centres = np.array([0.0, far, 0.0, near])
    return Contour(along * corners, np.array([0.0, math.pi, 0.0, math.pi]), along * centres)
