"""A disc as it is made: a cam with its part and what the scene asks of its files."""

from __future__ import annotations

from dataclasses import dataclass, field
from decimal import Decimal
from typing import TYPE_CHECKING, Literal

import numpy as np

from camgeo._version import __version__
from camgeo.check.judge import RETURN, Judgement
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger, lazy
from camgeo.motion.motion import Jet, Side
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.spec import PartSpec
from camgeo.pickled import Pickled
from camgeo.units import MM_PER, LengthUnit

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.cam.cam import Cam
    from camgeo.cam.contact import Contact
    from camgeo.cam.drive import Demanded
    from camgeo.check.finding import Finding
    from camgeo.contour.contour import Contour
    from camgeo.contour.fit import Effort, Fit
    from camgeo.effects.effect import Column
    from camgeo.files.product import CutOff, FollowerSketch, PlanSketch
    from camgeo.files.table import Table
    from camgeo.formats.format import Options, Values
    from camgeo.mechanism.sketch import MechanismSketch
    from camgeo.motion.time_course import TimeCourse
    from camgeo.part.part import Part
    from camgeo.scene.scene import Scene
    from camgeo.toolpath.cut import Cut
    from camgeo.toolpath.moves import Toolpath

TOPOLOGY_TOLERANCE = 0.01
"""Contours by which it is seen that a bore fits are this exact [mm]; their deviation is counted."""


