"""What a writer gets to see of a design, and what a writer is.

Writers register as entry points of the group ``camgeo.writers``; the entry point's name is the
format's name on the command line and in the scene, and it loads an object that is a `Writer`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal, Protocol

from camgeo.cam.contact import Contact
from camgeo.check.finding import Finding
from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort, Fit
from camgeo.files.table import Table
from camgeo.formats.format import Format, Options, Values
from camgeo.lazy import Ledger
from camgeo.mechanism.linkage_protocol import Member
from camgeo.motion.joints import Joint
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import Part
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.moves import Toolpath
from camgeo.units import LengthUnit

if TYPE_CHECKING:  # few scenes name an effect
    from camgeo.effects.effect import Column
    from camgeo.mechanism.sketch import MechanismSketch

DWELL: Final = "dwell"
"""What a segment of the motion plan that is a rest is called."""


@dataclass(frozen=True, slots=True)
class FollowerSketch:
    """What a picture shows of the follower at cam angle 0.

    Attributes
    ----------
    kind : "guide" for a translating follower, "pivot" for an oscillating one.
    end : complex [mm], the pivot, or any point of the guide further out than the roller centre.
    face : complex [mm], the two ends of a flat face; None for a roller.
    """

    kind: Literal["guide", "pivot"]
    end: complex
    face: tuple[complex, complex] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlanSegment:
    """A segment of the motion plan, of any length but 0.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi].
    label : name of its motion law; "dwell", or "data" for a motion by data.
    course : (n, 2) cam angles [rad] and positions [unit of the plan] of a motion by data, which is
        asked for as a whole; None for the others.
    """

    start: float
    end: float
    label: str
    course: FloatArray | None = None

    @property
    def is_dwell(self) -> bool:
        """Whether it is a rest."""
        return self.label == DWELL


Demanded = Literal["follower"] | Member
"""Whose motion a scene demands: the follower's, or with a linkage that of its far end."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanSketch:
    """What a picture shows of the motion plan.

    Attributes
    ----------
    of : whose motion is planned: the follower's, or with a linkage that of its far end.
    unit : of the plan's positions.
    joints : of the plan, as many as segments: joint k is where segment k begins.
    breaks : the joints, and the places inside the laws at which a derivative may jump.
    segments : by ascending cam angle, without those of no length.
    speed : of the disc [rad/s], positive; None if there is none or it varies.
    """

    of: Demanded
    unit: Literal["mm", "rad"]
    joints: tuple[Joint, ...]
    breaks: tuple[Joint, ...]
    segments: tuple[PlanSegment, ...]
    speed: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CutOff:
    """What a picture shows of a flank where the disc has a corner.

    Attributes
    ----------
    flank : "inner" or "outer".
    start, end : cam angles [rad] of the flank at the corner, start in [0, 2 pi), end above it.
    course : (n,) complex [mm], the flank between them, which is not on the disc; it begins and ends
        in the corner.
    """

    flank: str
    start: float
    end: float
    course: ComplexArray

    @property
    def corner(self) -> complex:
        """The corner [mm]."""
        return complex(self.course[0])


class Product(Protocol):
    """A design as its writers see it; `camgeo.design.Design` is one."""

    @property
    def name(self) -> str:
        """Name of the scene; the stem of the files."""

    @property
    def unit(self) -> LengthUnit:
        """Unit of length of the scene; drawings, programs and tables are written in it."""

    @property
    def scene_hash(self) -> str:
        """SHA-256 of all that the scene says of files, hexadecimal."""

    @property
    def scene_files(self) -> dict[str, str]:
        """SHA-256 of the files that the scene reads, by their names."""

    @property
    def version(self) -> str:
        """Version of camgeo."""

    @property
    def discs(self) -> Sequence[Product]:
        """The discs, this one first; each has files of its own, named as it is."""

    @property
    def ledger(self) -> Ledger:
        """What was computed of it, and how long it took."""

    @property
    def effect_columns(self) -> tuple[Column, ...]:
        """The effects that the scene calls for, over the cam angle."""

    @property
    def effort(self) -> Effort:
        """How hard the fits of its contours try."""

    @property
    def options(self) -> Options:
        """What the scene says of the formats."""

    @property
    def values(self) -> Values:
        """The scene's values, by which it is seen in which formats it can be written."""

    @property
    def contact(self) -> Contact:
        """The flank on which the roller runs."""

    @property
    def part(self) -> Part: ...

    @property
    def base_radius(self) -> float:
        """Radius r_G of the base circle of the pitch curve [mm]."""

    @property
    def roller_radius(self) -> float:
        """Radius r_R of the roller [mm], 0 for a knife edge."""

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""

    @property
    def is_flat(self) -> bool:
        """Whether a flat face touches the cam, whose contact runs on the outline itself: there is
        no pitch curve beside it.
        """

    @property
    def rotation(self) -> int:
        """Sense in which the disc turns: +1 counter-clockwise, -1 clockwise."""

    @property
    def findings(self) -> tuple[Finding, ...]: ...

    @property
    def follower_sketch(self) -> FollowerSketch: ...

    @property
    def plan_sketch(self) -> PlanSketch: ...

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """The mechanism at the cam angle `phi` [rad], for a picture."""

    @property
    def far_angle(self) -> float:
        """The cam angle [rad] at which the demanded motion is farthest from its start."""

    @property
    def cut_off(self) -> tuple[CutOff, ...]:
        """Where the flanks in use are cut off; empty also if it cannot be told what is left."""

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the motion plan begin, from 0 upwards."""

    @property
    def lift_unit(self) -> Literal["mm", "rad"]:
        """Unit of `quantity("s", ...)`."""

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the pitch curve."""

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter path."""

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """What the milling program cuts, exactly."""

    def table(self) -> Table:
        """The value table, in the scene's unit and degrees."""

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at the cam angles `phi` (n,) [rad]."""

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad]: "s", "s1", "s2", "s3" (lift and derivatives, mm or rad
        per rad^k), "transmission_angle" [rad], "curvature" [1/mm].
        """


def disc_of(product: Product, stem: str) -> Product:
    """The disc of which a file named `stem` without its ending is: `product` or a further one.

    A name that ends as that of a further disc does is that of such a disc, whatever comes before.
    """
    if stem == product.name:
        return product
    marks = [(disc, disc.name.removeprefix(product.name)) for disc in product.discs[1:]]
    return next((disc for disc, mark in marks if stem.lower().endswith(mark)), product)


@dataclass(frozen=True, slots=True)
class Written:
    """A file's content and what its writer says of it.

    Attributes
    ----------
    data : the whole file.
    facts : what the certificate should name besides the deviation, e.g. {"arcs": 64}; numbers and
        short texts, in the order to be written.
    """

    data: bytes
    facts: dict[str, int | float | str] = field(default_factory=dict)


class Writer(Protocol):
    """One file format.

    Attributes
    ----------
    format : its declaration; the name is that of the entry point.

    A writer may have `companions` too, a tuple of writers: the format's further files, each with
    a suffix of its own.
    """

    @property
    def format(self) -> Format[Any]: ...

    def write(self, product: Product, tolerance: float) -> Written:
        """The file. `tolerance` [mm] bounds the distance of everything in it from the exact curve.

        Raises ToleranceError if that cannot be met.
        """

    def measure(self, product: Product, data: bytes) -> float | None:
        """Read `data` back and return the proved deviation [mm]; None for pictures."""
