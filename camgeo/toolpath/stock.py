"""The blank from which a part is milled; imports nothing that computes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Length, Place, Radius
from camgeo.numeric.checked import check_fields, one_of

if TYPE_CHECKING:
    from camgeo.part.boundaries import ExactBoundary

ROUND: Final = "round"
PLATE: Final = "plate"

SHAPES: Final = (ROUND, PLATE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stock:
    """The blank, upright walls between two flat faces.

    Attributes
    ----------
    shape : "round" or "plate".
    diameter : of a round blank [mm].
    length, width : of a plate along x and y [mm]; both None if its outline is not known.
    centre : of the outline, seen from the cam axis [mm].
    bore : diameter of the hole that it has on the cam axis already [mm]; None without one.
    top : of its upper face above that of the part [mm].
    bottom : of its lower face below that of the part [mm].

    Raises
    ------
    GeometryError
        With the key in `stock`, if a value is invalid, missing, or belongs to the other shape.
    """

    shape: Annotated[str, partial(one_of, choices=SHAPES)] = PLATE
    diameter: Length | None = None
    length: Length | None = None
    width: Length | None = None
    centre: Place = 0j
    bore: Length | None = None
    top: Radius = 0.0
    bottom: Radius = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "stock.")
        if self.shape == ROUND and self.diameter is None:
            raise GeometryError("a round blank needs its diameter", "stock.diameter")
        if (self.length is None) != (self.width is None):
            key = "stock.length" if self.length is None else "stock.width"
            raise GeometryError("a plate needs its length and its width, or neither", key)
        other = ("length", "width") if self.shape == ROUND else ("diameter",)
        for key in other:
            if getattr(self, key) is not None:
                shape = PLATE if self.shape == ROUND else ROUND
                raise GeometryError(f'belongs to shape "{shape}"', f"stock.{key}")

    def turned_over(self, *, faced: bool) -> Stock:
        """What lies there for a second side; `faced` says whether the first one has taken off what
        was above the part.
        """
        return replace(self, top=self.bottom, bottom=0.0 if faced else self.top)

    @property
    def hole(self) -> ExactBoundary:
        """The hole that it has on the cam axis; GeometryError if there is none."""
        if self.bore is None:
            raise GeometryError("the blank has no bore", "stock.bore")
        from camgeo.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        circle = Contour.circle(self.bore / 2.0)
        return ExactBoundary("hole in the blank", hole=True, exact=circle)

    @property
    def outline(self) -> ExactBoundary | None:
        """The upright face around it; None if it is not known."""
        import numpy as np

        from camgeo.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        if self.diameter is not None:
            circle = Contour.circle(self.diameter / 2.0, self.centre)
            return ExactBoundary("stock", hole=False, exact=circle)
        if self.length is None or self.width is None:
            return None
        corner = 0.5 * complex(self.length, self.width)
        corners = np.array([-corner, corner.conjugate(), corner, -corner.conjugate()])
        rectangle = Contour.polygon(self.centre + corners)
        return ExactBoundary("stock", hole=False, exact=rectangle)
