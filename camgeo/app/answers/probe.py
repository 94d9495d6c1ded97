"""Answer of `camgeo probe`: points of the flanks to be measured, with their true normals."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Final

import numpy as np

from camgeo.app.answers.answer import FINDING, SCENE, Answer, Key, exit_code, finding_lines
from camgeo.app.cli.command import (
    CSV,
    SCENE_FILE,
    Argument,
    CallError,
    Written,
    check_step,
    decimal,
    non_negative,
    opened,
    output_options,
    positive,
    require_same_folder,
    show,
    table_file,
)
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.value_table import Table, cam_angles
from camgeo.errors import GeometryError
from camgeo.geometry.outline.exact_flank import ExactFlank, Feet, Places
from camgeo.geometry.outline.path import Flank, Stretch
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.extremes import Extreme, inverse
from camgeo.numeric.quadrature import gauss
from camgeo.scene.scene import Scene
from camgeo.studies.inspection import false_share, radius_angles
from camgeo.units import MM_PER, at_cam_angles, counted
from camgeo.units import at_cam_angles as places

STEP: Final = Decimal(1)
"""Default step of the cam angle [deg]."""


@dataclass(frozen=True, slots=True, eq=False)
class ProbedFlank:
    """The points of one flank.

    Attributes
    ----------
    disc : whose flank it is.
    flank : which one.
    points : to be measured.
    length : of the flank [mm].
    lifts : (n,) of the follower when it touches the points [mm or rad].
    findings : on the measuring ball, and on points that the disc lacks.
    """

    disc: Product
    flank: Flank
    points: ProbePoints
    length: float
    lifts: FloatArray
    findings: tuple[Finding, ...]

    @property
    def count(self) -> int:
        """Number of points."""
        return len(self.points.places)


@dataclass(frozen=True, slots=True, eq=False)
class Probing(Answer):
    """Points to be measured.

    Attributes
    ----------
    scene : whose flanks they are of.
    step : of the cam angle [deg]; None if they are evenly spaced.
    spacing : largest distance along the flank [mm]; None if they are at a step of the cam angle.
    ball : radius of the measuring ball [mm], 0 for none.
    tolerance : width [mm] of the zone about the flank in which points may lie; None if not stated.
    flanks : all in use, those of the main disc first.
    lift_curve : (n, 2) cam angle [rad] and lift [mm or rad] at every `step`, or every degree.
    """

    scene: Scene
    step: Decimal | None
    spacing: float | None
    ball: float
    tolerance: float | None
    flanks: tuple[ProbedFlank, ...]
    lift_curve: FloatArray

    @property
    def exit_code(self) -> int:
        """1 if the ball does not fit somewhere."""
        return exit_code(finding for flank in self.flanks for finding in flank.findings)


def probe(
    design: Design,
    flank: str | None = None,
    *,
    step: Decimal | None = None,
    spacing: float | None = None,
    ball: float = 0.0,
    tolerance: float | None = None,
) -> Probing:
    """Points of the flanks of a design.

    Parameters
    ----------
    flank : "inner" or "outer"; None for all in use.
    step : of the cam angle [deg]; every degree if neither it nor a spacing is given.
    spacing : largest distance along the flank [mm]; the points are equally far apart.
    ball : radius of the measuring ball [mm].
    tolerance : see `Probing`.

    Raises
    ------
    GeometryError
        If there is no such disc, or the spacing gives too many points.
    """
    if spacing is None:
        step = STEP if step is None else step
    probed = []
    for disc in design.discs:
        sides = disc.cam.contact.flanks if flank is None else (Flank(flank),)
        for side in sides:
            exact = ExactFlank(disc.cam.disc.outline(side).path, side)
            if spacing is not None:
                points = evenly_spaced_points(exact, spacing, ball)
            else:
                points = points_at_cam_angles(exact, np.radians(cam_angles(step or STEP)), ball)
            lifts = disc.cam.drive.motion.jet(points.places.phi, "right", 1)[0]
            findings = tuple(_findings(points))
            length = flank_length(exact)
            probed.append(ProbedFlank(disc, side, points, length, lifts, findings))
    return Probing(
        design.scene, step, spacing, ball, tolerance, tuple(probed), _lift_curve(design, step)
    )


def _lift_curve(design: Design, step: Decimal | None) -> FloatArray:
    """(n, 2) cam angle [rad] and actual lift of the follower on the main disc [mm or rad]."""
    cam = design.cam
    phi: FloatArray = np.radians(cam_angles(step or STEP))
    side = cam.contact.main
    if cam.disc.outline(side).is_trimmed:
        return np.column_stack((phi, cam.disc.replay(side).lift.displacement(phi)))
    return np.column_stack((phi, cam.drive.motion.jet(phi, "right", 1)[0]))


def _findings(points: ProbePoints) -> Iterator[Finding]:
    if points.ball > 0.0:
        blocked = points.obstructed
        if blocked is None:
            sentence = f"a ball of radius {points.ball:g} mm fits at every point"
            yield Finding("ball", "ok", sentence, points.ball, unit="mm")
        else:
            sentence = (
                f"a ball of radius {points.ball:g} mm cannot touch the point"
                f" {places(blocked.place)}: another place of the flank is {blocked.value:.3g} mm"
                " nearer to its centre; take a smaller ball"
            )
            yield Finding("ball", "broken", sentence, points.ball, None, "mm", blocked.place)
        if points.feigned > 0.0:
            delta = points.largest_radial_angle
            sentence = (
                f"compensation along the radius instead of the normal, which is up to"
                f" {math.degrees(delta.value):.3g} deg off it {places(delta.place)}, would show"
                f" {points.feigned:.3g} mm of material that is not there"
            )
            yield Finding("ball-compensation", "ok", sentence, points.feigned, unit="mm")
    if points.missing:
        sentence = (
            f"{points.missing} of the cam angles have no point, because the flank is cut away there"
        )
        yield Finding("left-out", "warning", sentence, float(points.missing))


# -- probing --------------------------------------------------------------------------------------
# Points of an exact flank to be measured, with their true normals.
#
# They lie at a step of the cam angle, or evenly along the flank. The arc length of each cell is
# Gauss's integral of the pace ds/du, an exact function of the position u along the path, and
# Newton's method finds the position of a given length.


MOST_PROBED: Final = 200_000
"""Largest number of points of a flank."""

NODES: Final = 8
"""Nodes of Gauss's rule on a cell of a quarter of a degree: exact to rounding between the breaks.
"""

ROOM: Final = 1e-9
"""The ball fits if no place of the flank is nearer to its centre than its radius less this share
of the flank's size."""


