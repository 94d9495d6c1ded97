"""What is printed beside a cam: its rollers, and a ring to try the fit on the shaft."""

from __future__ import annotations

from typing import Final

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.part.boundaries import ExactBoundary, largest_radius
from camgeo.part.part import Layer, Part
from camgeo.printing.spec import PrintSpec

RING_WALL: Final = 3.0
RING_SHARE: Final = 0.1
"""Thickness of a test ring around the bore [mm], and as a share of its diameter: the larger."""

RING_HEIGHT: Final = 6.0
"""Height of a test ring [mm]; that of a thinner disc is its thickness."""


def roller_part(radius: float, width: float, bore: float | None, spec: PrintSpec | None) -> Part:
    """A roller [mm] with the clearance of its bore, yet to be compensated otherwise.

    Raises
    ------
    GeometryError
        With the key of the scene, if the bore with its clearance is no smaller than the roller.
    """
    boundaries = [ExactBoundary("roller", hole=False, exact=Contour.circle(radius))]
    if bore is not None:
        clearance = 0.0 if spec is None else spec.bore_clearance or 0.0
        half = 0.5 * (bore + clearance)
        if half >= radius:
            message = f"must be less than {2.0 * radius - clearance:g} mm, for the clearance"
            raise GeometryError(message, key="output.3mf.roller_bore", value=f"{bore:g}")
        boundaries.append(ExactBoundary("bore", hole=True, exact=Contour.circle(half)))
    return Part((Layer(-width, 0.0, tuple(boundaries), "roller"),))


def ring_part(fitted: Part) -> Part:
    """A ring with the bore, keyway or flat of a part with its clearances, yet to be compensated
    otherwise.

    Raises
    ------
    GeometryError
        With key "output.3mf.plate", if the part has no bore.
    """
    bores = [each for each in fitted.boundaries if each.name == "bore"]
    if not bores or not isinstance(bores[0], ExactBoundary):
        raise GeometryError("the test ring needs the bore of the part", key="output.3mf.plate")
    reach = largest_radius(bores[0].exact)
    around = Contour.circle(reach + max(RING_WALL, 2.0 * RING_SHARE * reach))
    ring = ExactBoundary("ring", hole=False, exact=around)
    height = min(RING_HEIGHT, fitted.thickness)
    return Part((Layer(-height, 0.0, (ring, bores[0]), "ring"),))
