"""An exact flank as it is measured: places along it, and the foot of any point on it.

The flank's path runs along stretches of one parallel of the pitch curve and about points. A
position u on it is the cam angle passed on stretches plus the angle turned about points. Normals
point out of the material: outward on the inner flank, which bounds a disc, and inward on the outer
one, which bounds a hole.

The foot of a point P is the nearest place. On a stretch, (P - C) . t = 0 there, with C(phi) and the
tangent t(phi) exact functions of the cam angle. Chords of the path only choose the cells, a quarter
of a degree wide, in which the root of that equation is bracketed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Element, Flank, Path, Pivot, Stretch
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.plan import SNAP
from camgeo.numeric.arrays import (
    SIDES,
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    dot,
    joined,
    taken,
)
from camgeo.numeric.extremes import indexed_roots
from camgeo.units import TURN

if TYPE_CHECKING:
    from shapely import STRtree

CELL: Final = math.radians(0.25)
"""Widest cell [rad] of cam angle, or of the angle turned about a point."""

FEW: Final = 64
"""Up to this many points, the nearest cells are found without a search tree."""

CORNER_DISTANCE: Final = 1e-9
"""A point closer to a corner than this [mm] has no direction from it."""


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """n places on a flank.

    Attributes
    ----------
    course : (n,) position u on the path [rad].
    phi : (n,) cam angles [rad] in [0, 2 pi).
    points : (n,) complex [mm].
    normals : (n,) complex, unit, out of the material.
    tangents : (n,) complex, unit, of the pitch curve; of no meaning on a turn.
    """

    course: FloatArray
    phi: FloatArray
    points: ComplexArray
    normals: ComplexArray
    tangents: ComplexArray

    def __len__(self) -> int:
        return len(self.phi)


@dataclass(frozen=True, slots=True, eq=False)
class Feet:
    """The feet of n points.

    Attributes
    ----------
    places : where they are; at a corner the normal points from it to the point, or away from it.
    distances : (n,) [mm] from the flank to the points along the normal, positive on the free side.
    """

    places: Places
    distances: FloatArray


@dataclass(frozen=True)
class ExactFlank:
    """A flank of a disc.

    Attributes
    ----------
    path : its outline, whose stretches are all of one parallel.
    side : which flank it is.

    Raises
    ------
    GeometryError
        If the outline has no stretches.
    """

    path: Path
    side: Flank

    def __post_init__(self) -> None:
        if not self.path.stretches:
            raise GeometryError("an outline without any stretch of the flank cannot be measured")

    @property
    def curve(self) -> WorkingCurve:
        """The parallel."""
        return self.path.stretches[0].curve

    @cached_property
    def starts(self) -> FloatArray:
        """(m + 1,) u [rad] at which each element begins, and the last one ends."""
        spans = [_span(element)[1] - _span(element)[0] for element in self.path.elements]
        return np.concatenate(([0.0], np.cumsum(spans)))

    @property
    def total(self) -> float:
        """u [rad] after one turn; 2 pi if nothing of the flank is missing."""
        return float(self.starts[-1])

    def places(self, course: FloatArray) -> Places:
        """The places at the positions `course` (n,) [rad], in any turn."""
        return self._element_places(*self.locate_elements(course))

    def locate_elements(self, course: FloatArray) -> tuple[IntArray, FloatArray]:
        """Number of the element (n,) at the positions `course` (n,) [rad], and how far (n,) [rad]
        they are from its start.
        """
        wrapped = course % self.total
        last = len(self.path.elements) - 1
        element = np.minimum(np.searchsorted(self.starts, wrapped, side="right") - 1, last)
        return element, wrapped - self.starts[element]

    def positions(self, phi: FloatArray) -> FloatArray:
        """(n,) u [rad] at the cam angles `phi` (n,) [rad] in [0, 2 pi); NaN where the disc has
        nothing of the flank there.
        """
        positions = np.full(len(phi), np.nan)
        for start, element in zip(self.starts, self.path.elements, strict=False):
            if isinstance(element, Stretch):
                along = (phi - element.start) % TURN
                along[TURN - along < SNAP] = 0.0
                inside = along < element.end - element.start
                positions[inside] = start + along[inside]
        return positions

    @cached_property
    def nodes(self) -> Places:
        """Places at most `CELL` apart, in order, the ends of all elements among them: so a corner
        occurs twice, with the normals on both of its sides.
        """
        return joined(self._grids)

    @cached_property
    def turned(self) -> FloatArray:
        """(k,) angle [rad] by which the path turns from each of `nodes` to the next,
        counter-clockwise positive; 0 between the two nodes of a corner.
        """
        normals = self.nodes.normals
        same_element = self._element == np.roll(self._element, -1)
        same_element[-1] = False
        return np.where(same_element, np.angle(np.roll(normals, -1) * normals.conj()), 0.0)

    @cached_property
    def size(self) -> float:
        """Largest distance from the cam axis [mm], of `nodes`."""
        return float(np.max(np.abs(self.nodes.points)))

    def feet(self, points: ComplexArray) -> Feet:
        """The feet of `points` (n,) [mm], in cam coordinates."""
        nearest = self._nearest_cells(points)
        nearest_feet = Feet(taken(self.nodes, nearest), np.empty(len(points)))
        # The nearest chord selects the element; the foot on it is then exact.
        kinds = np.array([isinstance(element, Stretch) for element in self.path.elements])
        on_stretch = kinds[self._element[nearest]]
        for which, part in (
            (on_stretch, self._feet_on_stretches),
            (~on_stretch, self._feet_on_arcs),
        ):
            if np.any(which):
                part_feet = part(points[which], nearest[which])
                for name in ("course", "phi", "points", "normals"):
                    getattr(nearest_feet.places, name)[which] = getattr(part_feet.places, name)
                nearest_feet.distances[which] = part_feet.distances
        return nearest_feet

    def _nearest_cells(self, points: ComplexArray) -> IntArray:
        """(n,) the nodes at which those cells begin whose chords are nearest to `points` (n,)."""
        if len(points) > FEW:
            import shapely  # only what measures needs it

            tree, cells = self._tree
            return np.asarray(cells[tree.nearest(shapely.points(points.real, points.imag))])
        starts = self.nodes.points[self._cells]
        along = self.nodes.points[self._cells + 1] - starts
        from_start = points[:, None] - starts
        share = np.clip(dot(from_start, along) / np.abs(along) ** 2, 0.0, 1.0)
        nearest = np.argmin(np.abs(from_start - share * along), axis=1)
        return np.asarray(self._cells[nearest])

    def _feet_on_stretches(self, points: ComplexArray, node: IntArray) -> Feet:
        """Feet near the cells that begin at `node` (n,)."""
        nodes, element = self.nodes, self._element[node]
        first, stop = (np.searchsorted(self._element, element, side) for side in SIDES)
        last = stop - 1
        sides, turns = [], []
        # One cell more on both sides, as the foot need not lie on the nearest chord's own cell.
        for wanted in (node - 1, node + 2):
            # A whole curve has no end: beyond it, it begins again.
            wraps = np.where(wanted < first, -1, np.where(wanted > last, 1, 0))
            open_ended = self.path.is_whole
            shifted = wanted - wraps * (last - first)
            sides.append(shifted if open_ended else np.clip(wanted, first, last))
            turns.append(wraps * self.total if open_ended else np.zeros(len(node)))
        ahead = np.stack([dot(points - nodes.points[side], nodes.tangents[side]) for side in sides])
        low, high = (nodes.course[side] + turn for side, turn in zip(sides, turns, strict=True))
        # The foot lies between if the point is ahead of the first side and behind the last one.
        crossing = (ahead[0] > 0.0) & (ahead[1] < 0.0)
        offsets = self._shifts[element]

        def distance_ahead(course: FloatArray, which: IntArray) -> FloatArray:
            index = inside[which]
            curve_points, along = self.curve.points_and_tangents(course + offsets[index])
            return dot(points[index] - curve_points, along)

        inside = np.flatnonzero(crossing)
        course = np.where(ahead[0] <= 0.0, low, high)
        course[inside] = indexed_roots(distance_ahead, low[inside], high[inside], ahead[:, inside])
        places = self._stretch_places(course, offsets)
        at_end = ~crossing
        if np.any(at_end):
            end = np.where(ahead[0] <= 0.0, *sides)[at_end]
            for name in ("course", "phi", "points", "normals"):
                getattr(places, name)[at_end] = getattr(nodes, name)[end]
            self._orient_normals(points, places, at_end)
        distances = dot(places.normals, points - places.points)
        # Cells beyond the end of a whole curve were counted on; now back into one turn.
        np.remainder(places.course, self.total, out=places.course)
        return Feet(places, distances)

    def _orient_normals(self, points: ComplexArray, places: Places, which: BoolArray) -> None:
        """Turn the normals at ends of elements, in place, towards or away from `points`."""
        offsets = (points - places.points)[which]
        size, normals = np.abs(offsets), places.normals[which]
        sign = np.where(dot(normals, offsets) < 0.0, -1.0, 1.0)
        # At the corner itself the direction is undefined: the normal stays.
        far = size > CORNER_DISTANCE
        places.normals[which] = np.where(far, sign * offsets / np.where(far, size, 1.0), normals)

    def _feet_on_arcs(self, points: ComplexArray, node: IntArray) -> Feet:
        """Feet on turns about points, the cells of which begin at `node` (n,)."""
        element = self._element[node]
        pivots = [self.path.elements[k] for k in element.tolist()]
        assert all(isinstance(pivot, Pivot) for pivot in pivots)
        columns = ("centre", "distance", "normal", "sweep")
        centre, distance, normal, sweep = (
            np.array([getattr(pivot, name) for pivot in pivots]) for name in columns
        )
        # An arc on the inner side of its centre has its points opposite to its normals.
        away = (points - centre) * np.sign(distance)
        middle = normal * np.exp(0.5j * sweep)
        half = 0.5 * np.abs(sweep)
        turned = np.angle(away * middle.conj())
        along = half + np.sign(sweep) * np.clip(turned, -half, half)
        places = self._element_places(element, np.maximum(along, 0.0))
        self._orient_normals(points, places, np.abs(turned) > half)
        return Feet(places, dot(places.normals, points - places.points))

    # What is prepared once -----------------------------------------------------------------------

    @cached_property
    def _grids(self) -> list[Places]:
        """The `nodes` on each element that has a length, element by element."""
        grids = []
        for start, element in zip(self.starts, self.path.elements, strict=False):
            low, high = _span(element)
            if high == low:
                continue
            marks = element.marks if isinstance(element, Stretch) else np.array([low, high])
            counts = np.ceil(np.diff(marks) / CELL).astype(np.intp)
            parts = [
                np.linspace(a, b, count, endpoint=False)
                for a, b, count in zip(marks[:-1], marks[1:], np.maximum(counts, 1), strict=True)
            ]
            grid = np.concatenate((*parts, [high]))
            course = start + (grid - low)
            if isinstance(element, Stretch):
                curve = element.curve
                points, tangents = curve.points_and_tangents(grid)
                points[-1:] = curve.point(grid[-1:], "left")
                tangents[-1:] = curve.tangent(grid[-1:], "left")
                normals = self._outward * 1j * curve.pitch.rotation * tangents
                phi = grid % TURN
            else:
                points, normals = _pivot_places(element, grid)
                normals = self._outward * normals
                tangents = np.zeros_like(points)
                phi = np.full(len(grid), element.phi_end % TURN)
            grids.append(Places(course, phi, points, normals, tangents))
        return grids

    @property
    def _outward(self) -> int:
        """+1 if outward points out of the material, else -1."""
        return -self.side.sign

    @cached_property
    def _element(self) -> IntArray:
        """(k,) number of the element on which each node lies."""
        used = [k for k, element in enumerate(self.path.elements) if np.ptp(_span(element)) > 0.0]
        return np.repeat(used, [len(grid) for grid in self._grids])

    @cached_property
    def _shifts(self) -> FloatArray:
        """(m,) cam angle less u on each element, if it is a stretch."""
        lows = np.array([_span(element)[0] for element in self.path.elements])
        return lows - self.starts[:-1]

    @cached_property
    def _cells(self) -> IntArray:
        """The nodes at which a cell begins."""
        return np.flatnonzero(self._element[1:] == self._element[:-1])

    @cached_property
    def _tree(self) -> tuple[STRtree, IntArray]:
        """The chords of the cells, and the node at which each begins."""
        import shapely

        cells = self._cells
        ends = np.stack((self.nodes.points[cells], self.nodes.points[cells + 1]), axis=1)
        chords: Any = shapely.linestrings(  # of an array an array
            np.stack((ends.real, ends.imag), axis=2)
        )
        return shapely.STRtree(chords), cells

    def _stretch_places(self, course: FloatArray, offsets: FloatArray) -> Places:
        """Places on stretches at `course` (n,) [rad]."""
        phi = course + offsets
        points, tangents = self.curve.points_and_tangents(phi)
        normals = self._outward * 1j * self.curve.pitch.rotation * tangents
        turned = phi % TURN
        # Cam angles a few roundings from a full turn are 0.
        turned[(turned < SNAP) | (TURN - turned < SNAP)] = 0.0
        return Places(course, turned, points, normals, tangents)

    def _element_places(self, element: IntArray, along: FloatArray) -> Places:
        """Places on the elements of these numbers (n,), `along` (n,) [rad] from their starts."""
        places = self._stretch_places(self.starts[element] + along, self._shifts[element])
        for number, path_element in enumerate(self.path.elements):
            which = element == number
            if isinstance(path_element, Pivot) and np.any(which):
                points, normals = _pivot_places(path_element, along[which])
                places.points[which], places.normals[which] = points, self._outward * normals
                places.phi[which] = path_element.phi_end % TURN
        return places


def _span(element: Element) -> tuple[float, float]:
    """The parameters [rad] at which an element begins and ends; a corner has no length."""
    if isinstance(element, Stretch):
        return element.start, element.end
    return 0.0, abs(element.sweep) if element.distance != 0.0 else 0.0


def _pivot_places(pivot: Pivot, along: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Points (n,) [mm] of a turn and outward normals (n,), `along` (n,) [rad] from its start."""
    normals = pivot.normal * np.exp(1j * math.copysign(1.0, pivot.sweep) * along)
    return pivot.centre + pivot.distance * normals, normals
