"""What `camgeo replay` finds: the motion of the follower on a disc, and the demanded one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import ClassVar, Final

import numpy as np

from camgeo.answers.answer import Answer
from camgeo.answers.replay.contour_file import (
    ARCS,
    Progress,
    Reading,
    outline_in,
)
from camgeo.cam.cam import Cam
from camgeo.contour.spline import SplineContour
from camgeo.contour.spline_replay import replay_spline
from camgeo.design import Design
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.motion.time_course import in_time
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.outline.face_lift import FaceLift
from camgeo.outline.path import Flank
from camgeo.outline.replay import CORNER, replay_contour, replay_outline
from camgeo.outline.replay_result import Jumps, Replay, closing_error
from camgeo.product.product import Product, disc_of
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, TURN

STEP: Final = Decimal("0.1")
"""Of the cam angle [deg]."""

SLACK: Final = 1e-12
"""Rounding of a contact's place, as a fraction of the base radius."""


@dataclass(frozen=True, slots=True)
class Peak:
    """A largest magnitude.

    Attributes
    ----------
    actual : with its sign and cam angle [rad]; None where the roller falls off an edge: no bound.
    demanded : magnitude.
    """

    actual: Extreme | None
    demanded: float


@dataclass(frozen=True, slots=True)
class FaceContact:
    """Where a flat face is touched, measured along it as its ends are.

    Attributes
    ----------
    lowest, highest : places [mm] with cam angles [rad].
    leaves_face : whether they lie beyond an end that the scene states; the replay does not stop
        there, as if the face were longer.
    """

    lowest: Extreme
    highest: Extreme
    leaves_face: bool


@dataclass(frozen=True, slots=True, eq=False)
class DiscReplay:
    """The motion on one disc; lifts in `unit`, derivatives per rad, cam angles in rad.

    Attributes
    ----------
    disc : whose cam demands the motion.
    contour : on which the roller runs, in words.
    note : which contour of a file was chosen; empty if it has only one.
    notes : what of the file was left out, is not exact or may be meant otherwise.
    replay : the motion itself [mm or rad].
    of : "rocker" behind a linkage, else "follower".
    unit : that of the scene, or "deg".
    factor : `unit` per mm or rad.
    lost_stroke : the largest, see `Replay`.
    lift_error : actual - demanded lift of the largest magnitude.
    velocity, acceleration : largest magnitudes.
    ripple : largest error of the acceleration as a share of its demanded peak; None if that is 0,
        or there is no bound.
    shocks, drops : jumps of the velocity and of the lift.
    contact : on a flat face; None for a roller.
    in_time : "actual_velocity" and the like [`unit` per s^k]; None without a speed or a bound.
    """

    disc: Product
    contour: str
    note: str
    notes: tuple[str, ...]
    replay: Replay
    of: str
    unit: str
    factor: float
    lost_stroke: Extreme
    lift_error: Extreme
    velocity: Peak
    acceleration: Peak
    ripple: Extreme | None
    shocks: Jumps
    drops: Jumps
    contact: FaceContact | None
    in_time: Mapping[str, float] | None


@dataclass(frozen=True, slots=True, eq=False)
class FollowerReplay(Answer):
    """The motion of the follower on real discs.

    Attributes
    ----------
    scene : that demands the motion.
    flank : on which the roller runs.
    step : of the cam angle in the table [deg].
    discs : one, or both of a conjugate pair, the main one first.
    closing : smallest and largest play between a pair as travel of the main roller [mm], negative
        where the rollers are squeezed, with cam angles [rad]; None of one disc.
    """

    command: ClassVar[str] = "replay"

    scene: Scene
    flank: Flank
    step: Decimal
    discs: tuple[DiscReplay, ...]
    closing: Extremes | None


def replay(
    design: Design,
    files: Sequence[str | Path] = (),
    flank: str | None = None,
    *,
    step: Decimal = STEP,
    reading: Reading | None = None,
    progress: Progress = lambda _: None,
) -> FollowerReplay:
    """Press the follower against the real outline, or against contours from files.

    Parameters
    ----------
    files : one of each disc, or of one disc alone; none for the real outlines.
    flank : "inner" or "outer"; None for that of the scene.
    step : of the cam angle [deg].
    reading : how the files are read.
    progress : called with how far reading has come.

    Raises
    ------
    SceneError
        If there are more files than discs, or one has no contour on which the follower can run.
    GeometryError
        As `replay_contour` and `replay_outline`.
    """
    side, reading = Flank(flank or design.cam.contact.main), reading or Reading()
    found = tuple(
        _replayed(disc, file, side, math.radians(step), reading, progress)
        for disc, file in _discs(design, side, tuple(map(Path, files)))
    )
    closing = None
    if len(found) == 2:
        main, other = (each.replay for each in found)
        closing = _closing(design.cam, main, other)
    return FollowerReplay(design.scene, side, step, found, closing)


