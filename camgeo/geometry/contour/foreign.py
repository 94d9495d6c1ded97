"""Contours from files of others: what was read, where its axis may be, and splines as arcs.

A drawing seldom shows a cam alone, and seldom in the cam's axes. Whatever is not a closed contour
is reported in sentences; the bore shows where the cam axis is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import Biarcs
from camgeo.geometry.contour.contour import Contour, winding_number
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, cut

HALVINGS: Final = 24
"""How often a cubic is halved at most until arcs follow it."""

ROUND: Final = 1e-5
"""Centres of arcs of one bore differ by less than this fraction of its length."""

MORE_THAN_HALF: Final = 3.2
"""Turn [rad] of the arcs of a bore about its centre; both ends of a slot turn by less."""

CENTRED: Final = 1e-3
"""A bore as near to the origin [mm] is about it."""


@dataclass(frozen=True, slots=True)
class Outlines:
    """The closed contours of a file.

    Attributes
    ----------
    contours : [mm], counter-clockwise, the largest first.
    gap : largest distance of ends that were joined [mm].
    notes : what in the file was ignored or is not exact, one sentence each.
    followed : distance [mm] within which cubics approximate curves of other kinds; 0 if there are
        no such curves.
    loose : a sentence on a piece that has a loose end; empty if there is none.
    """

    contours: tuple[Contour | SplineContour, ...]
    gap: float = 0.0
    notes: tuple[str, ...] = ()
    followed: float = 0.0
    loose: str = ""

    def with_origin(self, origin: complex) -> Outlines:
        """The same contours in axes whose origin is at `origin` [mm]."""
        return replace(
            self, contours=tuple(_shift_contour(contour, -origin) for contour in self.contours)
        )

    def misplaced_bore(self, outline: Contour) -> str:
        """A sentence on the bore of `outline` if its centre is not the origin; else empty.

        The bore is the largest contour inside it with arcs that turn more than half round one
        centre.
        """
        inner = (
            contour
            for contour in self.contours
            if isinstance(contour, Contour) and contour.arc_count
        )
        for contour in inner:
            if (
                winding_number(outline, contour_centre(contour)) != 1
                or contour.area > 0.999 * outline.area
            ):
                continue
            bore = complex(contour.centres[np.argmax(np.abs(contour.sweeps))])
            # The centre of the arc with the largest sweep stands for the others on the same circle.
            concentric = np.abs(contour.centres - bore) <= ROUND * contour.length
            if abs(np.sum(contour.sweeps[concentric])) > MORE_THAN_HALF:
                # Adding 0.0 turns -0.0 into 0.0, which the sentence would print.
                x, y = (round(part, 6) + 0.0 for part in (bore.real, bore.imag))
                message = (
                    f"its bore is centred on ({x:.10g}, {y:.10g}) mm: --origin {x:.10g} {y:.10g}"
                )
                return message if abs(bore) > CENTRED else ""
        return ""


def _shift_contour(contour: Contour | SplineContour, shift: complex) -> Contour | SplineContour:
    if isinstance(contour, Contour):
        centres = np.where(contour.sweeps != 0.0, contour.centres + shift, 0.0)
        return Contour(contour.vertices + shift, contour.sweeps, centres)
    return SplineContour(
        tuple(
            CubicSpline(strand.knots, strand.controls + shift)
            if isinstance(strand, CubicSpline)
            else Arc(
                strand.start + shift,
                strand.end + shift,
                strand.sweep,
                strand.centre + shift * bool(strand.sweep),
            )
            for strand in contour.strands
        )
    )


def contour_centre(contour: Contour | SplineContour) -> complex:
    """Centroid of the area inside [mm]; of a spline contour the mean of its strands' starts."""
    if isinstance(contour, SplineContour):
        return complex(np.mean([strand.start for strand in contour.strands]))
    moments = contour.moments
    return moments.first / moments.area


def by_arcs(contour: SplineContour, tolerance: float) -> Contour:
    """The contour with each of its cubics followed by arcs within `tolerance` [mm].

    Raises GeometryError where a cubic turns too sharply for that.
    """
    columns: list[tuple[complex, float, complex]] = []
    for strand in contour.strands:
        if isinstance(strand, Arc):
            columns.append((strand.start, strand.sweep, strand.centre))
            continue
        pieces = strand.beziers
        for _ in range(HALVINGS):
            biarcs = Biarcs.along_cubics(pieces)
            far = ~(biarcs.distances <= tolerance)
            if not np.any(far):
                break
            # Only the cubics that their arcs miss are halved.
            pieces = cut(pieces, np.where(far, 2, 1))
        else:
            raise GeometryError(
                f"a spline turns too sharply for arcs to follow it within {tolerance:g} mm"
            )
        chain = biarcs.chain()
        columns += zip(chain.vertices, chain.sweeps, chain.centres, strict=True)
    vertices, sweeps, centres = (np.array(column) for column in zip(*columns, strict=True))
    return Contour(vertices, sweeps, centres)
