"""A disc: the body of a cam that turns in a plane, its curves and its real flanks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from camgeo.cam.contact import Contact, contact_of
from camgeo.curve.extremes import Extremes, curvature_extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.lazy import Ledger, lazy
from camgeo.numeric.checked import hold
from camgeo.outline.path import Flank
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.cam.drive import Drive
    from camgeo.mechanism.follower import Follower
    from camgeo.outline.outline import Outline
    from camgeo.outline.path import Path
    from camgeo.outline.replay_result import Replay


@dataclass(frozen=True)
class Disc(Pickled):
    """The curves of a disc, on demand; GeometryError if the mechanism is impossible.

    Attributes
    ----------
    drive : what moves the follower.
    follower : the one that touches the disc.
    rotation : sense in which the disc turns: +1 counter-clockwise, -1 clockwise.
    contact : the flank on which the follower runs; both for a groove.
    clearance : width of the groove minus the diameter of the roller [mm].
    """

    drive: Drive
    follower: Follower
    rotation: int = 1
    contact: Contact = Contact.INNER
    clearance: float = 0.0
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.follower.roller_radius + 0.5 * self.clearance

    def __post_init__(self) -> None:
        hold(self, contact=contact_of("follower.contact", self.contact))

    @lazy
    def pitch_curve(self) -> PitchCurve:
        """The pitch curve in cam coordinates; for a flat face the outline itself."""
        return PitchCurve(self.drive.motion, self.follower, self.rotation)

    @lazy
    def inner_curve(self) -> WorkingCurve:
        """The inner working curve."""
        return WorkingCurve(self.pitch_curve, -self.flank_distance)

    @lazy
    def outer_curve(self) -> WorkingCurve:
        """The outer working curve."""
        return WorkingCurve(self.pitch_curve, self.flank_distance)

    @property
    def flanks(self) -> tuple[tuple[str, WorkingCurve], ...]:
        """The working curves in use, with their names, the inner one first."""
        return tuple((flank, self.curve(flank)) for flank in self.contact.flanks)

    def curve(self, flank: Flank) -> WorkingCurve:
        """The working curve of a flank."""
        return {Flank.INNER: self.inner_curve, Flank.OUTER: self.outer_curve}[flank]

    @lazy
    def bends(self) -> Extremes:
        """The extremes of the pitch curve's curvature; GeometryError if it stands still somewhere.

        Guaranteed to include every extreme that could cause undercut on a flank in use.
        """
        bends = curvature_extremes(self.pitch_curve)
        if not self.follower.has_pitch_curve:
            return bends
        from camgeo.outline.cusps import sure_bends

        for _, flank in self.flanks:
            bends = sure_bends(flank, bends)
        return bends

    @lazy
    def inner_outline(self) -> Outline:
        """What remains of the inner flank, see `camgeo.outline.outline.real_outline`."""
        from camgeo.outline.outline import real_outline

        return real_outline(self.inner_curve, self.bends if self.follower.has_pitch_curve else None)

    @lazy
    def outer_outline(self) -> Outline:
        """What remains of the outer flank, see `camgeo.outline.outline.real_outline`."""
        from camgeo.outline.outline import real_outline

        return real_outline(self.outer_curve, self.bends)

    def outline(self, flank: str) -> Outline:
        """What remains of the "inner" or "outer" flank."""
        own: Outline = getattr(self, f"{Flank(flank)}_outline")
        return own

    def replay(self, flank: str) -> Replay:
        """The roller pressed against what remains of the "inner" or "outer" flank.

        In a groove with side clearance the roller is treated without play: lost stroke adds to the
        play.
        """
        from camgeo.outline.replay import replay_outline  # only needed with undercut

        path = self.outline(flank).path
        return self.ledger.run(
            f"replay of {flank} flank", lambda: replay_outline(self.pitch_curve, path)
        )

    @property
    def pitch_path(self) -> Path:
        """The pitch curve, with its corners where the velocity jumps."""
        from camgeo.outline.envelope import Envelope
        from camgeo.outline.path import Path

        return Path(Envelope(WorkingCurve(self.pitch_curve, 0.0)).elements)

    @property
    def untrimmed_paths(self) -> tuple[Path, Path]:
        """Inner and outer flank all round, with what undercut would cut off."""
        from camgeo.outline.envelope import Envelope
        from camgeo.outline.path import Path

        inner, outer = (Path(Envelope(self.curve(flank)).elements) for flank in Flank)
        return inner, outer

    @property
    def flank_paths(self) -> tuple[Path, Path]:
        """Inner and outer outline; the whole curve for the flank on which no roller runs."""
        from camgeo.outline.path import whole

        used = self.contact.flanks
        inner, outer = (
            self.outline(flank).path if flank in used else whole(self.curve(flank))
            for flank in Flank
        )
        return inner, outer