@dataclass(frozen=True)
class Workpiece(Pickled):
    """One disc as its files show it; a `camgeo.files.product.Product`.

    Attributes
    ----------
    scene : what is asked for.
    cam : the cam whose disc it is.
    judgement : what is found of it, and whether there is such a disc.
    returning : the return disc of a conjugate pair; None of one disc, and of the return disc.
    columns : gives the effects over the cam angle.
    ledger : where it is entered what was computed.
    """

    scene: Scene
    cam: Cam
    judgement: Judgement
    returning: Workpiece | None
    columns: Callable[[], tuple[Column, ...]]
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @property
    def name(self) -> str:
        """Name of the disc, the stem of its files."""
        return self.scene.name if self.is_main else f"{self.scene.name}-{RETURN}"

    @property
    def is_main(self) -> bool:
        """Whether it is no return disc of a conjugate pair."""
        return self.judgement.cams[0] is self.cam

    @property
    def unit(self) -> LengthUnit:
        """Unit of length of the scene and of drawings, programs and tables."""
        return self.scene.unit

    @property
    def millimetres(self) -> float:
        """Millimetres a unit of length of the scene."""
        return MM_PER[self.unit]

    @property
    def scene_hash(self) -> str:
        """SHA-256 of what the scene says of files, see `camgeo.scene.scene.Scene.made`."""
        return self.scene.made

    @property
    def scene_files(self) -> dict[str, str]:
        """SHA-256 of the files that the scene reads, hexadecimal, by their names."""
        return dict(self.scene.files)

    @property
    def version(self) -> str:
        """Version of camgeo."""
        return __version__

    @property
    def effort(self) -> Effort:
        """How hard the fits of its contours try."""
        return self.scene.output.fit

    @property
    def options(self) -> Options:
        """What the scene says of the formats."""
        return self.scene.output.options

    @property
    def values(self) -> Values:
        """The scene's values, by which it is seen in which formats it can be written."""
        return self.scene.stated

    @property
    def discs(self) -> tuple[Workpiece, ...]:
        """The disc, and behind it the return disc of a conjugate pair."""
        return (self,) if self.returning is None else (self, self.returning)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the checks find."""
        return self.judgement.findings

    @property
    def effect_columns(self) -> tuple[Column, ...]:
        """The effects over the cam angle; nothing of those that have no answer."""
        return self.columns()

    # The cam, as writers and tables ask for it -----------------------------------------------

    @property
    def contact(self) -> Contact:
        """The flank on which the roller runs."""
        return self.cam.contact

    @property
    def rotation(self) -> int:
        """Sense in which the disc turns: +1 counter-clockwise, -1 clockwise."""
        return self.cam.rotation

    @property
    def base_radius(self) -> float:
        """r_G, radius of the base circle of the pitch curve [mm]."""
        return self.cam.follower.base_radius

    @property
    def roller_radius(self) -> float:
        """r_R [mm]; 0 for a flat face."""
        return self.cam.follower.roller_radius

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.cam.disc.flank_distance

    @property
    def is_flat(self) -> bool:
        """Whether a flat face touches the cam, and no roller."""
        return self.cam.follower.is_flat

    @property
    def lift_unit(self) -> Literal["mm", "rad"]:
        """Unit of the follower's lift."""
        return self.cam.lift_unit

    @property
    def demanded_of(self) -> Demanded:
        """Whose motion the scene demands: the follower's, or that of a linkage's far end."""
        return self.cam.drive.demanded_of

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the motion plan begin, from 0 upwards."""
        return self.cam.drive.joints

    @property
    def far_angle(self) -> float:
        """The first cam angle [rad] at which the demanded motion is farthest from its start."""
        return self.cam.drive.far_angle

    @property
    def time_course(self) -> TimeCourse | None:
        """How the cam turns; None if the scene gives no speed."""
        return self.cam.drive.time_course

    def lift(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) the follower's lift and its derivatives [mm or rad per rad^k] at `phi` (n,)."""
        return self.cam.drive.motion.jet(np.atleast_1d(phi), side)

    def stroke(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) what the motion plan demands, of the far end of a linkage if there is one."""
        return self.cam.drive.plan.jet(np.atleast_1d(phi), side)

    def pitch(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the pitch curve at `phi` (n,) [rad]."""
        return _columns(self.cam.disc.pitch_curve.point(phi))

    def inner(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the inner working curve at `phi` (n,) [rad]."""
        return _columns(self.cam.disc.inner_curve.point(phi))

    def outer(self, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of the outer working curve at `phi` (n,) [rad]."""
        return _columns(self.cam.disc.outer_curve.point(phi))

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at `phi` (n,) [rad]."""
        return {"pitch": self.pitch, "inner": self.inner, "outer": self.outer}[what](phi)

    def curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1/mm] signed curvature of the pitch curve, positive where convex."""
        return self.cam.disc.pitch_curve.curvature(phi, side)

    def radius_of_curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [mm] signed r_K of the pitch curve; infinite exactly at an inflection.

        Prefer `curvature`, which has no poles.
        """
        kappa = self.curvature(phi, side)
        radius: FloatArray = np.full_like(kappa, np.inf)
        return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)

    def transmission_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: transmission angle mu."""
        return self.cam.disc.pitch_curve.transmission_angle(phi, side)

    def contact_place(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [mm] place of the contact along a flat face; `is_flat` tells that there is one."""
        from camgeo.outline.convex import touch

        curve = self.cam.disc.pitch_curve
        return np.asarray(touch(curve, np.atleast_1d(phi), side).contact[0])

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad], see `camgeo.files.product.Product`."""
        orders = {"s": 0, "s1": 1, "s2": 2, "s3": 3}
        if what in orders:
            lift: FloatArray = self.lift(phi)[orders[what]]
            return lift
        return {"transmission_angle": self.transmission_angle, "curvature": self.curvature}[what](
            phi
        )

    def table(self, step: Decimal | None = None) -> Table:
        """The value table at every `step` degrees (the scene's if None), in the scene's unit."""
        from camgeo.files.value_table import value_table
        from camgeo.formats.csv import FORMAT

        angles = step or self.options[FORMAT].step
        return self.ledger.run("table", lambda: value_table(self, angles))

    # What is drawn and milled ----------------------------------------------------------------

    @lazy
    def part(self) -> Part:
        """The part: its boundaries, thickness, bore; GeometryError if they do not fit together."""
        from camgeo.part.build import build_part

        spec = self.scene.part or PartSpec()
        self.judgement.require_outline(of_return=not self.is_main)
        paths = self.cam.disc.flank_paths
        return build_part(self.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""
        from camgeo.contour.arcs.fast import fit_arcs
        from camgeo.contour.arcs.fewest import fewest_arcs

        fit = fit_arcs if self.effort == "fast" else fewest_arcs
        return self.ledger.run(
            "arcs of pitch curve", lambda: fit(self.cam.disc.pitch_path, tolerance)
        )

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the pitch curve."""
        from camgeo.contour.proof.deviation import deviation

        return deviation(self.cam.disc.pitch_path, contour)

    @lazy
    def cuts(self) -> tuple[Cut, ...]:
        """What is milled, exactly; needs `[part]` and `[output.gcode]`."""
        from camgeo.formats.gcode import FORMAT
        from camgeo.toolpath.sequence import cuts_of

        if lacking := FORMAT.lacking(self.values):
            raise GeometryError(f"milling {'; '.join(lacking)}", key="output.gcode")
        spec = self.options[FORMAT]
        return cuts_of(self.part, spec.tool, spec.pass_depth)

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.formats.gcode import FORMAT
        from camgeo.toolpath.machine import load
        from camgeo.toolpath.plan import plan_toolpath

        cuts, spec = self.cuts, self.options[FORMAT]
        limits, height = load(spec.machine).arcs, spec.safe_height
        return self.ledger.run(
            "toolpath", lambda: plan_toolpath(cuts, height, limits, tolerance, self.effort)
        )

    # Pictures --------------------------------------------------------------------------------

    @property
    def follower_sketch(self) -> FollowerSketch:
        """Where the follower is held, for a picture."""
        from camgeo.files.product import FollowerSketch
        from camgeo.files.skeleton import face_ends

        return FollowerSketch(*self.cam.follower.held(face_ends(self.cam.disc.pitch_curve)))

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """The mechanism at the cam angle `phi` [rad], for a picture."""
        from camgeo.files.skeleton import skeleton

        other = None if self.returning is None else self.returning.cam.follower
        return skeleton(self.cam, other, phi)

    @property
    def cut_off(self) -> tuple[CutOff, ...]:
        """Where the flanks in use are cut off, for a picture."""
        from camgeo.files.sketch import cut_off_sketches

        found: list[CutOff] = []
        for name, curve in self.cam.disc.flanks:
            try:
                outline = self.cam.disc.outline(name)
            except GeometryError:  # which the findings tell
                continue
            found += cut_off_sketches(curve, outline, name)
        return tuple(found)

    @property
    def plan_sketch(self) -> PlanSketch:
        """The motion plan, for a picture."""
        from camgeo.files.sketch import plan_sketch

        drive = self.cam.drive
        return plan_sketch(
            drive.plan,
            of=drive.demanded_of,
            unit=drive.unit,
            speed=drive.speed if drive.speed_curve is None else None,
        )


def _columns(points: ComplexArray) -> FloatArray:
    return np.column_stack((points.real, points.imag))
