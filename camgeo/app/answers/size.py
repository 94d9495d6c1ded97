"""Answer of `camgeo size`: the smallest base circle, and the scene with it."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import ROUND_HALF_EVEN, Decimal
from pathlib import Path
from typing import Any, Final, Literal

from camgeo.app.answers.answer import BROKEN, FINE, SCENE, Answer, Key, Keys
from camgeo.app.cli.command import (
    SCENE_FILE,
    Argument,
    CallError,
    Written,
    notify,
    notify_main_disc,
    number,
    opened,
    picture_options,
    require_same_folder,
    show,
)
from camgeo.cam.cam import Cam
from camgeo.check.disc import transmission_angle_limit
from camgeo.check.finding import Finding
from camgeo.check.judge import motion_findings
from camgeo.check.sizing.face import FaceTask
from camgeo.check.sizing.rounding import RoundedMechanism, decimal_exponent, rated, sized
from camgeo.check.sizing.smallest import ARM_SIDES, Active, Rating, Sizing
from camgeo.check.sizing.task import Placing, RollerTask
from camgeo.design.design import Design
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.pictures.model import Figure
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, LengthUnit

BAD: Final = ("broken", "no-disc", "invalid")
"""Severities of findings that make a design unusable."""


@dataclass(frozen=True, slots=True)
class Side:
    """A rocker's arm on one side of the line pivot -> cam axis; or a guide.

    Attributes
    ----------
    task : the sizing task; its follower has the arm that was chosen, if an arm was to be chosen.
    sizing : the requirement, and the smallest cams that meet it.
    unit : of length in the scene.
    rounded : the mechanism with its sizes rounded up, as they are written; None if there is none.
    """

    task: Placing
    sizing: Sizing
    unit: LengthUnit
    rounded: RoundedMechanism | None = None

    @property
    def written(self) -> Rating | None:
        """The angles and ratios of the rounded sizes; None if there are none."""
        return None if self.rounded is None else rated(self.rounded.cam)

    @property
    def arm_side(self) -> str | None:
        """Side of the arm, as in scenes; None on a guide."""
        side = self.task.arm_side
        return None if side is None else ARM_SIDES[side]

    @property
    def base_radius(self) -> float:
        """The smallest base radius [mm]; infinite if there is none."""
        answer = self.sizing.answer
        return math.inf if answer is None else answer.base_radius

    @property
    def infeasible(self) -> str | None:
        """Why there is no such cam, and what can be achieved instead; None if there is one."""
        if self.sizing.answer is not None:
            return None
        if self.sizing.hopeless is not None:
            return f"infeasible at any size: {self.sizing.hopeless}"
        if self.sizing.radius is None:
            return self._roller_infeasibility(self.sizing)
        return (
            "infeasible: with its pivot there, no base radius gives a convex cam that goes round"
            " its axis and keeps the transmission angle over the whole turn; move the pivot, or"
            " make follower.face_offset smaller"
        )

    def _roller_infeasibility(self, sizing: Sizing) -> str:
        if sizing.nearest_angle is not None:
            nearest = math.degrees(sizing.nearest_angle)
            return (
                f"infeasible: no place of the cam axis keeps a transmission angle of"
                f" {math.degrees(sizing.angle):g} deg over the whole turn, because the swing is too"
                f" large; the largest that can be kept is {math.floor(nearest * 1e4) / 1e4:.4f} deg"
            )
        reach = sizing.reach or 0.0
        sure = "there is no place" if sizing.none_below > reach else "no place was found"
        message = (
            "infeasible: where the transmission angle is kept, the roller is too large for the"
            f" pitch curve; {sure} without undercut and with r_R/r_K at most {sizing.ratio:g} up to"
            f" a base radius of {reach / MM_PER[self.unit]:.4g} {self.unit}"
        )
        if sizing.nearest_ratio is None:
            return message
        return f"{message}; the smallest ratio found is about {sizing.nearest_ratio:.3g}"


@dataclass(frozen=True, slots=True)
class Proof:
    """What is proved about smaller cams, on either side of the arm.

    Attributes
    ----------
    exact : whether the smallest base radius is exact, to rounding.
    none_below : no base radius below this [mm] keeps the requirements; infinite if none does.
    """

    exact: bool
    none_below: float


@dataclass(frozen=True, slots=True)
class CamSize(Answer):
    """The smallest cam that meets the requirements, and the present one.

    Attributes
    ----------
    scene : of the present design.
    sides : the present side of the arm first; for a rocker the other one too.
    present : the present design; None if there is no such mechanism.
    remarks : findings of `camgeo check` on the scene with these sizes that make it unusable, except
        those on its motion: they do not depend on these sizes, or concern a return disc.
    """

    scene: Scene
    sides: tuple[Side, ...]
    present: Rating | None
    remarks: tuple[Finding, ...] = ()

    @property
    def best(self) -> Side:
        """The side with the smallest base circle; if neither has one, that with the larger angle;
        the present side if both are equal.
        """
        # A side without a nearest angle keeps the required one: it counts as the largest.
        return min(
            self.sides, key=lambda side: (side.base_radius, -(side.sizing.nearest_angle or math.pi))
        )

    @property
    def scene_side(self) -> Side:
        """The present side of the arm."""
        return self.sides[0]

    @property
    def longer_face(self) -> tuple[float, float] | None:
        """The ends of the face [mm] that the written sizes need; None if it is long enough."""
        if self.best.rounded is None or "face" not in self.best.rounded.lengths:
            return None
        follower: Any = self.best.rounded.cam.follower
        ends: tuple[float, float] = follower.face
        return ends

    @property
    def proof(self) -> Proof:
        """What is proved about smaller cams."""
        below = min(side.sizing.none_below for side in self.sides)
        limit = self.best.base_radius
        return Proof(self.best.sizing.exact and below >= limit, min(below, limit))

    @property
    def exit_code(self) -> int:
        """1 if nothing meets the requirement, or nothing that can be written down."""
        return FINE if self.best.rounded is not None else BROKEN

    @property
    def edits(self) -> dict[str, Any]:
        """The values by key that give the scene the rounded sizes; empty if there are none.

        If the arm changes sides, the same linkage moves the rocker the other way, so the direction
        is reversed. A yoke becomes wider or narrower by as much as both of its sides move. A return
        disc on a carriage stays as it is, because its roller does; a return arm stays on its side
        of the main arm.
        """
        scene, rounded = self.scene, self.best.rounded
        if rounded is None:
            return {}
        edits: dict[str, Any] = {f"follower.{key}": value for key, value in rounded.lengths.items()}
        present = scene.follower
        assert present is not None  # it was sized
        side, was = (
            getattr(follower, "arm_side", None) for follower in (rounded.cam.follower, present)
        )
        if side is not None and side != was:
            edits["follower.arm_side"] = ARM_SIDES[side]
            if scene.linkage is not None and scene.stated.has("follower", "direction"):
                edits["follower.direction"] = OTHER_WAY[scene.stated.get("follower", "direction")]
            # The angle from the main arm keeps its size, and is counted the other way.
            turned = scene.stated.exact("follower", "return", "arm_angle")
            if turned is not None:
                edits["follower.return.arm_angle"] = -float(turned)
        breadth = scene.stated.exact("follower", "yoke", "breadth")
        if breadth is not None:
            old = scene.stated.exact("follower", "base_radius") or Decimal(0)
            # In decimals, as the scene states them: binary fractions would add digits.
            wider = 2 * (Decimal(repr(rounded.lengths["base_radius"])) - old)
            edits["follower.yoke.breadth"] = float(breadth + wider)
        if scene.stated.has("follower", "return", "spacing"):
            edits |= _return_roller(scene, rounded.cam)
        return edits


def size(
    design: Design,
    *,
    transmission_angle: float | None = None,
    radius_ratio: float | None = None,
    radius_of_curvature: float = 0.0,
    arms: tuple[float, float] | None = None,
) -> CamSize:
    """Look for the smallest base circle, on both sides of a rocker.

    Parameters
    ----------
    transmission_angle : smallest allowed [rad]; None for the limit of the scene.
    radius_ratio : largest allowed r_R/r_K; None for the limit of the scene.
    radius_of_curvature : smallest allowed for the outline under a flat face [mm].
    arms : shortest and longest arm of a rocker [mm], to choose its arm too; None to keep it.

    Raises
    ------
    GeometryError
        As `camgeo.check.sizing.rounding.sized`.
    """
    limits, cam = design.scene.limits, design.cam
    angle = transmission_angle
    if angle is None:
        angle = transmission_angle_limit(cam, limits)
    ratio = limits.radius_ratio if radius_ratio is None else radius_ratio
    unit = design.scene.unit
    sizings = sized(cam, angle, ratio, radius_of_curvature, arms, MM_PER[unit])
    present = getattr(design.scene.follower, "arm", None)
    sides = tuple(
        Side(
            task,
            sizing,
            unit,
            RoundedMechanism.from_sizing(task, sizing, ratio, present, MM_PER[unit]),
        )
        for task, sizing in sizings
    )
    answer = CamSize(design.scene, sides, rated(cam))
    return replace(answer, remarks=_remarks(answer)) if answer.edits else answer


def _remarks(answer: CamSize) -> tuple[Finding, ...]:
    """Findings on the scene with these sizes that make it unusable, except those on its motion."""
    try:
        design = Design(answer.scene.with_values(answer.edits))
    except SceneError:  # which is reported where it is written
        return ()
    others = motion_findings(design.drive)
    return tuple(e for e in design.findings if e.severity in BAD and e not in others)


def sized_scene(answer: CamSize) -> Scene:
    """The scene with the rounded sizes, which certainly meets the requirements.

    Raises
    ------
    GeometryError
        If there is no such scene.
    SceneError
        If the scene would not be valid with them.
    """
    if not answer.edits:
        raise GeometryError(
            "no scene is certain to meet the requirements: they are met only at the exact limit"
        )
    return answer.scene.with_values(answer.edits)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


RATING: Final[Keys] = {
    "base_radius_mm": "r_G.",
    "offset_mm": Key(
        "Signed distance of the roller's guide from the cam axis; 0 for an oscillating follower.",
        of="follower.offset",
        type=float,
    ),
    "arm_mm": Key(
        "Length of the arm of an oscillating follower.",
        of="follower.arm",
        type=float,
        optional=True,
    ),
    "pivot_mm": Key(
        "x, y of its pivot, from the cam axis.",
        of="follower.pivot",
        type=tuple[float, float],
        optional=True,
    ),
    "pivot_distance_mm": Key(
        "Distance of the pivot from the cam axis.",
        of="follower.centre_distance",
        type=float,
        optional=True,
    ),
    "arm_side": Key(
        "Side of the arm, or of the face, of an oscillating follower, as in scenes.", optional=True
    ),
    "transmission_angle": Key(
        "The smallest one.",
        {
            "smallest_deg": Key("Extreme value over the turn.", of="value"),
            "cam_angle_deg": Key("Cam angle of the value.", of="place"),
        },
    ),
    "radius_ratio": Key(
        "The largest r_R/r_K; 0 for a flat face.",
        {
            "largest": Key("Extreme value over the turn.", of="value"),
            "cam_angle_deg": Key("Cam angle of the value.", of="place"),
        },
    ),
    "radius_of_curvature": Key(
        "The smallest of the cam under a flat face.",
        {
            "smallest_mm": Key("Extreme value over the turn.", of="value"),
            "cam_angle_deg": Key("Cam angle of the value.", of="place"),
        },
        optional=True,
    ),
    "contact_mm": Key(
        "The ends of the range of contact along a flat face, measured as the face is.",
        of="contact",
        optional=True,
    ),
}

DOCUMENT: Final = Key(
    "The smallest base circle that keeps the required transmission angle and ratio of radii"
    " without undercut, and Flocke's proposal; for a flat face the smallest with a convex cam.",
    {
        "scene": SCENE,
        "required": Key(
            "The requirements.",
            {
                "transmission_angle_deg": Key("Least transmission angle.", of="angle"),
                "radius_ratio": Key(
                    "Largest r_R/r_K; 1 for a flat face, where it limits nothing.", of="ratio"
                ),
                "radius_of_curvature_mm": Key(
                    "Least radius of curvature of the cam under a flat face.",
                    of="radius",
                    optional=True,
                ),
            },
            of="best.sizing",
        ),
        "present": Key("The present design; null if there is no such mechanism.", RATING),
        "flocke": Key(
            "Flocke's proposal for the present side of the arm; null if its region is empty, and"
            " for a flat face.",
            RATING,
            of="scene_side.sizing.flocke",
        ),
        "transmission_angle_alone": Key(
            "The smallest on the present side that keeps the transmission angle; null if none does,"
            " and for a flat face.",
            RATING,
            of="scene_side.sizing.for_angle",
        ),
        "smallest": Key(
            "The limit: the smallest that keeps all requirements, on the better side of a rocker,"
            " to the last digits; null if none does.",
            RATING,
            of="best.sizing.answer",
        ),
        "written": Key(
            "The smallest cam with its sizes rounded up, as they are printed and written; null if"
            " there is none.",
            RATING,
            of="best.written",
        ),
        "proof": Key(
            "What is proved about smaller cams.",
            {
                "exact": "Whether the limit is exact, to rounding.",
                "none_below_mm": Key(
                    "It is proved that no base radius below this keeps all requirements; null if"
                    " none does at all.",
                    type=float | None,
                ),
            },
        ),
        "face_mm": Key(
            "The ends that a flat face needs for the written sizes, if that of the follower is too"
            " short.",
            of="longer_face",
            optional=True,
        ),
        "sides": Key(
            "Both sides of a rocker, that of the scene first; a guide has one.",
            {
                "arm_side": "Side of the arm, or of the face, as in scenes; null for a guide.",
                "smallest": Key("As `smallest` above, on this side.", RATING, of="sizing.answer"),
                "written": Key("As `written` above, on this side.", RATING),
                "infeasible": "Why there is none on this side, in words; null if there is one.",
            },
        ),
        "remarks": Key(
            "Findings of `camgeo check` on the scene with these sizes that make it unusable,"
            " except those on its motion: they do not depend on the sizes, or concern a return"
            " disc.",
            {
                "name": "Name of the check.",
                "severity": Key("What it means.", type=Literal["broken", "no-disc", "invalid"]),
                "sentence": "The finding in words.",
            },
        ),
        "active": Key(
            "The conditions that determine it.",
            {
                "condition": Key(
                    "The condition that is at its limit.",
                    of="name",
                    type=Literal[
                        "transmission-angle",
                        "radius-ratio",
                        "global-undercut",
                        "roller-over-axis",
                        "convexity",
                        "face-over-axis",
                    ],
                ),
                "cam_angle_deg": "Cam angle of the value.",
            },
            of="best.sizing.active",
        ),
        "infeasible": Key(
            "Why none keeps all requirements, in words; null if one does.", of="best.infeasible"
        ),
        "nearest": Key(
            "What can be achieved instead.",
            {
                "transmission_angle_deg": Key(
                    "The largest that can be achieved, if the required one cannot; otherwise null.",
                    of="nearest_angle",
                ),
                "radius_ratio": Key(
                    "The smallest that was found, if the required one was not; otherwise null.",
                    of="nearest_ratio",
                ),
            },
            of="best.sizing",
        ),
    },
    type=CamSize,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo size` in words and as a picture.


WIDTH = 28
"""Width of the first column."""

CELL = 15

VELOCITIES = "it assumes the largest velocities at both end positions"


def text(answer: CamSize) -> str:
    """The requirement, and one row per design; lengths in the scene's unit, angles in degrees."""
    best = answer.best
    sizing = best.sizing
    lines = [
        f"required: {_required(answer)}",
        f"{'':{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in _head(answer)),
        _row(answer, "present design", answer.present),
    ]
    if sizing.construction is not None:
        scene_sizing = answer.scene_side.sizing
        lines += [
            _row(answer, "Flocke", scene_sizing.flocke),
            _row(answer, "mu alone, exact", scene_sizing.for_angle),
        ]
    lines.append(_row(answer, "smallest", best.written))
    for side in answer.sides:
        if side is not best:
            is_scene_side = side is answer.scene_side
            name = f"smallest on {'its present' if is_scene_side else 'the other'} side"
            lines.append(_row(answer, name, side.written))
    return "\n".join(
        [
            *lines,
            *_changed(answer),
            answer.best.infeasible
            or "determined by "
            + " and ".join(_active(condition, sizing) for condition in sizing.active),
            *_proved(answer),
            *(
                f"camgeo check finds in that scene: {finding.sentence}"
                for finding in answer.remarks
            ),
            *_flocke_lines(answer.scene_side.sizing),
        ]
    )


