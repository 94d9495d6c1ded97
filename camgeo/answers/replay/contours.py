"""Contours from files, of which one is the disc's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.simple import crossing
from camgeo.errors import Fault, SceneError
from camgeo.outline.path import Flank
from camgeo.product.product import Product
from camgeo.units import LengthUnit

READERS: Final = "camgeo.readers"
"""Entry points that read contours from files, by what the file's name ends in without the dot."""

GAP: Final = 1e-3
"""End points of a drawing up to this far apart [mm] are joined: the last digit that most programs
write."""

FLAT: Final = 1e-3
"""Corners of a drawing up to this angle [degrees] are not counted: pieces of 0.1 mm whose ends are
written with six decimals meet at angles of this size."""

OUTLINE_SAMPLES: Final = 3601


class Reader(Protocol):
    """Reads closed contours [mm] from a file of one format, the largest first."""

    def read(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Contour, ...]: ...


@dataclass(frozen=True, slots=True)
class Reading:
    """How contours are read from files.

    Attributes
    ----------
    layer : of a drawing; None for CUT, or all.
    unit : of a file that does not say one.
    gap : end points up to this far apart are joined [mm].
    corner : corners up to this angle count as none [rad].
    """

    layer: str | None = None
    unit: LengthUnit | None = None
    gap: float = GAP
    corner: float = math.radians(FLAT)


def contour_of(disc: Product, flank: Flank, file: Path, reading: Reading) -> tuple[Contour, str]:
    """The contour of the file whose area is nearest to that of the flank, and which one it is.

    Raises SceneError if the file cannot be read or the contour crosses itself.
    """
    readers = entry_points(group=READERS)
    kind = file.suffix.removeprefix(".").lower()
    if kind not in readers.names:
        endings = ", ".join(f".{name}" for name in sorted(readers.names))
        raise SceneError([Fault("CONTOUR", str(file), f"the name must end in one of {endings}")])
    reader: Reader = readers[kind].load()
    try:
        data = file.read_bytes()
    except OSError as error:
        message = f"cannot be read: {error.strerror or error}"
        raise SceneError([Fault("CONTOUR", str(file), message)]) from error
    found = reader.read(data, file.name, layer=reading.layer, unit=reading.unit, gap=reading.gap)
    points = disc.pictured.curve(flank, np.linspace(0.0, 2.0 * math.pi, OUTLINE_SAMPLES))
    x, y = points.T
    area = abs(0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))
    chosen = min(found, key=lambda contour: abs(contour.area - area))
    note = f"the one of {chosen.area:.6g} mm^2 is used" if len(found) > 1 else ""
    place = crossing(chosen)
    if place is not None:
        message = f"crosses itself ({place}): no disc has this outline"
        raise SceneError([Fault("CONTOUR", str(file), message, note)])
    return chosen, note and f"{file.name}: {len(found)} contours; {note}"
