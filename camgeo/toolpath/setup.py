"""What a simulation of a milling program is given: what each tool does, and what it starts from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray
from camgeo.toolpath.course import Course
from camgeo.toolpath.moves import Move, Point, Stop
from camgeo.toolpath.stages import Body, Slab

SLICES: Final = 4
"""Slabs of a point or of rounded corners at their lowest."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one tool does: an operation.

    Attributes
    ----------
    name : of the operation.
    moves : in order, halts among them.
    radius : of the cutter [mm].
    point : height [mm] of its point or its rounded corners, below the full radius.
    rounded : whether that is a rounded corner, and not a cone.
    plunges : whether it may go straight down into material.
    shank : radius above the cutting edges, and their length [mm]; None if not known.
    obstacles : that no move may touch below their tops.
    start : where it stands before; None if the first move is a traverse.
    """

    name: str
    moves: tuple[Move | Stop, ...]
    radius: float
    point: float = 0.0
    rounded: bool = False
    plunges: bool = True
    shank: tuple[float, float] | None = None
    obstacles: tuple[Body, ...] = ()
    start: Point | None = None

    def radius_at(self, height: FloatArray) -> FloatArray:
        """(n,) radius [mm] at heights (n,) above the tip, that of the tip below it."""
        if self.point <= 0.0:
            return np.full(len(height), self.radius)
        up = np.clip(height, 0.0, self.point)
        if self.rounded:
            return self.radius - self.point + np.sqrt(up * (2.0 * self.point - up))
        return self.radius * up / self.point

    def slices(self, tip: float, top: float) -> list[float]:
        """Z [mm] from a tip up to a `top` between which the radius changes by equal steps or so."""
        share = np.arange(1, SLICES + 1) / SLICES
        if self.rounded:
            share = 1.0 - np.cos(0.5 * np.pi * share)
        high = self.point if self.rounded else min(self.point, max(top - tip, 0.0))
        return (tip + high * share).tolist() if high > 0.0 else []


@dataclass(frozen=True, slots=True, eq=False)
class Chamfer:
    """An edge of the part that a cone takes off.

    Attributes
    ----------
    run : of the cone; its moves do not matter.
    course : exact, of its tip, all at one height.
    top : Z above which it is to take nothing off [mm].
    turned : height of the part's other face [mm], if it was taken off from there: run, course and
        top are those of that side.
    """

    run: Run
    course: Course
    top: float
    turned: float | None = None

    def height(self, z: float) -> float:
        """A height of the side from which it was taken off, seen from this one; and back [mm]."""
        return z if self.turned is None else self.turned - z

    @property
    def heights(self) -> list[float]:
        """Between which the section of the part changes by equal steps or so [mm]."""
        own = self.run.slices(float(np.min(self.course.lowest)), self.top)
        return [self.height(z) for z in own]


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """What another side has left, seen from this one.

    Attributes
    ----------
    slabs : of the material, from the lowest.
    corners : heights [mm] between which rounded corners of its cutters were lowest.
    """

    slabs: tuple[Slab, ...]
    corners: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Setup:
    """What a program starts from, and what must come of it.

    Attributes
    ----------
    blank : contours, of which a point of it is within an odd number.
    top, bottom : of the blank, Z [mm].
    part : what must be left.
    held : outlines within which the blank is held all the time, beside the clamps and screws of
        each run; None if that is not to be judged.
    rim : contours of the strip along the outline of the blank by which it is held where nothing
        else holds it, as with tabs; None if it is not.
    fixture : whether a fixture below all of the blank is to hold what nothing else holds.
    chamfers : edges that the part lacks.
    lowest : Z below which no tip may go but for its point [mm]; None for no limit.
    joined : Z up to which waste may hold on to the part [mm]: tabs, a skin; None for none.
    hanging : Z from which on it may do so; None for none.
    before : what an earlier side has left of the blank; None for all of it.
    final : whether the part must be all there is in the end, and no other side follows.
    unfinished : walls that the stated operations of all sides leave unfinished, or roughed.
    known : whether the outline of the blank is stated, and not one that reaches beyond all cuts.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    blank: tuple[Contour, ...]
    top: float
    bottom: float
    part: tuple[Body, ...] = ()
    held: tuple[tuple[Contour, ...], ...] | None = None
    rim: tuple[Contour, ...] | None = None
    fixture: bool = False
    chamfers: tuple[Chamfer, ...] = ()
    lowest: float | None = None
    joined: float | None = None
    hanging: float | None = None
    before: Before | None = None
    final: bool = True
    unfinished: tuple[Contour, ...] = ()
    known: bool = True
    density: float | None = None
