"""Whether engraved letters have room on the upper face of the disc."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.contour.pieces import Pieces
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.part.engraving import ENGRAVING
from camgeo.part.lettering import Letter
from camgeo.part.part import Boundary


def require_room(
    texts: Sequence[Sequence[Letter]],
    beside: Iterable[Boundary],
    hubs: Iterable[Boundary],
    tolerance: float,
) -> None:
    """Raise GeometryError with the key of a text, and the letter, unless all letters lie clear of
    other boundaries, on material of the disc and not under a hub.

    Parameters
    ----------
    texts : the letters of each.
    beside : other boundaries on the upper face of the disc.
    hubs : those that stand on it.
    tolerance : of the contours by which boundaries are compared [mm]; their deviation counts.
    """
    around: dict[Letter, int] = {}
    for boundary in (own := tuple(beside)) + tuple(hubs):
        fit = boundary.beside(tolerance)
        pieces = Pieces.around([fit.contour])
        for number, letters in enumerate(texts, start=1):
            key = f"part.{ENGRAVING}[{number}]"
            whole = Pieces.around(contour for each in letters for contour in each.contours)
            if least_distance(whole, pieces) <= fit.deviation + _deviation(letters):
                letter = min(letters, key=lambda each: _apart(each, pieces))
                message = f"must lie clear of the {boundary.name}, which the {letter.where} touches"
                raise GeometryError(message, key=key)
            for each in letters:
                inside = winding_number(fit.contour, _start(each.contours[0])) != 0
                if _surrounds(each, fit.contour):
                    message = f"the {each.where} lies around the {boundary.name}"
                    raise GeometryError(message, key=key)
                if boundary in own:
                    around[each] = around.get(each, 0) + inside
                elif inside:
                    message = f"the {each.where} lies under the {boundary.name}"
                    raise GeometryError(message, key=key)
    for number, letters in enumerate(texts, start=1):
        for each in letters:
            if not around[each] % 2:
                message = f"the {each.where} lies where the disc has no material"
                raise GeometryError(message, key=f"part.{ENGRAVING}[{number}]")


def _start(contour: Contour) -> complex:
    return complex(contour.vertices[0])


def _surrounds(letter: Letter, contour: Contour) -> bool:
    return any(winding_number(each, _start(contour)) for each in letter.contours)


def _deviation(letters: Iterable[Letter]) -> float:
    return max(each.deviation for each in letters)


def _apart(letter: Letter, pieces: Pieces) -> float:
    return least_distance(Pieces.around(letter.contours), pieces)
