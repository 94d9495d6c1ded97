"""Effect `roller-spin`: how the roller turns, and the traction that keeps it rolling.

In the notation of `friction`, a roller that rolls on the flank s turns in the fixed frame at

    omega_R = (sigma - s sigma |Z'|/r_R) omega,

and relative to its pin at omega_R - chi' omega. With its moment of inertia J, the friction of its
bearing and of rolling, and the force T along t by which the cam turns it at the lever r_R, the
balance of moments about the pin is

    J d omega_R/dt = |N| (m_p + m_r) + s sigma r_R T.

It rolls while |T| is at most mu_T |N|, with the coefficient of traction mu_T. Where the roller of a
groove changes flanks, it must reverse its spin, and skids whatever the traction (Norton, Cam Design
and Manufacturing Handbook, on form-closed followers and roller slip; Newton's second law for
rotation). Each of the two rollers of a yoke keeps its sense of spin, but nothing drives it while
the other one carries. How far it skids is in `camgeo.effects.roller_spin.skid`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column, Request, Result
from camgeo.effects.ranges import ranges_below
from camgeo.effects.roller_spin import RollerData
from camgeo.effects.roller_spin.rolling import Rolling
from camgeo.effects.touching import with_other_side
from camgeo.effects.wording import N_M, angles, extreme_findings, over, placed
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, piecewise_extremes, piecewise_highest, piecewise_lowest
from camgeo.units import RPM, TURN

if TYPE_CHECKING:
    from camgeo.effects.roller_spin.skid import Skid


@dataclass(frozen=True, slots=True, eq=False)
class RollerSpin(Result):
    """The spin of the roller.

    Attributes
    ----------
    rolling : the roller, as if it never skidded.
    skid : how it turns instead; None if it rolls all round, or nothing turns it.
    opposite : the same of the second roller of a yoke; None without one.
    """

    rolling: Rolling
    skid: Skid | None
    opposite: RollerSpin | None = None


def compute(request: Request[RollerData]) -> RollerSpin:
    """The spin at the speed of the scene, of both rollers of a yoke."""
    main, *others = (_spin_of(each) for each in Rolling.each(request))
    if not others:
        return main
    (other,) = others
    return replace(with_other_side(request.subject, main, other), opposite=other)


def _spin_of(rolling: Rolling) -> RollerSpin:
    """The spin of one roller."""
    edges = rolling.contact.edges
    lowest = piecewise_lowest(rolling.reserve, edges)
    skids = bool(lowest.value < 0.0 or len(rolling.reversals))
    skid = None
    if skids:
        from camgeo.effects.roller_spin.skid import steady  # most rollers roll

        skid = steady(rolling)

    def on_pin(phi: FloatArray, side: Side) -> FloatArray:
        return (rolling.spin(phi, side) if skid is None else skid.spin(phi, side))[1] / RPM

    def slip(phi: FloatArray, side: Side) -> FloatArray:
        return np.zeros(len(phi)) if skid is None else skid.slip(phi, side)

    inside = edges[(edges > 0.0) & (edges < TURN)]
    turning = inside if skid is None else merged(np.concatenate((inside, skid.borders)))
    return RollerSpin(
        findings=(
            *extreme_findings(
                "roller-spin",
                "speed of the roller on its pin",
                piecewise_extremes(on_pin, edges if skid is None else skid.edges),
                "rev/min",
                ", positive counter-clockwise",
            ),
            _of_reserve(rolling, edges, lowest),
            *_of_drag(rolling),
            *_of_reversals(rolling.reversals),
            *(_of_undriven() if skids and skid is None else _of_skid(skid)),
        ),
        columns=(
            Column("roller spin", "rev/min", on_pin, borders=turning),
            Column("roller traction", "N", rolling.traction, borders=inside),
            Column("traction reserve", "N", rolling.reserve, 0.0, inside),
            Column("roller slip", "mm/s", slip, borders=turning),
        ),
        rolling=rolling,
        skid=skid,
    )


def _of_reserve(rolling: Rolling, edges: FloatArray, lowest: Extreme) -> Finding:
    sentence = (
        f"smallest reserve of traction {lowest.value:.6g} N"
        f" {angles([lowest.place])}, with a coefficient of {rolling.data.traction:g}"
    )
    if lowest.value >= 0.0:
        return placed("traction-reserve", f"{sentence}: the roller rolls", lowest, "N", 0.0)
    found = ranges_below(rolling.reserve, edges, 0.0, lowest)
    where = over([(each.start, each.end) for each in found])
    return placed(
        "traction-reserve",
        f"{sentence}: too little for the roller to roll {where}",
        lowest,
        "N",
        0.0,
        "warning",
    )


def _of_drag(rolling: Rolling) -> Iterator[Finding]:
    """Where friction of bearing and rolling is more than the traction, even at constant speed."""
    drag = float(np.sum(rolling.levers[1:])) / rolling.subject.cam.follower.roller_radius
    if drag <= rolling.data.traction:
        return
    yield Finding(
        "roller-drag",
        "warning",
        f"to keep rolling against the friction of its bearing and of rolling, the roller needs a"
        f" coefficient of traction of {drag:.4g}; it has {rolling.data.traction:g}",
        drag,
        rolling.data.traction,
    )


def _of_reversals(places: FloatArray) -> Iterator[Finding]:
    if not len(places):
        return
    yield Finding(
        "roller-reversal",
        "warning",
        f"the roller changes flanks {angles(places.tolist())}, where it has to reverse its spin"
        " and skids",
        float(len(places)),
        0.0,
        cam_angle=float(places[0]),
    )


def _of_skid(skid: Skid | None) -> Iterator[Finding]:
    """How far the roller skids; all 0 if it rolls all round."""
    if skid is None:
        yield Finding("largest-slip", "ok", "the roller does not slip", 0.0, unit="mm/s")
        yield Finding("slip-distance", "ok", "path of the slip 0 mm a turn", 0.0, unit="mm")
        yield Finding("slip-work", "ok", "work of the slip 0 J a turn", 0.0, unit="J")
        return
    fastest = piecewise_highest(lambda phi, side: np.abs(skid.slip(phi, side)), skid.edges)
    text = f"the roller slips on its flank at up to {fastest.value:.6g} mm/s"
    yield placed("largest-slip", f"{text} {angles([fastest.place])}", fastest, "mm/s")
    distance, work, ranges = skid.distance, N_M * skid.work, skid.ranges
    where = f", {over(ranges)}" if ranges else ""
    text = f"path of the slip {distance:.6g} mm a turn{where}"
    yield Finding("slip-distance", "ok", text, distance, unit="mm")
    text = (
        f"work of the slip {work:.6g} J a turn; the roller of other effects rolls, and takes none"
    )
    yield Finding("slip-work", "ok", text, work, unit="J")


def _of_undriven() -> Iterator[Finding]:
    yield Finding(
        "roller-undriven",
        "warning",
        "nothing turns the roller, neither traction nor friction, so it is not known how it turns;"
        " the speed on its pin is that of one that rolls",
    )
