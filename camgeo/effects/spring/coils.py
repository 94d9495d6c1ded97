"""Stress, closure and buckling of a helical spring over the turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding, Severity
from camgeo.effects.effect import Column
from camgeo.effects.wording import at, placed
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity
    from camgeo.effects.helical import HelicalSpring
    from camgeo.numeric.extremes import Extremes

INDICES: Final = (4.0, 12.0)
"""Spring indices that can be wound well (Shigley, 8th ed., eq. 10-18)."""

OVERRUN: Final = 0.15
"""Share of the largest deflection that should be left to closure (as above, eq. 10-20)."""


@dataclass(frozen=True, slots=True)
class Wound:
    """What the wire adds to the spring: findings, and columns over the cam angle."""

    findings: tuple[Finding, ...]
    columns: tuple[Column, ...]


def of_wire(helical: HelicalSpring, force: Quantity, found: Extremes) -> Wound:
    """Of the `force` (n,) [N], with its extremes `found`."""
    per_force = helical.stress_per_force

    def stress(phi: FloatArray, side: Side) -> FloatArray:
        return per_force * force(phi, side)

    return Wound(
        (
            *_wire(helical),
            *_stresses(helical, found),
            *_closure(helical, found.highest),
            _buckling(helical),
        ),
        (Column("spring stress", "MPa", stress, helical.strength),),
    )


def _wire(helical: HelicalSpring) -> tuple[Finding, Finding]:
    """Its stiffness and its index."""
    stiffness, index = helical.stiffness, helical.index
    least, most = INDICES
    inside = least <= index <= most
    return (
        Finding(
            "spring-stiffness",
            "ok",
            f"stiffness of the helical spring {stiffness:.6g} N/mm",
            stiffness,
            unit="N/mm",
        ),
        Finding(
            "spring-index",
            "ok" if inside else "warning",
            f"spring index {index:.4g}, {'within' if inside else 'outside'} {least:g} to {most:g},"
            " in which springs are easily wound",
            index,
            most if index > most else least,
        ),
    )


def _stresses(helical: HelicalSpring, found: Extremes) -> tuple[Finding, ...]:
    """Largest, smallest and solid stress, against the strength."""
    per_force, strength = helical.stress_per_force, helical.strength

    def verdict(stress: float, beyond: Severity) -> tuple[str, Severity]:
        if strength is None:
            return "; no strength of the wire is stated", "ok"
        if stress > strength:
            return f", above {strength:g} MPa", beyond
        return f", at most {strength:g} MPa", "ok"

    largest, smallest = (
        Extreme(per_force * end.value, end.place) for end in (found.highest, found.lowest)
    )
    solid = per_force * helical.solid_force
    words, severity = verdict(largest.value, "broken")
    closed, warned = verdict(solid, "warning")
    return (
        placed(
            "largest-spring-stress",
            f"largest shear stress of the spring {largest.value:.6g} MPa {at(largest.place)}"
            f"{words}",
            largest,
            "MPa",
            strength,
            severity,
        ),
        placed(
            "smallest-spring-stress",
            f"smallest shear stress of the spring {smallest.value:.6g} MPa {at(smallest.place)}",
            smallest,
            "MPa",
        ),
        Finding(
            "solid-spring-stress",
            warned,
            f"shear stress of the spring with all coils touching, under {helical.solid_force:.6g}"
            f" N, {solid:.6g} MPa{closed}",
            solid,
            strength,
            "MPa",
        ),
    )


def _closure(helical: HelicalSpring, highest: Extreme) -> tuple[Finding, ...]:
    """How much farther than to its largest force it can be compressed; none if never compressed."""
    if not highest.value > 0.0:
        return ()
    solid = helical.solid_length
    shortest = helical.free_length - highest.value / helical.stiffness
    overrun = helical.solid_force / highest.value - 1.0
    length = f"shortest length of the spring {shortest:.6g} mm {at(highest.place)}"
    severity: Severity = "ok"
    if overrun < 0.0:
        sentence, severity = f"{length}: its coils touch at {solid:.6g} mm", "broken"
    else:
        little = overrun < OVERRUN
        sentence = (
            f"{length}; its coils touch at {solid:.6g} mm, after {100.0 * overrun:.4g} % more"
            f" deflection, {'below' if little else 'at least'} {100.0 * OVERRUN:g} %"
        )
        severity = "warning" if little else "ok"
    end = Extreme(overrun, highest.place)
    return (placed("spring-closure", sentence, end, "", OVERRUN, severity),)


def _buckling(helical: HelicalSpring) -> Finding:
    free, stable = helical.free_length, helical.stable_length
    severity: Severity
    if free < stable:
        end, severity = f"below {stable:.6g} mm: it cannot buckle", "ok"
    else:
        end = f"not below {stable:.6g} mm: it may buckle unless it is guided"
        severity = "warning"
    return Finding(
        "spring-buckling",
        severity,
        f"free length of the spring {free:.6g} mm, {end}",
        free,
        stable,
        "mm",
    )
