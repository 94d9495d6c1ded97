"""What is left of a blank: pieces that nothing holds any more, and material left on the part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from camgeo.toolpath.setup import Setup
from camgeo.toolpath.stages import Flaw, Slab, Stage, areas, each_once
from camgeo.toolpath.sweep import Area, farthest, grown, overlap, parts, place_in

TOUCHING = 1e-4
"""Area [mm^2] that two pieces must share to hang together; rounding leaves less."""

SAME = 1e-6
"""Heights [mm] that differ by less are one."""

PART = "the part"


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A connected part of the material: areas with the number of their slab."""

    areas: tuple[tuple[int, Area], ...]

    def volume(self, slabs: Sequence[Slab]) -> float:
        """[mm^3]."""
        return sum((slabs[k].z1 - slabs[k].z0) * float(area.area) for k, area in self.areas)

    def shared(self, others: Sequence[Area]) -> float:
        """Area [mm^2] shared with one area for each slab, all slabs together."""
        return sum(float(shapely.intersection(area, others[k]).area) for k, area in self.areas)


def pieces(slabs: Sequence[Slab]) -> tuple[Piece, ...]:
    """The connected parts of the material."""
    apart = each_once(parts, areas(slabs))
    single = [[(k, each) for each in found] for k, found in enumerate(apart)]
    offsets = np.concatenate(([0], np.cumsum([len(each) for each in single]))).astype(int)
    owner = list(range(int(offsets[-1])))

    def root(number: int) -> int:
        while owner[number] != number:
            number = owner[number]
        return number

    shared: dict[tuple[int, int], list[list[int]]] = {}
    for k, (low_parts, high_parts) in enumerate(pairwise(apart)):
        both = (id(low_parts), id(high_parts))
        if both not in shared:
            shared[both] = np.argwhere(overlap(low_parts, high_parts) > TOUCHING).tolist()
        for low, high in shared[both]:
            owner[root(int(offsets[k] + low))] = root(int(offsets[k + 1] + high))
    flat = [each for slab in single for each in slab]
    groups: dict[int, list[tuple[int, Area]]] = {}
    for number, each in enumerate(flat):
        groups.setdefault(root(number), []).append(each)
    return tuple(Piece(tuple(group)) for group in groups.values())


def left_flaws(
    stages: Sequence[Stage],
    part: Sequence[Area],
    held: Sequence[Area] | None,
    setup: Setup,
    allowed: float,
    *,
    corners: Sequence[tuple[float, float]] = (),
) -> Iterator[Flaw]:
    """Pieces that come loose, each where it does, and what is left on the part at the end.

    Parameters
    ----------
    part : in each slab.
    held : areas within which the blank is held; None if that is not to be judged.
    setup : what the program starts from, and what it has to leave.
    allowed : thickness [mm] that may be left; what is nowhere thicker is no piece.
    corners : heights [mm] between which rounded corners of cutters are, where those are lowest.
    """
    known: list[Piece] = []
    for stage in stages:
        for piece in pieces(stage.slabs) if held is not None else ():
            if any(_same(piece, each) for each in known) or _held(piece, held or ()):
                continue
            if _is_dust(piece, allowed):
                continue
            known.append(piece)
            yield _loose(stage, piece, part, fixture=setup.fixture)
    if stages and setup.final:
        yield from _rests(stages[-1], part, setup, allowed, corners)


def _held(piece: Piece, held: Sequence[Area]) -> bool:
    return any(
        float(shapely.intersection(area, each).area) > TOUCHING
        for _, area in piece.areas
        for each in held
    )


def _is_dust(piece: Piece, allowed: float) -> bool:
    """Whether a piece is nowhere thicker than paths may be off: chips, which may not be there."""
    return all(grown(area, -0.5 * allowed).is_empty for _, area in piece.areas)


