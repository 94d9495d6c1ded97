"""How far the steady state of a camshaft is off if its rates are, to first order.

The state x over the cam angle, of one or two numbers, obeys x' = f(x) and repeats itself after the
turn. With rates off by d it is off by dx, with dx' = f_x dx + d, and dx repeats itself too. Of d
only the size is known at each cam angle. Over a cell the collocation equations give dx at the nodes
from that at the start, by H, and from the d at each node, whose parts are added by their sizes.

From cell to cell an orthonormal basis Q is carried along, H Q = Q' R with R upper triangular, and
the parts b of each cell pass on by the sizes of the elements of R: s' = |R| s + |Q'^T| b. This
keeps what decays apart from what lasts, and where the state swings, its phase does not matter. With
one number little is lost. With the s of a turn from 0, and its matrix M, the periodic dx at cam
angle 0 is at most |(1 - M)^-1 Q| s, and that of all other places follows from there in the same
way.
"""

from __future__ import annotations

import numpy as np

from camgeo.effects.shaft.mesh import collocation
from camgeo.numeric.arrays import FloatArray


def spread(spans: FloatArray, slopes: FloatArray, off: FloatArray) -> FloatArray:
    """(d,) the largest |dx| at the nodes.

    Parameters
    ----------
    spans : (m,) lengths of the cells of the turn [rad].
    slopes : (m, n, d, d) f_x at their nodes.
    off : (m, n, d) |d| there.
    """
    count, nodes, size = off.shape
    scales = _balanced(slopes)
    slopes, off = slopes * scales[:, np.newaxis] / scales, off * scales
    inner = spans[:, np.newaxis, np.newaxis] * collocation().integral
    coupled = inner[:, :, np.newaxis, :, np.newaxis] * slopes.swapaxes(1, 2)[:, np.newaxis]
    matrix = np.eye(nodes * size) - coupled.reshape(count, nodes * size, nodes * size)
    starts = np.broadcast_to(np.tile(np.eye(size), (nodes, 1)), (count, nodes * size, size))
    parts = np.einsum("mpq,mqe,de->mpdqe", inner, off, np.eye(size))
    sides = np.concatenate((starts, parts.reshape(matrix.shape)), axis=2)
    solved = np.linalg.solve(matrix, sides).reshape(count, nodes, size, -1)
    passed = solved[..., :size]
    own = np.sum(np.abs(solved[..., size:]), axis=-1)

    def turned(first: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, d) at most |dx| at the starts of the cells, Q and s at the end; from |dx| `first`."""
        basis, bound, found = np.eye(size), first, np.empty((count, size))
        for cell in range(count):
            found[cell] = np.abs(basis) @ bound
            basis, factor = np.linalg.qr(passed[cell, -1] @ basis)
            # Radau's last node is the end of the cell.
            bound = np.abs(factor) @ bound + np.abs(basis.T) @ own[cell, -1]
        return found, basis, bound

    _, basis, bound = turned(np.zeros(size))
    whole = np.eye(size)
    for each in passed[:, -1]:
        whole = each @ whole
    first = np.abs(np.linalg.solve(np.eye(size) - whole, basis)) @ bound
    at_starts = turned(first)[0]
    everywhere = np.einsum("mndk,mk->mnd", np.abs(passed), at_starts) + own
    return np.asarray(np.max(everywhere, axis=(0, 1)) / scales)


def _balanced(slopes: FloatArray) -> FloatArray:
    """(d,) factors with which the numbers of a state that swings are of one size."""
    across = np.mean(np.abs(slopes), axis=(0, 1))
    if len(across) == 1 or not across[0, 1] * across[1, 0] > 0.0:
        return np.ones(len(across))
    return np.array([1.0, float(np.sqrt(across[0, 1] / across[1, 0]))])