def _discs(
    design: Design, flank: Flank, files: tuple[Path, ...]
) -> list[tuple[Product, Path | None]]:
    """The discs to replay, the main one first, each with its file or None for its real outline."""
    discs = design.discs
    if len(files) > len(discs):
        allowed = "two files at most, one of each disc"
        if len(discs) == 1:
            allowed = "one file at most, because the scene has one disc"
        raise SceneError([Fault("CONTOUR", "", allowed)])
    if len(discs) == 1 or flank is Flank.OUTER:
        return [(design.disc, files[0] if files else None)]
    if not files:
        return [(disc, None) for disc in discs]
    named = [disc_of(discs, file.stem) for file in files]
    if len(files) == 1:
        return [(named[0], files[0])]
    return list(zip(discs, files[::-1] if named == [*reversed(discs)] else files, strict=True))


def _replayed(
    disc: Product,
    file: Path | None,
    flank: Flank,
    step: float,
    reading: Reading,
    progress: Progress,
) -> DiscReplay:
    """The roller of a disc on its outline, or on the contour of a file; `step` in rad."""
    cam, pitch = disc.cam, disc.cam.disc.pitch_curve
    if file is None:
        outline = cam.disc.outline(flank).path
        found = replay_outline(pitch, outline, step=step, clearance=cam.clearance)
        return _result(disc, "the real outline", "", (), found)
    chosen, plain, note, notes = outline_in(file, disc, flank, reading, progress)
    corner = max(reading.corner, CORNER)
    try:
        if isinstance(chosen, SplineContour) and pitch.follower.has_pitch_curve:
            try:
                found = replay_spline(pitch, chosen, flank, step=step, corner=corner)
                return _result(disc, file.name, note, notes, found)
            except GeometryError:  # it is curved more tightly than that follows
                pass
        found = replay_contour(pitch, plain, flank, step=step, corner=corner)
    except GeometryError as error:
        if error.key:  # it is the call's
            raise
        raise SceneError([Fault("CONTOUR", str(file), error.message)]) from error
    if plain is not chosen:
        notes.append(f"{file.name}: splines are followed by arcs within {ARCS:g} mm")
    return _result(disc, file.name, note, notes, found)


def _result(
    disc: Product, contour: str, note: str, notes: Sequence[str], replay: Replay
) -> DiscReplay:
    """The result of a replay, in the unit of the scene."""
    cam, unit = disc.cam, disc.scene.unit
    turns = cam.lift_unit == "rad"
    factor = math.degrees(1.0) if turns else 1.0 / MM_PER[unit]
    falls = bool(len(replay.drops))

    def scaled(extreme: Extreme) -> Extreme:
        return Extreme(extreme.value * factor + 0.0, extreme.place)

    def peak(actual: Extreme | None, demanded: float) -> Peak:
        return Peak(None if actual is None else scaled(actual), demanded * factor)

    ripple, off, most = None, replay.largest_acceleration_error, replay.demanded_acceleration
    if off is not None and most > 0.0:
        ripple = Extreme(abs(off.value) / most, off.place)
    return DiscReplay(
        disc=disc,
        contour=contour,
        note=note,
        notes=tuple(notes),
        replay=replay,
        of="rocker" if cam.drive.linkage is not None and turns else "follower",
        unit="deg" if turns else unit,
        factor=factor,
        lost_stroke=scaled(replay.largest_loss),
        lift_error=scaled(replay.largest_error),
        velocity=peak(replay.velocity, replay.demanded_velocity),
        acceleration=peak(replay.acceleration, replay.demanded_acceleration),
        ripple=ripple,
        shocks=replay.shocks.scaled(factor),
        drops=replay.drops.scaled(factor),
        contact=_contact(cam, replay),
        in_time=None if falls else _in_time(cam, replay, factor),
    )


def _contact(cam: Cam, replay: Replay) -> FaceContact | None:
    """Where a flat face is touched; None for a roller."""
    if not isinstance(replay.lift, FaceLift):
        return None
    places, angles = replay.lift.contacts()
    low, high = (
        Extreme(float(places[k]), float(angles[k])) for k in (np.argmin(places), np.argmax(places))
    )
    slack, face = SLACK * cam.follower.base_radius, cam.follower.face
    leaves = face is not None and not face[0] - slack <= low.value <= high.value <= face[1] + slack
    return FaceContact(low, high, leaves)


def _closing(cam: Cam, main: Replay, other: Replay) -> Extremes:
    """Play and squeeze of a conjugate pair, see `FollowerReplay`."""
    scale = abs(cam.follower.reach)

    def travel(play: Extreme) -> Extreme:
        return Extreme(scale * play.value + 0.0, play.place % TURN)

    found = closing_error(main, other)
    return Extremes(travel(found.lowest), travel(found.highest))


def _in_time(cam: Cam, replay: Replay, factor: float) -> dict[str, float] | None:
    """Largest velocity and acceleration per second, actual and demanded at the samples."""
    course = cam.drive.time_course
    if course is None:
        return None
    out = {}
    for name, jet in (("actual", replay.actual), ("demanded", replay.demanded)):
        full = np.vstack((jet, np.zeros_like(jet[:1])))
        timed = np.abs(in_time(full, course, replay.phi)) * factor
        out[f"{name}_velocity"] = float(np.max(timed[1]))
        out[f"{name}_acceleration"] = float(np.max(timed[2][replay.smooth]))
    return out
