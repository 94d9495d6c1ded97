"""How the cutter of each roughing operation is engaged: its share of air, and the largest angle.

That is judged at the last depth; the others are run by the same rule. Left out are entries,
declared as such by going down, each with the round that levels its floor; slots, which have a depth
and a feed of their own; and finishes, which take an allowance off.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray
from camgeo.part.part import Part
from camgeo.toolpath.course import Course, course_of
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.engagement import LEVEL, Cutting, cleared_by
from camgeo.toolpath.judged import runs_of, setup_of
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import Toolpath
from camgeo.toolpath.verdict import FINENESS

QUANTILE: Final = 0.995
"""Share of the length of a cut on which its usual engagement is not exceeded."""

SAMPLES: Final = 1000
"""About so many places of an operation are judged."""

PIECES: Final = 300
"""Pieces of a longer course that are judged, evenly chosen: a place of a spiral of many turns takes
milliseconds, for each is held against all turns that are near.
"""

SPACING: Final = 0.5
"""Least distance of such places [mm]."""

SAME: Final = 1e-6
"""Centres and radii [mm] that differ by less are those of one circle."""


@dataclass(frozen=True, slots=True)
class Engaged:
    """The engagement of one roughing operation at its last depth, its entries left out.

    Attributes
    ----------
    operation : its name.
    length : of its course there [mm].
    air : share of that on which the cutter is in no material.
    usual : angle [rad] that is not exceeded on `QUANTILE` of the length.
    largest : of the angles at the places that are judged [rad], refined beside the largest.
    limit : the tool's, or that of a straight wall at the stepover [rad].
    place : of the largest [mm].
    """

    operation: str
    length: float
    air: float
    usual: float
    largest: float
    limit: float
    place: complex

    @property
    def sentence(self) -> str:
        """In words."""
        largest, limit = math.degrees(self.largest), math.degrees(self.limit)
        return (
            f"{100.0 * self.air:.0f} % of its length in air, the cutter engaged over at most"
            f" {largest:.1f} deg, {limit:.1f} deg allowed"
        )


def engaged_of(toolpath: Toolpath, part: Part, milling: MillingSpec) -> tuple[Engaged, ...]:
    """The engagement of each operation of a program that clears an area."""
    cuts = [operation.cut for operation in toolpath.operations]
    if not any(isinstance(cut, AreaCut) for cut in cuts):
        return ()
    runs = runs_of(toolpath)
    setup = setup_of(cuts, runs, part, milling.stock, milling.holding, FINENESS)
    return engaged(toolpath, setup.blank, setup.top)


def engagement_findings(found: Iterable[Engaged]) -> Iterator[Finding]:
    """Where the engagement exceeds its limit."""
    for each in found:
        if each.largest > each.limit:
            place = f"at X {each.place.real:.4g}, Y {each.place.imag:.4g} mm"
            sentence = f"{each.operation}: {each.sentence}, {place}"
            angles = math.degrees(each.largest), math.degrees(each.limit)
            yield Finding("engagement", "warning", sentence, *angles, "deg")


def engaged(toolpath: Toolpath, blank: Sequence[Contour], top: float) -> tuple[Engaged, ...]:
    """The engagement of each operation that clears an area.

    Parameters
    ----------
    blank : contours of the blank, of which a point of it is within an odd number.
    top : of the blank, Z [mm].
    """
    found = []
    cleared: list[tuple[Course, float]] = []
    for operation in toolpath.operations:
        if isinstance(operation.cut, AreaCut):
            course, radius = course_of(operation.moves), operation.tool.radius
            cutting = Cutting(course, radius, tuple(blank), top, tuple(cleared))
            found.append(_engaged(operation.cut, cutting))
        cleared.append(cleared_by(operation))
    return tuple(found)


def _engaged(cut: AreaCut, cutting: Cutting) -> Engaged:
    course = cutting.course
    chosen = ~entries(course) & (course.lowest <= np.min(course.lowest, initial=np.inf) + LEVEL)
    length = float(np.sum(course.lengths[chosen]))
    spacing = max(SPACING, length / SAMPLES)
    moves = course.moves[chosen]
    judged = moves[:: math.ceil(len(moves) / PIECES) or 1]
    made = cutting.engagement(spacing, judged.tolist())
    place = complex(made.places[np.argmax(made.largest)]) if len(made.largest) else 0j
    limit = cut.tool.engagement or math.acos(max(-1.0, 1.0 - cut.stepover / cut.tool.radius))
    return Engaged(
        cut.name, length, made.air_share, made.quantile(QUANTILE), made.peak, limit, place
    )


def entries(course: Course) -> BoolArray:
    """(n,) whether a piece goes down, or levels the floor of the helix that it goes on from."""
    found = course.to_z < course.from_z
    radii = course.radii
    for piece in np.flatnonzero(~found[1:] & found[:-1]) + 1:
        arc = course.sweeps[piece - 1] != 0.0
        turned = 0.0
        for each in range(piece, len(course)):
            joined = course.starts[each] == course.ends[each - 1]
            same = abs(course.centres[each] - course.centres[piece - 1]) < SAME
            same &= abs(radii[each] - radii[piece - 1]) < SAME
            turned += abs(course.sweeps[each])
            if not (arc and joined and same and turned < 2.0 * np.pi + SAME):
                break
            found[each] = True
    return found