def figure(answer: CamSize) -> Figure:
    """The region in which the cam axis may lie."""
    name = answer.scene.name
    from camgeo.pictures import size

    faces = [(e.task, e.sizing) for e in answer.sides if isinstance(e.task, FaceTask)]
    if faces:
        return size.face_figure(name, faces, answer.scene.unit)
    sides = [(e.task, e.sizing) for e in answer.sides if isinstance(e.task, RollerTask)]
    return size.figure(name, sides, answer.scene.unit)


def _required(answer: CamSize) -> str:
    sizing, unit = answer.best.sizing, answer.scene.unit
    angle = f"transmission angle at least {math.degrees(sizing.angle):g} deg"
    if sizing.radius is None:
        return f"{angle}, r_R/r_K at most {sizing.ratio:g}, no undercut"
    if sizing.radius == 0.0:
        return f"{angle}, a convex cam"
    radius = f"{sizing.radius / MM_PER[unit]:g} {unit}"
    return f"{angle}, a convex cam with radii of curvature of at least {radius}"


def _head(answer: CamSize) -> tuple[str, ...]:
    unit = answer.scene.unit
    last = "r_R/r_K" if answer.best.sizing.radius is None else f"rho [{unit}]"
    second = f"{answer.best.task.second} [{unit}]"
    return f"r_G [{unit}]", second, "mu [deg]", "at [deg]", last, "at [deg]"


