"""Findings of the contact pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from camgeo.check.finding import Finding, held
from camgeo.effects.contact_pressure.life import Life
from camgeo.effects.contact_pressure.line_contact import (
    SHEAR_DEPTH,
    SHEAR_SHARE,
    half_width,
    largest_pressure,
    needed_radius,
    roller_radii,
)
from camgeo.effects.contact_pressure.table import PressureRequirements
from camgeo.effects.wording import at, placed
from camgeo.numeric.extremes import Extreme
from camgeo.units import RPM

HOUR: Final = 3600.0

LONGEST: Final = 1e6
"""A life [h] of more than a century is not told in figures: no bearing ends by fatigue alone then,
which is all that the formula knows."""

HEAVY: Final = 0.5
"""Share of the dynamic load rating up to which the life formula applies (ISO 281:2007)."""


@dataclass(frozen=True, slots=True)
class Worst:
    """The contact where the pressure is largest.

    Attributes
    ----------
    angle : cam angle [rad] in [0, 2 pi).
    flank : "inner" or "outer".
    load : force on the follower [N]; 0 if there is never any.
    radius : R, of the relative curvature [mm].
    curvature : of the pitch curve, positive if convex towards the follower [1/mm].
    roller : r_R [mm]; None with a flat face.
    width : L [mm].
    """

    angle: float
    flank: str
    load: float
    radius: float
    curvature: float
    roller: float | None
    width: float

    @property
    def place(self) -> str:
        """The place in words."""
        return at(self.angle)

    def pressure(self, modulus: float) -> float:
        """p [MPa] for E* `modulus` [MPa]; 0 without force, whatever the radius."""
        if not self.load > 0.0:
            return 0.0
        return largest_pressure(self.load / self.width, modulus, self.radius)


def pressure_findings(worst: Worst, data: PressureRequirements) -> tuple[Finding, ...]:
    """Pressure, safety, subsurface shear and half width; needed width and roller radius."""
    pressure = worst.pressure(data.modulus)
    if not pressure > 0.0:
        return (
            Finding(
                name="largest-contact-pressure",
                severity="ok",
                sentence=(
                    f"nothing presses the {'roller' if worst.roller else 'face'} on its flank:"
                    " there is no contact pressure"
                ),
                value=0.0,
                limit=data.limit,
                unit="MPa",
            ),
        )
    safety = data.limit / pressure
    beyond = pressure > data.limit
    shear = SHEAR_SHARE * pressure
    width = half_width(worst.load / worst.width, data.modulus, worst.radius)
    depth = SHEAR_DEPTH * width
    return (
        placed(
            "largest-contact-pressure",
            f"largest contact pressure {pressure:.6g} MPa on the {worst.flank} flank {worst.place},"
            f" {'above' if beyond else 'at most'} {data.limit:g} MPa; the force is"
            f" {worst.load:.6g} N, the radius of relative curvature {worst.radius:.6g} mm",
            Extreme(pressure, worst.angle),
            "MPa",
            data.limit,
            "broken" if beyond else "ok",
        ),
        held(
            "pressure-safety",
            f"smallest safety against a contact pressure of {data.limit:g} MPa is {safety:.4f}"
            f" {worst.place}",
            safety,
            data.safety,
            cam_angle=worst.angle,
            least=True,
        ),
        placed(
            "largest-subsurface-shear",
            f"largest shear below the surface {shear:.6g} MPa {worst.place}, {depth:.6g} mm deep",
            Extreme(shear, worst.angle),
            "MPa",
        ),
        placed(
            "subsurface-shear-depth",
            f"depth of the largest shear {depth:.6g} mm {worst.place}",
            Extreme(depth, worst.angle),
            "mm",
        ),
        placed(
            "contact-half-width",
            f"half width of the contact {width:.6g} mm {worst.place}",
            Extreme(width, worst.angle),
            "mm",
        ),
        _needed_width(worst, pressure, data),
        _needed_radius(worst, data) if worst.roller is None else _needed_roller(worst, data),
    )


def _needed_width(worst: Worst, pressure: float, data: PressureRequirements) -> Finding:
    needed = worst.width * (pressure / data.allowed) ** 2
    sentence = (
        f"width of contact needed for {data.allowed:.6g} MPa {worst.place}: {needed:.6g}"
        f" mm; it has {worst.width:g} mm"
    )
    return placed("needed-width", sentence, Extreme(needed, worst.angle), "mm")


def _needed_radius(worst: Worst, data: PressureRequirements) -> Finding:
    """The radius of curvature of the cam at which a flat face has the allowed pressure."""
    needed = needed_radius(worst.load / worst.width, data.modulus, data.allowed)
    sentence = (
        f"radius of curvature of the cam needed for {data.allowed:.6g} MPa {worst.place}:"
        f" {needed:.6g} mm; it is {worst.radius:.6g} mm"
    )
    return placed("needed-radius-of-curvature", sentence, Extreme(needed, worst.angle), "mm")


def _needed_roller(worst: Worst, data: PressureRequirements) -> Finding:
    """The roller radius for the allowed pressure, with the same pitch curve and force."""
    assert worst.roller is not None  # a flat face has its own finding
    name, load = "needed-roller-radius", worst.load / worst.width
    radii = roller_radii(needed_radius(load, data.modulus, data.allowed), worst.curvature)
    goal = f"for {data.allowed:.6g} MPa {worst.place} with the same pitch curve"
    if radii is None:
        best = 0.5 / worst.curvature
        least = largest_pressure(load, data.modulus, 0.5 * best)
        return Finding(
            name=name,
            severity="warning",
            sentence=(
                f"no roller radius is sufficient {goal}: {best:.6g} mm gives the smallest pressure,"
                f" {least:.6g} MPa"
            ),
            cam_angle=worst.angle,
        )
    low, high = radii
    nearest = high if worst.roller > high else low
    upper = "or more" if math.isinf(high) else f"to {high:.6g} mm"
    sentence = f"roller radius needed {goal}: {low:.6g} mm {upper}; it is {worst.roller:g} mm"
    return placed(name, sentence, Extreme(nearest, worst.angle), "mm")


def life_findings(life: Life, data: PressureRequirements) -> tuple[Finding, ...]:
    """Life of the roller bearing, its equivalent load, and the speed of the roller."""
    assert data.rating is not None  # else there is no life
    speed = life.speed / RPM
    turning = Finding(
        name="roller-speed",
        severity="ok",
        sentence=f"the roller turns on its pin at a mean speed of {speed:.6g} rev/min",
        value=speed,
        unit="rev/min",
    )
    asked = None if data.life is None else data.life / HOUR
    if life.seconds is None:
        unlimited = (
            "nothing presses the roller on its flank, so the life of its bearing has no limit"
        )
        return (Finding("roller-life", "ok", unlimited, limit=asked, unit="h"), turning)
    hours = life.seconds / HOUR
    known = f"over {LONGEST:,.0f}" if hours > max(LONGEST, asked or 0.0) else f"{hours:.6g}"
    text = f"basic rating life of the roller bearing {known} h"
    heavy = life.load > HEAVY * data.rating
    most = HEAVY * data.rating
    return (
        held("roller-life", text, hours, asked, "h", least=True),
        Finding(
            name="equivalent-roller-load",
            severity="warning" if heavy else "ok",
            sentence=(
                f"equivalent load on the roller bearing {life.load:.6g} N,"
                f" {'above' if heavy else 'at most'} {most:g} N, half of its load rating"
                + (": its life is uncertain" if heavy else "")
            ),
            value=life.load,
            limit=most,
            unit="N",
        ),
        turning,
    )
