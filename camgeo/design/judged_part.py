"""The assessment of a disc's part: size, mass properties and walls, with their limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import BROKEN, Finding, findings_in_unit, limit_finding
from camgeo.design.product import solid_products
from camgeo.errors import CamgeoError, GeometryError, ToleranceError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, piecewise_highest
from camgeo.part.mass import SHARE, Solid, Web, largest_diameter, section_area
from camgeo.part.materials import KG_M3
from camgeo.part.spec import MAIN, Pair, PartSpec
from camgeo.units import TURN, at_cam_angles, listed

if TYPE_CHECKING:
    from camgeo.design.product import Product
    from camgeo.part.part import Part
    from camgeo.scene.scene import Scene

KG: Final = 1e3
"""From t to kg, and from t mm^2 to kg mm^2."""

SMALLEST_WALL: Final = "smallest-wall"
"""Name of the finding on the thinnest material between two boundaries."""

WALL_RATIO: Final = "wall-ratio"
"""Name of the finding on the material that is thinnest as a share of its hole."""

SET_SCREW: Final = "set-screw"
"""Name of the finding on the hole of a set screw, which no file has."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A layer of the part: its name, the heights of its faces [mm], and its area [mm^2]."""

    name: str
    z0: float
    z1: float
    area: float


@dataclass(frozen=True, slots=True)
class PartBody:
    """The part as a body.

    Attributes
    ----------
    solid : volume and moments of the part.
    density : density [t/mm^3]; None if the scene does not state it.
    """

    solid: Solid
    density: float | None

    @property
    def stated_density(self) -> float | None:
        """The density [kg/m^3]; None if it is not stated."""
        return None if self.density is None else KG_M3 * self.density

    @property
    def mass(self) -> float | None:
        """The mass [kg]; None without a density."""
        return None if self.density is None else KG * self.density * self.solid.volume

    @property
    def axial_inertia(self) -> float | None:
        """The moment of inertia about the cam axis [kg mm^2]; None without a density."""
        return None if self.density is None else KG * self.density * self.solid.axial

    @property
    def inertia(self) -> FloatArray | None:
        """(3, 3) inertia tensor about the centre of mass [kg mm^2]; None without a density."""
        return None if self.density is None else KG * self.density * self.solid.inertia


@dataclass(frozen=True, slots=True)
class PartAssessment:
    """The properties of a part, and the findings on it.

    Attributes
    ----------
    diameter : diameter of the circle about the cam axis that the part sweeps [mm]; None if there is
        no such part.
    layers : layers of the part from the lowest upward; empty if there is no such part.
    body : the part as a body; None if the scene does not state all heights.
    findings : findings on diameter, mass and smallest wall, with their limits, on what no file has,
        and on what a printer cannot make; or why there is no such part.
    """

    diameter: float | None
    layers: tuple[Slice, ...]
    body: PartBody | None
    findings: tuple[Finding, ...]

    @staticmethod
    def from_disc(disc: Product) -> PartAssessment:
        """The assessment of the part of a disc that exists."""
        try:
            part = disc.drawn.part
        except (GeometryError, ToleranceError) as error:
            return PartAssessment(None, (), None, (_impossible(disc, error),))
        body = _body(disc, part)
        layers = tuple(
            Slice(layer.name, layer.z0, layer.z1, section_area(layer)) for layer in part.layers
        )
        return PartAssessment(largest_diameter(part)[0], layers, body, _findings(disc, part, body))


def part_findings(disc: Product) -> tuple[Finding, ...]:
    """The findings of `PartAssessment.from_disc`; none if the scene states nothing of a part."""
    if not _stated(disc.scene):
        return ()
    try:
        part = disc.drawn.part
    except (GeometryError, ToleranceError) as error:
        return (_impossible(disc, error),)
    body = None if _density(disc.scene) is None else _body(disc, part)
    return _findings(disc, part, body)


def _impossible(disc: Product, error: CamgeoError) -> Finding:
    """The finding that there is no such part, with the reason in the unit of the scene."""
    disc.scene.restate(error)
    return Finding("part", "invalid", str(error))


