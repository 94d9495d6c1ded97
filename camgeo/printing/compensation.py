"""The part that a printer is given, so that what it makes is the part that the scene states.

First bore and key get their clearance, then everything is scaled about the cam axis, then the
lowest layers are drawn in: layers are counted in millimetres of the file, as a slicer counts them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise
from typing import Final

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import surely_apart
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import PartSpec
from camgeo.printing.drawn_in import drawn_in
from camgeo.printing.scaled import scaled
from camgeo.printing.spec import Foot, PrintSpec

TOLERANCE: Final = 1e-3
"""Of the contours that show that boundaries lie apart [mm]; their deviation is accounted for."""

FOOT: Final = "foot"
"""Name of the layers that are drawn in."""


def with_clearance(part: PartSpec, spec: PrintSpec) -> PartSpec:
    """The part with a larger bore, keyway and flat.

    The bottom of the keyway and the flat move with the clearance of the key, not with that of the
    bore.

    Raises
    ------
    GeometryError
        With the key in `print`, if no such keyway or flat is left.
    """
    if part.bore is None:
        return part
    wider, key = spec.bore_clearance or 0.0, spec.key_clearance or 0.0
    if not (wider or key):
        return part
    radius = 0.5 * part.bore
    keyway, flat = part.keyway, part.d_shaft
    try:
        if keyway is not None:
            bottom = radius + keyway.depth + 0.5 * key
            depth = bottom - (radius + 0.5 * wider)
            keyway = replace(keyway, width=keyway.width + key, depth=depth)
        if flat is not None:
            flat = replace(flat, across=flat.across + 0.5 * (wider + key))
        return replace(part, bore=part.bore + wider, keyway=keyway, d_shaft=flat)
    except GeometryError as error:
        raise fault_of_clearance(spec, error) from None


def fault_of_clearance(spec: PrintSpec, error: GeometryError) -> GeometryError:
    """Why a part has no room for its clearance, as a fault of the key that asks for it."""
    key = "bore_clearance" if spec.bore_clearance else "key_clearance"
    value = getattr(spec, key)
    message = f"the part has no room for it: {error}"
    return GeometryError(message, key=f"print.{key}", value=f"{value:g}")


def compensated(part: Part, spec: PrintSpec) -> Part:
    """The part as the file has it: scaled, its lowest layers drawn in.

    `part` has its clearance already. Raises GeometryError with the key in `print`, if a boundary of
    the lowest face cannot be drawn in.
    """
    part = _scaled(part, spec.scale_xy, spec.scale_z)
    foot = spec.elephant_foot
    return part if foot is None else _on_foot(part, foot)


def _scaled(part: Part, xy: float, z: float) -> Part:
    if xy == z == 1.0:
        return part
    known = {each.name: scaled(each, xy) for each in part.boundaries}

    def larger(layer: Layer) -> Layer:
        boundaries = tuple(known[each.name] for each in layer.boundaries)
        return Layer(z * layer.z0, z * layer.z1, boundaries, layer.name)

    bevels = tuple(
        replace(
            each,
            boundary=known[each.boundary.name],
            edge=scaled(each.edge, xy),
            width=xy * each.width,
            height=z * each.height,
            z=z * each.z,
        )
        for each in part.bevels
    )
    return Part(tuple(larger(each) for each in part.layers), bevels)


def _on_foot(part: Part, foot: Foot) -> Part:
    """The part with its lowest layer drawn in, step by step."""
    lowest, *others = part.layers
    part.require_heights()
    room = lowest.z1 - lowest.z0
    key = "print.elephant_foot"
    if any(each.z == lowest.z0 for each in part.bevels):
        message = "edges of the lowest face have chamfers: state upper ones only, or no such foot"
        raise GeometryError(message, key=key)
    if foot.height >= room:
        message = f"must be less than the height of the lowest layer, {room:.6g} mm"
        raise GeometryError(message, key=f"{key}.height", value=f"{foot.height:g}")
    rise = foot.height / foot.steps
    heights = [lowest.z0 + step * rise for step in range(foot.steps)]
    heights.append(lowest.z0 + foot.height)
    layers = []
    for step, ((low, high), inset) in enumerate(
        zip(pairwise(heights), foot.insets, strict=True), start=1
    ):
        try:
            drawn = tuple(
                drawn_in(each, inset, f"{each.name} at step {step}") for each in lowest.boundaries
            )
            _require_alike(drawn, lowest.boundaries)
        except GeometryError as error:
            message = f"the part has no room for it: {error.message}"
            raise GeometryError(message, key=f"{key}.inset", value=f"{foot.inset:g}") from None
        layers.append(Layer(low, high, drawn, FOOT))
    rest = replace(lowest, z0=heights[-1])
    return replace(part, layers=(*layers, rest, *others))


def _require_alike(moved: tuple[Boundary, ...], before: tuple[Boundary, ...]) -> None:
    """GeometryError unless boundaries lie apart, each in those that it lay in before."""
    fits, were = ([each.beside(TOLERANCE) for each in group] for group in (moved, before))
    for a, b in combinations(range(len(moved)), 2):
        inside = [_nested(each[a].contour, each[b].contour) for each in (fits, were)]
        if surely_apart(fits[a], fits[b]) <= 0.0 or inside[0] != inside[1]:
            message = f"{before[a].name} and {before[b].name} would touch"
            raise GeometryError(message, key="part")


def _nested(one: Contour, other: Contour) -> tuple[bool, bool]:
    """Whether the first contour lies in the second, and the second in the first."""
    return (
        winding_number(other, complex(one.vertices[0])) != 0,
        winding_number(one, complex(other.vertices[0])) != 0,
    )
