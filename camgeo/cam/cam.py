"""A cam: a drive, a follower with its contact, and the body that moves the follower."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from camgeo.cam.contact import Contact, contact_of
from camgeo.cam.disc import Disc
from camgeo.lazy import Ledger, built
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.checked import hold
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.cam.breadth import Breadth, Yoke
    from camgeo.cam.drive import Drive
    from camgeo.mechanism.conjugate import Mount
    from camgeo.mechanism.follower import Follower
    from camgeo.units import LiftUnit


@dataclass(frozen=True)
class Cam(Pickled):
    """One disc with its drive and follower; a conjugate pair is two cams with one drive.

    Attributes
    ----------
    drive : gives the prescribed motion.
    follower : the one that touches the disc.
    rotation, contact, clearance : as for `Disc`.
    yoke : the other side of the follower on a cam of constant breadth; None if there is none.
    mount : how the roller is fixed to the main one of a conjugate pair; None for a main cam.
    """

    drive: Drive
    follower: Follower
    rotation: int = 1
    contact: Contact = Contact.INNER
    clearance: float = 0.0
    yoke: Yoke | None = None
    mount: Mount | None = None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def __post_init__(self) -> None:
        hold(self, contact=contact_of("follower.contact", self.contact))

    @built
    def disc(self) -> Disc:
        """The body."""
        return Disc(
            self.drive, self.follower, self.rotation, self.contact, self.clearance, self.ledger
        )

    @property
    def lift_unit(self) -> LiftUnit:
        """Unit of the follower's own motion."""
        return self.follower.lift_unit

    @property
    def distances(self) -> tuple[float, ...]:
        """d [mm] of each flank in use: negative for the inner one, positive for the outer one."""
        return tuple(self.contact.distances(self.disc.flank_distance).values())

    @built
    def breadth(self) -> Breadth | None:
        """Width of the disc between the two sides of its yoke; None if there is no yoke."""
        if self.yoke is None:
            return None
        from camgeo.cam.breadth import Breadth  # few followers are yokes

        return Breadth(self.drive.motion, self.follower.base_radius, self.follower.reach)

    @property
    def yoke_breadth(self) -> float:
        """Distance between the two sides of the yoke [mm], see `Yoke`; 0 without one."""
        if self.yoke is None or self.breadth is None:
            return 0.0
        return self.breadth.best if self.yoke.breadth is None else self.yoke.breadth

    @built
    def opposite(self) -> Cam | None:
        """The disc as the second side of the yoke touches it, a cam of the same drive; None without
        a yoke. Raises GeometryError as `Breadth.opposite`.
        """
        if self.breadth is None:
            return None
        second = self.breadth.opposite(self.follower)
        return replace(self, follower=second, ledger=self.ledger.named(" of the opposite side"))

    def sized(self, **sizes: complex) -> Cam:
        """The same cam with other dimensions of the follower; GeometryError if they are
        impossible.

        The drive is shared, so its linkage is not checked over the turn again.
        """
        changes: dict[str, Any] = dict(sizes)
        follower: Any = self.follower  # a frozen dataclass
        return replace(self, follower=replace(follower, **changes), ledger=Ledger())

    def moved(self, plan: MotionPlan) -> Cam:
        """The same cam with another motion plan."""
        ledger = Ledger()
        return replace(self, drive=replace(self.drive, plan=plan, ledger=ledger), ledger=ledger)