def _stated(scene: Scene) -> bool:
    """Whether a scene states anything about the part, or limits its diameter."""
    return scene.part is not None or scene.limits.diameter is not None


def _findings(disc: Product, part: Part, body: PartBody | None) -> tuple[Finding, ...]:
    limits = disc.scene.limits
    diameter = _diameter(part, limits.diameter)
    walls = (*_smallest_wall(part, limits.wall), *_set_screw(disc.drawn.spec), *_printed(disc))
    mass = (*_mass(body, limits.mass), *_combined_mass(disc, body))
    return findings_in_unit(disc.unit, (*relation_findings(disc), diameter, *mass, *walls))


def broken_findings(disc: Product) -> tuple[Finding, ...]:
    """The findings of `part_findings` beyond a limit; only what may be beyond one is computed."""
    return tuple(
        finding for finding in _suspect_findings(disc, warned=False) if finding.severity in BROKEN
    )


def poor_findings(disc: Product) -> tuple[Finding, ...]:
    """The findings beyond a limit or worth a warning; what makes a part impossible is left out, as
    its files report that.
    """
    findings = _suspect_findings(disc, warned=True)
    return tuple(finding for finding in findings if finding.severity not in ("ok", "invalid"))


def _suspect_findings(disc: Product, *, warned: bool) -> tuple[Finding, ...]:
    """The findings that may be poor; with `warned` also those that can only be a warning."""
    if not _stated(disc.scene):
        return ()
    try:
        part = disc.drawn.part
    except (GeometryError, ToleranceError) as error:
        return (_impossible(disc, error),)
    limits, findings = disc.scene.limits, [*relation_findings(disc), *_set_screw(disc.drawn.spec)]
    if limits.diameter is not None:
        findings.append(_diameter(part, limits.diameter))
    if limits.mass is not None:
        findings += _mass(_body(disc, part), limits.mass)
    if (warned or limits.wall is not None) and not Web.surely_thick(part, limits.wall):
        findings += _smallest_wall(part, limits.wall)
    printing = disc.scene.printing
    if printing is not None and (printing.nozzle is not None or not warned):
        findings += _printed(disc)  # without a nozzle the files say that nothing is compensated
    return findings_in_unit(disc.unit, findings)


def _diameter(part: Part, limit: float | None) -> Finding:
    """Compare the largest diameter with its limit [mm]."""
    diameter, angle = largest_diameter(part)
    where = "" if angle is None else f" {at_cam_angles(angle)}"
    statement = f"largest diameter {diameter:.6g} mm{where}"
    return limit_finding("largest-diameter", statement, diameter, limit, "mm", angle)


def _body(disc: Product, part: Part) -> PartBody | None:
    """The part as a body; None if the scene does not state all heights."""
    try:
        return PartBody(Solid.from_part(part), _density(disc.scene))
    except GeometryError:
        return None


def _mass(body: PartBody | None, limit: float | None) -> Iterator[Finding]:
    """Compare the mass with its limit [t], if the scene states the density."""
    if body is not None and body.mass is not None:
        most = None if limit is None else KG * limit
        yield limit_finding("mass", f"mass {body.mass:.6g} kg", body.mass, most, "kg")


def _combined_mass(disc: Product, body: PartBody | None) -> Iterator[Finding]:
    """Report the mass of a main disc and a return disc of two pieces, if the density is stated."""
    is_separate = disc.others and not disc.is_pair and disc.pair is None
    if not is_separate or body is None or body.density is None:
        return
    try:
        solids = [body.solid, *(Solid.from_part(other.drawn.part) for other in disc.others)]
    except (GeometryError, ToleranceError):  # the other disc has a finding on that
        return
    weight = KG * body.density
    mass = math.fsum(weight * solid.volume for solid in solids)
    inertia = math.fsum(weight * solid.axial for solid in solids)
    sentence = (
        f"mass of both discs {mass:.6g} kg, moment of inertia about the cam axis {inertia:.6g} kg"
        " mm^2"
    )
    yield Finding("mass-of-both-discs", "ok", sentence, mass, unit="kg")


