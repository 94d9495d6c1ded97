"""A conjugate pair in one piece: the layers of both discs, and of a spacer between them.

Each disc is the part that it would be alone, but for the hub, which is that of the pair: the upper
disc bears the hub on its upper face, the lower disc that on its lower face. Both discs are in cam
coordinates, so the return disc is at 0 degrees to the main one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.contour.nearness import surely_apart
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger
from camgeo.outline.path import Path
from camgeo.outline.radii import radii
from camgeo.part.bevels import bevelled
from camgeo.part.boundaries import ExactBoundary, numbers_of
from camgeo.part.build import build_part
from camgeo.part.faces import BOTH, LOWER, UPPER
from camgeo.part.pair_spec import MAIN, RETURN, Pair
from camgeo.part.part import OF_RETURN, Boundary, Layer, Part
from camgeo.part.spec import PartSpec
from camgeo.wording import at_cam_angles

SPACER: Final = "spacer"
"""Name of the boundary, and of its layer."""

KEY: Final = "part.pair.spacer"


def build_pair(
    paths: tuple[Path, Path], spec: PartSpec, tolerance: float, ledger: Ledger | None = None
) -> Part:
    """The pair as one part, the upper face of its upper disc at height 0.

    Layers of the return disc have names that begin with `OF_RETURN`, and so have its boundaries
    where the main disc has others of those names; what both have in the same place, as the bore, is
    one boundary.

    Parameters
    ----------
    paths : the real outlines of main disc and return disc.
    spec : of the part, with the pair and a thickness.
    tolerance : as of `camgeo.part.build.build_part`.
    ledger : records fits of the flanks.

    Raises
    ------
    GeometryError
        With the key of the scene, if one of the discs is impossible with what it bears, the spacer
        does not lie within both and around the bore, or a hole or mark is not clear of it.
    """
    pair = spec.pair
    if pair is None or spec.thickness is None:
        raise GeometryError("a pair in one piece needs its thickness", key="part.pair")
    own: dict[str, Part] = {}
    for name, path in zip((MAIN, RETURN), paths, strict=True):
        bearing = _bearing(spec, pair, name)
        try:
            own[name] = build_part(Contact.INNER, path, path, bearing, tolerance, ledger)
        except GeometryError as error:
            message = f"{name} disc: {error.message}"
            raise GeometryError(message, error.key, error.value) from error
        _require_spacer_within(pair, path, name, tolerance)
    other = tuple(_returning(own[MAIN], own[RETURN]))
    main = own[MAIN].layers
    upper, lower = (main, other) if pair.upper == MAIN else (other, main)
    down = spec.thickness + pair.gap
    lower = tuple(replace(each, z0=each.z0 - down, z1=each.z1 - down) for each in lower)
    circle = ExactBoundary(SPACER, hole=False, exact=Contour.circle(0.5 * pair.spacer))
    within = _through(circle, upper[0], lower[-1], tolerance)
    between = Layer(lower[-1].z1, upper[0].z0, (circle, *within), SPACER)
    whole = Part((*lower, between, *upper))
    return whole if spec.chamfers is None else bevelled(whole, spec.chamfers, tolerance)


def _bearing(spec: PartSpec, pair: Pair, name: str) -> PartSpec:
    """A disc with the hub on its outer face, if there is one there, and with sharp edges."""
    disc, hub = replace(spec.alone(name), chamfers=None), spec.hub
    side = UPPER if name == pair.upper else LOWER
    if hub is None or hub.side not in (side, BOTH):
        return disc
    first = side == UPPER or hub.side == LOWER  # which has the set screw
    screw = spec.set_screw if first else None
    return replace(disc, hub=replace(hub, side=side), set_screw=screw)


def _require_spacer_within(pair: Pair, path: Path, name: str, tolerance: float) -> None:
    nearest = radii(path).lowest
    if 0.5 * pair.spacer + tolerance >= nearest.value:
        raise GeometryError(
            f"the spacer reaches {0.5 * pair.spacer:.6g} mm from the cam axis, but the flank of the"
            f" {name} disc comes as near as {nearest.value:.6g} mm {at_cam_angles(nearest.place)}",
            key=KEY,
            value=f"{pair.spacer:g}",
        )


def _returning(main: Part, other: Part) -> Iterator[Layer]:
    """The layers of the return disc, with its own names, and the boundaries shared with `main`."""
    taken = {each.name: each for each in main.boundaries}
    known: dict[str, Boundary] = {}

    def own(boundary: Boundary) -> Boundary:
        name = boundary.name
        if name not in known:
            there = taken.get(name)
            if there is None:
                known[name] = boundary
            else:
                known[name] = there if _alike(boundary, there) else _renamed(boundary)
        return known[name]

    outline = other.outermost
    for layer in other.layers:
        name = f"{OF_RETURN}{layer.name}" if outline in layer.boundaries else layer.name
        yield replace(layer, boundaries=tuple(map(own, layer.boundaries)), name=name)


def _alike(one: Boundary, other: Boundary) -> bool:
    if not (isinstance(one, ExactBoundary) and isinstance(other, ExactBoundary)):
        return False
    return one.hole == other.hole and numbers_of(one.exact) == numbers_of(other.exact)


def _renamed(boundary: Any) -> Boundary:
    """A boundary that shares only its name with one of the main disc, like its flank."""
    name = boundary.name
    found: Boundary = replace(boundary, name=f"{OF_RETURN}{name}")
    return found


def _through(
    circle: ExactBoundary, upper: Layer, lower: Layer, tolerance: float
) -> tuple[Boundary, ...]:
    """The holes that go through the spacer, as through both discs.

    Raises GeometryError if one touches the spacer, or ends at it.
    """
    sides = [list(_inside(circle, layer, tolerance)) for layer in (upper, lower)]
    for one, other in (sides, sides[::-1]):
        for each in one:
            if each not in other:
                raise GeometryError(f"the {each.name} ends under the spacer", key=KEY)
    return tuple(sides[0])


def _inside(circle: ExactBoundary, layer: Layer, tolerance: float) -> Iterator[Boundary]:
    """The boundaries of a disc within the spacer."""
    ring = circle.beside(tolerance)
    for each in layer.boundaries[1:]:
        fit = each.beside(tolerance)
        if surely_apart(ring, fit) <= 0.0:
            raise GeometryError(
                f"the spacer must lie clear of the {each.name}, which it touches", key=KEY
            )
        if winding_number(fit.contour, complex(circle.exact.vertices[0])):
            raise GeometryError(f"the {each.name} lies around the spacer", key=KEY)
        if winding_number(circle.exact, complex(fit.contour.vertices[0])):
            yield each