def _row(answer: CamSize, name: str, rating: Rating | None) -> str:
    if rating is None:
        return f"{name:{WIDTH}}{'none':>{CELL}}"
    unit = MM_PER[answer.scene.unit]
    angle, last, per = rating.transmission_angle, rating.radius_ratio, 1.0
    if rating.radius_of_curvature is not None:
        last, per = rating.radius_of_curvature, unit
    digits = 4 if unit == 1.0 else 5
    cells = (
        f"{rating.base_radius / unit:.{digits}f}",
        f"{answer.best.task.second_length(rating.place) / unit + 0.0:.{digits}f}",
        f"{math.degrees(angle.value):.4f}",
        f"{math.degrees(angle.place):.3f}",
        f"{last.value / per:.4f}",
        f"{math.degrees(last.place):.3f}",
    )
    return f"{name:{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in cells)


def _changed(answer: CamSize) -> Iterator[str]:
    """What differs from the present design, besides the sizes in the rows."""
    best, scene_side = answer.best, answer.scene_side
    unit = answer.scene.unit
    if best is not scene_side and best.sizing.answer is not None:
        change = (
            f'the smallest has follower.arm_side = "{best.arm_side}", not "{scene_side.arm_side}"'
        )
        if answer.scene.linkage is not None:
            change += ", where the linkage moves the follower the other way, inward for outward"
        yield change
    arms = [
        getattr(follower, "arm", 0.0) for follower in (best.task.follower, answer.scene.follower)
    ]
    if arms[0] != arms[1]:
        length = f"{arms[0] / MM_PER[unit]:.4f} {unit}"
        yield f"all but the present design have an arm of {length}"
    written = best.written
    if written is not None and written.face is not None:
        low, high = (end.value / MM_PER[unit] for end in written.face)
        needed = f"the contact runs over the face from {low:.4f} to {high:.4f} {unit}"
        longer = best.rounded.lengths.get("face") if best.rounded is not None else None
        if longer is not None:
            needed += f", which needs follower.face = {longer}"
        yield needed