def _same(piece: Piece, other: Piece) -> bool:
    """Whether a piece is what is left of one that came loose before."""
    before = dict(other.areas)
    return all(
        k in before and float(shapely.intersection(area, before[k]).area) > TOUCHING
        for k, area in piece.areas[:1]
    )


def _loose(stage: Stage, piece: Piece, part: Sequence[Area], *, fixture: bool) -> Flaw:
    k, area = max(piece.areas, key=lambda each: each[1].area)
    low, _, high, _ = area.bounds
    _, bottom, _, top = area.bounds
    volume = piece.volume(stage.slabs)
    what = PART if piece.shared(part) > 0.5 * sum(each.area for each in part) else "a core"
    watched = fixture and what != PART
    text = f"{what} of {high - low:.3g} x {top - bottom:.3g} mm, {volume:.3g} mm^3, "
    text += "which the fixture must hold, comes loose" if watched else (
        "comes loose and nothing holds it"
    )  # fmt: skip
    place = place_in(area)
    where = (place.real, place.imag, stage.slabs[k].z0)
    return Flaw("loose", stage.operation, text, volume, 0.0, where, "mm^3", watched=watched)


def _may_stay(slab: Slab, setup: Setup) -> bool:
    """Whether waste may hold on to the part there: up to a height, or from one on beside it."""
    low, high = setup.joined, setup.hanging
    if low is not None and slab.z1 <= low + SAME:
        return True
    top = max((body.z1 for body in setup.part), default=setup.top)
    return high is not None and high - SAME <= slab.z0 and slab.z1 <= top + SAME


def _left_on(
    material: Area, target: Area, near: Iterable[Area], allowed: float
) -> Iterator[tuple[Area, float]]:
    """What is left beside the section `target` of the part, with its thickness [mm]; or only over
    or under the sections `near` by, with 0.
    """
    beside = shapely.difference(material, grown(target, allowed))
    thick = parts(grown(grown(beside, -0.5 * allowed), 0.5 * allowed))
    close = grown(target, 2.0 * allowed)
    faces = shapely.difference(shapely.union_all(list(near)), target)
    for each in thick:
        if not target.is_empty and shapely.intersects(each, close):
            yield each, farthest(each, target)[0]
        elif float(shapely.intersection(each, faces).area) > TOUCHING:
            yield each, 0.0


def _rests(
    stage: Stage,
    part: Sequence[Area],
    setup: Setup,
    allowed: float,
    corners: Sequence[tuple[float, float]],
) -> Iterator[Flaw]:
    """Material that is left beside the part, or on one of its faces."""
    found: list[Flaw] = []
    known: dict[tuple[int, ...], list[tuple[Area, float]]] = {}
    for k, (slab, target) in enumerate(zip(stage.slabs, part, strict=True)):
        if slab.material.is_empty or _may_stay(slab, setup):
            continue
        near = {id(each): each for each in part[max(k - 1, 0) : k + 2]}
        same = (id(slab.material), id(target), *sorted(near))
        if same not in known:
            known[same] = list(_left_on(slab.material, target, near.values(), allowed))
        for each, thickness in known[same]:
            size = thickness or slab.z1 - slab.z0
            left, low, right, high = each.bounds
            rounding = max((z1 - z0 for z0, z1 in corners if z0 < slab.middle < z1), default=0.0)
            by_corner = size <= rounding + allowed
            text = (
                f"material is left on the part, up to {size:.3g} mm thick, {right - left:.3g} mm"
                f" along X, {high - low:.3g} mm along Y and {slab.z1 - slab.z0:.3g} mm high"
            )
            text += ", where the corners of a cutter are rounded" if by_corner else ""
            place = place_in(each)
            where = (place.real, place.imag, slab.z0)
            found.append(
                Flaw("rest", stage.operation, text, size, allowed, where, watched=by_corner)
            )
    for watched in (False, True):  # the largest of both
        yield from sorted(
            (each for each in found if each.watched == watched), key=lambda each: -each.value
        )[:1]
