"""Tables of effects that are refused: by themselves, for a machine, or beside the rest of a scene.

Each is refused with its key; what the schema alone refuses is in `tests/scene/test_effects.py`.
"""

from __future__ import annotations

import cmath
import math
import tomllib
from typing import Any, Final

import numpy as np
import pytest

from camgeo.dynamics.effects.effect import DataFile, Results
from camgeo.dynamics.effects.graph import Effects
from camgeo.dynamics.effects.loads import follower_loads
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.errors import EffectError, GeometryError, SceneError
from camgeo.lazy import Ledger
from tests.effects.scenes import LOCKED, design

WOUND: Final = {"diameter": 3.0, "coil_diameter": 24.0, "active_coils": 6.0, "free_length": 60.0}
"""A wire whose coils touch at 24 mm."""

LINEAR: Final = {"stiffness": 1.0, "preload": 1.0}
TORSION: Final = {"kind": "torsion", "torsional_stiffness": 1.0, "preload_torque": 1.0}
WIRE: Final = {"wire": WOUND, "preload": 1.0}
MOTOR: Final = {"stall_torque": 1.0, "no_load_speed": 1.0}


def curve(rows: bytes) -> dict[str, Any]:
    """Of a motor."""
    return {"file": DataFile("m.csv", rows), "moment_of_inertia": 1.0}


INCOMPLETE: Final[dict[str, list[tuple[dict[str, Any], str]]]] = {
    "spring": [
        ({}, "stiffness"),
        ({"stiffness": 1.0}, "preload"),
        ({"kind": "extension", "preload": 1.0}, "stiffness"),
        ({"kind": "torsion", "torsional_stiffness": 1.0}, "preload_torque"),
        ({"kind": "torsion", "preload_torque": 1.0}, "torsional_stiffness"),
        (LINEAR | {"preload_torque": 1.0}, "preload_torque"),
        (TORSION | {"stiffness": 1.0}, "stiffness"),
        (TORSION | {"anchor": (0.0, 1.0)}, "anchor"),
        (LINEAR | {"anchor": (0.0, 1.0)}, "attachment"),
        (LINEAR | {"attachment": (0.0, 1.0)}, "anchor"),
        ({"wire": WOUND}, "preload"),
        (WIRE | {"stiffness": 1.0}, "stiffness"),
        (WIRE | {"kind": "extension"}, "wire"),
        ({"wire": WOUND, "preload_torque": 1.0, "kind": "torsion"}, "wire"),
        (WIRE | {"wire": WOUND | {"coil_diameter": 3.0}}, "wire.coil_diameter"),
        (WIRE | {"wire": WOUND | {"total_coils": 5.5}}, "wire.total_coils"),
        (WIRE | {"wire": WOUND | {"free_length": 24.0}}, "wire.free_length"),
    ],
    "friction": [
        ({"pivot": 0.1}, "pivot_diameter"),
        ({"roller_pin": 0.1}, "roller_pin_diameter"),
        ({"guide": 0.1, "guide_overhang": 5.0}, "guide_length"),
    ],
    "inertia": [
        ({"rocker_centre": (1.0, 2.0)}, "rocker_centre"),
        ({"coupler_centre": 0.3}, "coupler_centre"),
        ({"coupler_moment": 0.3}, "coupler_moment"),
    ],
    "contact-pressure": [
        ({"cam_material": "stel"}, "cam_material"),
        ({"roller_material": "stel"}, "roller_material"),
        ({"roller_material": "pom"}, "limit"),
        ({"life": 1.0}, "life"),
        ({"rating": 0.0}, "rating"),
    ],
    "speed-fluctuation": [
        ({"moment_of_inertia": 1.0}, "stall_torque"),
        ({"moment_of_inertia": 1.0, "stall_torque": 1.0}, "no_load_speed"),
        (MOTOR | {"moment_of_inertia": 1.0, "stall_torque": 0.0}, "stall_torque"),
        (MOTOR | curve(b"0;1\n1;0\n"), "stall_torque"),
        (curve(b"0;1\n1;2\n"), "file"),
        (curve(b"1;1\n0;0\n"), "file"),
        (curve(b"-1;1\n0;0\n"), "file"),
        (MOTOR, "moment_of_inertia"),
        (MOTOR | {"moment_of_inertia": 0.0}, "moment_of_inertia"),
    ],
    "balance": [
        ({"hole_diameter": 5.0}, "hole_diameter"),
        ({"material": "unob"}, "material"),
    ],
}


