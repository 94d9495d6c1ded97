"""What a scene file says, converted to millimetres and radians: the input of a `Design`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from camgeo.cam.contact import Contact
from camgeo.check.limits import Limits
from camgeo.formats.format import Options
from camgeo.motion.plan import MotionPlan
from camgeo.part.spec import PartSpec
from camgeo.scene.document import Document
from camgeo.scene.sound import SoundValues
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.contour.fit import Effort
    from camgeo.mechanism.kinds import AnyFollower, RollerFollower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.mechanism.yoke import Yoke
    from camgeo.motion.time_course import SpeedCurve


@dataclass(frozen=True, slots=True)
class OutputSpec:
    """`[output]`: what is written, and how exactly.

    Attributes
    ----------
    formats : names of the writers, in the order of the scene.
    tolerance : largest deviation of any written contour from the exact curve [mm].
    fit : how hard fits try, see `camgeo.contour.fit.Effort`.
    options : of the formats, see `camgeo.formats.format.Options`.
    accuracy_ripple : whether what accuracy costs shows the ripple of the acceleration too.
    """

    formats: tuple[str, ...] = ("dxf",)
    tolerance: float = 0.001
    fit: Effort = "fewest"
    options: Options = field(default_factory=Options)
    accuracy_ripple: bool = False


@dataclass(frozen=True, slots=True)
class SceneSource:
    """Where a scene came from.

    Attributes
    ----------
    file : path as given, or empty for a scene that was not read from a file.
    sha256 : of the file's bytes without the tables of effects, hexadecimal, see
        `camgeo.scene.fingerprint`.
    files : names of the files that the scene reads, each with the SHA-256 of its bytes.
    """

    file: str = ""
    sha256: str = ""
    files: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Scene:
    """One scene; lengths in mm, angles in rad, unless said otherwise.

    Attributes
    ----------
    name : of the design, the stem of its files.
    unit : of length in the scene file; drawings, programs and tables are written in it.
    rotation : sense in which the disc turns, +1 counter-clockwise, -1 clockwise.
    speed : of the disc, positive [rad/s], the mean one if it varies; None if the scene gives none.
    speed_curve : how the speed varies over the turn; None if it does not.
    plan : the motion; of the far end of a linkage if there is one, else of the follower.
    follower : what touches the disc.
    linkage : between motion and follower; None if the motion is the follower's own.
    returning : the second roller, on the return disc of a conjugate pair; None if there is none.
    yoke : the other side of the follower on a cam of constant breadth; None if there is none.
    contact : the flank on which the roller runs.
    side_clearance : groove's width less the roller's diameter [mm]; 0 without groove.
    limits : what the design is held to.
    part : the disc as a body; None if the scene has no `[part]`.
    effects : what the scene says of each effect that it names, in its order, numbers in the units
        of `camgeo.effects.effect`.
    output : what is written.
    source : where the scene came from.
    values : what stands in the scene, key by key.
    """

    name: str
    unit: LengthUnit
    rotation: int
    speed: float | None
    plan: MotionPlan
    follower: AnyFollower
    linkage: Linkage | None = None
    returning: RollerFollower | None = None
    yoke: Yoke | None = None
    speed_curve: SpeedCurve | None = None
    contact: Contact = Contact.INNER
    side_clearance: float = 0.0
    limits: Limits = field(default_factory=Limits)
    part: PartSpec | None = None
    effects: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: MappingProxyType({}))
    output: OutputSpec = field(default_factory=OutputSpec)
    source: SceneSource = field(default_factory=SceneSource)
    values: SoundValues = field(
        default_factory=lambda: SoundValues(Document("", {}, {}, (), frozenset(), {})),
        compare=False,
        repr=False,
    )
