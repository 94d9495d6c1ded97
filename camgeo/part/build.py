"""The part built from a scene's numbers and the flanks of the cam."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.contour.pieces import Pieces
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger
from camgeo.outline.path import Path
from camgeo.part.assembly import assembled
from camgeo.part.boundaries import (
    CurveBoundary,
    ExactBoundary,
    largest_radius,
)
from camgeo.part.features import bore_outline
from camgeo.part.part import Part
from camgeo.part.spec import PartSpec


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
    tolerance : by which one boundary must at least lie inside another [mm]: contours of both that
        are as exact as that do not touch.
    ledger : records fits of the flanks.

    Raises
    ------
    GeometryError
        With the key of the scene if a bore or a hub does not fit inside the disc, a flank not
        inside the rim, or a mark is not clear of all of them.
    """
    return PARTS[contact](inner, outer, spec, tolerance, ledger or Ledger())


def _plate(inner: Path, _: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A disc whose outline is the inner flank."""
    outline = CurveBoundary("outline", hole=False, path=inner, ledger=book)
    _bore_fits(spec, outline, tolerance)
    return assembled(spec, outline, (), (outline, outline), tolerance)


def _ring(_: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a hole whose outline is the outer flank: there is no room for bore and hub."""
    if spec.hub is not None:
        raise GeometryError("the roller runs where it would be", key="part.hub")
    rim = _rim(spec, outer, tolerance, book)
    flank = CurveBoundary("outline", hole=True, path=outer, ledger=book)
    return assembled(
        replace(spec, bore=None, keyway=None, d_shaft=None), rim, (flank,), (rim, rim), tolerance
    )


def _grooved(inner: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a groove between both flanks."""
    rim = _rim(spec, outer, tolerance, book)
    groove = (
        CurveBoundary("inner flank", hole=False, path=inner, ledger=book),
        CurveBoundary("outer flank", hole=True, path=outer, ledger=book),
    )
    _bore_fits(spec, groove[0], tolerance)
    return assembled(spec, rim, groove, (groove[0], rim), tolerance)


PARTS: Final = {Contact.INNER: _plate, Contact.OUTER: _ring, Contact.GROOVE: _grooved}


def _rim(spec: PartSpec, outer: Path, tolerance: float, book: Ledger) -> ExactBoundary:
    if spec.rim is None:
        raise GeometryError("a groove or inside cam needs the diameter of its rim", key="part.rim")
    flank = CurveBoundary("outer flank", hole=True, path=outer, ledger=book)
    needed = 2.0 * (flank.farthest()[0] + tolerance)
    if spec.rim <= needed:
        raise GeometryError(
            f"the rim must lie outside the outer flank: more than {needed:.6g} mm",
            key="part.rim",
            value=f"{spec.rim:g}",
        )
    return ExactBoundary("rim", hole=False, exact=Contour.circle(spec.rim / 2.0))


def _bore_fits(spec: PartSpec, flank: CurveBoundary, tolerance: float) -> None:
    """GeometryError unless the flank surrounds bore and keyway, which may point to where there is
    more room than beside the bore.
    """
    if spec.bore is None:
        return
    outline = bore_outline(spec.bore, spec.keyway)
    reach = largest_radius(outline)
    if flank.surely_around(reach + tolerance):
        return
    room = flank.nearest()
    if reach + tolerance < room:
        return
    if 0.5 * spec.bore + tolerance < room:
        fit = flank.beside(tolerance)
        apart = least_distance(Pieces.around([outline]), Pieces.around([fit.contour]))
        if apart > fit.deviation:
            return
    raise GeometryError(
        f"the bore reaches {reach:.6g} mm from the cam axis, but the {flank.name} comes as near"
        f" as {room:.6g} mm",
        key="part.bore",
        value=f"{spec.bore:g}",
    )
