"""Many drives, or discs, of one plan as one, to be evaluated at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from camgeo.cam.disc import Disc
from camgeo.cam.drive import Drive
from camgeo.curve.together import Together, one_curve, one_motion
from camgeo.lazy import Ledger
from camgeo.mechanism.several import several
from camgeo.numeric.arrays import IntArray


def drives_together(drives: Sequence[Drive]) -> Together[Drive]:
    """Drives that differ in numbers of their linkages only."""

    def joined(some: tuple[Drive, ...], which: IntArray, times: int) -> Drive:
        one = replace(some[0], ledger=Ledger())
        vars(one)["motion"] = one_motion([drive.motion for drive in some], which, times)
        return one

    return Together(tuple(drives), joined)


def discs_together(discs: Sequence[Disc]) -> Together[Disc]:
    """Discs that differ in numbers of their followers, and of the linkages of their drives, only.

    Of the one that they make only the curves can be used.
    """

    def joined(some: tuple[Disc, ...], which: IntArray, times: int) -> Disc:
        follower = several([disc.follower for disc in some], which)
        one = replace(some[0], follower=follower, ledger=Ledger())
        vars(one)["pitch_curve"] = one_curve([disc.pitch_curve for disc in some], which, times)
        return one

    return Together(tuple(discs), joined)
