"""Where the normal force changes its flank, and where the follower would jam."""

from __future__ import annotations

from functools import partial

import numpy as np

from camgeo.effects.carrier import INNER, OUTER
from camgeo.effects.contact_force.balance import VANISHING, Balance
from camgeo.effects.force import all_borders
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.peaks import grid_of, piecewise_extremes
from camgeo.numeric.ranges import stretch_below
from camgeo.numeric.roots import Function, roots_on_grid


def smooth_edges(balance: Balance) -> FloatArray:
    """(k,) cam angles [rad] from 0 to 2 pi between which the normal force is smooth.

    Those of the motion, the borders of the forces, and the roots of R and of the leverage: at both
    the flank that carries changes.
    """
    borders = all_borders(balance.forces)
    edges = merged(np.concatenate((balance.subject.cam.drive.smooth_angles, borders)))
    grid = grid_of(edges)

    def demand(phi: FloatArray) -> FloatArray:
        return balance.demand(phi, "right", balance.rates(phi))

    def leverage(phi: FloatArray, sense: int) -> FloatArray:
        return balance.leverage(phi, "right", sense)

    senses = (INNER,) if balance.subject.returning is None else (INNER, OUTER)
    inner = grid_of(merged(np.concatenate((edges, _dips(demand, grid)))))
    found = [edges, roots_on_grid(demand, inner)]
    found += [roots_on_grid(partial(leverage, sense=sense), grid) for sense in senses]
    return merged(np.concatenate(found))


def _dips(function: Function, grid: FloatArray) -> FloatArray:
    """Places at which `function` has another sign than at the three points of `grid` around it.

    A parabola through three points falls below the middle one by an eighth of the larger difference
    at most; where twice that could change the sign, the least value is looked for.
    """
    values = function(grid.ravel()).reshape(grid.shape)
    size = np.abs(values)
    before, here, after = size[:, :-2], size[:, 1:-1], size[:, 2:]
    signs = np.sign(values)
    near = (signs[:, :-2] == signs[:, 1:-1]) & (signs[:, 2:] == signs[:, 1:-1])
    near &= (here <= before) & (here <= after) & (here > 0.0)
    near &= 4.0 * here <= np.maximum(before, after) - here
    found = []
    for row, column in np.argwhere(near):
        sign = signs[row, column + 1]

        def upright(phi: FloatArray, _side: Side, sign: float = sign) -> FloatArray:
            return sign * function(phi)

        lowest = piecewise_extremes(upright, grid[row, [column, column + 2]]).lowest
        if lowest.value < 0.0:
            found.append(lowest.place)
    return np.array(found)


def refuse_jamming(balance: Balance, edges: FloatArray) -> None:
    """Raise EffectError if the follower jams between any two of `edges`.

    Self-locking (Rothbart, Cam Design Handbook, chapter on forces, and Volmer, Kurvengetriebe, on
    the transmission angle): friction outweighs what the normal force does along the path of the
    follower. Without friction it happens at transmission angle 0.
    """
    least = VANISHING * abs(balance.subject.cam.follower.reach)

    def reserve(phi: FloatArray, side: Side) -> FloatArray:
        needed, _, left = balance.parts(phi, side, balance.rates(phi))
        return np.where(needed != 0.0, left, abs(balance.subject.cam.follower.reach)) - least

    lowest = piecewise_extremes(reserve, edges).lowest
    if lowest.value > 0.0:
        return
    stretch = stretch_below(lambda phi: reserve(phi, "right"), edges, lowest.place)
    if stretch is None:
        balance.refuse(lowest.place, "right")
    else:
        side: Side = "left" if lowest.place == stretch[1] else "right"
        balance.refuse(lowest.place, side, stretch)
