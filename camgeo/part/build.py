"""The part built from a scene's numbers and the flanks of the cam."""

from __future__ import annotations

import cmath
import math
from typing import Final

import numpy as np

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger
from camgeo.numeric.checked import positive
from camgeo.outline.path import Path
from camgeo.part.boundaries import (
    CurveBoundary,
    ExactBoundary,
    largest_radius,
    smallest_radius,
)
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import Keyway, PartSpec


def build_part(
    contact: Contact,
    inner: Path,
    outer: Path,
    spec: PartSpec,
    tolerance: float,
    ledger: Ledger | None = None,
) -> Part:
    """The part for one contact.

    Parameters
    ----------
    contact : flank on which the roller runs.
    inner, outer : the real outlines of the flanks; only those of the contact are used.
    spec : the scene's specification of the part.
    tolerance : of the contours [mm] that show that one boundary lies inside another.
    ledger : records fits of the flanks.

    Raises
    ------
    GeometryError
        With the key of the scene if a bore does not fit inside the disc or a flank inside the rim.
    UndercutError
        If a flank is not an outline.
    """
    return PARTS[contact](inner, outer, spec, tolerance, ledger or Ledger())


def _plate(inner: Path, _: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A disc whose outline is the inner flank."""
    outline = CurveBoundary("outline", hole=False, path=inner, ledger=book)
    _bore_fits(spec, outline, tolerance)
    return Part((Layer(-(spec.thickness or 0.0), 0.0, (outline, *_bore(spec))),))


def _ring(_: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a hole whose outline is the outer flank: there is no room for a bore."""
    rim = _rim(spec, outer, tolerance, book)
    flank = CurveBoundary("outline", hole=True, path=outer, ledger=book)
    return Part((Layer(-(spec.thickness or 0.0), 0.0, (rim, flank)),))


def _grooved(inner: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a groove between both flanks."""
    rim = _rim(spec, outer, tolerance, book)
    groove = (
        CurveBoundary("inner flank", hole=False, path=inner, ledger=book),
        CurveBoundary("outer flank", hole=True, path=outer, ledger=book),
    )
    _bore_fits(spec, groove[0], tolerance)
    body = (rim, *_bore(spec))
    # Without thickness there is nothing to sink the groove into.
    floor = -(spec.groove_depth or 0.0) if spec.thickness else 0.0
    bottom = -(spec.thickness or 0.0)
    return Part((Layer(bottom, floor, body), Layer(floor, 0.0, (*body, *groove), "groove")))


PARTS: Final = {Contact.INNER: _plate, Contact.OUTER: _ring, Contact.GROOVE: _grooved}


def _bore(spec: PartSpec) -> tuple[Boundary, ...]:
    return () if spec.bore is None else (bore_boundary(spec.bore, spec.keyway),)


def _rim(spec: PartSpec, outer: Path, tolerance: float, book: Ledger) -> ExactBoundary:
    if spec.rim is None:
        raise GeometryError("a groove or inside cam needs the diameter of its rim", key="part.rim")
    flank = CurveBoundary("outer flank", hole=True, path=outer, ledger=book)
    fit = flank.arcs(tolerance, "fast")
    needed = 2.0 * (largest_radius(fit.contour) + fit.deviation)
    if spec.rim <= needed:
        raise GeometryError(
            f"the rim must lie outside the outer flank: more than {needed:.6g} mm",
            key="part.rim",
            value=f"{spec.rim:g}",
        )
    return ExactBoundary("rim", hole=False, exact=Contour.circle(spec.rim / 2.0))


def _bore_fits(spec: PartSpec, flank: CurveBoundary, tolerance: float) -> None:
    if spec.bore is None:
        return
    fit = flank.arcs(tolerance, "fast")
    room = smallest_radius(fit.contour) - fit.deviation
    reach = largest_radius(bore_outline(spec.bore, spec.keyway))
    if reach >= room:
        raise GeometryError(
            f"the bore reaches {reach:.6g} mm from the cam axis, but the {flank.name} comes as near"
            f" as {max(room, 0.0):.6g} mm",
            key="part.bore",
            value=f"{spec.bore:g}",
        )


def bore_boundary(diameter: float, keyway: Keyway | None) -> ExactBoundary:
    """The bore as a boundary; raises like `bore_outline`."""
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
