"""A machine in other units of mass, length and time has the same figures in these units.

Every length of the scene times L, every mass times M, every time times T: then each figure goes
with its dimension, a force with M L / T^2, whatever the effect is. Weight stays what it is where
T^2 is L.
"""

from __future__ import annotations

import math
import tomllib
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from tests.effects.recorded import NUMBER, PLACED, SHOWN, result_of
from tests.effects.recorded_scenes import OF_SMALL, SMALL, small
from tests.thinned import share

Units = tuple[float, float, float]
"""Of mass, length and time."""

UNITS_OF: Final[tuple[Units, ...]] = (
    (3.0, 2.0, math.sqrt(2.0)),
    (1e6, 1e3, math.sqrt(1e3)),
    (1e-6, 1e-3, math.sqrt(1e-3)),
)
"""Ordinary ones, and those in which a design is tiny or huge, slow or fast."""

FORCE: Final = (1, 1, -2)
TORQUE: Final = (1, 2, -2)
STRESS: Final = (1, -1, -2)

Dimension = tuple[int, int, int]
"""Powers of mass, length and time."""

KEYS: Final[dict[str, Dimension]] = {
    "base_radius": (0, 1, 0), "roller_radius": (0, 1, 0), "offset": (0, 1, 0), "to": (0, 1, 0),
    "thickness": (0, 1, 0), "bore": (0, 1, 0), "speed": (0, 0, -1), "mass": (1, 0, 0),
    "stiffness": (1, 0, -2), "preload": FORCE, "guide": (0, 0, 0), "guide_length": (0, 1, 0),
    "guide_overhang": (0, 1, 0), "rolling": (0, 1, 0), "guide_viscous": (1, 0, -1),
    "margin": FORCE, "restitution": (0, 0, 0), "width": (0, 1, 0), "safety": (0, 0, 0),
    "rating": FORCE, "life": (0, 0, 1), "moment_of_inertia": (1, 2, 0), "traction": (0, 0, 0),
    "damping": (0, 0, 0), "viscous": (1, 0, -1), "ground_viscous": (1, 0, -1),
    "ground_stiffness": (1, 0, -2), "natural_frequency": (0, 0, -1), "mass_ratio": (0, 0, 0),
    "fluctuation": (0, 0, 0), "segments": FORCE, "no_load_speed": (0, 0, -1),
    "stall_torque": TORQUE, "diameter": (0, 1, 0), "coil_diameter": (0, 1, 0),
    "active_coils": (0, 0, 0), "total_coils": (0, 0, 0), "free_length": (0, 1, 0),
    "density": (1, -3, 0), "shear_modulus": STRESS, "strength": STRESS, "cam_modulus": STRESS,
    "roller_modulus": STRESS, "highest_ratio": (0, 0, 0), "output": (0, 0, 0), "span": (0, 0, 0),
    "dwell": (0, 0, 0),
}  # fmt: skip
"""What the numbers of the scenes are."""

LIMITS: Final[dict[str, Dimension]] = {
    "drive-torque": TORQUE, "contact-pressure": STRESS, "vibration": (0, 1, 0),
    "camshaft-windup": (0, 0, 0),
}  # fmt: skip
"""What `limit` is, by the effect."""

TURNING_STIFFNESS: Final = ("camshaft-windup",)
"""Effects whose stiffness is a torque."""

UNITS: Final[dict[str, Dimension]] = {
    "": (0, 0, 0), "%": (0, 0, 0), "deg": (0, 0, 0), "N": FORCE, "N m": TORQUE, "N mm": TORQUE,
    "mm": (0, 1, 0), "mm/s": (0, 1, -1), "mm/s^2": (0, 1, -2), "mm/s^3": (0, 1, -3),
    "kg": (1, 0, 0), "kg m^2": (1, 2, 0), "J": TORQUE, "W": (1, 2, -3), "rev/min": (0, 0, -1),
    "MPa": STRESS, "Hz": (0, 0, -1), "s": (0, 0, 1), "ms": (0, 0, 1), "h": (0, 0, 1),
    "N/mm": (1, 0, -2), "rad/s^2": (0, 0, -2), "g mm": (1, 1, 0),
}  # fmt: skip

SCENES: Final = [
    name
    for name, (effects, _) in OF_SMALL.items()
    # The curve of a motor is in a file; others take seconds.
    if "file =" not in effects and "before a train" not in name and name != "elastic flight"
]  # fmt: skip


