"""A design as its effects see it, whose motion recalls what it was asked for last."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.motion.recalled import RecalledPlan

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.motion.motion import Motion


class Recalling:
    """The `subject`, with its motion and curves made from a `RecalledPlan`; the rest is its own.

    A return disc makes the motion of its `main` disc.
    """

    def __init__(self, subject: Subject, main: Recalling | None = None) -> None:
        self._subject = subject
        self._main = main

    @cached_property
    def plan(self) -> RecalledPlan:
        """See `Subject`."""
        return RecalledPlan(self._subject.plan.segments) if self._main is None else self._main.plan

    @cached_property
    def motion(self) -> Motion:
        """See `Subject`."""
        if self._main is not None:
            return self._main.motion
        linkage = self._subject.linkage
        return self.plan if linkage is None else LinkedMotion(self.plan, linkage)

    @cached_property
    def returning(self) -> Recalling | None:
        """See `Subject`."""
        other = self._subject.returning
        return None if other is None else Recalling(other, self)

    @cached_property
    def pitch_curve(self) -> PitchCurve:
        """See `Subject`."""
        return PitchCurve(self.motion, self._subject.follower, self._subject.rotation)

    @cached_property
    def inner_curve(self) -> WorkingCurve:
        """See `Subject`."""
        return WorkingCurve(self.pitch_curve, -self._subject.flank_distance)

    @cached_property
    def outer_curve(self) -> WorkingCurve:
        """See `Subject`."""
        return WorkingCurve(self.pitch_curve, self._subject.flank_distance)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._subject, name)
