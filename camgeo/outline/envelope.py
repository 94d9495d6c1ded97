"""Envelope of the roller on one flank: the working curve, and the turns where its tangent jumps.

Where the follower's velocity jumps the roller centre has a corner, and the roller turns about it:
the flank continues along an arc of the roller's radius. A path parameter runs through both: the cam
angle along the curve, the angle turned along such an arc.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from camgeo.curve.closure import joints
from camgeo.curve.working_curve import WorkingCurve
from camgeo.motion.kept import Kept, kept_with_owner
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    ascending,
    frozen,
)
from camgeo.outline.path import Element, Pivot, Stretch
from camgeo.units import TURN

KINK = 1e-9
"""A smaller angle between the tangents at a joint [rad] is rounding of a smooth joint."""


@dataclass(frozen=True, slots=True, eq=False)
class EnvelopeSamples:
    """Samples of the envelope at n places.

    Attributes
    ----------
    points : (n,) complex [mm].
    tangents : (n,) complex, unit, in the direction of growing cam angle.
    pace : (n,) signed length passed per unit of the path parameter; negative in undercut.
    """

    points: ComplexArray
    tangents: ComplexArray
    pace: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Pivots:
    """The turns among m elements, in their places: `Pivot.centre`, `normal` at the start, and +1 or
    -1 for the sense of the sweep; 0 for stretches.
    """

    centre: ComplexArray
    normal: ComplexArray
    sense: FloatArray


@dataclass(frozen=True, eq=False)
class Envelope:
    """The closed envelope at the signed distance of `curve`.

    Attributes
    ----------
    curve : the parallel of the pitch curve; Z' must not vanish.
    kept : the last result of each function of the envelope, see `kept_with_owner`.
    """

    curve: WorkingCurve
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """One stretch, or turn and stretch for each corner of the pitch curve, in turn."""
        curve = self.curve
        met = joints(curve.pitch)
        angles = met.phi[met.turns > KINK]
        if not len(angles):
            return (Stretch(curve, 0.0, TURN),)
        before, after = (curve.tangent(angles, side) for side in ("left", "right"))
        sweeps = np.angle(after * np.conj(before))
        centres = curve.pitch.point(angles)
        found: list[Element] = []
        ends = np.append(angles[1:], angles[0] + TURN)
        for k, (start, end) in enumerate(zip(map(float, angles), map(float, ends), strict=True)):
            normal = 1j * curve.pitch.rotation * complex(before[k])
            found.append(
                Pivot(
                    complex(centres[k]),
                    curve.distance,
                    normal,
                    float(sweeps[k]),
                    before=start if start > 0.0 else TURN,
                    after=start,
                )
            )
            found.append(Stretch(curve, start, end))
        return tuple(found)

    @cached_property
    def starts(self) -> FloatArray:
        """(m,) path parameter at which each element begins, from 0 on."""
        return frozen(np.concatenate(([0.0], np.cumsum(self._spans)[:-1])), np.float64)

    @cached_property
    def total(self) -> float:
        """Path parameter after one turn; 2 pi if there is no corner."""
        return float(np.sum(self._spans)) if len(self.elements) > 1 else TURN

    @cached_property
    def is_pivot(self) -> BoolArray:
        """(m,) whether each element is a turn about a corner of the pitch curve."""
        return frozen([isinstance(each, Pivot) for each in self.elements], np.bool_)

    @cached_property
    def pivots(self) -> Pivots:
        """The turns about corners of the pitch curve."""
        rows = [
            (each.centre, each.normal, math.copysign(1.0, each.sweep))
            if isinstance(each, Pivot)
            else (0j, 0j, 0.0)
            for each in self.elements
        ]
        centre, normal, sense = np.array(rows, dtype=np.complex128).T
        return Pivots(centre, normal, sense.real)

    @cached_property
    def angle_offsets(self) -> FloatArray:
        """(m,) cam angle minus path parameter along each element; 0 for turns."""
        pairs = zip(self.starts, self.elements, strict=True)
        offsets = [
            each.start - start if isinstance(each, Stretch) else 0.0 for start, each in pairs
        ]
        return frozen(offsets, np.float64)

    @cached_property
    def _spans(self) -> FloatArray:
        return np.array([_span(each) for each in self.elements])

    @cached_property
    def borders(self) -> FloatArray:
        """(k,) path parameters where the formula changes, from 0 on."""
        return self._places(self.curve.borders)

    @cached_property
    def breaks(self) -> FloatArray:
        """(k,) path parameters where the curvature may jump, from 0 on."""
        return self._places(self.curve.breaks)

    def _places(self, angles: FloatArray) -> FloatArray:
        """Path parameters of the cam angles `angles` in [0, 2 pi) and of all ends of elements."""
        angles = np.concatenate((angles, angles + TURN))
        found = [self.starts]
        for start, each in zip(self.starts, self.elements, strict=True):
            if isinstance(each, Stretch):
                within = angles[(angles > each.start) & (angles < each.end)]
                found.append(start + (within - each.start))
        return frozen(ascending(np.concatenate(found)), np.float64)

    def element_at(self, places: FloatArray) -> IntArray:
        """(n,) index of the element at each of `places` (n,) in [0, total)."""
        return np.asarray(np.searchsorted(self.starts, places, side="right") - 1)

    def within(self, places: FloatArray) -> FloatArray:
        """(n,) `places` reduced to [0, total)."""
        reduced = places - self.total * np.floor(places / self.total)
        return np.asarray(np.where(reduced >= self.total, 0.0, reduced))

    def angles_at(self, places: FloatArray) -> FloatArray:
        """Cam angles [rad] in [0, 2 pi) at path parameters of any shape in [0, total)."""
        index = self.element_at(places)
        angles = self._angles[index] + np.where(
            self.is_pivot[index], 0.0, places - self.starts[index]
        )
        return np.asarray(np.where(angles >= TURN, angles - TURN, angles))

    @cached_property
    def _angles(self) -> FloatArray:
        """(m,) cam angle [rad] at which each stretch begins, or of a turn."""
        return np.array(
            [each.after if isinstance(each, Pivot) else each.start for each in self.elements]
        )

    def place_of(self, angle: float, side: Side = "right") -> float:
        """Path parameter of a cam angle [rad] in [0, 2 pi), after a turn that is there, or before
        it if it is seen from the left.
        """
        left = side == "left"
        for start, each in zip(self.starts, self.elements, strict=True):
            if isinstance(each, Stretch):
                before = angle < each.start or (left and angle == each.start)
                beyond = angle + TURN if before else angle
                if beyond < each.end or (left and beyond == each.end):
                    return float(start) + (beyond - each.start)
        # A turn added to an angle just below the first stretch may round up to the end of the last.
        pairs = zip(self.starts, self.elements, strict=True)
        return next(float(start) for start, each in pairs if isinstance(each, Stretch))

    def samples(self, places: FloatArray) -> EnvelopeSamples:
        """Points, tangents and pace at the path parameters `places` (n,), any number of turns."""
        places = self.within(np.asarray(places, dtype=np.float64))
        if len(self.elements) == 1:
            return self._along(places)
        index = self.element_at(places)
        points, tangents = np.empty((2, len(places)), dtype=np.complex128)
        pace = np.empty(len(places))
        on_pivot = self.is_pivot[index]
        turned = places - self.starts[index]
        angles = places + self.angle_offsets[index]
        for here, part in (
            (~on_pivot, self._along(angles[~on_pivot])),
            (on_pivot, self.pivot_samples(index[on_pivot], turned[on_pivot])),
        ):
            points[here], tangents[here], pace[here] = part.points, part.tangents, part.pace
        return EnvelopeSamples(points, tangents, pace)

    def pivot_samples(self, index: IntArray, turned: FloatArray) -> EnvelopeSamples:
        """The arcs about corners of the pitch curve, the elements `index` (n,), `turned` (n,) [rad]
        from their starts.
        """
        sense, rotation = self.pivots.sense[index], self.curve.pitch.rotation
        normal = self.pivots.normal[index] * np.exp(1j * sense * turned)
        distance = self.curve.distance
        points = self.pivots.centre[index] + distance * normal
        return EnvelopeSamples(points, -1j * rotation * normal, -rotation * distance * sense)

    def _along(self, angles: FloatArray) -> EnvelopeSamples:
        """The parallel at cam angles, from the right."""
        pitch, distance = self.curve.pitch, self.curve.distance
        jet = pitch.jet(angles)
        z1, z2 = jet[1], jet[2]
        speed = np.abs(z1)
        tangents = z1 / speed
        turning = (z1.real * z2.imag - z1.imag * z2.real) / (speed * speed)
        normal = 1j * pitch.rotation * tangents
        return EnvelopeSamples(
            jet[0] + distance * normal, tangents, speed - pitch.rotation * distance * turning
        )


@kept_with_owner
def envelope_of(curve: WorkingCurve) -> Envelope:
    """The envelope at the distance of `curve`."""
    return Envelope(curve)


def _span(element: Element) -> float:
    return abs(element.sweep) if isinstance(element, Pivot) else element.end - element.start
