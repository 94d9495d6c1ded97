"""Several bodies on one build plate: a cam, its rollers, and a test ring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from camgeo.design.product import Product, display_title
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.part.boundaries import ExactBoundary, largest_radius
from camgeo.part.compensation import PrintSpec, compensate_part
from camgeo.part.part import Layer, Part
from camgeo.scene.formats.threemf import FORMAT, PlateBody, ThreeMfSpec

COLOURS: Final[dict[str, str]] = {
    PlateBody.CAM: "#3B6FB6",
    PlateBody.RETURN_CAM: "#C44E52",
    PlateBody.ROLLER: "#8C8C8C",
    PlateBody.RETURN_ROLLER: "#B0B0B0",
    PlateBody.TEST_RING: "#E0A030",
}
"""Colours of the bodies on the screen, red, green and blue, by kind."""

STEP: Final = 0.001
"""Places are rounded to multiples of this [mm], away from each other."""

NOISE: Final = 6
"""Decimals [mm] of a reach that are not rounding, so that the same scene gives the same places on
any processor."""


@dataclass(frozen=True, slots=True)
class PlatePiece:
    """A body on a plate.

    Attributes
    ----------
    kind : kind of the body, one of `camgeo.scene.formats.threemf.PlateBody`.
    name : name of the body for people.
    part : the body, compensated, about an axis of its own.
    reach : radius of the circle about that axis in which it lies [mm].
    x, y : where its axis stands on the plate [mm].
    """

    kind: str
    name: str
    part: Part
    reach: float
    x: float
    y: float

    @property
    def colour(self) -> str:
        """See `COLOURS`."""
        return COLOURS[self.kind]


def plate_pieces(product: Product) -> tuple[PlatePiece, ...]:
    """The bodies on the build plate of a scene, side by side; empty if it asks for none.

    They stand in one row in the positive quadrant, and the circles about them do not overlap.

    Raises
    ------
    GeometryError
        With the key of the scene, if one of them is impossible.
    """
    options = product.options[FORMAT]
    bodies = [(kind, *_body(kind, product, options)) for kind in options.plate]
    reaches = [round(part.outermost.farthest()[0], NOISE) for _, _, part in bodies]
    pieces = []
    y = _rounded_place(options.gap + max(reaches, default=0.0))
    edge = 0.0
    for (kind, name, part), reach in zip(bodies, reaches, strict=True):
        # Places are rounded up, away from the body before, so that the gap is kept.
        x = _rounded_place(edge + options.gap + reach)
        pieces.append(PlatePiece(kind, name, part, reach, x, y))
        edge = x + reach
    return tuple(pieces)


def _rounded_place(place: float) -> float:
    """The coordinate [mm] rounded up to whole steps."""
    # The inner rounding removes noise that would lift a whole number of steps to the next one.
    return round(math.ceil(round(place / STEP, 3)) * STEP, 3)


def _body(kind: str, product: Product, options: ThreeMfSpec) -> tuple[str, Part]:
    """The name of a body of that kind, and its part, compensated."""
    missing = not product.others or (kind == PlateBody.RETURN_CAM and product.is_pair)
    if kind in (PlateBody.RETURN_CAM, PlateBody.RETURN_ROLLER) and missing:
        message = f'there is no return disc of its own for "{kind}"'
        raise GeometryError(message, key="output.3mf.plate")
    disc = product.others[0] if kind in (PlateBody.RETURN_CAM, PlateBody.RETURN_ROLLER) else product
    if kind in (PlateBody.CAM, PlateBody.RETURN_CAM):
        return display_title(disc), disc.drawn.printed.target
    spec, fitted = product.scene.printing, product.drawn.printed.fitted
    if kind == PlateBody.TEST_RING:
        part = ring_part(fitted)
    else:
        stated = product.scene.part
        assert stated is not None  # every body has a thickness
        assert stated.thickness is not None
        of_pair = None if stated.pair is None else stated.pair.roller_width
        width = options.roller_width or of_pair or stated.thickness
        radius = disc.cam.follower.roller_radius
        if not radius > 0.0:
            raise GeometryError("a knife edge is no roller", key="output.3mf.plate")
        part = roller_part(radius, width, options.roller_bore, spec)
    return kind.replace("-", " "), part if spec is None else compensate_part(part, spec)


# -- accessories ----------------------------------------------------------------------------------
# What is printed beside a cam: its rollers, and a ring to try the fit on the shaft.


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
    bores = [boundary for boundary in fitted.boundaries if boundary.name == "bore"]
    if not bores or not isinstance(bores[0], ExactBoundary):
        raise GeometryError("the test ring needs the bore of the part", key="output.3mf.plate")
    reach = largest_radius(bores[0].exact)
    around = Contour.circle(reach + max(RING_WALL, 2.0 * RING_SHARE * reach))
    ring = ExactBoundary("ring", hole=False, exact=around)
    height = min(RING_HEIGHT, fitted.thickness)
    return Part((Layer(-height, 0.0, (ring, bores[0]), "ring"),))
