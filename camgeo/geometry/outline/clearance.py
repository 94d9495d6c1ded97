"""Whether points of a flank are clear of the roller throughout the turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.geometry.pieces import centres_at, extremes, halves, turn_cells, turn_enclosed
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, Side
from camgeo.units import TURN

HALVINGS = 50
"""Most rounds of halving."""

CLOSE = 1e-9
"""A point closer than the roller's radius by this fraction of it is covered; one within this
fraction of the radius is touched."""


def are_clear(
    pitch: PitchCurve, points: ComplexArray, radius: float, owns: FloatArray
) -> BoolArray:
    """(n,) True for those of `points` (n,) that no roller of `radius` [mm] on the pitch curve
    covers.

    This is proved: a cell of cam angle that cannot decide it is halved.

    Parameters
    ----------
    owns : (n, 2) cam angles [rad] for each point, start in [0, 2 pi) and end above it, that are not
        examined: the point is touched there, and its neighbours are known to be regular.
    """
    covered = (1.0 - CLOSE) * radius
    clear = np.ones(len(points), dtype=np.bool_)
    low, high = turn_cells(pitch)
    wide = high - low
    centres, reach = pitch.point(0.5 * (low + high)), _Reach.of(pitch, low, high)
    owners, lows, highs = [], [], []
    for k, (start, end) in enumerate(owns.tolist()):
        ahead, span = (low - start) % TURN, end - start
        whole = (ahead >= span) & (ahead + wide <= TURN)
        distance = np.abs(centres[whole] - points[k])
        clear[k] = not np.any(distance < covered)
        near = distance - reach.seen_from(points[k])[whole] < covered
        nearer = halves(low[whole], high[whole], near)
        # Of the cells in which its own angles begin or end, the part outside of these.
        cut = np.flatnonzero(~whole & (ahead + wide > span))
        both = cut[ahead[cut] + wide[cut] - TURN > span]
        ends = np.full(len(both), end % TURN)
        left = np.where(ahead[cut] >= span, low[cut], end % TURN)
        right = np.where(ahead[cut] + wide[cut] <= TURN, high[cut], start)
        lows.append(np.concatenate((nearer[0], left, ends)))
        highs.append(np.concatenate((nearer[1], right, high[both])))
        owners.append(np.full(len(lows[-1]), k))
    owner, low, high = (np.concatenate(parts) for parts in (owners, lows, highs))
    for _ in range(HALVINGS):
        wanted = clear[owner]
        owner, low, high = owner[wanted], low[wanted], high[wanted]
        if not len(owner):
            break
        distance = np.abs(pitch.point(0.5 * (low + high)) - points[owner])
        clear[owner[distance < covered]] = False
        near = distance - _Reach.of(pitch, low, high).seen_from(points[owner]) < covered
        owner = np.tile(owner[near], 2)
        low, high = halves(low, high, near)
    return clear  # or touched, to rounding


@dataclass(frozen=True, slots=True, eq=False)
class _Reach:
    """How far the roller centre goes in n cells from its place in the middle of each.

    Attributes
    ----------
    half : (n,) half the cells [rad].
    pace : (n,) bound of |Z'| [mm/rad].
    about : (n,) complex [mm] the point about which it turns with the cam; NaN where it does not.
    """

    half: FloatArray
    pace: FloatArray
    about: ComplexArray

    @classmethod
    def of(cls, pitch: PitchCurve, low: FloatArray, high: FloatArray) -> Self:
        about = centres_at(pitch, 0.5 * (low + high))
        return cls(0.5 * (high - low), pitch.speed_bounds(low, high)[0], about)

    def seen_from(self, points: ComplexArray | complex) -> FloatArray:
        """(n,) bound [mm] of the change of its distance from `points` (n,), or from one point.

        Where it turns about a point, it is as if `points` turned about that.
        """
        return np.asarray(self.half * np.fmin(self.pace, np.abs(points - self.about)))


def nearest_to_axis(pitch: PitchCurve) -> tuple[float, float]:
    """Smallest distance of the roller centre from the cam axis [mm] and its cam angle [rad]."""

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        return np.asarray(relative.along[0] ** 2 + relative.across[0] ** 2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        (a0, a1), (b0, b1) = relative.along[:2], relative.across[:2]
        return np.asarray(a0 * a1 + b0 * b1)

    smallest, phi = extremes(pitch, square, slope).smallest()
    return float(np.sqrt(smallest)), phi


def surely_clear_of_axis(pitch: PitchCurve, radius: float) -> bool:
    """True if bounds over cells show that the roller centre stays farther than `radius` [mm].

    False is inconclusive; `nearest_to_axis` decides then.
    """
    low, high = turn_cells(pitch)
    jet, bounds = turn_enclosed(pitch)
    return bool(np.all(np.abs(jet[0]) - 0.5 * (high - low) * bounds[0] > radius))


def stays_on_one_side(pitch: PitchCurve) -> bool:
    """True if the roller centre never passes the foot of the guide, or the line of centres.

    There the transmission angle is 0, and a distance from the cam axis occurs twice.
    """
    middle, bounds = pitch.motion.jet_and_bounds(*turn_cells(pitch))
    reach = np.array([np.min(middle[0] - bounds[0]), np.max(middle[0] + bounds[0])])
    if pitch.follower.on_one_side(reach):
        return True
    return pitch.follower.on_one_side(np.array(lift_range(pitch.motion)))
