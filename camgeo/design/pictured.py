"""A cam as pictures show it: the mechanism's skeleton, and where a flank is cut off."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.envelope import Envelope
from camgeo.geometry.outline.outline import Outline
from camgeo.geometry.outline.path import Flank, Pivot, whole
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen
from camgeo.record import Pickled
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam

SAMPLES = 721
"""Points along the cut-off part of a flank: finer than a printed line."""


@dataclass(frozen=True, slots=True)
class FollowerSketch:
    """What a picture shows of the follower at cam angle 0.

    Attributes
    ----------
    kind : "guide" for a translating follower, "pivot" for an oscillating one.
    end : complex [mm], the pivot, or any point of the guide farther out than the roller centre.
    face : complex [mm], the two ends of a flat face; None for a roller.
    """

    kind: Literal["guide", "pivot"]
    end: complex
    face: tuple[complex, complex] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TrimmedStretch:
    """What a picture shows of a flank where the disc has a corner.

    Attributes
    ----------
    flank : the flank that is cut off.
    start, end : cam angles [rad] of the flank at the corner, start in [0, 2 pi), end above it.
    course : (n,) complex [mm], the flank between them, which is not on the disc; it begins and ends
        at the corner.
    """

    flank: Flank
    start: float
    end: float
    course: ComplexArray

    @property
    def corner(self) -> complex:
        """The corner [mm]."""
        return complex(self.course[0])


@dataclass(frozen=True)
class PicturedCam(Pickled):
    """What pictures show of a cam in addition to its own quantities.

    Attributes
    ----------
    cam : the cam.
    returning : the follower on the return disc of a conjugate pair; None if there is none.
    known : pages that a writer has drawn already, as its formats show the same.
    """

    cam: Cam
    returning: Follower | None
    known: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at `phi` (n,) [rad]."""
        points = getattr(self.cam.disc, f"{what}_curve").point(phi)
        return np.column_stack((points.real, points.imag))

    @property
    def follower_sketch(self) -> FollowerSketch:
        """The guide or pivot of the follower, and the ends of a flat face."""
        return FollowerSketch(*self.cam.follower.held(self._face_ends))

    @property
    def linkage_joint(self) -> tuple[complex, complex]:
        """Joint of linkage and follower at lift 0 [mm], and the direction outward from there, see
        `Follower.linkage_joint`.
        """
        return self.cam.follower.linkage_joint(self._farthest)

    @property
    def _farthest(self) -> float:
        """The lift [mm or rad] at which the follower is farthest from the cam."""
        reach = self.cam.follower.reach
        return max(lift_range(self.cam.drive.motion), key=lambda lift: reach * lift)

    def mechanism_sketch(self, phi: float) -> MechanismSketch[complex]:
        """The links and joints of the mechanism at the cam angle `phi` [rad]."""
        return self.mechanism_sketches(np.array([phi])).position(0)

    def mechanism_sketches(self, phi: FloatArray) -> MechanismSketch[Places]:
        """The links and joints of the mechanism at cam angles `phi` (n,) [rad]."""
        cam, follower, linkage = self.cam, self.cam.follower, self.cam.drive.linkage
        motion, ends = cam.drive.motion, self._face_ends
        lift = motion.jet(phi)[0]
        lifts = lift_range(motion)
        sketch = follower.sketch(lift, self._farthest, ends).of_table("follower")
        if self.returning is not None:
            both = (follower, self.returning)
            # The largest distance of either roller from the cam axis at the ends of the stroke.
            reach = max(abs(roller.traced_point(lift_end)) for roller in both for lift_end in lifts)
            first = follower.traced(lift)
            sketch += self.returning.return_sketch(first, lift, reach).of_table("follower.return")
        if cam.yoke_breadth > 0.0:
            sketch += follower.far_side(lift, ends, cam.yoke_breadth)
        if linkage is None:
            return sketch
        place, outward = self.linkage_joint
        linked = linkage.sketch(place, outward, cam.drive.plan.jet(phi)[0])
        way = linkage.sketch(place, outward, np.array(lift_range(cam.drive.plan)))
        ends_of_way = way.position(0).guides, way.position(1).guides
        guides = tuple(
            replace(guide, travel=tuple(guide_end[number].middle for guide_end in ends_of_way))
            for number, guide in enumerate(linked.guides)
        )
        return sketch + replace(linked, guides=guides).of_table("linkage")

    @property
    def trimmed_stretches(self) -> tuple[TrimmedStretch, ...]:
        """The stretches of the flanks in use that are cut off; none of a flank of which it is
        unknown what remains.
        """
        stretches: list[TrimmedStretch] = []
        for flank in self.cam.contact.flanks:
            try:
                outline = self.cam.disc.outline(flank)
            except GeometryError:  # reported by the findings
                continue
            stretches += _trimmed_stretches(self.cam.disc.curve(flank), outline, flank)
        return tuple(stretches)

    @property
    def _face_ends(self) -> tuple[float, float]:
        """The ends of a flat face [mm]: as the scene states, else as the contact requires.

        Zeros for a roller, which has no face.
        """
        curve = self.cam.disc.pitch_curve
        if curve.follower.face is not None:
            return curve.follower.face
        from camgeo.geometry.outline.face import contact_places  # few cams have a flat face

        try:
            places, _ = contact_places(curve, self.cam.disc.outline(Flank.INNER).path)
        except GeometryError:  # reported by the findings
            places, _ = contact_places(curve, whole(self.cam.disc.inner_curve))
        return float(np.min(places)), float(np.max(places))


def _trimmed_stretches(curve: WorkingCurve, outline: Outline, flank: Flank) -> list[TrimmedStretch]:
    """The stretches that are cut off at the corners of `outline`, the real outline of `curve`.

    Empty for a knife edge: the corners of its flank are those of the pitch curve, not cuts.
    """
    if curve.pitch.follower.has_edge:
        return []
    envelope, pivots = Envelope(curve), outline.path.pivots
    return [_trimmed_stretch(envelope, pivot, flank) for pivot in pivots if pivot.distance == 0.0]


def _trimmed_stretch(envelope: Envelope, corner: Pivot, flank: Flank) -> TrimmedStretch:
    start = corner.phi_start % TURN
    first, last = (
        envelope.path_parameter(start, "left"),
        envelope.path_parameter(corner.phi_end % TURN),
    )
    last += envelope.total if last < first else 0.0  # the stretch passes cam angle 0
    # Places on both sides of the roller's turns are added, to include the ends of their arcs.
    turns = [*envelope.starts, *(envelope.starts + envelope.total)]
    inside = [place for place in turns if first < place < last]
    places = np.unique(np.append(np.linspace(first, last, SAMPLES)[1:-1], inside))
    points = envelope.samples(places).points
    course = np.concatenate(([corner.centre], points, [corner.centre]))
    end = start + (corner.phi_end - corner.phi_start) % TURN
    return TrimmedStretch(flank, start, end, frozen(course, np.complex128))
