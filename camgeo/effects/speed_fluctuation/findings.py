"""What the speed of the cam has to say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.check.finding import Finding, held
from camgeo.effects.told import at, placed
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.units import RPM, TURN

JOULE: Final = 1e-3
"""J in an N mm."""


@dataclass(frozen=True, slots=True)
class Balance:
    """Work over a turn [N mm] and its duration [s].

    Attributes
    ----------
    motor : work of the motor.
    cam : work that the cam takes: of friction and of the process.
    period : duration of the turn.
    """

    motor: float
    cam: float
    period: float


def findings(
    speeds: Extremes, torques: Extremes, balance: Balance, slope: float, limit: float | None
) -> tuple[Finding, ...]:
    """All findings; `speeds` in rad/s, `torques` of the motor in N mm, `slope` of the map of y from
    turn to turn, `limit` of the fluctuation.
    """
    mean = TURN / balance.period
    fluctuation = (speeds.highest.value - speeds.lowest.value) / mean
    told = f"speed fluctuation {fluctuation:.5g} (largest less smallest speed by the mean)"
    return (
        held("speed-fluctuation", told, fluctuation, limit),
        Finding(
            "mean-speed",
            "ok",
            f"mean speed {mean / RPM:.6g} rev/min over time; a disturbance of the speed falls to"
            f" {100.0 * slope:.4g} % of itself in a turn",
            mean / RPM,
            unit="rev/min",
        ),
        _extreme("largest-speed", "largest speed", speeds.highest, 1.0 / RPM, "rev/min"),
        _extreme("smallest-speed", "smallest speed", speeds.lowest, 1.0 / RPM, "rev/min"),
        _extreme(
            "largest-motor-torque", "largest torque of the motor", torques.highest, JOULE, "N m"
        ),
        _extreme(
            "smallest-motor-torque", "smallest torque of the motor", torques.lowest, JOULE, "N m"
        ),
        Finding(
            "motor-work",
            "ok",
            f"work of the motor over a turn {JOULE * balance.motor:.5g} J, taken by the cam"
            f" {JOULE * balance.cam:.5g} J",
            JOULE * balance.motor,
            unit="J",
        ),
        Finding(
            "mean-motor-power",
            "ok",
            f"mean power of the motor {JOULE * balance.motor / balance.period:.5g} W",
            JOULE * balance.motor / balance.period,
            unit="W",
        ),
    )


def _extreme(name: str, words: str, extreme: Extreme, factor: float, unit: str) -> Finding:
    value, place = factor * extreme.value, extreme.place
    return placed(name, f"{words} {value:.6g} {unit} {at(place)}", Extreme(value, place), unit)