def times(units: Units, dimension: Dimension) -> float:
    return math.prod(unit**power for unit, power in zip(units, dimension, strict=True))


def scaled(units: Units, of: Any, effect: str = "", key: str = "") -> Any:
    """A table of the scene, or a value in it, in the other units."""
    if isinstance(of, dict):
        return {name: scaled(units, each, effect, name) for name, each in of.items()}
    if isinstance(of, list):
        return [scaled(units, each, effect, key) for each in of]
    if isinstance(of, (str, bool)) or key == "camgeo":
        return of
    dimension = LIMITS[effect] if key == "limit" else KEYS[key]
    if key == "stiffness" and effect in TURNING_STIFFNESS:
        dimension = TORQUE
    factor = times(units, dimension)
    return of if factor == 1.0 else of * factor


STEEL: Final = {"cam_modulus": 2e5, "roller_modulus": 2e5, "limit": 1100.0}
"""Of the contact, which else is of a material whose strength nothing scales."""


def stated(name: str) -> Design:
    """The scene of the record, with all that a material says of it stated, or left out."""
    edits: dict[str, Any] = {}
    if "contact-pressure" in (made := small(name)).scene.effects:
        edits |= {f"effects.contact-pressure.{key}": each for key, each in STEEL.items()}
    if "balance" in made.scene.effects:
        edits["effects.balance"] = None
    return Design(made.scene.with_values(edits))


def in_other_units(units: Units, name: str, made: Design) -> Design:
    text = f"{SMALL}{OF_SMALL[name][0]}"
    for old, new in OF_SMALL[name][1]:
        text = text.replace(old, new)
    table = tomllib.loads(text)
    if "contact-pressure" in table["effects"]:
        table["effects"]["contact-pressure"] |= STEEL
    table["effects"].pop("balance", None)
    edits: dict[str, Any] = {}
    for head in ("cam", "follower", "part"):
        edits |= {f"{head}.{key}": each for key, each in scaled(units, table[head]).items()}
    edits["motion"] = scaled(units, table["motion"])
    for effect, own in table["effects"].items():
        for key, each in scaled(units, own, effect).items():
            if isinstance(each, dict):
                edits |= {f"effects.{effect}.{key}.{one}": value for one, value in each.items()}
            else:
                edits[f"effects.{effect}.{key}"] = each
    return Design(made.scene.with_values(edits))


@pytest.mark.parametrize("units", UNITS_OF)
def test_each_figure_goes_with_its_dimension(units: Units) -> None:
    for name in share(SCENES, 3):
        made = stated(name)
        other = in_other_units(units, name, made)
        for effect in made.scene.effects:
            assert_alike(units, made, other, effect, f"{name}, {effect}")


def assert_alike(units: Units, made: Design, other: Design, effect: str, where: str) -> None:
    one, two = result_of(made, effect), result_of(other, effect)
    errors = {} if one is None else one.errors
    findings = zip(made.effects.findings(effect), other.effects.findings(effect), strict=True)
    for here, there in findings:
        what, factor = f"{where}: {here.name}", times(units, UNITS[here.unit])
        assert (here.name, here.severity, here.unit) == (there.name, there.severity, there.unit)
        assert NUMBER.sub("", here.sentence) == NUMBER.sub("", there.sentence), what
        bound = errors[here.name].error if here.name in errors else 0.0
        for number, its in ((here.value, there.value), (here.limit, there.limit)):
            assert (number is None) == (its is None), what
            if number is not None:
                near = max(2.0 * bound, 1e-8 * abs(number), 1e-13)
                assert its == pytest.approx(number * factor, abs=near * factor), what
        assert (here.cam_angle is None) == (there.cam_angle is None), what
        if here.cam_angle is not None:
            assert here.cam_angle == pytest.approx(there.cam_angle, abs=PLACED), what
    assert (one is None) == (two is None), where
    for column, same in zip(one.columns, two.columns, strict=True) if one and two else ():
        factor = times(units, UNITS[column.unit])
        own, found = (each.values(SHOWN, "right") for each in (column, same))
        bound = errors[column.name].error if column.name in errors else 0.0
        near = max(2.0 * bound, 1e-8 * float(np.max(np.abs(own))))
        assert found == pytest.approx(own * factor, abs=near * factor), f"{where}: {column.name}"