def _smallest_wall(part: Part, limit: float | None) -> Iterator[Finding]:
    """Compare the thinnest wall between two boundaries with its limit [mm].

    Without a limit also report the wall that is thinnest for its hole, with a warning if it is
    thinner than usual.
    """
    web, slimmest = Web.thinnest_webs(part, limit)
    if web is None:
        return
    statement = f"smallest wall {web.thickness:.6g} mm, {_place(web)}"
    yield limit_finding(SMALLEST_WALL, statement, web.thickness, limit, "mm", least=True)
    if slimmest is None:
        return
    thin = slimmest.thickness < slimmest.usual
    share = SHARE * slimmest.thickness / slimmest.usual
    sentence = (
        f"thinnest wall for its hole {slimmest.thickness:.6g} mm, {_place(slimmest)}:"
        f" {100.0 * share:.3g}% of the diameter of the hole, {'below' if thin else 'at least'}"
        f" {SHARE:.0%}, {slimmest.usual:.4g} mm"
    )
    yield Finding(WALL_RATIO, "warning" if thin else "ok", sentence, share, SHARE)


def _place(web: Web) -> str:
    place = f"({web.place.real:.4g}, {web.place.imag:.4g}) mm"
    return f"between {web.one} and {web.other}, at {place}"


def _set_screw(spec: PartSpec | None) -> Iterator[Finding]:
    """Warn of the radial hole of a set screw, which prismatic layers cannot show."""
    if spec is None or spec.set_screw is None:
        return
    screw = spec.set_screw
    angle = math.degrees(screw.angle)
    yield Finding(
        SET_SCREW,
        "warning",
        f"the radial hole of the set screw, {screw.diameter:g} mm in diameter, {screw.height:g} mm"
        f" above the face of the disc in the direction {angle:g} deg, is in no file and not taken"
        " off the mass: drill it by the drawing",
    )


def _printed(disc: Product) -> Iterator[Finding]:
    """Report a part that cannot be compensated as stated, and what the nozzle cannot make."""
    spec = disc.scene.printing
    if spec is None or not any(body is disc for body in solid_products(disc)):
        return  # the discs of a pair in one piece are not printed, but the piece
    from camgeo.design.drawn import COMPENSATED

    printed = disc.drawn.printed
    try:
        fitted = printed.fitted
        printed.target  # noqa: B018  # it is asked whether there is one
    except (GeometryError, ToleranceError) as error:
        yield Finding(COMPENSATED, "broken", str(error))
        return
    if spec.nozzle is not None:
        from camgeo.part.nozzle import nozzle_findings

        yield from nozzle_findings(fitted, spec.nozzle)


def _density(scene: Scene) -> float | None:
    """Density of the part [t/mm^3]; None if the scene does not state it."""
    return None if scene.part is None else scene.part.density


# -- relation -------------------------------------------------------------------------------------
# How the two discs of a conjugate pair stand to each other on their shaft.
#
# Both outlines are in cam coordinates, the frame at cam angle 0, so the return disc is at 0 degrees
# to the main one. Turned from there by a small angle d, it would hold the follower at s(phi + d)
# where the main disc holds it at s(phi): the pair opens or squeezes by s' d, as travel of the
# follower, and by the reach of the main roller times that, as travel of that roller.


ANGLE: Final = 0.0
"""Angle of the return disc relative to the main disc [degrees]."""

DISC_ANGLE: Final = "disc-angle"
ROLLER_WIDTH: Final = "roller-width"
"""Names of the findings on both discs together."""


