"""Fit by the fewest straight pieces: chords with the curve on both sides of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise

import numpy as np

from camgeo.contour.chain import Chain
from camgeo.contour.chords.arc_chords import arc_angles, arc_count, arc_offset
from camgeo.contour.chords.fast import MAX_CHORDS, fit_polyline
from camgeo.contour.chords.ladder import MOST_TURN, Ladder
from camgeo.contour.chords.two_sided import Chords, Stretched, stretch_table
from camgeo.contour.contour import Fit
from camgeo.contour.counts import too_many
from camgeo.contour.joints import require_regular
from camgeo.contour.legs import StretchLeg, TurnLeg
from camgeo.contour.proof.deviation import SHARPNESS
from camgeo.contour.proved import PieceOfLeg, proved_fit
from camgeo.errors import GeometryError, ToleranceError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.path import Path

PROVED = 1.0 + SHARPNESS + 2e-3
"""Expected bound of the proof as a multiple of the deviation found: slightly more, because the
largest deviation lies between the samples."""

FEW = 64
"""Up to this many pieces the fit is compared with chords between points of the curve: on turns of
many radians per millimetre both are limited by the angle of a chord, not by its sagitta. Beyond,
there are 1.4 times as many of the latter."""

EASE = 1.0 - 2.0**-8
"""Factor of the deviation of the next layout if a proof fails. Near tips samples miss up to one
hundredth of the distance; three of the six possible steps make up for that."""

KINK = 2.0**-52 * 256.0
"""A gap above this fraction of the distance from the cam axis, or this many radians between
tangents, is more than rounding: there the curve has a corner or a small gap."""


def fewest_chords(path: Path, tolerance: float) -> Fit:
    """The fewest straight pieces within `tolerance` [mm] of `path`, counter-clockwise.

    A chord of length h with the curve on both sides lies |kappa| h^2/16 off it, so the integral of
    sqrt(|kappa|/(16 tolerance)) ds is their number. Vertices are off the curve, at bends on its
    outer side; only the corners of the path, and the ends of its arcs, are vertices themselves.
    Breaks need not be. There are never more pieces than from `fit_polyline`.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    ladders: list[list[Ladder]] = []
    found: list[float] = []

    def fit_pieces(pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        for leg, piece in pieces:
            require_regular(leg.curve, piece)
        legs = [list(group) for _, group in groupby(pieces, lambda each: id(each[0]))]
        if not ladders:
            ladders.extend(_ladders(own[0][0]) for own in legs)
        # If the proved deviation of a layout exceeds the one found, a layout with less deviation
        # follows. Which one does not depend on the tolerance, so a looser one takes no more
        # pieces.
        most = max(found) * EASE if found else aim
        found.clear()
        chains: list[Chain] = []
        for own, of_leg in zip(legs, ladders, strict=True):
            laid = [each.fewest(most, PROVED, MAX_CHORDS) for each in of_leg]
            found.extend(deviation for _, deviation in laid)
            # One chain for all of a leg, none for its other pieces.
            chains += [_chain([chords for chords, _ in laid]), *[Chain.empty()] * (len(own) - 1)]
        return chains

    def fit_turn(leg: TurnLeg, aim: float) -> Chain:
        return _arc_chords(leg, aim / (1.0 + SHARPNESS))

    try:
        fit = proved_fit(path, tolerance, tolerance, fit_pieces, fit_turn)
    except (ToleranceError, GeometryError):
        return fit_polyline(path, tolerance)
    if len(fit.contour) <= FEW:
        plain = fit_polyline(path, tolerance)
        if len(plain.contour) < len(fit.contour):
            return plain
    return fit


def _ladders(leg: StretchLeg) -> list[Ladder]:
    """The ladders along a whole leg, from corner to corner."""
    cuts = _kinks(leg)
    if leg.closed and not len(cuts):
        return [Ladder.of(_stretched(leg, leg.start, leg.end, closed=True))]
    ends = [*cuts, cuts[0] + leg.end - leg.start] if leg.closed else [leg.start, *cuts, leg.end]
    parts = [_stretched(leg, low, high, closed=False) for low, high in pairwise(ends)]
    return [Ladder.of(part) for part in parts]


def _kinks(leg: StretchLeg) -> list[float]:
    """Cam angles [rad] inside the leg where its pieces do not meet smoothly to rounding."""
    inner = [piece.start for piece in leg.pieces if leg.closed or piece.start > leg.start]
    if not inner:
        return []
    at = np.array(inner)
    right, left = leg.point(at), leg.point(at, "left")
    turned = np.abs(leg.curve.tangent(at) - leg.curve.tangent(at, "left"))
    apart = np.abs(right - left) > KINK * np.abs(right)
    return [float(angle) for angle in at[apart | (turned > KINK)]]


def _stretched(leg: StretchLeg, start: float, end: float, *, closed: bool) -> Stretched:
    curve = leg.curve

    def place(phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        points, tangents = curve.points_and_tangents(phi)
        if not closed:
            points[-1] = curve.point(phi[-1:], "left")[0]
            tangents[-1] = curve.tangent(phi[-1:], "left")[0]
        return points, tangents

    return Stretched(stretch_table(curve, start, end), place, curve.point, leg.rotation, closed)


def _chain(laid: Sequence[Chords]) -> Chain:
    """Stretches one after the other; the last vertex of each is the first of the next."""
    angles = np.concatenate([each.angles[: len(each.worst)] for each in laid])
    vertices = np.concatenate([each.vertices[: len(each.worst)] for each in laid])
    return Chain.straight(angles, vertices)


def _arc_chords(leg: TurnLeg, aim: float) -> Chain:
    count = arc_count(aim, leg.radius, leg.end, MOST_TURN)
    if count > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", aim)
    offset = arc_offset(count, leg.radius, leg.end)
    angles = arc_angles(count, leg.radius, leg.end, offset)[:-1]
    vertices = leg.centre + (1.0 + offset / leg.radius) * (leg.point(angles) - leg.centre)
    vertices[0] = leg.first
    return Chain.straight(angles, vertices)
