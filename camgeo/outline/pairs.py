"""Pairs of cells whose boxes overlap: sorted along one axis, then by separating axes."""

from __future__ import annotations

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, IntArray, grouped
from camgeo.outline.cells import Cells

MOST = 4_000_000
"""Pairs looked at together; more is a flank that lies on itself."""


def overlapping(cells: Cells) -> tuple[IntArray, IntArray]:
    """(k,), (k,) indices i < j of the cells whose upright bounding boxes overlap."""
    tangent = cells.tangent
    wide = np.abs(tangent.real) * cells.along + np.abs(tangent.imag) * cells.across
    high = np.abs(tangent.imag) * cells.along + np.abs(tangent.real) * cells.across
    left, right = cells.middle.real - wide, cells.middle.real + wide
    order = np.argsort(left, kind="stable")
    # In the order of their left sides, cell k overlaps those that begin before it ends.
    last = np.searchsorted(left[order], right[order], side="right")
    counts = last - np.arange(len(order)) - 1
    if np.sum(counts) > MOST:
        raise GeometryError("the flank has too many neighbours of itself to be told apart")
    one, step = grouped(counts)
    first, second = order[one], order[one + 1 + step]
    apart = np.abs(cells.middle.imag[first] - cells.middle.imag[second])
    near = apart <= high[first] + high[second]
    first, second = first[near], second[near]
    return np.minimum(first, second), np.maximum(first, second)


def meet(one: Cells, other: Cells) -> BoolArray:
    """(k,) False where the boxes of the cells k of both surely have no point in common."""
    way = other.middle - one.middle
    turned = np.conj(one.tangent) * other.tangent
    cosine, sine = np.abs(turned.real), np.abs(turned.imag)
    from_one, from_other = np.conj(one.tangent) * way, np.conj(other.tangent) * way
    touching: BoolArray = (
        (np.abs(from_one.real) <= one.along + cosine * other.along + sine * other.across)
        & (np.abs(from_one.imag) <= one.across + sine * other.along + cosine * other.across)
        & (np.abs(from_other.real) <= other.along + cosine * one.along + sine * one.across)
        & (np.abs(from_other.imag) <= other.across + sine * one.along + cosine * one.across)
    )
    return touching


def cross_once(one: Cells, other: Cells) -> BoolArray:
    """(k,) True where the tangents of both cells surely differ: they cross at most once."""
    turned = np.conj(one.tangent) * other.tangent
    between = np.abs(np.angle(turned))
    between = np.minimum(between, np.pi - between)
    once: BoolArray = between > one.turn + other.turn
    return once