def _active(active: Active, sizing: Sizing) -> str:
    place = f"at cam angle {math.degrees(active.cam_angle):.4f} deg"
    what = {
        "transmission-angle": f"the transmission angle of {math.degrees(sizing.angle):g} deg",
        "radius-ratio": f"r_R/r_K of {sizing.ratio:g}",
        "global-undercut": "two sides of a flank that touch each other (global undercut)",
        "roller-over-axis": "the roller, which reaches the cam axis",
        "convexity": "the radius of curvature",
        "face-over-axis": "the face, which reaches the cam axis",
    }
    return f"{what[active.name]} {place}"


def _proved(answer: CamSize) -> list[str]:
    """What is proved about smaller cams."""
    side, proof = answer.best, answer.proof
    sizing, unit = side.sizing, MM_PER[side.unit]
    if sizing.answer is None:
        return []
    if side.rounded is None:
        return [
            "no sizes near this limit pass the checks when they are rounded up: none is written"
        ]
    limit = f"{sizing.answer.base_radius / unit:.9g} {side.unit}"
    if sizing.radius == 0.0 and any(condition.name == "convexity" for condition in sizing.active):
        blunt = "; its radius of curvature comes down to 0: --radius-of-curvature requires more"
    else:
        blunt = ""
    if proof.exact:
        return [f"the limit is {limit}, exactly: nothing smaller keeps all of this{blunt}"]
    # Rounded down, so that the printed bound is proved as well.
    below = math.floor(proof.none_below / unit * 1e4) / 1e4
    gap = sizing.answer.base_radius / unit - below
    known = f"nothing below {below:.4f} {side.unit} keeps all of this"
    bounds = f"so that the smallest is known within {gap:.2g} {side.unit}"
    return [f"the limit found is {limit}; it is proved that {known}, {bounds}"]


