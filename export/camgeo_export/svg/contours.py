"""Contours of an SVG drawing at true size, for replay."""

from __future__ import annotations

from collections.abc import Callable

from camgeo.contour.contour import Contour
from camgeo.contour.foreign import Outlines
from camgeo.units import LengthUnit
from camgeo_export.errors import FileError
from camgeo_export.layers import CUT, of_the_part
from camgeo_export.svg.reader import drawing_of


class SvgReader:
    """Reads contours from SVG; its groups with an id are its layers."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Callable[[str], object] = lambda _: None,
    ) -> Outlines:
        """The closed contours [mm], counter-clockwise, the largest first, of the group `layer`;
        without one of the part's edges if there is a group CUT, else all.

        Raises FileError if the drawing is not read, has no such group, or a unit is given: its size
        is stated.
        """
        drawing = drawing_of(data, name)
        if unit is not None:
            raise FileError(f"{name}: an SVG drawing states its size; leave out the unit {unit}")
        if layer is not None and layer not in drawing.layers:
            known = ", ".join(repr(each) for each in sorted(drawing.layers) if each) or "none"
            raise FileError(f"{name}: has no contour in a group {layer!r}; groups: {known[:200]}")
        names = set(drawing.layers) if layer is None else {layer}
        if CUT in names:
            names = of_the_part(names)
        found = [each for name in names for each in drawing.layers[name]]
        found.sort(key=lambda each: (-each.area, *_place(each)))
        return Outlines(tuple(found))


def _place(contour: Contour) -> tuple[float, float]:
    """Which of two equal ones is first."""
    first = complex(contour.vertices[0])
    return first.real, first.imag


READER = SvgReader()