def relation_findings(disc: Product) -> tuple[Finding, ...]:
    """The findings on both discs together, if the scene states a part.

    They are reported for the pair in one piece, or for the main disc if the return disc is another
    piece, and not for any other disc.
    """
    spec = disc.scene.part
    if not disc.others or spec is None:
        return ()
    if disc.is_pair:
        assert spec.pair is not None  # of which this is
        features = _angle_features(spec)
        sentence = f"{in_one_piece(spec.pair)}{f'; {listed(features)}' if features else ''}"
        angle = Finding(DISC_ANGLE, "ok", sentence, ANGLE, unit="deg")
        return (angle, _room(disc, spec, spec.pair))
    return () if spec.pair is not None else (_two_piece_finding(disc, spec),)


def in_one_piece(pair: Pair) -> str:
    """How the discs of a pair in one piece stand to each other, in words."""
    side = "below" if pair.upper == MAIN else "above"
    return (
        f"both discs in one piece: the return disc at {ANGLE:g} deg to the main disc, {side} it,"
        f" with a gap of {pair.gap:.6g} mm"
    )


def _two_piece_finding(main: Product, spec: PartSpec) -> Finding:
    statement = f"the return disc must be mounted at {ANGLE:g} deg to the main disc, as drawn"
    steepest, limit = _steepest(main), main.scene.limits.closing_error
    # Turned by a small angle, the pair opens or squeezes by the travel per radian times that angle.
    if steepest.value > 0.0:
        angle = math.degrees(limit / steepest.value)
        statement += (
            f"; if it is off by {angle:.3g} deg, the rollers have {limit:g} mm of play or squeeze"
            f" {at_cam_angles(steepest.place)}"
        )
    features, bolts = _angle_features(spec), spec.bolt_circle
    doubt = ""
    if not features:
        doubt = "nothing on the discs shows this angle: neither keyway, flat, mark nor bolt circle"
    elif len(features) == 1 and bolts is not None and bolts.count > 1:
        doubt = f"the bolt holes fit in {bolts.count} positions, of which one is right"
    if doubt:
        return Finding(DISC_ANGLE, "warning", f"{statement}; {doubt}", ANGLE, unit="deg")
    statement = f"{statement}; in line on both discs: {listed(features)}"
    return Finding(DISC_ANGLE, "ok", statement, ANGLE, unit="deg")


def _angle_features(spec: PartSpec) -> list[str]:
    """The features, in words, that show the angle of a disc, at the same place of both discs."""
    named = {
        "keyway": spec.keyway,
        "flat of the bore": spec.d_shaft,
        "timing mark": spec.mark,
        "first bolt hole": spec.bolt_circle,
    }
    return [
        f"{name} at {math.degrees(feature.angle):g} deg"
        for name, feature in named.items()
        if feature is not None
    ]


def _steepest(main: Product) -> Extreme:
    """The largest travel of the main roller per radian of the cam [mm], and its cam angle [rad]."""
    drive = main.cam.drive
    reach = abs(main.cam.follower.reach)

    def speed(phi: FloatArray, side: Side) -> FloatArray:
        speeds: FloatArray = reach * np.abs(drive.motion.jet(phi, side)[1])
        return speeds

    edges = merged(np.concatenate((drive.smooth_angles, [0.0, TURN])))
    return piecewise_highest(speed, edges)


def _room(main: Product, spec: PartSpec, pair: Pair) -> Finding:
    """Report how wide the rollers may be before one reaches the other disc, or both meet."""
    assert spec.thickness is not None  # a pair has one
    one, other = (cam.follower for cam in main.judgement.cams)
    distance = abs(one.traced_point(0.0) - other.traced_point(0.0))
    near = distance <= one.roller_radius + other.roller_radius
    # A roller in the middle of its disc overhangs on both sides: by half the gap at most where the
    # two rollers are near each other, else by the whole gap.
    most = spec.thickness + (1.0 if near else 2.0) * pair.gap
    reached = "the rollers reach each other" if near else "one reaches the other disc"
    widest = f"in the middle of their discs rollers may be {most:g} mm wide before {reached}"
    if pair.roller_width is None:
        return Finding(ROLLER_WIDTH, "ok", widest, most, unit="mm")
    statement = f"rollers {pair.roller_width:g} mm wide; {widest}"
    return limit_finding(ROLLER_WIDTH, statement, pair.roller_width, most, "mm")
