"""A design: the one place that knows how the quantities of a cam depend on each other.

Lazy: nothing is computed before it is asked for, and each quantity at most once. Stages that only
files need are imported only then, so that a check stays as quick as its sums.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from camgeo._version import __version__
from camgeo.check.closure import check_closure
from camgeo.check.curvature import check_radius_ratio, check_undercut
from camgeo.check.finding import Finding, Severity
from camgeo.check.follower import check_follower
from camgeo.check.limits import default_transmission_angle
from camgeo.check.linkage import check_linkage
from camgeo.check.motion import check_motion
from camgeo.check.speed import check_speed
from camgeo.check.standstill import check_standstill
from camgeo.check.transmission_angle import check_transmission_angle
from camgeo.curve.curvature import curvature_extremes
from camgeo.curve.extremes import Extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger, lazy
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Jet, Motion, Side
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import ComplexArray, FloatArray, merged
from camgeo.part.spec import Contact, PartSpec
from camgeo.specification import Specification
from camgeo.units import MM_PER, TURN, LengthUnit

if TYPE_CHECKING:
    import pathlib
    from collections.abc import Sequence

    from camgeo.check.breadth import Breadth
    from camgeo.check.cures import Cure
    from camgeo.contour.contour import Contour
    from camgeo.contour.fit import Effort, Fit
    from camgeo.effects.effect import Column
    from camgeo.effects.graph import Effects
    from camgeo.files.mechanism_sketch import MechanismSketch
    from camgeo.files.product import CutOff, Demanded, FollowerSketch, PlanSketch
    from camgeo.files.specs import DxfSpec
    from camgeo.files.table import Table
    from camgeo.files.write import Report
    from camgeo.mechanism.kinds import AnyFollower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.time_course import TimeCourse
    from camgeo.outline.outline import Outline
    from camgeo.outline.path import Path
    from camgeo.outline.replay_result import Replay
    from camgeo.part.part import Part
    from camgeo.toolpath.moves import Toolpath
    from camgeo.toolpath.paths import CutterPath
    from camgeo.toolpath.spec import GcodeSpec

TOPOLOGY_TOLERANCE = 0.01
"""Contours by which it is seen that a bore fits are this exact [mm]; their deviation is counted."""


WORST_FIRST = ("wrong", "fatal", "broken", "warning", "ok")
"""Order of the findings by their severity."""

UNDERCUT = ("cusp-", "undercut-", "global-undercut-")
"""How the names of findings begin that a cure can be looked for."""

NO_OUTLINE = ("wrong", "fatal")
"""Severities with which no outline is made."""


RETURN = "return"
"""What marks the return disc: its files are NAME-return, its findings begin with "return: "."""


@dataclass(frozen=True)
class Design:
    """A cam as a scene states it, and everything that follows from it, on demand.

    Cam angles are in radians, any number of turns, arrays (n,) or a single number; lengths in mm.
    Errors of the mechanism are raised as `GeometryError` when the quantity is asked for.
    """

    specification: Specification

    @property
    def name(self) -> str:
        """Name of the design, the stem of its files."""
        return self.specification.name

    @property
    def unit(self) -> LengthUnit:
        """Unit of length of the scene and of drawings, programs and tables."""
        return self.specification.unit

    @property
    def scene_hash(self) -> str:
        """SHA-256 of the scene file without its effects, see `camgeo.scene.fingerprint`."""
        return self.specification.source.sha256

    @property
    def scene_files(self) -> dict[str, str]:
        """SHA-256 of the files that the scene reads, hexadecimal, by their names."""
        return dict(self.specification.source.files)

    @property
    def version(self) -> str:
        """Version of camgeo."""
        return __version__

    @property
    def rotation(self) -> int:
        """Sense in which the disc turns: +1 counter-clockwise, -1 clockwise."""
        return self.specification.rotation

    @property
    def base_radius(self) -> float:
        """r_G, radius of the base circle of the pitch curve [mm]."""
        return self.specification.follower.base_radius

    @property
    def roller_radius(self) -> float:
        """r_R [mm]; 0 for a flat face."""
        return self.specification.follower.roller_radius

    @property
    def side_clearance(self) -> float:
        """Groove's width less the roller's diameter [mm]; 0 without groove."""
        return self.specification.side_clearance

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.roller_radius + 0.5 * self.side_clearance

    @property
    def is_flat(self) -> bool:
        """Whether a flat face touches the cam, and no roller."""
        return self.specification.follower.is_flat

    @property
    def effort(self) -> Effort:
        """How hard the fits of its contours try."""
        return self.specification.output.fit

    @property
    def dxf(self) -> DxfSpec:
        """How curves are drawn."""
        return self.specification.output.dxf

    @property
    def gcode(self) -> GcodeSpec | None:
        """Tool, feeds and machine."""
        return self.specification.output.gcode

    @cached_property
    def ledger(self) -> Ledger:
        """What was computed of this design, and how long it took."""
        return Ledger()

    # Curves -----------------------------------------------------------------------------------

    @lazy
    def motion(self) -> Motion:
        """The follower's own motion, behind the linkage if there is one [mm or rad]."""
        linkage = self.specification.linkage
        plan = self.specification.plan
        return plan if linkage is None else LinkedMotion(plan, linkage)

    @lazy
    def pitch_curve(self) -> PitchCurve:
        """The pitch curve in cam coordinates; of a flat face the outline itself."""
        return PitchCurve(self.motion, self.specification.follower, self.rotation)

    @lazy
    def inner_curve(self) -> WorkingCurve:
        """The inner working curve."""
        return WorkingCurve(self.pitch_curve, -self.flank_distance)

    @lazy
    def outer_curve(self) -> WorkingCurve:
        """The outer working curve."""
        return WorkingCurve(self.pitch_curve, self.flank_distance)

    @lazy
    def bends(self) -> Extremes:
        """The extremes of the pitch curve's curvature; GeometryError where it stands still.

        All of them that undercut on a flank in use could hide behind, surely.
        """
        from camgeo.outline.sure_bends import sure_bends

        bends = curvature_extremes(self.pitch_curve)
        if self.is_flat:  # whose own check leaves no undercut
            return bends
        for _, flank in self.flanks:
            bends = sure_bends(flank, bends)
        return bends

    @lazy
    def inner_outline(self) -> Outline:
        """What is left of the inner flank, see `camgeo.outline.outline.real_outline`."""
        from camgeo.outline.outline import real_outline

        bends = None if self.is_flat else self.bends
        return real_outline(self.inner_curve, bends)

    @lazy
    def outer_outline(self) -> Outline:
        """What is left of the outer flank, see `camgeo.outline.outline.real_outline`."""
        from camgeo.outline.outline import real_outline

        return real_outline(self.outer_curve, self.bends)

    def outline(self, flank: str) -> Outline:
        """What is left of the "inner" or "outer" flank."""
        return self.inner_outline if flank == "inner" else self.outer_outline

    def replay(self, flank: str) -> Replay:
        """The roller pressed against what is left of the "inner" or "outer" flank.

        In a groove with side clearance it is a roller without play: what it loses comes on top of
        the play.
        """
        from camgeo.outline.replay import replay_outline  # only what undercuts needs it

        path = self.outline(flank).path
        return self.ledger.run(
            f"replay of {flank} flank", lambda: replay_outline(self.pitch_curve, path)
        )

    @property
    def plan(self) -> MotionPlan:
        """The motion that the scene demands: that of the far end of a linkage, if there is one."""
        return self.specification.plan

    @property
    def linkage(self) -> Linkage | None:
        """Between the plan and the follower's own motion."""
        return self.specification.linkage

    @property
    def demand_unit(self) -> Literal["mm", "rad"]:
        """Unit of the motion that the scene demands."""
        linkage = self.linkage
        return self.lift_unit if linkage is None else linkage.unit

    @property
    def demanded_of(self) -> Demanded:
        """Whose motion the scene demands: the follower's, or that of a linkage's far end."""
        linkage = self.linkage
        return "follower" if linkage is None else linkage.member

    @property
    def follower(self) -> AnyFollower:
        """What touches the disc."""
        return self.specification.follower

    @cached_property
    def returning(self) -> Design | None:
        """The return disc of a conjugate pair, a design of its own; None if there is none.

        It has the motion, part, output and limits of this one, its own follower, and no effects.
        """
        follower = self.specification.returning
        if follower is None:
            return None
        spec = replace(  # type: ignore[type-var]
            self.specification,
            name=f"{self.name}-{RETURN}",
            follower=follower,
            returning=None,
            effects={},
        )
        return Design(spec)

    def pitch(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the pitch curve at `phi` (n,) [rad]."""
        return _columns(self.pitch_curve.point(phi))

    def inner(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the inner working curve at `phi` (n,) [rad]."""
        return _columns(self.inner_curve.point(phi))

    def outer(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the outer working curve at `phi` (n,) [rad]."""
        return _columns(self.outer_curve.point(phi))

    def lift(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) the follower's lift and its derivatives [mm or rad per rad^k] at `phi` (n,)."""
        return self.motion.jet(np.atleast_1d(phi), side)

    def stroke(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) what the motion plan demands, of the far end of a linkage if there is one."""
        return self.specification.plan.jet(np.atleast_1d(phi), side)

    def curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1/mm] signed curvature of the pitch curve, positive where convex."""
        return self.pitch_curve.curvature(phi, side)

    def radius_of_curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [mm] signed r_K of the pitch curve; infinite exactly at an inflection.

        Prefer `curvature`, which has no poles.
        """
        kappa = self.curvature(phi, side)
        radius: FloatArray = np.full_like(kappa, np.inf)
        return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)

    def transmission_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: transmission angle mu."""
        return self.pitch_curve.transmission_angle(phi, side)

    def contact_place(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [mm] place of the contact along a flat face; `is_flat` tells that there is one."""
        from camgeo.outline.convex import touch

        return np.asarray(touch(self.pitch_curve, np.atleast_1d(phi), side).contact[0])

    @property
    def _plan_unit(self) -> Literal["mm", "deg"]:
        """Unit in which positions of the plan are told."""
        return "mm" if self.demand_unit == "mm" else "deg"

    @lazy
    def time_course(self) -> TimeCourse | None:
        """How the cam turns; None if the scene gives no speed."""
        if self.specification.speed_curve is not None:
            return self.specification.speed_curve
        from camgeo.motion.time_course import ConstantSpeed

        speed = self.specification.speed
        return None if speed is None else ConstantSpeed(speed)

    def in_time(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(4, n) lift, velocity, acceleration, jerk [mm or rad per s^k] at `phi` (n,) [rad].

        Of the motion that the scene demands, before any linkage. Raises
        GeometryError if the scene gives no speed.
        """
        if self.time_course is None:
            raise GeometryError("needs [cam] speed or speed_curve", key="cam.speed")
        from camgeo.motion.time_course import in_time

        angles = np.atleast_1d(phi)
        return in_time(self.stroke(angles, side), self.time_course, angles)

    @lazy
    def smooth_angles(self) -> FloatArray:
        """(k,) cam angles [rad] from 0 to 2 pi, both included, ascending.

        Between two neighbours all derivatives of motion and time course are smooth, and the
        follower's velocity keeps its sign.
        """
        from camgeo.motion.extremes import turning_angles

        course = self.time_course
        edges = [self.motion.borders, turning_angles(self.motion), np.array([0.0, TURN])]
        if course is not None:
            edges.append(course.borders)
        return merged(np.concatenate(edges))

    # Effects ----------------------------------------------------------------------------------

    @cached_property
    def effects(self) -> Effects:
        """The effects that the scene calls for, each computed when it is asked for."""
        from camgeo.effects.graph import Effects  # few scenes name an effect
        from camgeo.effects.recalling import Recalling

        return Effects(Recalling(self), self.specification.effects, self.ledger)

    @property
    def effect_names(self) -> tuple[str, ...]:
        """The effects that the scene calls for."""
        return tuple(self.specification.effects)

    def effect(self, name: str) -> Any:
        """The result of the effect `name`, see `camgeo.effects.effect.Result`.

        Raises KeyError if there is no such effect, GeometryError with the scene's key if its data
        are missing, EffectError if it has no answer for this design.
        """
        return self.effects.result(name)

    @property
    def effect_findings(self) -> tuple[Finding, ...]:
        """What the effects find that the scene calls for, in the order of the scene.

        What keeps several of them from an answer is told once.
        """
        found = [each for name in self.effect_names for each in self.effects.findings(name)]
        return tuple(dict.fromkeys(found))

    @property
    def effect_columns(self) -> tuple[Column, ...]:
        """The effects over the cam angle; nothing of those that have no answer."""
        from camgeo.errors import EffectError

        found: list[Column] = []
        for name in self.effect_names:
            try:
                found += self.effect(name).columns
            except EffectError:  # which the findings tell
                continue
        return tuple(found)

    # Checks -----------------------------------------------------------------------------------

    @property
    def contact(self) -> Contact:
        """The flank on which the roller runs."""
        return self.specification.contact

    @lazy
    def flanks(self) -> tuple[tuple[str, WorkingCurve], ...]:
        """The working curves in use, with their names."""
        flanks = (("inner", self.inner_curve), ("outer", self.outer_curve))
        return tuple(flank for flank in flanks if self.contact in (flank[0], "groove"))

    @lazy
    def transmission_angle_limit(self) -> float:
        """Smallest transmission angle that is allowed [rad], the scene's or the sources'."""
        limit = self.specification.limits.transmission_angle
        if limit is not None:
            return limit
        spec = self.specification
        return default_transmission_angle(translating=not spec.follower.rocks, speed=spec.speed)

    @lazy
    def findings(self) -> tuple[Finding, ...]:
        """What the checks find, the good with the bad, worst first.

        Of a conjugate pair also what they find of the return disc, and of both together.
        """
        found = [*self.disc_findings, *self._pair_findings(), *self._yoke_findings()]
        found += check_motion(self.specification.plan, self._plan_unit)
        found += check_speed(self.specification.plan, self.time_course, self._plan_unit)
        return tuple(sorted(found, key=lambda finding: WORST_FIRST.index(finding.severity)))

    @cached_property
    def disc_findings(self) -> tuple[Finding, ...]:
        """What the checks find of the mechanism and of the disc, without the motion."""
        found: list[Finding] = []
        follower = self.specification.follower
        inner = self.contact != "outer"
        found += check_follower(follower, runs_on_inner=inner, clearance=self.side_clearance)
        regular = True
        if isinstance(self.motion, LinkedMotion):
            of_linkage = check_linkage(self.motion)
            found += of_linkage
            regular = not _fatal(of_linkage)
        if regular and follower.is_flat:
            found += self._flat_findings()
        elif regular:
            stands = check_standstill(self.pitch_curve)
            found += stands
            regular = not stands
        if regular and not follower.is_flat:
            found.append(check_transmission_angle(self.pitch_curve, self.transmission_angle_limit))
            ratio = self.specification.limits.radius_ratio
            mechanism = not any(finding.severity == "wrong" for finding in found)
            for name, flank in self.flanks:
                found.append(check_radius_ratio(flank, name, self.bends, ratio, self.roller_radius))
                found += check_undercut(flank, name, self.bends, self._severity)
                found += self._outline_findings(name, flank) if mechanism else ()
            if self.side_clearance > 0.0:
                from camgeo.check.side_clearance import check_side_clearance  # few grooves have it

                found.append(check_side_clearance(self.pitch_curve, self.side_clearance))
            found += check_closure(self.pitch_curve, self._severity)
        return tuple(found)

    def _pair_findings(self) -> list[Finding]:
        """What the checks find of the return disc and of both discs together; nothing of one."""
        other = self.returning
        if other is None:
            return []
        from camgeo.check.conjugate import check_pair  # few cams are pairs

        # The linkage, which both discs share, is told once.
        shared = check_linkage(self.motion) if isinstance(self.motion, LinkedMotion) else ()
        found = [
            replace(each, name=f"{RETURN}: {each.name}", sentence=f"{RETURN} disc: {each.sentence}")
            for each in other.disc_findings
            if each not in shared
        ]
        limits, tolerance = self.specification.limits, self.specification.output.tolerance
        if _fatal(shared):
            return found
        try:
            pair = check_pair(self.pitch_curve, other.pitch_curve, tolerance, limits.closing_error)
        except GeometryError:  # a cusp, which the findings of its disc tell
            return found
        return [*found, *pair]

    @cached_property
    def breadth(self) -> Breadth | None:
        """How wide the cam is between the two sides of its yoke; None if there is no yoke."""
        follower = self.specification.follower
        if self.specification.yoke is None or follower.rocks:
            return None
        from camgeo.check.breadth import Breadth  # few followers are yokes

        return Breadth(self.motion, follower.base_radius, follower.reach)

    @property
    def has_yoke(self) -> bool:
        """Whether the follower has a second side beyond the cam axis, see `breadth`."""
        return self.specification.yoke is not None

    @property
    def yoke_breadth(self) -> float:
        """Distance of the two sides of the yoke [mm], see `camgeo.mechanism.yoke`; 0 without."""
        yoke, cam = self.specification.yoke, self.breadth
        if yoke is None or cam is None:
            return 0.0
        return cam.best if yoke.breadth is None else yoke.breadth

    def _yoke_findings(self) -> list[Finding]:
        """Whether both sides of a yoke touch all through the turn; nothing without one."""
        if self.breadth is None:
            return []
        from camgeo.check.breadth import check_breadth

        limit = self.specification.limits.closing_error
        return [check_breadth(self.breadth, self.yoke_breadth, limit)]

    def _flat_findings(self) -> list[Finding]:
        """Whether there is a cam for a flat face, and how the face is used."""
        from camgeo.check.convexity import check_convexity  # few cams have a flat face
        from camgeo.check.face import check_face

        found = [*check_convexity(self.pitch_curve)]
        if not _fatal(found):
            found.append(check_transmission_angle(self.pitch_curve, self.transmission_angle_limit))
            found += check_face(self.pitch_curve)
            found += check_closure(self.pitch_curve)
        return found

    @property
    def _severity(self) -> Severity:
        """Of a disc that undercuts: whether it is made all the same."""
        return "broken" if self.specification.limits.undercut == "trim" else "fatal"

    def _outline_findings(self, name: str, flank: WorkingCurve) -> list[Finding]:
        """What is left of a flank, and what the follower does on it."""
        from camgeo.check.outline import check_lost_stroke, check_outline, no_outline
        from camgeo.outline.cusps import undercut_ranges

        try:
            outline = self.outline(name)
            replay = self.replay(name) if outline.is_trimmed else None
        except GeometryError as error:
            return [no_outline(name, error.message)]
        ranges = undercut_ranges(flank, self.bends)
        kinks = [pivot.after for pivot in self._pitch_path.pivots]
        found = [*check_outline(outline, name, ranges, self._severity, kinks)]
        if replay is not None:
            found.append(check_lost_stroke(replay, name, self.lift_unit, self._severity))
        return found

    @lazy
    def cures(self) -> tuple[Cure, ...]:
        """What would cure the undercut, one for each knob, the cheapest first; empty without any.

        Raises GeometryError if it cannot be decided whether the flanks cross.
        """
        if not any(f.name.startswith(UNDERCUT) and f.severity != "ok" for f in self.findings):
            return ()
        from camgeo.check.cures import Cam, cures  # a search, and few cams need one
        from camgeo.mechanism.kinds import require_roller

        spec = self.specification
        return cures(
            Cam(
                spec.plan,
                spec.linkage,
                require_roller(spec.follower),
                spec.rotation,
                spec.contact,
                spec.side_clearance,
            )
        )

    @property
    def has_outline(self) -> bool:
        """False if a finding says that there is no such disc."""
        return not _fatal(self.findings)

    # Files ------------------------------------------------------------------------------------

    @property
    def part_spec(self) -> PartSpec | None:
        """What the scene says of the part."""
        return self.specification.part

    @lazy
    def part(self) -> Part:
        """The part: its boundaries, thickness, bore; GeometryError if they do not fit together."""
        from camgeo.part.build import build_part

        spec = self.specification.part or PartSpec()
        self._require_outline()
        paths = self.flank_paths
        return build_part(self.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    @property
    def flank_paths(self) -> tuple[Path, Path]:
        """Inner and outer outline; the whole curve for the flank on which no roller runs."""
        from camgeo.outline.path import whole

        used = [name for name, _ in self.flanks]
        inner, outer = (
            self.outline(name).path if name in used else whole(curve)
            for name, curve in (("inner", self.inner_curve), ("outer", self.outer_curve))
        )
        return inner, outer

    @property
    def _pitch_path(self) -> Path:
        """The pitch curve, with its corners where the velocity jumps."""
        from camgeo.outline.envelope import Envelope
        from camgeo.outline.path import Path

        return Path(Envelope(WorkingCurve(self.pitch_curve, 0.0)).elements)

    def _require_outline(self, *, of_return: bool = False) -> None:
        """Raise UndercutError if there is no such disc, or with `of_return` no return disc."""
        from camgeo.errors import UndercutError

        forbidding = [
            finding.sentence
            for finding in self.findings
            if finding.severity in NO_OUTLINE
            and (of_return or not finding.name.startswith(f"{RETURN}: "))
        ]
        if forbidding:
            raise UndercutError("; ".join(forbidding))

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""
        from camgeo.contour.arcs.fast import fit_arcs
        from camgeo.contour.arcs.fewest import fewest_arcs

        fit = fit_arcs if self.effort == "fast" else fewest_arcs
        return self.ledger.run("arcs of pitch curve", lambda: fit(self._pitch_path, tolerance))

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the pitch curve."""
        from camgeo.contour.proof.deviation import deviation

        return deviation(self._pitch_path, contour)

    @lazy
    def cutter_paths(self) -> tuple[CutterPath, ...]:
        """The exact cutter paths of all operations; needs `[part]` and `[output.gcode]`."""
        from camgeo.toolpath.paths import cutter_paths

        spec = self.specification.part
        if self.gcode is None or spec is None:
            raise GeometryError("milling needs [part] and [output.gcode]", key="output.gcode")
        radius = self.gcode.tool_diameter / 2.0
        return cutter_paths(self.contact, *self.flank_paths, self.part, spec, radius)

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.toolpath.plan import plan_toolpath

        paths, spec = self.cutter_paths, self.gcode
        assert spec is not None  # cutter_paths raises without it
        return self.ledger.run(
            "toolpath", lambda: plan_toolpath(paths, spec, tolerance, self.effort)
        )

    def toolpath_deviation(self, operation: str, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the cutter path of `operation`.

        Raises KeyError if there is no such operation.
        """
        from camgeo.contour.exact import distance_between
        from camgeo.contour.proof.deviation import deviation

        path = {path.name: path for path in self.cutter_paths}[operation]
        if path.path is not None:
            return deviation(path.path, contour)
        assert path.circle is not None  # a path is one or the other
        return distance_between(path.circle, contour)

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at `phi` (n,) [rad]."""
        return {"pitch": self.pitch, "inner": self.inner, "outer": self.outer}[what](phi)

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad], see `camgeo.files.product.Product`."""
        orders = {"s": 0, "s1": 1, "s2": 2, "s3": 3}
        if what in orders:
            lift: FloatArray = self.lift(phi)[orders[what]]
            return lift
        return {"transmission_angle": self.transmission_angle, "curvature": self.curvature}[what](
            phi
        )

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the motion plan begin, from 0 upwards."""
        return tuple(
            math.radians(float(angle)) for angle in self.specification.plan.joints_deg[:-1]
        )

    @property
    def lift_unit(self) -> Literal["mm", "rad"]:
        """Unit of the follower's lift."""
        return "rad" if self.specification.follower.rocks else "mm"

    @property
    def follower_sketch(self) -> FollowerSketch:
        """Where the follower is held, for a picture."""
        from camgeo.files.product import FollowerSketch

        follower = self.specification.follower
        if follower.is_flat:
            from camgeo.files.sketch import flat_sketch  # few cams have a flat face

            return flat_sketch(self.pitch_curve)
        if isinstance(follower, OscillatingRoller):
            return FollowerSketch("pivot", follower.pivot)
        assert isinstance(follower, TranslatingRoller)  # the other roller there is
        out = complex(math.cos(follower.guide_angle), math.sin(follower.guide_angle))
        foot = -1j * out * follower.offset
        return FollowerSketch(
            "guide", foot + out * (follower.start_height + 2.0 * self.base_radius)
        )

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """The mechanism at the cam angle `phi` [rad], for a picture."""
        from camgeo.files.skeleton import skeleton

        return skeleton(self, phi)

    @property
    def far_angle(self) -> float:
        """The first cam angle [rad] at which the demanded motion is farthest from its start."""
        from camgeo.motion.extremes import turning_angles

        plan = self.specification.plan
        angles = merged(np.concatenate((plan.borders, turning_angles(plan))))
        return float(angles[np.argmax(np.abs(plan.jet(angles)[0]))]) if len(angles) else 0.0

    @property
    def cut_off(self) -> tuple[CutOff, ...]:
        """Where the flanks in use are cut off, for a picture."""
        from camgeo.files.sketch import cut_off_sketches

        found: list[CutOff] = []
        for name, curve in self.flanks:
            try:
                outline = self.outline(name)
            except GeometryError:  # which the findings tell
                continue
            found += cut_off_sketches(curve, outline, name)
        return tuple(found)

    @property
    def plan_sketch(self) -> PlanSketch:
        """The motion plan, for a picture."""
        from camgeo.files.sketch import plan_sketch

        spec = self.specification
        return plan_sketch(
            spec.plan,
            of=self.demanded_of,
            unit=self.demand_unit,
            speed=spec.speed if spec.speed_curve is None else None,
        )

    def table(self, step: Decimal | None = None) -> Table:
        """The value table at every `step` degrees (the scene's if None), in the scene's unit."""
        from camgeo.files.value_table import value_table

        angles = step or self.specification.output.table_step
        return self.ledger.run("table", lambda: value_table(self, angles))

    @property
    def has_linkage(self) -> bool:
        """True if the motion plan is that of the far end of a linkage."""
        return self.specification.linkage is not None

    @property
    def millimetres(self) -> float:
        """Millimetres a unit of length of the scene."""
        return MM_PER[self.unit]

    def write(
        self,
        folder: str | pathlib.Path,
        formats: Sequence[str] | None = None,
        *,
        tolerance: float | None = None,
        force: bool = False,
    ) -> Report:
        """Write the files and their certificate into `folder`, all of them or none.

        Of a conjugate pair those of both discs.

        Parameters
        ----------
        folder : made if it does not exist.
        formats : names of writers, or None for those of the scene.
        tolerance : largest deviation [mm] of any contour from the exact curve, or None for the
            scene's.
        force : write over files that exist and differ.

        Raises
        ------
        UndercutError
            If the cam has no outline, or its return disc none.
        ToleranceError
            If the tolerance cannot be reached.
        OutputError
            If a file cannot be written; nothing is left behind.
        """
        from camgeo.files.write import write_files

        if self.returning is not None:  # files of both discs or of none
            self._require_outline(of_return=True)
        output = self.specification.output
        return write_files(
            self,
            folder,
            tuple(formats or output.formats),
            output.tolerance if tolerance is None else tolerance,
            force=force,
        )


def _columns(points: ComplexArray) -> FloatArray:
    return np.column_stack((points.real, points.imag))


def _fatal(found: Sequence[Finding]) -> bool:
    return any(finding.severity in NO_OUTLINE for finding in found)
