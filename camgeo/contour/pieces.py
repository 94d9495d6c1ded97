"""Lines and arcs in the plane, each for itself: the places on them and the distances from them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from camgeo.contour.contour import POINTS, Contour, lengths_of, radii_of
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    frozen,
    grouped,
    taken,
)
from camgeo.units import TURN

HALF_TURN = 0.5 * TURN


class Run(Protocol):
    """What consists of lines and arcs: their `Pieces`, a chain of them, a course."""

    @property
    def starts(self) -> ComplexArray: ...
    @property
    def ends(self) -> ComplexArray: ...
    @property
    def sweeps(self) -> FloatArray: ...
    @property
    def centres(self) -> ComplexArray: ...


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """Lines and arcs; each begins anywhere.

    Attributes
    ----------
    starts, ends : (n,) complex [mm].
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
    centres : (n,) complex [mm], centre of each arc; 0 where the piece is a line.
    """

    starts: ComplexArray
    ends: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    def __post_init__(self) -> None:
        for name in ("starts", "ends", "centres"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.complex128))
        object.__setattr__(self, "sweeps", frozen(self.sweeps, np.float64))

    def __len__(self) -> int:
        return len(self.starts)

    @classmethod
    def of(cls, run: Run) -> Pieces:
        """Those of `run`."""
        return Pieces(run.starts, run.ends, run.sweeps, run.centres)

    @classmethod
    def around(cls, contours: Iterable[Contour]) -> Pieces:
        """Those of closed contours, in parts of at most half a turn."""
        each = [contour.split(HALF_TURN) for contour in contours]
        columns = (
            [contour.vertices for contour in each],
            [contour.ends for contour in each],
            [contour.sweeps for contour in each],
            [contour.centres for contour in each],
        )
        return Pieces(*(np.concatenate([np.empty(0), *column]) for column in columns))

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] of arcs; 0 for lines."""
        return radii_of(self.starts, self.sweeps, self.centres)

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm]."""
        return lengths_of(self.starts, self.ends, self.sweeps, self.radii)

    def at(self, shares: FloatArray) -> ComplexArray:
        """(n,) complex [mm] the place at a share of the length of each; its own ends at 0 and 1."""
        straight = self.starts + (self.ends - self.starts) * shares
        turned = self.centres + (self.starts - self.centres) * np.exp(1j * self.sweeps * shares)
        inner = np.where(self.sweeps == 0.0, straight, turned)
        found: ComplexArray = np.where(shares == 1.0, self.ends, inner)
        return np.where(shares == 0.0, self.starts, found)

    def tangents(self, places: ComplexArray) -> ComplexArray:
        """(n,) unit tangents at `places` (n,) [mm] on the pieces; 0 on one without a length."""
        turned = 1j * np.sign(self.sweeps) * (places - self.centres)
        along = np.where(self.sweeps == 0.0, self.ends - self.starts, turned)
        size = np.abs(along)
        found: ComplexArray = np.divide(along, np.where(size > 0.0, size, 1.0))
        return found

    def between(self, first: FloatArray, last: FloatArray) -> Pieces:
        """The part of each from the share `first` to the share `last` (n,) of its length."""
        ends = (self.at(first), self.at(last))
        return Pieces(*ends, self.sweeps * (last - first), self.centres)

    def halves(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Equal parts of at most half a turn: (m,) the piece of each, and the shares of its length
        between which it lies.
        """
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / HALF_TURN - 1e-12)).astype(np.intp)
        index, step = grouped(counts)
        return index, step / counts[index], (step + 1) / counts[index]

    def chords(self, sagitta: float) -> tuple[IntArray, ComplexArray]:
        """Chords within `sagitta` [mm] of the pieces: (m,) the piece of each, and (m,) complex [mm]
        its end.
        """
        flat = np.maximum(0.0, 1.0 - sagitta / np.where(self.sweeps == 0.0, np.inf, self.radii))
        steps = np.maximum(2.0 * np.arccos(flat), TURN / POINTS)
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / steps)).astype(np.intp)
        index, number = grouped(counts)
        return index, taken(self, index).at((number + 1) / counts[index])

    def faces(self, arms: ComplexArray) -> BoolArray:
        """(n,) whether the ray along `arms` (n,) from the centre of each arc meets it."""
        turned = np.angle(arms * np.conj(self.starts - self.centres))
        turned = np.mod(np.where(self.sweeps < 0.0, -turned, turned), TURN)
        on: BoolArray = (self.sweeps != 0.0) & (turned <= np.abs(self.sweeps))
        return on

    def feet(self, places: ComplexArray) -> FloatArray:
        """(n,) where the foot of `places` (n,) [mm] lies on each line, as a share of its length."""
        chords = self.ends - self.starts
        squares = np.where(chords == 0.0, 1.0, np.abs(chords) ** 2)
        shares: FloatArray = ((places - self.starts) * np.conj(chords)).real / squares
        return shares

    def apart(self, places: ComplexArray) -> FloatArray:
        """(n,) distance [mm] of `places` (n,) from its piece each; (k, n) of places (k, 1).

        The nearest point of a piece is the foot of the perpendicular, if that lies on it, or an
        end.
        """
        shares = np.clip(self.feet(places), 0.0, 1.0)
        to_line = np.abs(places - (self.starts + shares * (self.ends - self.starts)))
        at_ends = np.minimum(np.abs(places - self.starts), np.abs(places - self.ends))
        arms = places - self.centres
        to_arc = np.where(self.faces(arms), np.abs(np.abs(arms) - self.radii), at_ends)
        found: FloatArray = np.where(self.sweeps == 0.0, to_line, to_arc)
        return found
