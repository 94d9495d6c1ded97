"""The discs of a machine that a cure changes together: the one, or both of a conjugate pair."""

from __future__ import annotations

from dataclasses import replace

from camgeo.cam.cam import Cam
from camgeo.lazy import Ledger
from camgeo.motion.plan import MotionPlan

Discs = tuple[Cam, ...]
"""The cam, or the main and the return cam of a pair. Both have one drive."""


def sized(discs: Discs, number: int = 0, **sizes: float) -> Discs:
    """The same with other dimensions of the follower of disc `number`, as its table states them.

    A return roller follows the main one in what is not stated for it. GeometryError if the
    dimensions are impossible.
    """
    main, *others = discs
    if number == 0:
        main = main.sized(**sizes)
    changed = [main]
    for place, cam in enumerate(others, start=1):
        mount = cam.mount
        assert mount is not None  # what makes it the second disc of a pair
        mount = mount.sized(**sizes) if place == number else mount
        follower = mount.roller(main.follower)
        changed.append(replace(cam, follower=follower, mount=mount, ledger=Ledger()))
    return tuple(changed)


def moved(discs: Discs, plan: MotionPlan) -> Discs:
    """The same with another motion plan."""
    main, *others = discs
    main = main.moved(plan)
    return (main, *(replace(cam, drive=main.drive, ledger=Ledger()) for cam in others))


def plan_of(discs: Discs) -> MotionPlan:
    """The motion plan of their drive."""
    return discs[0].drive.plan
