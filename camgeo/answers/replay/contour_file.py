"""The contour of a disc in a file of any origin: read, chosen among others, its axis found."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final, Protocol

from camgeo.contour.contour import Contour
from camgeo.contour.foreign import Outlines, by_arcs
from camgeo.contour.simple import crossing, winding_number
from camgeo.contour.spline import SplineContour
from camgeo.errors import Fault, FileError, SceneError, unreadable
from camgeo.outline.moments import area
from camgeo.outline.path import Flank
from camgeo.product.product import Product
from camgeo.reading import DRAWING, read_within
from camgeo.units import LengthUnit, in_unit
from camgeo.wording import counted

Progress = Callable[[str], object]

READERS: Final = "camgeo.readers"
"""Entry points that read contours from files, by what the file's name ends in without the dot."""

GAP: Final = 1e-3
"""End points of a drawing up to this far apart [mm] are joined: the last digit that most programs
write."""

FLAT: Final = 1e-3
"""Corners of a drawing up to this angle [degrees] are not counted: pieces of 0.1 mm whose ends are
written with six decimals meet at angles of this size."""


ARCS: Final = 1e-8
"""Distance [mm] within which arcs follow a spline where the follower's motion on it has no closed
form: under a flat face, and in hollows."""


class Reader(Protocol):
    """Reads closed contours from a file of one format, and tells how far it has come."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Progress,
    ) -> Outlines: ...


@dataclass(frozen=True, slots=True)
class Reading:
    """How contours are read from files.

    Attributes
    ----------
    layer : of a drawing; None for CUT, or all.
    unit : of a file that does not say one.
    gap : end points up to this far apart are joined [mm].
    corner : corners up to this angle count as none [rad].
    origin : where the cam axis lies in the axes of the file [mm].
    """

    layer: str | None = None
    unit: LengthUnit | None = None
    gap: float = GAP
    corner: float = math.radians(FLAT)
    origin: complex = 0j


def outline_in(
    file: Path, disc: Product, flank: Flank, reading: Reading, progress: Progress
) -> tuple[Contour | SplineContour, Contour, str, list[str]]:
    """The contour of the file whose area is nearest to that of the flank, about the cam axis; the
    same with splines followed by arcs; a note on the choice, and others.

    Raises SceneError if the file cannot be read, or the contour crosses itself or does not go round
    the cam axis.
    """
    readers = entry_points(group=READERS)
    kind = file.suffix.removeprefix(".").lower()
    if kind not in readers.names:
        endings = ", ".join(f".{name}" for name in sorted(readers.names))
        raise SceneError([Fault("CONTOUR", str(file), f"the name must end in one of {endings}")])
    reader: Reader = readers[kind].load()
    try:
        data = read_within(file, DRAWING)
    except FileError:
        raise
    except (OSError, ValueError) as error:
        message = f"cannot be read: {unreadable(error)}"
        raise SceneError([Fault("CONTOUR", str(file), message)]) from error
    read = reader.read(
        data,
        file.name,
        layer=reading.layer,
        unit=reading.unit,
        gap=reading.gap,
        progress=progress,
    ).about(reading.origin)
    own = abs(area(dict(zip(Flank, disc.cam.disc.untrimmed_paths, strict=True))[flank]))
    chosen = min(read.contours, key=lambda contour: abs(contour.area - own))
    size = in_unit(f"{chosen.area:.6g} mm^2", disc.unit)
    note = f"{file.name}: {counted(len(read.contours), 'contour')}; the one of {size} is used"
    note = note if len(read.contours) > 1 else ""
    plain = by_arcs(chosen, ARCS) if isinstance(chosen, SplineContour) else chosen
    elsewhere = read.off_axis(plain) if flank is Flank.INNER else ""
    message = ""
    if (place := crossing(plain)) is not None:
        message = f"crosses itself ({place}): no disc has this outline"
    elif winding_number(plain, 0j) != 1:
        message = "does not go round the cam axis, the origin of its axes; "
        message += elsewhere or "say with --origin where the axis is"
    if message:
        raise SceneError([Fault("CONTOUR", str(file), message, note)])
    told = [f"{file.name}: {elsewhere} puts the cam axis there, not into the origin"]
    return chosen, plain, note, [*read.notes, *(told if elsewhere else ())]