@dataclass(frozen=True, slots=True, eq=False)
class ProbePoints:
    """Points of one flank to be measured.

    Attributes
    ----------
    flank : of which they are.
    places : (n,) of the points, in the order of the path.
    missing : number of steps at which the disc has nothing of the flank.
    ball : radius of the measuring ball [mm], 0 for a point.
    """

    flank: ExactFlank
    places: Places
    missing: int = 0
    ball: float = 0.0

    @property
    def centres(self) -> ComplexArray:
        """(n,) complex centres [mm] of the ball when it touches the points."""
        ball_centres: ComplexArray = self.places.points + self.ball * self.places.normals
        return ball_centres

    @property
    def largest_radial_angle(self) -> Extreme:
        """The largest angle [rad] between a normal and the radius, with its cam angle."""
        angles = np.abs(radius_angles(self._feet))
        worst = int(np.argmax(angles))
        return Extreme(float(angles[worst]), float(self.places.phi[worst]))

    @property
    def feigned(self) -> float:
        """The largest deviation [mm] that radial normals would feign with this ball."""
        return float(np.max(false_share(radius_angles(self._feet)))) * self.ball

    @property
    def obstructed(self) -> Extreme | None:
        """How much nearer [mm] than its radius another place of the flank is to the ball where it
        fits worst, with the cam angle; None if it fits everywhere.
        """
        if self.ball == 0.0:
            return None
        short = self.ball - self.flank.feet(self.centres).distances
        worst = int(np.argmax(short))
        if short[worst] <= ROOM * self.flank.size:
            return None
        return Extreme(float(short[worst]), float(self.places.phi[worst]))

    @property
    def _feet(self) -> Feet:
        return Feet(self.places, np.zeros(len(self.places)))


def points_at_cam_angles(flank: ExactFlank, phi: FloatArray, ball: float = 0.0) -> ProbePoints:
    """Points at the cam angles `phi` (n,) [rad] in [0, 2 pi), ascending.

    Raises GeometryError if the disc has nothing of the flank at any of them.
    """
    course = flank.positions(phi)
    there = ~np.isnan(course)
    if not np.any(there):
        raise GeometryError("the flank is cut away at all of these cam angles")
    places = flank.places(course[there])
    # As asked for: a turn added and taken away again would round it.
    places.phi[:] = phi[there]
    return ProbePoints(flank, places, int(np.count_nonzero(~there)), ball)


