"""What holds for every figure: none of a numerical effect is off by more than its result says, and
a machine in other units of mass, length and time has the same figures in these units.

Figures are the values of all findings and the columns over the turn; errors are held against a
computation to a hundredth of the tolerance. Every length of the scene times L, every mass times M,
every time times T: then each figure goes with its dimension, a force with M L / T^2, whatever the
effect is. Weight stays what it is where T^2 is L.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Bound, Result
from camgeo.dynamics.effects.graph import WithTrain
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.oscillator.steady import Response
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene
from camgeo.studies.accuracy.survey import TIGHTER, compare_figures, result_figures
from camgeo.units import TURN
from tests.effects.recorded import NUMBER, PLACED, SHOWN, result_of
from tests.effects.recorded_scenes import OF_SMALL, small, text_of
from tests.effects.scenes import SCENES, design
from tests.long_form import LONG, examples
from tests.thinned import share

NAMES: Final = (
    "plate_translating", "setzhub", "groove", "inch", "querhub", "schnitt", "feed", "shuttle",
    "measured", "vorschub", "ring",
)  # fmt: skip
"""Scenes with rollers of all kinds; with friction the torque has kinks wherever the load changes
sides."""

TOLERANCES: Final = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10) if LONG else (1e-2, 1e-5)

NUMERICAL: Final = tuple(name for name in EFFECTS if find_effect(name).numerical)


def drawn(rng: Random) -> Design:
    """A scene with all numerical effects, whose numbers range over decades."""
    name = rng.choice(NAMES)
    text = (SCENES / f"{name}.toml").read_text("utf-8")
    rocks = "oscillating" in text

    def number(low: float, high: float) -> str:
        return f"{math.exp(rng.uniform(math.log(low), math.log(high))):.3g}"

    moving = ("moment_of_inertia", (1e-4, 1e-1)) if rocks else ("mass", (0.1, 5.0))
    tables = [f"[effects.inertia]\n{moving[0]} = {number(*moving[1])}"]
    if rocks:
        kind = 'kind = "torsion"\ntorsional_stiffness = '
        tables.append(f"[effects.spring]\n{kind}{number(1, 50)}\npreload_torque = {number(1, 100)}")
    else:
        wire = f"diameter = 0.1\ncoil_diameter = 1\nactive_coils = {number(1, 20)}"
        tables.append(
            f"[effects.spring]\npreload = {number(10, 1e3)}\n[effects.spring.wire]\n{wire}\n"
            f"free_length = 90\ndensity = {number(1e-3, 1e5)}\n[effects.spring-surge]"
        )
    if rng.random() < 0.6:
        pivot = "\npivot = 0.1\npivot_diameter = 12" if rocks else ""
        tables.append(f"[effects.friction]\nrolling = 0.02{pivot}")
    tables.append("[effects.reactions]")
    motor = f"no_load_speed = {number(20, 600)}\nstall_torque = {number(5, 5e4)}"
    damping = f"damping = {rng.choice((0.0, 0.01, 0.1, 0.4))}"
    backlash = 'contact = "groove"' in text and "side_clearance" not in text
    tables += [
        "[effects.drive-torque]\nfluctuation = 0.05",
        f"[effects.speed-fluctuation]\nmoment_of_inertia = {number(1e-3, 10)}\n{motor}",
        f"[effects.vibration]\nnatural_frequency = {number(2, 500)}\n{damping}",
        "[effects.lift-off]" + (f"\nbacklash = {number(5e-3, 0.3)}" if backlash else ""),
        f"[effects.contact-pressure]\nwidth = {0.2 if name == 'inch' else 4}\nrating = 5000",
        "[effects.balance]",
    ]
    changes = [] if "\nspeed = " in text else [("[cam]\n", "[cam]\nspeed = 200\n")]
    return design(name, "\n".join(tables), *changes)


def to_tolerance(of: Design, name: str, tolerance: float) -> Result | None:
    """The effect to a tolerance; None if it has no answer."""
    try:
        result: Result = of.effects.recomputed(name, tolerance).result(name)
    except EffectError:
        return None
    return result


def assert_true(of: Design, name: str, *tolerances: float) -> None:
    """Each is compared with the result to a hundredth."""
    for tolerance in tolerances:
        own, best = (to_tolerance(of, name, each) for each in (tolerance, tolerance / TIGHTER))
        for each in compare_figures(own, best) if own is not None and best is not None else ():
            assert each.holds, (name, tolerance, each)


@settings(max_examples=examples(2, long=50), deadline=None)
@given(st.randoms(use_true_random=False))
def test_no_figure_of_any_scene_is_off_by_more_than_stated(rng: Random) -> None:
    found = drawn(rng)
    for name in set(NUMERICAL) & found.scene.effects.keys():
        assert_true(found, name, *TOLERANCES)


def test_a_false_statement_is_seen() -> None:
    of = design("schnitt", KINKED)
    own, best = (to_tolerance(of, "speed-fluctuation", each) for each in (1e-2, 1e-6))
    assert own is not None
    assert best is not None
    assert all(each.holds for each in compare_figures(own, best))
    sure = {name: Bound(0.0, bound.scale) for name, bound in own.errors.items()}
    object.__setattr__(own, "errors", sure)
    assert {"cam speed", "motor-work"} <= {
        each.figure for each in compare_figures(own, best) if not each.holds
    }


# What was off by more ----------------------------------------------------------------------------

KINKED: Final = (
    "[effects.inertia]\nmoment_of_inertia = 0.0635\n[effects.friction]\nrolling = 0.02\n"
    "[effects.speed-fluctuation]\nmoment_of_inertia = 1.21\nno_load_speed = 61.34\n"
    "stall_torque = 1700\n"
)
"""The load changes sides a hundredth of a degree after the end of a smooth piece."""


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_a_kink_that_no_node_sees(tolerance: float) -> None:
    assert_true(design("schnitt", KINKED), "speed-fluctuation", tolerance)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
def test_the_work_of_the_motor_is_as_accurate_as_stated(tolerance: float) -> None:
    """A strong motor, whose torque follows from a slip that is small compared with the speed."""
    of = design("schnitt", KINKED.replace("1700", "5e5"))
    assert_true(of, "speed-fluctuation", tolerance)
    result = to_tolerance(of, "speed-fluctuation", tolerance)
    assert result is not None
    for figure in ("motor-work", "mean-motor-power", "motor torque"):
        assert result.errors[figure].share <= tolerance


# Of an elastic train -----------------------------------------------------------------------------

FOLLOWING: Final = (
    "contact-force", "contact-pressure", "drive-torque", "power-balance", "reactions",
    "roller-spin",
)  # fmt: skip
"""Effects whose figures follow from the force of the train; lift-off does too."""


def with_train(name: str) -> Design:
    rocks = name != "plate_translating"
    torsion = 'kind = "torsion"\ntorsional_stiffness = 20\npreload_torque = 60'
    values = {
        "mass": "moment_of_inertia = 0.01" if rocks else "mass = 0.8",
        "spring": torsion if rocks else "preload = 260\nstiffness = 4",
        "friction": "" if rocks else "guide = 0.08",
    }
    return design(
        name,
        "[effects.inertia]\n{mass}\n[effects.spring]\n{spring}\n[effects.load]\nconstant = 15\n"
        "[effects.friction]\nrolling = 0.02\n{friction}\n"
        "[effects.vibration]\nnatural_frequency = 90\ndamping = 0.05\n[effects.contact-force]\n"
        "[effects.contact-pressure]\nwidth = 4\nrating = 5000\n[effects.drive-torque]\n"
        "[effects.power-balance]\n[effects.reactions]\n"
        "[effects.roller-spin]\nmoment_of_inertia = 1e-5\ntraction = 0.05\n".format(**values),
    )


@pytest.mark.parametrize("name", ["groove", "plate_translating"])
def test_a_force_of_the_train_off_by_its_error_moves_no_figure_by_more_than_stated(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the course of the error, here of a train that is known to 0.05 N or N mm."""
    found = with_train(name)
    nodes = found.effects._nodes("contact-force")
    train = nodes.result("vibration")
    monkeypatch.setattr(Response, "reading_error", lambda _self, _reading: 0.05)
    told = {each: found.effect(each) for each in FOLLOWING}
    for result in told.values():
        valued = {each.name for each in result.findings if each.value is not None}
        assert set(result.errors) == valued | {each.name for each in result.columns}
    alone = found.effects.recomputed("drive-torque").result("drive-torque")
    assert "drive torque" not in alone.errors  # of what depends on its tolerance only
    rng = np.random.default_rng(1)
    for count in (3, 0, 1, 17) if LONG else (3,):
        phase = rng.uniform(0.0, TURN)

        def way(phi: FloatArray, _side: Side, count: int = count, phase: float = phase) -> Any:
            return np.cos(count * phi + phase)

        off = replace(train, behind=train.behind._perturbed(way))
        moved = WithTrain(nodes, off)
        for effect, result in told.items():
            own, other = result_figures(result), result_figures(moved.result(effect))
            assert own.keys() == other.keys()
            for figure, values in own.items():
                # A life goes with the power 10/3 of the load, of which the error is a thousandth.
                bound = 1.01 * result.errors[figure].error
                assert np.max(np.abs(values - other[figure])) <= bound, (effect, figure)
                assert bound <= 0.05 * result.errors[figure].scale, (effect, figure)


# Rounding ----------------------------------------------------------------------------------------


def test_conservative_forces_do_no_work() -> None:
    scene = Design(load_scene(str(SCENES.parent / "effects" / "motor_work_zero.toml")))
    values = {each.name: each.value for each in scene.effect("speed-fluctuation").findings}
    assert values["motor-work"] == 0.0
    assert values["mean-motor-power"] == 0.0
    assert values["largest-motor-torque"] > 0.9


# Dimensions ---------------------------------------------------------------------------------------
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
    table = tomllib.loads(text_of(name))
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
    for name in share(
        [
            name
            for name, (effects, _) in OF_SMALL.items()
            # The curve of a motor is in a file; others take seconds.
            if "file =" not in effects and "before a train" not in name and name != "elastic flight"
        ],
        3,
    ):
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
