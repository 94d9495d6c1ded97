"""Answer of `camgeo replay`: the motion of the follower on a disc, and the demanded one."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final, Literal, Protocol

import numpy as np

from camgeo.app.answers.answer import (
    SCENE,
    Answer,
    Key,
    Keys,
    display_unit,
    named_line,
    read_named,
    scaled,
    whose_lift,
)
from camgeo.app.cli.command import (
    SCENE_FILE,
    TABLE_OR_PICTURE,
    Argument,
    check_step,
    decimal,
    non_negative,
    notify,
    opened,
    origin_option,
    show,
)
from camgeo.cam.cam import Cam
from camgeo.design.design import Design
from camgeo.design.product import Product, find_disc
from camgeo.design.value_table import Table, cam_angles
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.geometry.contour.contour import Contour, crossing, winding_number
from camgeo.geometry.contour.foreign import Outlines, by_arcs
from camgeo.geometry.contour.spline import SplineContour
from camgeo.geometry.outline.face import FaceLift
from camgeo.geometry.outline.path import Flank, area
from camgeo.geometry.outline.replay import (
    Jumps,
    Replay,
    extreme_play,
    play,
    replay_contour,
    replay_outline,
    replay_spline,
)
from camgeo.geometry.outline.roller import CORNER
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.pictures.model import Figure
from camgeo.reading import DRAWING
from camgeo.scene.scene import Scene
from camgeo.units import TURN, LengthUnit, counted, in_unit

STEP: Final = Decimal("0.1")
"""Default step of the cam angle [deg]."""

SLACK: Final = 1e-12
"""Rounding of a contact's place, as a fraction of the base radius."""


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest magnitude of a quantity.

    Attributes
    ----------
    actual : with its sign and cam angle [rad]; None if it is unbounded, because the roller falls
        off an edge.
    demanded : largest magnitude of the demanded motion.
    """

    actual: Extreme | None
    demanded: float


@dataclass(frozen=True, slots=True)
class FaceContact:
    """The range of contact along a flat face, measured as its ends are.

    Attributes
    ----------
    lowest, highest : places [mm] with cam angles [rad].
    leaves_face : whether they lie beyond an end that the scene states; the replay then goes on as
        if the face were longer.
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
    notes : sentences on parts of the file that were left out, are not exact or are ambiguous.
    replay : the motion itself [mm or rad].
    member : "rocker" behind a linkage, else "follower".
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
    member: str
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
    progress : called with the state of reading, in words.

    Raises
    ------
    SceneError
        If there are more files than discs, or one has no contour on which the follower can run.
    GeometryError
        As `replay_contour` and `replay_outline`.
    """
    side, reading = Flank(flank or design.cam.contact.main), reading or Reading()
    replays = tuple(
        _replayed(disc, file, side, math.radians(step), reading, progress)
        for disc, file in _discs(design, side, tuple(map(Path, files)))
    )
    closing = None
    if len(replays) == 2:
        main, other = (disc.replay for disc in replays)
        closing = _closing(design.cam, main, other)
    return FollowerReplay(design.scene, side, step, replays, closing)


def _discs(
    design: Design, flank: Flank, files: tuple[Path, ...]
) -> list[tuple[Product, Path | None]]:
    """The discs to replay, the main one first, each with its file or None for its real outline."""
    discs = design.discs
    if len(files) > len(discs):
        allowed = "at most two files are allowed, one for each disc"
        if len(discs) == 1:
            allowed = "at most one file is allowed, because the scene has one disc"
        raise SceneError([Fault("CONTOUR", "", allowed)])
    if len(discs) == 1 or flank is Flank.OUTER:
        return [(design.disc, files[0] if files else None)]
    if not files:
        return [(disc, None) for disc in discs]
    named = [find_disc(discs, file.stem) for file in files]
    if len(files) == 1:
        return [(named[0], files[0])]
    # The files of a pair may be stated in either order.
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
        replay = replay_outline(pitch, outline, step=step, clearance=cam.clearance)
        return _result(disc, "the real outline", "", (), replay)
    chosen, plain, note, notes = read_contour(file, disc, flank, reading, progress)
    corner = max(reading.corner, CORNER)
    try:
        if isinstance(chosen, SplineContour) and pitch.follower.has_pitch_curve:
            try:
                replay = replay_spline(pitch, chosen, flank, step=step, corner=corner)
                return _result(disc, file.name, note, notes, replay)
            except GeometryError:  # it is curved more tightly than that follows
                pass
        replay = replay_contour(pitch, plain, flank, step=step, corner=corner)
    except GeometryError as error:
        if error.key:  # it is the call's
            raise
        raise SceneError([Fault("CONTOUR", str(file), error.message)]) from error
    if plain is not chosen:
        notes.append(f"{file.name}: splines are approximated by arcs within {ARCS:g} mm")
    return _result(disc, file.name, note, notes, replay)


def _result(
    disc: Product, contour: str, note: str, notes: Sequence[str], replay: Replay
) -> DiscReplay:
    """The result of a replay, in the unit of the scene."""
    cam = disc.cam
    unit, factor = display_unit(disc.scene.unit, is_angle=cam.lift_unit == "rad")
    # At a drop velocity and acceleration are unbounded.
    falls = bool(len(replay.drops))

    def peak(actual: Extreme | None, demanded: float) -> Peak:
        return Peak(None if actual is None else scaled(actual, factor), demanded * factor)

    ripple, error, most = None, replay.largest_acceleration_error, replay.demanded_acceleration
    if error is not None and most > 0.0:
        ripple = Extreme(abs(error.value) / most, error.place)
    return DiscReplay(
        disc=disc,
        contour=contour,
        note=note,
        notes=tuple(notes),
        replay=replay,
        member=whose_lift(cam),
        unit=unit,
        factor=factor,
        lost_stroke=scaled(replay.largest_loss, factor),
        lift_error=scaled(replay.largest_error, factor),
        velocity=peak(replay.velocity, replay.demanded_velocity),
        acceleration=peak(replay.acceleration, replay.demanded_acceleration),
        ripple=ripple,
        shocks=replay.shocks.scaled(factor),
        drops=replay.drops.scaled(factor),
        contact=_contact(cam, replay),
        in_time=None if falls else _time_peaks(cam, replay, factor),
    )


def _contact(cam: Cam, replay: Replay) -> FaceContact | None:
    """The range of contact along a flat face; None for a roller."""
    if not isinstance(replay.lift, FaceLift):
        return None
    places, angles = replay.lift.contacts()
    low, high = (
        Extreme(float(places[k]), float(angles[k])) for k in (np.argmin(places), np.argmax(places))
    )
    # A contact at the very end of the face may lie beyond it by rounding.
    slack, face = SLACK * cam.follower.base_radius, cam.follower.face
    leaves = face is not None and not face[0] - slack <= low.value <= high.value <= face[1] + slack
    return FaceContact(low, high, leaves)


def closing_error(main: Replay, other: Replay) -> Extremes:
    """The extreme play between two discs, see `extreme_play`.

    Raises
    ------
    GeometryError
        If both discs push the follower in the same sense, so that it is not between them.
    """
    if main.lift.outward == other.lift.outward:
        raise GeometryError("the two discs push the follower in the same sense: they do not close")
    return extreme_play(main, other)


def _closing(cam: Cam, main: Replay, other: Replay) -> Extremes:
    """Play and squeeze of a conjugate pair, see `FollowerReplay`."""
    # Play is measured in the lift: an angle [rad] of an arm times its length is travel [mm].
    scale = abs(cam.follower.reach)

    def travel(play: Extreme) -> Extreme:
        return Extreme(scale * play.value + 0.0, play.place % TURN)

    gap = closing_error(main, other)
    return Extremes(travel(gap.lowest), travel(gap.highest))


def _time_peaks(cam: Cam, replay: Replay, factor: float) -> dict[str, float] | None:
    """Largest velocity and acceleration per second, actual and demanded at the samples."""
    course = cam.drive.time_course
    if course is None:
        return None
    peaks = {}
    for name, jet in (("actual", replay.actual), ("demanded", replay.demanded)):
        # `in_time` takes three derivatives; the third affects neither velocity nor acceleration.
        full = np.vstack((jet, np.zeros_like(jet[:1])))
        timed = np.abs(in_time(full, course, replay.phi)) * factor
        peaks[f"{name}_velocity"] = float(np.max(timed[1]))
        peaks[f"{name}_acceleration"] = float(np.max(timed[2][replay.smooth]))
    return peaks


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


EXTREME: Final = Key(
    "A largest value and its place.",
    {
        "value": "The value, in the unit of the lift, or as a fraction.",
        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
    },
)

DISC: Final[Keys] = {
    "name": Key("Name of the disc, the stem of its files.", of="disc.name"),
    "contour": 'On which the follower runs: the name of a file, or "the real outline".',
    "note": "The contour that is used of a file with several; otherwise empty.",
    "notes": ("Sentences on parts of the file that were left out, are not exact or are ambiguous."),
    "of": Key(
        "Whose motion this is: that of the rocker of a linkage, or of the follower.",
        of="member",
        type=Literal["follower", "rocker"],
    ),
    "unit": Key(
        'Unit of lifts, "deg" for a swing. Derivatives are per rad of the cam angle.',
        type=Literal["mm", "inch", "deg"],
    ),
    "lost_stroke": Key(
        "Largest distance by which the follower moves beyond the demanded position, into the disc.",
        EXTREME,
    ),
    "lift_error": Key("Actual minus demanded lift, where its magnitude is largest.", EXTREME),
    "velocity": Key(
        "The largest magnitude.",
        {
            "actual": Key(
                "Signed value; null where it is unbounded, because the roller falls off an edge.",
                EXTREME,
            ),
            "demanded": "Largest magnitude.",
        },
    ),
    "acceleration": Key(
        "The largest magnitude.",
        {
            "actual": Key(
                "Signed value; null where it is unbounded, because the roller falls off an edge.",
                EXTREME,
            ),
            "demanded": "Largest magnitude.",
        },
    ),
    "ripple": Key(
        "Largest error of the acceleration as a fraction of its demanded peak; null if that is 0,"
        " or if the acceleration is unbounded.",
        EXTREME,
    ),
    "shocks": Key(
        "Jumps of the velocity.",
        {
            "count": Key("How many.", of="phi.size", type=int),
            "largest": Key("The largest of them; null if there is none.", EXTREME),
        },
    ),
    "shock_share": Key(
        "The largest shock as a fraction of the demanded peak velocity; null if that is 0.",
        of="replay.largest_shock",
    ),
    "drops": Key(
        "Jumps of the lift: the roller falls off an edge.",
        {
            "count": Key("How many.", of="phi.size", type=int),
            "largest": Key("The largest of them; null if there is none.", EXTREME),
        },
    ),
    "contact": Key(
        "The range of contact along a flat face; left out for a roller.",
        {
            "from": Key(
                "The lowest place.",
                {
                    "place_mm": Key("Along the face, measured as its ends are.", of="value"),
                    "cam_angle_deg": Key("Cam angle of the value.", of="place"),
                },
                of="lowest",
            ),
            "to": Key(
                "The highest place.",
                {
                    "place_mm": Key("Along the face, measured as its ends are.", of="value"),
                    "cam_angle_deg": Key("Cam angle of the value.", of="place"),
                },
                of="highest",
            ),
            "leaves_face": (
                "Whether these lie beyond an end of the face that the scene states; the motion is"
                " that of a longer face."
            ),
        },
        optional=True,
    ),
    "in_time": Key(
        "Velocity and acceleration per s and s^2, for a scene with a speed, where they are"
        " bounded.",
        {
            "actual_velocity": Key("Largest magnitude, actual.", type=float),
            "demanded_velocity": Key("Largest magnitude, demanded.", type=float),
            "actual_acceleration": Key("Largest magnitude, actual.", type=float),
            "demanded_acceleration": Key("Largest magnitude, demanded.", type=float),
        },
        optional=True,
        by_key=True,
    ),
}

DOCUMENT: Final = Key(
    "The actual motion of the follower on a disc, compared with the demanded one.",
    {
        "scene": SCENE,
        "flank": "The flank on which the follower runs.",
        "discs": Key("One disc, or both of a conjugate pair, the main one first.", DISC),
        "closing": Key(
            "Play between the discs of a conjugate pair.",
            {
                "largest_play": Key(
                    "The largest play between the discs.",
                    {
                        "travel_mm": Key("As travel of the main roller.", of="value"),
                        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
                    },
                    of="highest",
                ),
                "smallest_play": Key(
                    "The smallest play between the discs; negative where the rollers are squeezed.",
                    {
                        "travel_mm": Key("As travel of the main roller.", of="value"),
                        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
                    },
                    of="lowest",
                ),
            },
            optional=True,
        ),
    },
    type=FollowerReplay,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo replay` in words, as a table and as a picture.


TOUCHING: Final = 1e-9
"""Rollers that are squeezed by up to this [mm] touch: rounding."""


def text(answer: FollowerReplay) -> str:
    """The motion of the follower on each disc, and the play of a pair."""
    lines = []
    for disc in answer.discs:
        what = disc.disc.cam.follower.touching
        lines.append(f"{disc.disc.name}: the {what} on {disc.contour}, {answer.flank} flank")
        lines += _lines(disc)
    if answer.closing is not None:
        lines += [f"{answer.scene.name}: both discs", *_closing_lines(answer.closing)]
    return "\n".join(lines)


def table(answer: FollowerReplay) -> Table:
    """One row for every step of the cam angle, right-hand values; of a pair with the play."""
    first = answer.discs[0]
    degrees = cam_angles(answer.step)
    phi: FloatArray = np.radians(degrees)
    lift, unit = first.replay.lift, first.unit
    demanded = lift.motion.jet(phi, "right", 2) * first.factor
    actual = lift.jet(phi) * first.factor
    columns = {
        "phi [deg]": degrees,
        f"s demanded [{unit}]": demanded[0],
        f"s [{unit}]": actual[0],
        f"difference [{unit}]": actual[0] - demanded[0],
        f"s' [{unit}/rad]": actual[1],
        f"s'' [{unit}/rad^2]": actual[2],
        f"s' demanded [{unit}/rad]": demanded[1],
        f"s'' demanded [{unit}/rad^2]": demanded[2],
    }
    if answer.closing is not None:
        main, other = (disc.replay for disc in answer.discs)
        columns[f"play [{unit}]"] = play(main, other, phi) * first.factor
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def figure(answer: FollowerReplay) -> Figure:
    """Lift, velocity and acceleration on the first disc."""
    from camgeo.pictures.deviations import replay_figure

    first = answer.discs[0]
    return replay_figure(
        first.replay,
        title=f"{first.disc.name}: replay, {answer.flank} flank, {first.contour}",
        unit=first.unit,
        scale=first.factor,
        joints=first.disc.cam.drive.joints,
    )


def _lines(disc: DiscReplay) -> Iterator[str]:
    """One line per quantity of the motion on a disc."""
    unit = disc.unit
    yield named_line("lost stroke", _extreme_text(disc.lost_stroke, unit))
    yield named_line("lift error", _extreme_text(disc.lift_error, unit))
    for name, peak, per in (
        ("velocity", disc.velocity, "rad"),
        ("acceleration", disc.acceleration, "rad^2"),
    ):
        actual = "unbounded" if peak.actual is None else _extreme_text(peak.actual, f"{unit}/{per}")
        yield named_line(name, f"{actual}; demanded {peak.demanded:.6g}")
    if disc.ripple is not None:
        share = f"{_percent(disc.ripple.value)} of the demanded peak acceleration"
        yield named_line("ripple", f"{share}, at {_place(disc.ripple)}")
    shocks, largest = "none", disc.shocks.largest
    if largest is not None:
        shocks = f"{len(disc.shocks)}, the largest {_extreme_text(largest, f'{unit}/rad')}"
        if disc.replay.largest_shock is not None:
            shocks += f", {_percent(disc.replay.largest_shock)} of the demanded peak velocity"
    yield named_line("shocks", shocks)
    if (drop := disc.drops.largest) is not None:
        count = len(disc.drops)
        often = "once," if count == 1 else f"{count} times, the largest"
        yield named_line("falls off an edge", f"{often} {_extreme_text(drop, unit)}")
    if (contact := disc.contact) is not None:
        ends = " to ".join(_extreme_text(end, "mm") for end in (contact.lowest, contact.highest))
        beyond = "; it leaves the face, and is that of a longer one" if contact.leaves_face else ""
        yield named_line("contact on the face", f"{ends}{beyond}")
    if (timed := disc.in_time) is not None:
        for name, per in (("velocity", "s"), ("acceleration", "s^2")):
            actual, demanded = (f"{timed[f'{case}_{name}']:.6g}" for case in ("actual", "demanded"))
            yield named_line(f"{name} in time", f"{actual} {unit}/{per}; demanded {demanded}")


def _closing_lines(closing: Extremes) -> Iterator[str]:
    """The largest and the smallest play; negative play squeezes the rollers."""
    for name, extreme in (("largest play", closing.highest), ("smallest play", closing.lowest)):
        tail = ": the rollers are squeezed there" if extreme.value < -TOUCHING else ""
        yield named_line(
            name, f"{_extreme_text(extreme, 'mm')}, as travel of the main roller{tail}"
        )


def _extreme_text(extreme: Extreme, unit: str) -> str:
    return f"{extreme.value:.6g} {unit} at {_place(extreme)}"


def _place(extreme: Extreme) -> str:
    return f"cam angle {math.degrees(extreme.place):.6g} deg"


def _percent(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.0f} %" if percent >= 100.0 else f"{percent:.3g} %"


# -- contour file ---------------------------------------------------------------------------------
# The contour of a disc in a file of any origin: read, chosen among others, its axis found.


Progress = Callable[[str], object]

READERS: Final = "camgeo.readers"
"""Entry points that read contours from files, by what the file's name ends in without the dot."""