def evenly_spaced_points(flank: ExactFlank, spacing: float, ball: float = 0.0) -> ProbePoints:
    """Points as far apart along the flank as possible, at most `spacing` [mm], all equally.

    The first one is at the start of the path, or half a spacing from it where that is a corner.

    Raises GeometryError if these would be more than `MOST_PROBED`.
    """
    nodes, lengths = flank.nodes, _lengths(flank)
    total = float(lengths[-1])
    if total > MOST_PROBED * spacing:
        raise GeometryError(
            f"points {spacing:g} mm apart on a flank of {total:.6g} mm would be more than"
            f" {MOST_PROBED:,}"
        )
    count = max(1, math.ceil(total / spacing))
    # A path that is not whole begins at a corner, where the normal jumps: half a gap keeps clear of
    # it.
    first = 0.0 if flank.path.is_whole else 0.5
    wanted: FloatArray = (np.arange(count, dtype=np.float64) + first) * (total / count)
    used = np.concatenate(([True], np.diff(lengths) > 0.0))  # the second of two at a corner is not
    edges, marks = nodes.course[used], lengths[used]

    def length(course: FloatArray) -> FloatArray:
        # The last edge itself belongs to the last cell.
        cell = np.clip(np.searchsorted(edges, course, side="right") - 1, 0, len(edges) - 2)
        return marks[cell] + _integrals(flank, edges[cell], course)

    course = inverse(length, lambda u: _paces(flank, u), edges, wanted)
    return ProbePoints(flank, flank.places(course), 0, ball)


def flank_length(flank: ExactFlank) -> float:
    """Length of the flank [mm]."""
    return float(_lengths(flank)[-1])


def _lengths(flank: ExactFlank) -> FloatArray:
    """(k,) arc lengths [mm] from the start of the path to each of its nodes."""
    course = flank.nodes.course
    return np.concatenate(([0.0], np.cumsum(_integrals(flank, course[:-1], course[1:]))))


