"""A turn of the mechanism as data: the discs, which turn, and the bodies in a number of positions.

Everything is in the fixed frame with its origin in the cam axis, in mm; the discs at cam angle 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.displayed import Brief
from camgeo.errors import CamgeoError
from camgeo.figure import disc, flanks
from camgeo.figure.marks import Area, Circle, Fill, Line, Mark, Style, Text, plane
from camgeo.figure.mechanism import PAST, parts_of, window
from camgeo.figure.model import data_of
from camgeo.figure.style import AUXILIARY, cam_angles
from camgeo.mechanism.sketch import MechanismSketch, Places
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.part.part import Part
from camgeo.product.product import Product
from camgeo.units import MM_PER, TURN

POSITIONS: Final = 240
"""Of a turn, one and a half degrees apart: between two of them bodies move in straight lines, which
differ from their arcs by less than a line is wide."""

CHORDS: Final = 1.5e-4
"""Distance of the discs' chords from the flanks where these were sampled, at each end and half way
of a chord, relative to the base radius: the picture is at least two of them wide."""

PITCH: Final = Style(AUXILIARY, 0.8, (10.0, 3.0, 2.0, 3.0))
BASE: Final = Fill(edge=AUXILIARY, width=0.6, dashes=(5.0, 4.0))


@dataclass(frozen=True, slots=True)
class Way:
    """A guide: where it begins and ends [mm], and whether a slider runs on it."""

    start: complex
    end: complex
    block: bool


@dataclass(frozen=True, slots=True, eq=False)
class Animation(Brief):
    """A turn of the mechanism.

    Attributes
    ----------
    low, high : lower left and upper right corner of what is shown [mm].
    rotation : +1 if the cam turns counter-clockwise, -1 clockwise.
    turning : marks that turn with the cam, at cam angle 0 [mm].
    note : why there is no disc; empty if there is one.
    links : how many points each link has.
    rollers : their radii [mm].
    faces : how many there are.
    joints : how many there are, without the fixed ones.
    shafts : places of the fixed joints [mm].
    guides : which do not move.
    places : (POSITIONS, n, 2) [mm], at equal steps of the cam angle from 0: the points of the
        links, both ends of each face, the centres of rollers, joints, and sliders on guides.
    lifts : (POSITIONS,) of the follower, in `lift_unit`.
    lift_unit : that of the scene, or "°".
    """

    low: complex
    high: complex
    rotation: int
    turning: tuple[Mark, ...]
    note: str
    links: tuple[int, ...]
    rollers: tuple[float, ...]
    faces: int
    joints: int
    shafts: tuple[complex, ...]
    guides: tuple[Way, ...]
    places: FloatArray
    lifts: FloatArray
    lift_unit: str

    def to_data(self) -> dict[str, Any]:
        """As `Figure.to_data`; a place is a list of two numbers."""
        data: dict[str, Any] = data_of(self)
        return data


def animation(product: Product, *, moving: bool = False) -> Animation:
    """A turn of the mechanism of `product`, with all discs of a conjugate pair.

    If it is `moving`, as in a drag, discs whose flanks have no cusp are shown before they are
    judged: flanks that cross are whole then. Everything else is the same either way.

    Raises
    ------
    CamgeoError
        If the mechanism has no position at some cam angle.
    """
    cam = product.cam
    angles = np.linspace(0.0, TURN, POSITIONS, endpoint=False)
    sketch = product.pictured.mechanism_at(angles)
    first = sketch.at(0)
    marks, reach, note = _turning(product, moving=moving)
    low, high = window(reach, [sketch])
    lifts = cam.drive.motion.jet(angles)[0]
    degrees = cam.lift_unit == "rad"
    # As much beyond what moves as in the still picture, whose joints are of this size.
    past = PAST * 0.012 * math.sqrt((high - low).real * (high - low).imag)
    return Animation(
        low,
        high,
        cam.rotation,
        marks,
        note,
        tuple(len(link) for link in first.links),
        tuple(radius for _, radius in first.rollers),
        len(first.faces),
        len(first.joints),
        first.shafts,
        tuple(_way(guide.middle, guide.direction, guide.travel, guide.block, past)
              for guide in first.guides),
        _places(sketch),
        frozen(np.degrees(lifts) if degrees else lifts / MM_PER[product.unit], np.float64),
        "°" if degrees else product.unit,
    )  # fmt: skip


def _turning(product: Product, *, moving: bool) -> tuple[tuple[Mark, ...], float, str]:
    """What turns with the cam, how far it reaches [mm], why there is no disc."""
    cam = product.cam
    base = cam.follower.base_radius
    note = ""
    marks = _discs(product, moving=moving)
    if not marks:
        try:
            drawn = flanks.whole(product, product.pictured.cut_off, 1.0)[0]
        except CamgeoError:  # the findings say so
            drawn = []
        note = next((mark.text for mark in drawn if isinstance(mark, Text)), "no disc")
        marks += [mark for mark in drawn if not isinstance(mark, Text)]
    if cam.follower.has_pitch_curve:
        marks.append(Line(plane(cam.disc.pitch_curve.point(cam_angles())), PITCH))
    reach = max([base, *map(_farthest, marks)])
    marks.append(Circle((0.0, 0.0), base, BASE, layer=2.0))
    return tuple(marks), reach, note


def _discs(product: Product, *, moving: bool) -> list[Mark]:
    """The discs; none if there are none.

    Chords are sampled and not proved: an animation follows a drag.
    """
    if moving:
        try:
            return _bodies(product, tuple(each.drawn.untrimmed for each in product.discs))
        except CamgeoError:  # undercut, for one: what is left of the disc takes longer
            pass
    return _bodies(product, parts_of(product))


def _bodies(product: Product, parts: tuple[Part, ...]) -> list[Mark]:
    """The parts of the main disc and of those behind it."""
    sagitta = CHORDS * product.cam.follower.base_radius
    marks: list[Mark] = []
    for part in parts[:1]:
        marks += disc.whole(part, 1.0, sagitta, sampled=True)[0]
    for part in parts[1:]:
        marks += disc.behind(part, 1.0, sagitta, sampled=True)
    return marks


def _farthest(mark: Mark) -> float:
    """The farthest point of an area or a line from the cam axis [mm]."""
    rings = (
        mark.rings if isinstance(mark, Area) else (mark.points,) if isinstance(mark, Line) else ()
    )
    return max((float(np.hypot(*ring.T).max()) for ring in rings), default=0.0)


def _way(
    middle: complex, direction: complex, travel: tuple[complex, ...], block: bool, past: float
) -> Way:
    ways = [((at - middle) * direction.conjugate()).real for at in travel] or [0.0]
    start, end = min(ways) - past, max(ways) + past
    return Way(middle + start * direction, middle + end * direction, block)


def _places(sketch: MechanismSketch[Places]) -> FloatArray:
    """See `Animation.places`."""
    points = [point for link in sketch.links for point in link]
    points += [point for face in sketch.faces for point in face]
    points += [centre for centre, _ in sketch.rollers]
    points += sketch.joints
    points += [guide.middle for guide in sketch.guides if guide.block]
    places = np.empty((POSITIONS, len(points)), np.complex128)
    for number, point in enumerate(points):
        places[:, number] = point
    return frozen(places.view(np.float64).reshape(POSITIONS, len(points), 2), np.float64)