GAP: Final = 1e-3
"""End points of a drawing up to this far apart [mm] are joined: the last digit that most programs
write."""

FLAT: Final = 1e-3
"""Corners of a drawing up to this angle [degrees] are not counted: pieces of 0.1 mm whose ends are
written with six decimals meet at angles of this size."""


ARCS: Final = 1e-8
"""Distance [mm] within which arcs approximate a spline where the follower's motion on it has no
closed form: under a flat face, and in hollows."""


class Reader(Protocol):
    """Reads closed contours from a file of one format, and reports its progress."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Progress,
    ) -> Outlines: ...


@dataclass(frozen=True, slots=True)
class Reading:
    """How contours are read from files.

    Attributes
    ----------
    layer : of a drawing; None for CUT, or all.
    unit : of a file that does not say one.
    gap : end points up to this far apart are joined [mm].
    corner : corners up to this angle count as none [rad].
    origin : where the cam axis lies in the axes of the file [mm].
    """

    layer: str | None = None
    unit: LengthUnit | None = None
    gap: float = GAP
    corner: float = math.radians(FLAT)
    origin: complex = 0j


def read_contour(
    file: Path, disc: Product, flank: Flank, reading: Reading, progress: Progress
) -> tuple[Contour | SplineContour, Contour, str, list[str]]:
    """The contour of the file whose area is nearest to that of the flank, about the cam axis; the
    same with splines approximated by arcs; a note on the choice, and further notes.

    Raises SceneError if the file cannot be read, or the contour crosses itself or does not go round
    the cam axis.
    """
    readers = entry_points(group=READERS)
    kind = file.suffix.removeprefix(".").lower()
    if kind not in readers.names:
        endings = ", ".join(f".{name}" for name in sorted(readers.names))
        raise SceneError([Fault("CONTOUR", str(file), f"the name must end in one of {endings}")])
    reader: Reader = readers[kind].load()
    data = read_named(file, DRAWING, "CONTOUR")
    read = reader.read(
        data,
        file.name,
        layer=reading.layer,
        unit=reading.unit,
        gap=reading.gap,
        progress=progress,
    ).with_origin(reading.origin)
    flank_area = abs(area(dict(zip(Flank, disc.cam.disc.untrimmed_paths, strict=True))[flank]))
    chosen = min(read.contours, key=lambda contour: abs(contour.area - flank_area))
    size = in_unit(f"{chosen.area:.6g} mm^2", disc.unit)
    note = (
        f"{file.name}: {counted(len(read.contours), 'contour')}; the one with an area of {size} is"
        " used"
    )
    note = note if len(read.contours) > 1 else ""
    plain = by_arcs(chosen, ARCS) if isinstance(chosen, SplineContour) else chosen
    elsewhere = read.misplaced_bore(plain) if flank is Flank.INNER else ""
    message = ""
    if (place := crossing(plain)) is not None:
        message = f"crosses itself ({place}): no disc has this outline"
    elif winding_number(plain, 0j) != 1:
        message = "does not go round the cam axis, the origin of its axes; "
        message += elsewhere or "say with --origin where the axis is"
    if message:
        raise SceneError([Fault("CONTOUR", str(file), message, note)])
    notes = [f"{file.name}: {elsewhere} puts the cam axis there, not at the origin"]
    return chosen, plain, note, [*read.notes, *(notes if elsewhere else ())]


# -- command line ----------------------------------------------------------------------------------


SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(10)

EXAMPLE: Final = (
    "camgeo replay fixtures/scenes/setzhub.toml\n"
    "  camgeo replay fixtures/scenes/setzhub.toml out/setzhub.dxf -o ripple.png\n"
    "  camgeo replay my-cam.toml measured.csv --unit mm --json\n"
    "  camgeo replay pair.toml out/pair.dxf out/pair-return.dxf"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "contours",
        metavar="CONTOUR",
        nargs="*",
        help="drawing (DXF, SVG), or vertices (CSV: x, y, and bulge if a heading names it), in the"
        " axes of the scene's cam; default the scene's real outline. Of a conjugate pair one of"
        " each disc, or of one disc alone: that of the return disc has a name that ends in -return",
    ),
    Argument("--layer", metavar="NAME", help="layer of the drawing; default CUT, or all"),
    Argument("--unit", choices=("mm", "inch"), help="unit of CONTOUR, if it does not state one"),
    Argument(
        "--gap",
        metavar="MM",
        type=non_negative,
        default=GAP,
        help=f"end points of a drawing up to this far apart are joined; default {GAP:g}",
    ),
    origin_option("CONTOUR"),
    Argument(
        "--corner",
        metavar="DEG",
        type=non_negative,
        default=FLAT,
        help=f"corners of CONTOUR up to this angle are ignored; default {FLAT:g}",
    ),
    Argument(
        "--flank", choices=tuple(map(str, Flank)), help="flank of the follower; default the scene's"
    ),
    Argument(
        "--step",
        metavar="DEG",
        type=decimal,
        default=STEP,
        help=f"step of the cam angle; default {STEP}",
    ),
    *TABLE_OR_PICTURE,
)


def run(arguments: argparse.Namespace) -> int:
    """Replay, and print or write the results."""
    check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
    corner = math.radians(arguments.corner)
    origin = complex(*arguments.origin)
    reading = Reading(arguments.layer, arguments.unit, arguments.gap, corner, origin)
    answer = replay(
        opened(arguments),
        arguments.contours,
        arguments.flank,
        step=arguments.step,
        reading=reading,
        progress=arguments.progress,
    )
    for disc in answer.discs:
        for note in filter(None, (disc.note, *disc.notes)):
            notify(note)
    return show(answer, arguments, contents="lift, velocity, acceleration")
