"""The part of a disc, judged: size, mass properties, walls, and their limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import BROKEN, Finding, held, stated_in
from camgeo.design.product import bodies_of, relation_of
from camgeo.errors import CamgeoError, GeometryError, ToleranceError
from camgeo.part.mass import (
    SHARE,
    Solid,
    Web,
    largest_diameter,
    section_area,
    solid,
    surely_thick,
    thinnest_of_each,
)
from camgeo.part.materials import KG_M3
from camgeo.units import at_cam_angles

if TYPE_CHECKING:
    from camgeo.design.product import Product
    from camgeo.numeric.arrays import FloatArray
    from camgeo.part.part import Part
    from camgeo.part.spec import PartSpec
    from camgeo.scene.scene import Scene

KG: Final = 1e3
"""From t to kg, and from t mm^2 to kg mm^2."""

SMALLEST_WALL: Final = "smallest-wall"
"""Name of the finding on the thinnest material between two boundaries."""

WALL_RATIO: Final = "wall-ratio"
"""Name of the finding on the material that is thinnest as a share of its hole."""

SET_SCREW: Final = "set-screw"
"""Name of the finding on a hole that no file has."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A layer of the part: its name, the heights of its faces [mm], and its area [mm^2]."""

    name: str
    z0: float
    z1: float
    area: float


@dataclass(frozen=True, slots=True)
class Body:
    """The part as a body.

    Attributes
    ----------
    solid : its volume and moments.
    density : [t/mm^3]; None if the scene does not state it.
    """

    solid: Solid
    density: float | None

    @property
    def stated_density(self) -> float | None:
        """The density [kg/m^3]."""
        return None if self.density is None else KG_M3 * self.density

    @property
    def mass(self) -> float | None:
        """The mass [kg]."""
        return None if self.density is None else KG * self.density * self.solid.volume

    @property
    def axial_inertia(self) -> float | None:
        """The moment of inertia about the cam axis [kg mm^2]."""
        return None if self.density is None else KG * self.density * self.solid.axial

    @property
    def inertia(self) -> FloatArray | None:
        """(3, 3) inertia tensor about the centre of mass [kg mm^2]."""
        return None if self.density is None else KG * self.density * self.solid.inertia


@dataclass(frozen=True, slots=True)
class PartFound:
    """What is found of a part.

    Attributes
    ----------
    diameter : of the circle about the cam axis that it sweeps [mm]; None if there is no such part.
    layers : from the lowest upward; empty if there is no such part.
    body : None if the scene does not state all heights.
    findings : diameter, mass and smallest wall, with their limits, what no file has, and what a
        printer does not make; or why there is no such part.
    """

    diameter: float | None
    layers: tuple[Slice, ...]
    body: Body | None
    findings: tuple[Finding, ...]


def part_of(disc: Product) -> PartFound:
    """The part of a disc that exists."""
    try:
        part = disc.drawn.part
    except (GeometryError, ToleranceError) as error:
        return PartFound(None, (), None, (_impossible(disc, error),))
    body = _body(disc, part)
    layers = tuple(Slice(each.name, each.z0, each.z1, section_area(each)) for each in part.layers)
    return PartFound(largest_diameter(part)[0], layers, body, _findings(disc, part, body))


def findings_on(disc: Product) -> tuple[Finding, ...]:
    """The findings of `part_of`; of a scene that states nothing of a part, none."""
    if not _stated(disc.scene):
        return ()
    try:
        part = disc.drawn.part
    except (GeometryError, ToleranceError) as error:
        return (_impossible(disc, error),)
    body = None if _density(disc.scene) is None else _body(disc, part)
    return _findings(disc, part, body)


def _impossible(disc: Product, error: CamgeoError) -> Finding:
    """Why there is no such part."""
    disc.scene.restate(error)
    return Finding("part", "invalid", str(error))


def _stated(scene: Scene) -> bool:
    """Whether a scene says anything of the part, or what it must hold."""
    return scene.part is not None or scene.limits.diameter is not None


def _findings(disc: Product, part: Part, body: Body | None) -> tuple[Finding, ...]:
    limits = disc.scene.limits
    diameter = _diameter(part, limits.diameter)
    walls = (*_smallest_wall(part, limits.wall), *_set_screw(disc.drawn.spec), *_printed(disc))
    mass = (*_mass(body, limits.mass), *_mass_of_both(disc, body))
    return stated_in(disc.unit, (*relation_of(disc), diameter, *mass, *walls))


def broken_in(disc: Product) -> tuple[Finding, ...]:
    """The findings of `findings_on` beyond a limit, of which only what may be one is computed."""
    return tuple(each for each in _poor(disc, warned=False) if each.severity in BROKEN)


def poor_in(disc: Product) -> tuple[Finding, ...]:
    """The same with those worth a warning. What makes a part impossible is left to its files."""
    found = _poor(disc, warned=True)
    return tuple(each for each in found if each.severity not in ("ok", "invalid"))