@pytest.mark.parametrize(
    ("effect", "table", "key"),
    [(effect, *each) for effect, tables in INCOMPLETE.items() for each in tables],
)
def test_a_table_that_lacks_or_contradicts_something_is_refused(
    effect: str, table: dict[str, Any], key: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        find_effect(effect).parse(table)
    assert caught.value.key == key


LEVER: Final = "is for the lever"
DEMANDED: Final = "is for a demanded motion"

FOREIGN: Final = [
    ("groove", "friction", "guide = 0.1", ""),
    ("groove", "friction", "guide_length = 10.0", ""),
    ("groove", "friction", "guide_viscous = 0.1", ""),
    ("groove", "friction", "slider = 5.0", ""),
    ("plate_translating", "friction", "slider = 5.0", ""),
    ("plate_translating", "friction", "pivot = 0.1\npivot_diameter = 9.0", ""),
    ("plate_translating", "friction", "pivot_viscous = 0.1", ""),
    ("setzhub", "friction", "guide = 0.1", ""),
    ("knife_edge", "friction", "rolling = 0.01", ""),
    ("knife_edge", "friction", "roller_pin = 0.1\nroller_pin_diameter = 5.0", ""),
    ("flat_rocker", "friction", "guide_length = 3", "this follower is a rocker"),
    ("flat_rocker", "friction", "guide_offset = 1\nguide_length = 3", "this follower is a rocker"),
    ("conjugate_carriage", "friction", "guide_length = 80", "supports a single roller"),
    ("conjugate_carriage", "friction", "guide_overhang = 10", "supports a single roller"),
    ("tappet", "friction", "rolling = 1", "is for roller followers"),
    ("plate_translating", "friction", "face = 0.1", "is for flat-faced followers"),
    ("tappet", "inertia", "roller_mass = 1", "is for roller followers"),
    ("tappet", "contact-pressure", 'roller_material = "steel"', "is for roller followers"),
    ("plate_translating", "contact-pressure", 'face_material = "steel"', "is for flat-faced"),
    ("tappet", "lift-off", "backlash = 0.1", "is for roller followers"),
    ("plate_translating", "inertia", "moment_of_inertia = 0", ""),
    ("plate_translating", "inertia", "rocker_mass = 1", ""),
    ("plate_translating", "inertia", "coupler_mass = 1", ""),
    ("plate_translating", "inertia", "output_moment = 0.01", LEVER),
    ("setzhub", "inertia", "output_moment = 0.01", LEVER),
    ("groove", "inertia", "mass = 1", ""),
    ("groove", "inertia", "coupler_mass = 1", ""),
    ("groove", "vibration", "stiffness = 500", DEMANDED),
    ("plate_translating", "vibration", "torsional_stiffness = 5", DEMANDED),
    ("groove", "vibration", "limit = 0.1\nnatural_frequency = 50", DEMANDED),
    ("setzhub", "vibration", "limit_angle = 1\nnatural_frequency = 50", DEMANDED),
    ("plate_translating", "reactions", "bearings = [12, 12]", "two places"),
    ("conjugate_lever", "reactions", "bearings = [0, 12]", "single disc"),
    ("constant_breadth", "lift-off", "backlash = 0.1", "its breadth"),
]
"""The first key does not apply to the machine."""


@pytest.mark.parametrize(("scene", "effect", "text", "words"), FOREIGN)
def test_a_key_that_does_not_apply_is_refused_by_scene_and_design(
    scene: str, effect: str, text: str, words: str
) -> None:
    key = text.partition(" ")[0]
    with pytest.raises(SceneError) as stated:
        design(scene, f"[effects.{effect}]\n{text}\n")
    (fault,) = (each for each in stated.value.faults if each.key == f"effects.{effect}.{key}")
    assert words in fault.message
    subject = design(scene, "").effects.subject
    with pytest.raises(GeometryError) as error:
        Effects(subject, {effect: tomllib.loads(text)}, Ledger()).result(effect)
    assert error.value.key.startswith(f"effects.{effect}.")
    assert words in error.value.message


LOST: Final = "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.lift-off]\n"
GUIDED: Final = "[effects.inertia]\nmass = 1\n[effects.lift-off]\n"
SPRUNG: Final = "[effects.spring]\nstiffness = 5\npreload = 50\n"
TURNED: Final = '[effects.spring]\nkind = "torsion"\ntorsional_stiffness = 5\npreload_torque = 50\n'

MET: Final = 110.0 - 90.0 * cmath.exp(1j * math.radians(8.0))
"""Where an attachment of the shuttle, which swings by 16 degrees about [110, 0], is half-way."""


UNFIT: Final = [
    ("groove", f"{LOST}margin = 5", "lift-off.margin", "one flank"),
    ("conjugate_lever", f"{LOST}margin = 5", "lift-off.margin", "or between two discs, the force"),
    ("constant_breadth", f"{GUIDED}margin = 3", "lift-off.margin", "in a yoke, or between"),
    ("plate_translating", f"{GUIDED}backlash = 1", "lift-off.backlash", "groove"),
    ("groove_clearance", f"{GUIDED}backlash = 0.05", "lift-off.backlash", r"clearance, 0\.08 mm"),
    ("plate_translating", TURNED, "spring.kind", "no pivot for a torsion spring"),
    (
        "plate_translating",
        SPRUNG + "anchor = [30, -60]\nattachment = [60, 30]\n",
        "spring.anchor",
        "is for rockers",
    ),
    ("groove", SPRUNG, "spring.anchor", "needs anchor and attachment"),
    (
        "shuttle",
        SPRUNG + "anchor = [0, 0]\nattachment = [110, 0]\n",
        "spring.attachment",
        "is at the pivot of the rocker",
    ),
    (
        "shuttle",
        SPRUNG + f"anchor = [{MET.real!r}, {MET.imag!r}]\nattachment = [20, 0]\n",
        "spring.anchor",
        "has no direction there",
    ),
    ("groove", "[effects.load]\nsegments = [1, 2]\n", "load.segments", "number of values 2"),
    ("ring", "[effects.balance]\ngrade = 6.3\n", "balance.grade", r"needs \[cam\] speed"),
    (
        "ring",
        "[effects.load]\nconstant = 1\n[effects.drive-torque]\nfluctuation = 0.01\n",
        "drive-torque.fluctuation",
        "a flywheel needs the speed of the cam",
    ),
    (
        "ring",
        "[effects.load]\nconstant = -1\n[effects.contact-pressure]\nrating = 9000\nwidth = 5",
        "cam.speed",
        "speed",
    ),
    ("plate_translating", f"{SPRUNG}[effects.spring-surge]", "spring.wire", "stated by its wire"),
    ("plate_translating", "[effects.vibration]\nstiffness = 500", "inertia", "needs the masses"),
]
"""Scenes, tables, the key and words of the refusal; the last table is computed."""


@pytest.mark.parametrize(("scene", "tables", "key", "words"), UNFIT)
def test_what_does_not_fit_the_design_is_refused(
    scene: str, tables: str, key: str, words: str
) -> None:
    made = design(scene, tables)
    *_, last = made.scene.effects
    with pytest.raises(GeometryError, match=words) as caught:
        made.effect(last)
    assert caught.value.key.removeprefix("effects.") == key


ROW: Final = "mass = 1, stiffness = 5"

TRAINS: Final = [
    ("damping = 0.1", "natural_frequency", "is missing, and so are stiffness"),
    ("natural_frequency = 50\nstiffness = 3", "stiffness", "with natural_frequency: give only one"),
    ("stiffness = 0", "stiffness", "must be above 0"),
    ("damping = 1\nnatural_frequency = 4", "damping", "from 0 and below 1"),
    ("masses = [{ mass = 0, stiffness = 5 }]", "masses", "mass of number 1 must be above 0"),
    ("masses = [{ mass = 1, stiffness = 0 }]", "masses", "stiffness of number 1 must be above 0"),
    (f"masses = [{{ {ROW}, damping = 0.1, viscous = 1 }}]", "masses", "damping and viscous of"),
    (f"masses = [{{ {ROW} }}]\noutput = 2", "output", "allowed: 1 to 1"),
    (f"masses = [{{ {ROW} }}]\ndamping = 0.1", "damping", "each mass has its own"),
    (f"masses = [{{ {ROW} }}]\nnatural_frequency = 9", "masses", "give only one"),
    ("natural_frequency = 9\noutput = 1", "output", "needs masses or moments"),
    ("masses = []", "masses", "must be a list of tables"),
    ("moments = [{ moment = 1, torsional_stiffness = 5 }]", "moments", "that is an angle"),
]
"""Tables of `vibration`, the key and words of the refusal."""


@pytest.mark.parametrize(
    ("scene", "tables", "key", "words"),
    [
        ("ring", "[effects.inertia]\nmass = 1", "inertia", "speed"),
        ("ring", "[effects.kinematics]", "kinematics", "speed"),
        ("ring", "[effects.vibration]\nnatural_frequency = 50", "vibration", "speed"),
        ("plate_translating", "[effects.gravity]", "gravity", "inertia"),
        ("plate_translating", "[effects.contact-force]", "contact-force", "inertia"),
        ("plate_translating", "[effects.lift-off]", "lift-off", "inertia"),
        ("plate_translating", "[effects.load]", "load", "one of constant, segments, file"),
        (
            "plate_translating",
            "[effects.load]\nconstant = 1\nsegments = [1, 2, 3, 4, 5]",
            "load.segments",
            "one of constant, segments, file",
        ),
        *(
            ("plate_translating", f"[effects.vibration]\n{table}", f"vibration.{key}", words)
            for table, key, words in TRAINS
        ),
    ],
)
def test_a_scene_that_lacks_or_contradicts_something_is_refused(
    scene: str, tables: str, key: str, words: str
) -> None:
    with pytest.raises(SceneError) as caught:
        design(scene, tables)
    (fault,) = caught.value.faults
    assert fault.key == f"effects.{key}"
    assert words in fault.message


@pytest.mark.parametrize("name", [each for each in EFFECTS if find_effect(each).tabled])
def test_without_its_table_it_is_missing(name: str) -> None:
    with pytest.raises(GeometryError) as caught:
        design("plate_translating", "").effect(name)
    assert caught.value.key == f"effects.{name}"


@pytest.mark.parametrize("table", ["load]\nconstant", "inertia]\nmass", "friction]\nslider"])
def test_a_slider_that_the_rocker_cannot_move_has_no_force(table: str) -> None:
    made = design("schnitt", f"[effects.{table} = 1", *LOCKED)
    (name,) = made.scene.effects
    with pytest.raises(EffectError, match="is square to the guide") as caught:
        made.effect(name)
    (at,) = made.cam.drive.plan.jet(np.array([caught.value.cam_angle]))[0]
    assert at == pytest.approx(60.0 + math.sqrt(100.0**2 - 40.0**2), rel=1e-12)
    (reported,) = made.effects.findings(name)
    assert reported.severity == "broken"
    # The rocker alone can be moved.
    alone = design("schnitt", "[effects.inertia]\nmoment_of_inertia = 1\n", *LOCKED)
    assert np.all(np.isfinite(alone.effect("inertia").to_follower(np.linspace(0, 6, 9), "right")))


def test_what_a_locked_slider_leaves_without_an_answer() -> None:
    """The pins of its coupler, and a spring that is to close the contact."""
    subject = design("schnitt", "", *LOCKED).effects.subject
    with pytest.raises(EffectError, match="the rocker cannot move the slider there") as caught:
        follower_loads(subject, Results({}), (), idle=True)
    assert caught.value.finding == "locked-slider"
    with pytest.raises(GeometryError, match="square to the guide"):
        design("schnitt", SPRUNG, *LOCKED).effect("spring")


LOCKING: Final = {
    # The lever comes into line with the coupler; the crank into line with it.
    "four_bar": ((("coupler = 120", "coupler = 60"), ("to = 22", "to = -60")), "lever"),
    "crank_slider": ((("to = -40", "to = -160"),), "crank"),
}


@pytest.mark.parametrize("scene", LOCKING)
@pytest.mark.parametrize("table", ["load]\nconstant = 1", "inertia]\noutput_moment = 0.01"])
def test_a_far_end_that_cannot_be_moved_has_no_answer(scene: str, table: str) -> None:
    changes, member = LOCKING[scene]
    made = design(scene, f"[effects.{table}", *changes)
    (name,) = made.scene.effects
    with pytest.raises(EffectError, match="are in line at cam angle") as caught:
        made.effect(name)
    assert caught.value.finding == f"locked-{member}"
