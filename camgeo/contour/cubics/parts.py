"""A path as parts for a fit of splines: smooth pieces, evaluated at once, and arcs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgeo.contour.cubics.arc_length import CELLS, ArcLength, Traced, cells_of
from camgeo.contour.joints import APART, check_regular, torn_apart
from camgeo.contour.legs import Leg, StretchLeg, TurnLeg
from camgeo.contour.proved import SLIGHT, by_curve
from camgeo.contour.spline import Arc
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, taken

ROUNDING = 2.0**-52 * 64.0
"""Rounding of a point, and smallest tolerance, as a fraction of the distance from the cam axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part of a path that becomes one strand: a smooth piece of a stretch, or a turn.

    Attributes
    ----------
    leg : number of the leg that it lies on.
    begin : its parameter [rad] where the strand begins.
    start : its point there [mm].
    course, piece : for a spline, the arc length that its knots measure, from the start of the piece
        of that number; None for an arc.
    sweep, centre : of an arc, [rad] and [mm].
    first, last : unit tangents at the ends of a smooth piece.
    """

    leg: int
    begin: float
    start: complex
    course: ArcLength | None = None
    piece: int = 0
    sweep: float = 0.0
    centre: complex = 0j
    first: complex = 0j
    last: complex = 0j

    def arc(self, end: complex) -> Arc | None:
        """The single arc of a dwell or a turn; None for a piece that needs a spline."""
        if self.course is not None:
            return None
        return Arc(self.start, end, self.sweep, self.centre)


def parts_of(legs: Sequence[Leg], tolerance: float) -> list[Part]:
    """The parts of a path, in order; those too short for a strand are omitted.

    Raises
    ------
    UndercutError
        If a piece is not regular.
    GeometryError
        If the path is torn apart inside a stretch.
    """
    stretches = [(k, leg) for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
    pieces = [(number, leg, piece) for number, leg in stretches for piece in leg.pieces]
    found: list[Part | None] = [None] * len(pieces)
    right = np.empty(len(pieces), dtype=np.complex128)
    left = right.copy()
    for curve, chosen in by_curve([(leg, piece) for _, leg, piece in pieces]):
        numbers = [pieces[k][0] for k in chosen]
        starts, ends, parts = _of_curve(curve, [pieces[k][2] for k in chosen], numbers)
        right[chosen], left[chosen] = starts, ends
        for k, part in zip(chosen, parts, strict=True):
            found[k] = part
    order: list[Part] = []
    begin = 0
    for number, leg in enumerate(legs):
        if isinstance(leg, TurnLeg):
            if leg.length > SLIGHT * tolerance:
                order.append(Part(number, 0.0, leg.first, sweep=leg.sweep, centre=leg.centre))
            continue
        end = begin + len(leg.pieces)
        _require_joined(leg, right[begin:end], left[begin:end], tolerance)
        kept = [part for part in found[begin:end] if part is not None]
        if kept and not leg.closed:
            # An omitted piece before a part belongs to that part.
            start = kept[0].start if leg.first is None else leg.first
            kept[0] = replace(kept[0], start=start, begin=leg.start)
        order += kept
        begin = end
    return order


def _require_joined(
    leg: StretchLeg, right: ComplexArray, left: ComplexArray, tolerance: float
) -> None:
    """A parallel is torn apart where the follower's velocity jumps: there it is no single leg.

    `right`, `left` (pieces,) are the starts and the ends of its pieces.
    """
    gaps = np.abs(right - np.roll(left, 1))
    if not leg.closed:
        gaps[0] = 0.0
    if np.any(gaps > np.maximum(tolerance, ROUNDING * np.abs(right))):
        raise torn_apart(leg.pieces[int(np.argmax(gaps))].start)


def _of_curve(
    curve: WorkingCurve, pieces: Sequence[Piece], legs: Sequence[int]
) -> tuple[ComplexArray, ComplexArray, list[Part | None]]:
    """Starts and ends (pieces,) [mm] of pieces of one curve, and the parts that they will be; None
    for one too short. `legs` are the numbers of their legs.

    Two evaluations serve all: one from the right, one from the left, as calls cost more than
    numbers.
    """
    moving = [k for k, piece in enumerate(pieces) if not piece.is_arc]
    rests = [k for k, piece in enumerate(pieces) if piece.is_arc]
    phi, nodes = cells_of([pieces[k] for k in moving])
    count = len(moving)
    resting_from = np.array([pieces[k].start for k in rests])
    middle = np.array([0.5 * (pieces[k].start + pieces[k].end) for k in rests])
    here = Traced.of(
        curve, np.concatenate((phi[:, :-1].ravel(), nodes.ravel(), resting_from, middle))
    )
    back = Traced.of(curve, np.array([piece.end for piece in pieces]), "left")

    stop, last = phi[:, :-1].size, phi[:, :-1].size + nodes.size
    cells = here.shaped(slice(0, stop), (count, CELLS))
    inside = here.shaped(slice(stop, last), nodes.shape)
    resting = here.shaped(slice(last, None), (2, len(rests)))
    for place, k in enumerate(moving):
        check_regular(curve, pieces[k], inside.regular[place])
    for place, k in enumerate(rests):
        check_regular(curve, pieces[k], resting.regular[:, place])

    starts = np.empty(len(pieces), dtype=np.complex128)
    middles = starts.copy()
    starts[moving], middles[moving] = cells.points[:, 0], cells.points[:, CELLS // 2]
    starts[rests], middles[rests] = resting.points
    ends = back.points
    long = np.abs(middles - starts) + np.abs(ends - middles) > APART * np.abs(starts)

    rows = [place for place, k in enumerate(moving) if long[k]]
    kept = [moving[place] for place in rows]
    course = None
    if kept:
        points = np.column_stack((cells.points[rows], ends[kept]))
        tangents = np.column_stack((cells.tangents[rows], back.tangents[kept]))
        course = ArcLength.of(curve, phi[rows], points, tangents, taken(inside, rows))
    parts: list[Part | None] = [None] * len(pieces)
    for row, (place, k) in enumerate(zip(rows, kept, strict=True)):
        first, arriving = complex(cells.tangents[place, 0]), complex(back.tangents[k])
        begin, start = pieces[k].start, complex(starts[k])
        parts[k] = Part(legs[k], begin, start, course, row, first=first, last=arriving)
    for k in rests:
        if long[k]:
            centre = pieces[k].centre or 0j
            turn = -curve.pitch.rotation * (pieces[k].end - pieces[k].start)
            parts[k] = Part(legs[k], pieces[k].start, complex(starts[k]), sweep=turn, centre=centre)
    return starts, ends, parts