def _poor(disc: Product, *, warned: bool) -> tuple[Finding, ...]:
    """What may be poor, with what is worth no more than a warning if `warned`."""
    if not _stated(disc.scene):
        return ()
    try:
        part = disc.drawn.part
    except (GeometryError, ToleranceError) as error:
        return (_impossible(disc, error),)
    limits, found = disc.scene.limits, [*relation_of(disc), *_set_screw(disc.drawn.spec)]
    if limits.diameter is not None:
        found.append(_diameter(part, limits.diameter))
    if limits.mass is not None:
        found += _mass(_body(disc, part), limits.mass)
    if (warned or limits.wall is not None) and not surely_thick(part, limits.wall):
        found += _smallest_wall(part, limits.wall)
    printing = disc.scene.printing
    if printing is not None and (printing.nozzle is not None or not warned):
        found += _printed(disc)  # without a nozzle the files say that nothing is compensated
    return stated_in(disc.unit, found)


def _diameter(part: Part, limit: float | None) -> Finding:
    """The largest diameter."""
    diameter, angle = largest_diameter(part)
    where = "" if angle is None else f" {at_cam_angles(angle)}"
    statement = f"largest diameter {diameter:.6g} mm{where}"
    return held("largest-diameter", statement, diameter, limit, "mm", angle)


def _body(disc: Product, part: Part) -> Body | None:
    """The part as a body; None if the scene does not state all heights."""
    try:
        return Body(solid(part), _density(disc.scene))
    except GeometryError:
        return None


def _mass(body: Body | None, limit: float | None) -> Iterator[Finding]:
    """The mass, where the scene states the density; the limit in t."""
    if body is not None and body.mass is not None:
        most = None if limit is None else KG * limit
        yield held("mass", f"mass {body.mass:.6g} kg", body.mass, most, "kg")


def _mass_of_both(disc: Product, body: Body | None) -> Iterator[Finding]:
    """Of a main disc and a return disc that is another piece, where the density is stated."""
    apart = disc.others and not disc.is_pair and disc.pair is None
    if not apart or body is None or body.density is None:
        return
    try:
        solids = [body.solid, *(solid(other.drawn.part) for other in disc.others)]
    except (GeometryError, ToleranceError):  # which the other disc reports
        return
    weight = KG * body.density
    mass = math.fsum(weight * each.volume for each in solids)
    inertia = math.fsum(weight * each.axial for each in solids)
    sentence = (
        f"mass of both discs {mass:.6g} kg, moment of inertia about the cam axis {inertia:.6g} kg"
        " mm^2"
    )
    yield Finding("mass-of-both-discs", "ok", sentence, mass, unit="kg")


def _smallest_wall(part: Part, limit: float | None) -> Iterator[Finding]:
    """The thinnest wall between two boundaries; without a limit also that which is thinnest beside
    its hole, a warning if it is thinner than usual.
    """
    web, beside = thinnest_of_each(part, limit)
    if web is None:
        return
    statement = f"smallest wall {web.thickness:.6g} mm, {_place(web)}"
    yield held(SMALLEST_WALL, statement, web.thickness, limit, "mm", least=True)
    if beside is None:
        return
    thin = beside.thickness < beside.usual
    share = SHARE * beside.thickness / beside.usual
    sentence = (
        f"thinnest wall beside its hole {beside.thickness:.6g} mm, {_place(beside)}:"
        f" {100.0 * share:.3g}% of the diameter of the hole, {'below' if thin else 'at least'}"
        f" {SHARE:.0%}, {beside.usual:.4g} mm"
    )
    yield Finding(WALL_RATIO, "warning" if thin else "ok", sentence, share, SHARE)


def _place(web: Web) -> str:
    at = f"({web.place.real:.4g}, {web.place.imag:.4g}) mm"
    return f"between {web.one} and {web.other}, at {at}"


def _set_screw(spec: PartSpec | None) -> Iterator[Finding]:
    """What upright walls cannot show."""
    if spec is None or spec.set_screw is None:
        return
    screw = spec.set_screw
    angle = math.degrees(screw.angle)
    yield Finding(
        SET_SCREW,
        "warning",
        f"the radial hole of the set screw, {screw.diameter:g} mm in diameter, {screw.height:g} mm"
        f" above the face of the disc in the direction {angle:g} deg, is in no file and in no mass:"
        " it is drilled by the drawing",
    )


def _printed(disc: Product) -> Iterator[Finding]:
    """Whether the part can be compensated as the scene asks, and what the nozzle cannot make."""
    spec = disc.scene.printing
    if spec is None or not any(each is disc for each in bodies_of(disc)):
        return  # of a pair in one piece only that is printed
    from camgeo.design.drawn import COMPENSATED

    printed = disc.drawn.printed
    try:
        fitted = printed.fitted
        printed.target  # noqa: B018  # it is asked whether there is one
    except (GeometryError, ToleranceError) as error:
        yield Finding(COMPENSATED, "broken", str(error))
        return
    if spec.nozzle is not None:
        from camgeo.part.nozzle import findings_of

        yield from findings_of(fitted, spec.nozzle)


def _density(scene: Scene) -> float | None:
    """Of the part [t/mm^3], where the scene states it."""
    return None if scene.part is None else scene.part.density
