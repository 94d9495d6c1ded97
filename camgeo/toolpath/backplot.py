"""The course of a program as traces of points, told apart by what the cutter does: for pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, Literal

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, taken
from camgeo.toolpath.course import Course, alike, course_of
from camgeo.toolpath.engagement import Cutting, cleared_by
from camgeo.toolpath.moves import Operation, Rapid, Stop, Toolpath

Kind = Literal["cut", "air", "entry", "rapid"]

KINDS: Final[tuple[Kind, ...]] = ("rapid", "air", "cut", "entry")

JUDGED: Final = (0.01, 0.5, 0.99)
"""Shares of a piece at which it is in air if it is at all of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One stretch of the course in the plane.

    Attributes
    ----------
    kind : "rapid"; "entry" where the tip goes down at feed; "air" where the cutter is in no
        material; else "cut".
    points : complex [mm], at least two; two equal ones for a move along Z.
    """

    kind: Kind
    points: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Plotted:
    """The traces of one operation, in order."""

    operation: Operation
    traces: tuple[Trace, ...]

    def length(self, kind: Kind) -> float:
        """Length [mm] in the plane of all traces of a kind."""
        found = (each.points for each in self.traces if each.kind == kind)
        return float(sum(np.sum(np.abs(np.diff(points))) for points in found))


def plotted(
    toolpath: Toolpath, blank: Sequence[Contour], top: float, fineness: float
) -> tuple[Plotted, ...]:
    """The traces of each operation.

    Parameters
    ----------
    blank : contours of the blank, of which a point of it is within an odd number.
    top : of the blank, Z [mm].
    fineness : deviation of chords [mm].
    """
    found = []
    cleared: list[tuple[Course, float]] = []
    for operation in toolpath.operations:
        course = course_of(operation.moves)
        radius = operation.tool.radius
        cutting = Cutting(course, radius, tuple(blank), top, tuple(cleared))
        traces = [*_feeds(cutting, fineness), *_rapids(operation)]
        found.append(Plotted(operation, tuple(traces)))
        cleared.append(cleared_by(operation))
    return tuple(found)


def _feeds(cutting: Cutting, fineness: float) -> Iterator[Trace]:
    """Traces of feed moves; neighbours of one kind that join are one."""
    course = cutting.course
    first = alike(course)
    known: dict[int, Kind] = {}
    kinds: list[Kind] = []
    for piece in range(len(course)):
        if course.to_z[piece] < course.from_z[piece]:
            kinds.append("entry")
            continue
        # In the plane further rounds are drawn over the first one, which cuts if any does.
        same = int(first[piece])
        if same not in known:
            known[same] = _kind(cutting, piece)
        kinds.append(known[same])
    gaps = np.concatenate(([0], np.cumsum(course.starts[1:] != course.ends[:-1]))).astype(int)
    keys = list(zip(kinds, gaps.tolist(), strict=False))
    for (kind, _), group in groupby(range(len(course)), key=lambda piece: keys[piece]):
        chain = taken(course, list(group))
        yield Trace(kind, np.concatenate((chain.starts[:1], chain.chords(fineness)[1])))


def _kind(cutting: Cutting, piece: int) -> Kind:
    if cutting.course.lengths[piece] == 0.0:
        return "air"
    return "cut" if any(cutting.angle(piece, share) for share in JUDGED) else "air"


def _rapids(operation: Operation) -> Iterator[Trace]:
    """Traverses across; those along Z are no line in the plane."""
    at = None
    for move in operation.moves:
        if isinstance(move, Stop):
            continue
        end = complex(move.end[0], move.end[1])
        if isinstance(move, Rapid) and at is not None and at != end:
            yield Trace("rapid", np.array([at, end]))
        at = end