def _flocke_lines(sizing: Sizing) -> Iterator[str]:
    """How much larger than needed Flocke's proposal is, and where it breaks the radius ratio."""
    if sizing.construction is None:
        return
    if sizing.flocke is None:
        yield f"Flocke's region is empty: {VELOCITIES}"
        return
    if sizing.for_angle is not None:
        more = sizing.flocke.base_radius / sizing.for_angle.base_radius - 1.0
        yield (
            f"Flocke's base circle is {more:.0%} larger than the transmission angle needs:"
            f" {VELOCITIES}"
        )
    largest = sizing.flocke.radius_ratio
    if largest.value > sizing.ratio:
        yield (
            "Flocke's proposal is optimistic: it ignores curvature, and has r_R/r_K ="
            f" {largest.value:.4g} at cam angle {math.degrees(largest.place):.4f} deg, above"
            f" {sizing.ratio:g}"
        )


# -- writing --------------------------------------------------------------------------------------
# The scene with the sizes that were found, and what has to change with them.


OTHER_WAY: Final = {"outward": "inward", "inward": "outward"}


def _return_roller(scene: Scene, cam: Cam) -> dict[str, float]:
    """The edits that leave the return roller where it is, in the scene's unit."""
    main: Any = cam.follower
    other: Any = scene.returning
    unit = MM_PER[scene.unit]

    def near(length: float) -> float:
        # As many decimals as the rounded base radius has.
        last = Decimal(1).scaleb(decimal_exponent(main.base_radius, unit))
        return float(Decimal(length / unit).quantize(last, ROUND_HALF_EVEN)) + 0.0

    edits = {"follower.return.spacing": near(main.start_height + other.start_height)}
    if not scene.stated.has("follower", "return", "offset"):
        edits["follower.return.offset"] = near(-other.offset)
    return edits


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo size fixtures/scenes/setzhub.toml -o size.png\n"
    "  camgeo size my-cam.toml --transmission-angle 50 --scene my-smaller-cam.toml"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "--transmission-angle",
        metavar="DEG",
        type=number,
        help="smallest allowed, in degrees; default: the scene's",
    ),
    Argument(
        "--radius-ratio",
        metavar="RATIO",
        type=number,
        help="largest allowed r_R/r_K, above 0 to 1; default: the scene's",
    ),
    Argument(
        "--radius-of-curvature",
        metavar="LENGTH",
        type=number,
        default=0.0,
        help="smallest allowed for the cam of a flat face, in the scene's unit; default 0",
    ),
    Argument(
        "--arm",
        nargs=2,
        metavar=("LOW", "HIGH"),
        type=number,
        help="also choose the arm of a rocker, between two lengths in the scene's unit",
    ),
    Argument(
        "--scene",
        metavar="FILE",
        dest="target",
        help="write the scene with the answer's base_radius, offset or pivot, and arm_side",
    ),
    *picture_options(),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the answer; write picture and scene, both or none."""
    require_same_folder("--scene", arguments.target, arguments.output)
    if arguments.arm is not None and arguments.output is not None:
        raise CallError(
            "-o draws places for one arm: write the scene with --scene, and draw that one"
        )
    design = opened(arguments)
    notify_main_disc(design, "sizes")
    angle, arm, unit = arguments.transmission_angle, arguments.arm, MM_PER[design.scene.unit]
    answer = size(
        design,
        transmission_angle=None if angle is None else math.radians(angle),
        radius_ratio=arguments.radius_ratio,
        radius_of_curvature=unit * arguments.radius_of_curvature,
        arms=None if arm is None else (unit * arm[0], unit * arm[1]),
    )
    return show(answer, arguments, _scene_file(answer, arguments), "region of the cam axis")


def _scene_file(answer: CamSize, arguments: argparse.Namespace) -> list[Written]:
    """The file of the scene with the sizes, if it was requested and there is one."""
    if arguments.target is None:
        return []
    if answer.best.written is None:
        notify(f"{arguments.target}: not written, there is no such mechanism")
        return []
    unit, target, source = answer.scene.unit, Path(arguments.target), Path(arguments.scene)
    if answer.scene.files and target.resolve().parent != source.resolve().parent:
        raise SceneError(
            [Fault("--scene", str(target), "must be in the folder of SCENE, which names files")]
        )
    radius = f"base radius {answer.best.written.base_radius / MM_PER[unit]:.12g} {unit}"
    return [(target, sized_scene(answer).to_toml().encode(), radius)]
