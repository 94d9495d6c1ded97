"""Smooth pieces in groups of one curve, so that a fit shares the cost of a call between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from camgeo.contour.chain import Chain
from camgeo.contour.proved import FitPieces, PieceOfLeg
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve

AIM = 0.985
"""Share of the tolerance that the sampled distance of a fast fit may reach; the proof takes the
rest."""


class Group(Protocol):
    """Smooth pieces of one curve, ready to be fitted at any aim."""

    def fit(self, aim: float, tolerance: float) -> Sequence[Chain]:
        """A chain for each of the pieces within `aim` [mm]; `tolerance` [mm] is for messages."""


def fit_by_groups(
    make: Callable[[WorkingCurve, list[Piece]], Group], tolerance: float
) -> FitPieces:
    """What fits the pieces of `camgeo.contour.proved.proved_fit` group by group.

    `make` makes a group of a curve and its pieces; once, however often the aim is lowered.
    """
    groups: list[tuple[Group, list[int]]] = []

    def fit_pieces(pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        if not groups:
            for curve, places in by_curve(pieces):
                groups.append((make(curve, [pieces[k][1] for k in places]), places))
        found: dict[int, Chain] = {}
        for group, places in groups:
            found.update(zip(places, group.fit(aim, tolerance), strict=True))
        return [found[k] for k in range(len(pieces))]

    return fit_pieces


def by_curve(pieces: Sequence[PieceOfLeg]) -> list[tuple[WorkingCurve, list[int]]]:
    """The curves that the pieces belong to, each with the numbers of its pieces."""
    shared: dict[tuple[int, float], list[int]] = {}
    for number, (leg, _) in enumerate(pieces):
        shared.setdefault((id(leg.curve.pitch), leg.curve.distance), []).append(number)
    return [(pieces[numbers[0]][0].curve, numbers) for numbers in shared.values()]
