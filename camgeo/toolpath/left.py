"""What is left of a blank: pieces that nothing holds any more, and material left on the part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from camgeo.toolpath.setup import Run, Setup
from camgeo.toolpath.stages import Flaw, Slab, Stage, areas, each_once
from camgeo.toolpath.sweep import Area, farthest, grown, overlap, parts, place_in, polygon

TOUCHING = 1e-4
"""Area [mm^2] that two pieces must share to hang together; rounding leaves less."""

FINENESS = 1e-3
"""Deviation of chords of clamps [mm]."""

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
    runs: Sequence[Run],
    setup: Setup,
    allowed: float,
    *,
    corners: Sequence[tuple[float, float]] = (),
) -> Iterator[Flaw]:
    """Pieces that come loose, each where it does, and what is left on the part at the end.

    Parameters
    ----------
    part : in each slab.
    runs : of each stage, with the clamps and screws that are set.
    setup : what the program starts from, and what it has to leave.
    allowed : thickness [mm] that may be left; what is nowhere thicker is no piece.
    corners : heights [mm] between which rounded corners of cutters are, where those are lowest.
    """
    if setup.held is not None:
        held = [polygon(each, FINENESS) for each in setup.held]
        yield from _loose_pieces(stages, part, runs, held, setup, allowed)
    if stages and setup.final:
        yield from _rests(stages[-1], part, setup, allowed, corners)


def _loose_pieces(
    stages: Sequence[Stage],
    part: Sequence[Area],
    runs: Sequence[Run],
    always: Sequence[Area],
    setup: Setup,
    allowed: float,
) -> Iterator[Flaw]:
    """Pieces that neither what holds `always` nor the clamps of a run hold, each once.

    Until the first clamp is set, a blank that is still one piece is held in a way that is not
    stated: screws often stand in a bore that is milled first.
    """
    known: list[Piece] = []
    clamped = bool(always) or setup.rim is not None
    rim = [] if setup.rim is None else [polygon(setup.rim, FINENESS)]
    for stage, run in zip(stages, runs, strict=True):
        found = pieces(stage.slabs)
        held = [*always, *(polygon(body.contours, FINENESS) for body in run.obstacles)]
        clamped |= bool(run.obstacles)
        if not clamped and len(found) == 1:
            continue
        kept = [piece for piece in found if _meets(piece, held or rim)]
        if not held:  # what holds the rim is not stated; it holds what hangs on the part
            kept = [piece for piece in kept if piece.shared(part) > TOUCHING] or kept
        for piece in found:
            if piece in kept or any(_same(piece, each) for each in known):
                continue
            if _is_dust(piece, allowed):
                continue
            known.append(piece)
            yield _loose(stage, piece, part, setup)


def _meets(piece: Piece, held: Sequence[Area]) -> bool:
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


def _loose(stage: Stage, piece: Piece, part: Sequence[Area], setup: Setup) -> Flaw:
    """A piece that comes loose: what it is, how large and heavy, and where."""
    k, area = max(piece.areas, key=lambda each: each[1].area)
    left, low, right, high = area.bounds
    place, value, unit = place_in(area), piece.volume(stage.slabs), "mm^3"
    what = _name(piece, place, part)
    size = f"{what} of {right - left:.3g} x {high - low:.3g} mm, {value:.3g} mm^3"
    if setup.density is not None:
        size += f", {1e3 * setup.density * value:.3g} kg"
    edge = float(np.max(np.abs(setup.blank[0].vertices)))
    if not setup.known and max(map(abs, area.bounds)) > edge / np.sqrt(2.0) - SAME:
        size, value, unit = f"{what}, in a blank of unstated size", 1.0, "pieces"
    watched = setup.fixture and what != PART
    text = f"{size}, which the fixture must hold, comes loose" if watched else (
        f"{size}, comes loose and nothing holds it"
    )  # fmt: skip
    where = (place.real, place.imag, stage.slabs[k].z0)
    return Flaw("loose", stage.operation, text, value, 0.0, where, unit, watched=watched)


def _name(piece: Piece, place: complex, part: Sequence[Area]) -> str:
    """What a piece is: the part, a core within it, or waste beside it."""
    if piece.shared(part) > 0.5 * sum(each.area for each in part):
        return PART
    rings = [ring for each in part for ring in parts(each)]
    point = shapely.Point(place.real, place.imag)
    inside = any(shapely.intersects(shapely.Polygon(ring.exterior), point) for ring in rings)
    return "a core" if inside or not rings else "waste"


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
    found: dict[int, Flaw] = {}  # the largest fault, of what is meant, and of what corners leave
    known: dict[tuple[int, ...], list[tuple[Area, float]]] = {}
    unfinished = shapely.boundary([polygon([each], 0.5 * allowed) for each in setup.unfinished])
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
            meant = thickness and np.any(shapely.distance(unfinished, each) <= 2.0 * allowed)
            text = (
                f"material is left on the part, up to {size:.3g} mm thick, {right - left:.3g} mm"
                f" along X, {high - low:.3g} mm along Y and {slab.z1 - slab.z0:.3g} mm high"
            )
            text += ", where the corners of a cutter are rounded" if by_corner else ""
            place = place_in(each)
            where = (place.real, place.imag, slab.z0)
            kind = 2 if by_corner else 1 if meant else 0
            if kind not in found or size > found[kind].value:
                found[kind] = Flaw(
                    "rest", stage.operation, text, size, allowed, where, watched=kind > 0
                )
    yield from (found[kind] for kind in sorted(found))