def _integrals(flank: ExactFlank, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) lengths [mm] of the path from `low` (n,) to `high` (n,) [rad], within a cell each."""
    places, half, weights = gauss(low, high, NODES)
    return np.asarray(half * (_paces(flank, places.ravel()).reshape(places.shape) @ weights))


def _paces(flank: ExactFlank, course: FloatArray) -> FloatArray:
    """(n,) arc length per position along the path, ds/du [mm/rad]."""
    element, along = flank.locate_elements(course)
    paces = np.empty(len(course))
    for number, piece in enumerate(flank.path.elements):
        which = element == number
        if not np.any(which):
            continue
        if isinstance(piece, Stretch):
            paces[which] = flank.curve.traced(piece.start + along[which])[2]
        else:
            # About a corner u is the angle of the normal, and the radius of the arc is constant.
            paces[which] = abs(piece.distance)
    return paces


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


FLANK: Final = Key(
    "The points of one flank.",
    {
        "name": Key("Name of the disc, the stem of its files.", of="disc.name"),
        "flank": "Which flank; normals point out of the material, outward on the inner one.",
        "length_mm": "Length of the flank.",
        "count": "Number of points.",
        "off_radius": Key(
            "The largest angle between a normal and the radius.",
            {
                "angle_deg": Key("That angle.", of="value"),
                "cam_angle_deg": Key("Cam angle of the value.", of="place"),
            },
            of="points.largest_radial_angle",
        ),
        "findings": Key("All findings, worst first.", FINDING),
    },
)

DOCUMENT: Final = Key(
    "Points of the flanks to be measured; their table and the lift curve are the CSV files.",
    {
        "scene": SCENE,
        "step_deg": "Step of the cam angle; null if the points are evenly spaced.",
        "spacing_mm": (
            "Largest distance along the flank; null if the points are at a step of the cam angle."
        ),
        "ball_mm": "Radius of the measuring ball, 0 for none.",
        "tolerance_mm": "Profile tolerance: width of the zone about the flank; null if not stated.",
        "flanks": Key("All in use, those of the main disc first.", FLANK),
    },
    type=Probing,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo probe` in words and as tables.


def text(answer: Probing) -> str:
    """Number and spacing of the points of each flank, its length, and the findings."""
    lines = []
    for flank in answer.flanks:
        spaced = "evenly along it" if answer.step is None else f"every {answer.step} deg"
        lines.append(
            f"{flank.disc.name}: {counted(flank.count, 'point')} of the {flank.flank} flank,"
            f" {spaced}, {flank.length:.6g} mm long"
        )
        angle = flank.points.largest_radial_angle
        lines.append(
            f"        {'normals':26}up to {math.degrees(angle.value):.4g} deg off the radius,"
            f" {at_cam_angles(angle.place)}"
        )
        lines += finding_lines(flank.findings)
    return "\n".join(lines)


def table(answer: Probing) -> Table:
    """The points of the first flank: a curve in the plane with its normals, out of the material."""
    return flank_table(answer, answer.flanks[0])


def flank_table(answer: Probing, flank: ProbedFlank) -> Table:
    """The points of one flank, in the unit of the scene.

    `upper` and `lower` are the deviations allowed, positive for more material.
    """
    unit, places = answer.scene.unit, flank.points.places
    mm = MM_PER[unit]
    columns = {
        "phi [deg]": _degrees(places.phi, answer.step),
        f"x [{unit}]": places.points.real / mm,
        f"y [{unit}]": places.points.imag / mm,
        "nx": places.normals.real,
        "ny": places.normals.imag,
        _lift(answer): _scaled(answer, flank.lifts),
    }
    if answer.ball > 0.0:
        columns[f"ball x [{unit}]"] = flank.points.centres.real / mm
        columns[f"ball y [{unit}]"] = flank.points.centres.imag / mm
    if answer.tolerance is not None:
        half = np.full(flank.count, 0.5 * answer.tolerance / mm)
        columns[f"upper [{unit}]"], columns[f"lower [{unit}]"] = half, -half
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def lift_table(answer: Probing) -> Table:
    """The lift curve."""
    phi, lifts = answer.lift_curve.T
    columns = (_degrees(phi, answer.step or STEP), _scaled(answer, lifts))
    return Table(("phi [deg]", _lift(answer)), np.column_stack(columns))


def _degrees(phi: FloatArray, step: Decimal | None) -> FloatArray:
    """(n,) cam angles [deg]: at a step those that it states, which radians would round twice."""
    if step is None:
        return np.degrees(phi)
    stated = cam_angles(step)
    return stated[np.searchsorted(np.radians(stated), phi)]


def _turns(answer: Probing) -> bool:
    return answer.flanks[0].disc.cam.lift_unit == "rad"


def _lift(answer: Probing) -> str:
    return "psi [deg]" if _turns(answer) else f"s [{answer.scene.unit}]"


def _scaled(answer: Probing, lifts: np.ndarray) -> np.ndarray:
    return np.degrees(lifts) if _turns(answer) else lifts / MM_PER[answer.scene.unit]


# -- command line ----------------------------------------------------------------------------------


SMALLEST_STEP: Final = Decimal("0.01")
LARGEST_STEP: Final = Decimal(30)


EXAMPLE: Final = (
    "camgeo probe fixtures/scenes/setzhub.toml --ball 1.5 -o points.csv\n"
    "  camgeo probe my-cam.toml --spacing 0.5 --tolerance 0.02 -o points.csv --lift lift.csv"
)


def _csv(name: str) -> str:
    if Path(name).suffix != CSV:
        raise argparse.ArgumentTypeError(f"{name!r} must end in {CSV}")
    return name


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument("--step", metavar="DEG", type=decimal, help=f"step of the cam angle; default {STEP}"),
    Argument(
        "--spacing",
        metavar="MM",
        type=positive,
        help="instead of a step: equal distances along the flank, at most this",
    ),
    Argument("--flank", choices=tuple(map(str, Flank)), help="flank; default all in use"),
    Argument(
        "--ball",
        metavar="MM",
        type=non_negative,
        default=0.0,
        help="radius of the measuring ball: also list its centres, and check that it fits",
    ),
    Argument(
        "--tolerance",
        metavar="MM",
        type=positive,
        help="also list the deviations allowed: plus and minus half of this profile tolerance",
    ),
    Argument("--lift", metavar="FILE", type=_csv, help=f"lift curve to write as well ({CSV})"),
    *output_options(
        f"file to write ({CSV}); of several flanks one each, with -inner, -outer, -return", (CSV,)
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """List the points, and write them."""
    if arguments.step is not None and arguments.spacing is not None:
        raise CallError("--step and --spacing are both given; only one of them is allowed")
    check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
    require_same_folder("--lift", arguments.lift, arguments.output)
    answer = probe(
        opened(arguments),
        arguments.flank,
        step=arguments.step,
        spacing=arguments.spacing,
        ball=arguments.ball,
        tolerance=arguments.tolerance,
    )
    files = list(_points(answer, arguments.output))
    if arguments.lift is not None:
        lift = lift_table(answer)
        report = f"lift curve, {counted(len(lift.values), 'row')}"
        files.append((Path(arguments.lift), lift.encoded(), report))
    if len({path for path, _, _ in files}) < len(files):
        raise CallError("--lift names the file of a flank")
    return show(answer, arguments, files)


def _points(answer: Probing, output: str | None) -> Iterator[Written]:
    """The table file of each flank; none without a name in `output`."""
    if output is None:
        return
    main = answer.flanks[0]
    for one in answer.flanks:
        name = Path(output)
        ending = one.disc.name.removeprefix(main.disc.name)
        if len(one.disc.cam.contact.flanks) > 1:
            ending += f"-{one.flank}"
        path = name.with_name(f"{name.stem}{ending}{name.suffix}")
        yield table_file(flank_table(answer, one), path)
