"""What a design needs to be told: the shape of a scene, without the scene's file format."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from camgeo.cam.contact import Contact
from camgeo.check.limits import Limits
from camgeo.motion.plan import MotionPlan
from camgeo.part.spec import PartSpec
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.contour.fit import Effort
    from camgeo.formats.format import Options, Values
    from camgeo.mechanism.kinds import AnyFollower, RollerFollower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.mechanism.yoke import Yoke
    from camgeo.motion.time_course import SpeedCurve


class OutputRequest(Protocol):
    """What a scene says of its output, see `camgeo.scene.model.OutputSpec`."""

    @property
    def formats(self) -> tuple[str, ...]: ...

    @property
    def tolerance(self) -> float: ...

    @property
    def fit(self) -> Effort: ...

    @property
    def options(self) -> Options: ...

    @property
    def accuracy_ripple(self) -> bool: ...


class Source(Protocol):
    """Where a scene came from, see `camgeo.scene.model.SceneSource`."""

    @property
    def file(self) -> str: ...

    @property
    def sha256(self) -> str: ...

    @property
    def files(self) -> tuple[tuple[str, str], ...]: ...


class Specification(Protocol):
    """All that a design needs to be told; `camgeo.scene.model.Scene` is one."""

    @property
    def name(self) -> str: ...

    @property
    def unit(self) -> LengthUnit: ...

    @property
    def rotation(self) -> int: ...

    @property
    def speed(self) -> float | None: ...

    @property
    def speed_curve(self) -> SpeedCurve | None: ...

    @property
    def plan(self) -> MotionPlan: ...

    @property
    def follower(self) -> AnyFollower: ...

    @property
    def linkage(self) -> Linkage | None: ...

    @property
    def returning(self) -> RollerFollower | None: ...

    @property
    def yoke(self) -> Yoke | None: ...

    @property
    def contact(self) -> Contact: ...

    @property
    def side_clearance(self) -> float: ...

    @property
    def limits(self) -> Limits: ...

    @property
    def part(self) -> PartSpec | None: ...

    @property
    def effects(self) -> Mapping[str, Mapping[str, Any]]: ...

    @property
    def output(self) -> OutputRequest: ...

    @property
    def source(self) -> Source: ...

    @property
    def values(self) -> Values: ...
