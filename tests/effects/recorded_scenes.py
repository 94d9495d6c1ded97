"""Small designs whose complete results are recorded, chosen so that effects take all their ways:
flights of rigid and elastic trains, a motor that stalls, jams or is given by its curve, trimmed
discs, pairs, yokes, faces, linkages, speed curves, trains of several masses.
"""

from __future__ import annotations

from typing import Final

from camgeo.design.design import Design
from camgeo.scene.scene import parse_scene
from tests.effects.scenes import SCENES, changed, design
from tests.state.test_outline import STEEPER, trimmed

SMALL: Final = """
camgeo = 1
name = "small"
[cam]
rotation = "ccw"
speed = 600
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
offset = 4
[[motion]]
law = "polynomial-345"
span = 90
to = 20
[[motion]]
law = "modified-sine"
span = 110
to = 0
[[motion]]
dwell = 160
[part]
thickness = 12
bore = 20
"""

WITHOUT_SPEED: Final = ("speed = 600\n", "")


def held(preload: float) -> str:
    return (
        f"[effects.inertia]\nmass = 1.5\n[effects.spring]\nstiffness = 2\npreload = {preload}\n"
        "[effects.contact-force]\n"
    )


TURNED: Final = """
[effects.inertia]
moment_of_inertia = 0.02
roller_mass = 0.1
rocker_mass = 0.6
rocker_centre = [60, -30]
[effects.gravity]
[effects.spring]
kind = "torsion"
torsional_stiffness = 25
preload_torque = 20
[effects.contact-force]
"""

TOLD: Final = """
[effects.reactions]
[effects.lift-off]
[effects.drive-torque]
fluctuation = 0.05
[effects.power-balance]
[effects.contact-pressure]
width = 8
rating = 4000
"""

OF_SMALL: Final[dict[str, tuple[str, tuple[tuple[str, str], ...]]]] = {
    "free flight": (
        held(60.0)
        + """
[effects.gravity]
[effects.friction]
guide = 0.1
guide_length = 60
guide_overhang = 30
rolling = 0.01
[effects.lift-off]
restitution = 0.4
[effects.kinematics]
[effects.drive-torque]
limit = 5
[effects.contact-pressure]
width = 3
limit = 300
[effects.reactions]
[effects.balance]
hole_radius = 30
hole_diameter = 8
[effects.power-balance]
[effects.roller-spin]
moment_of_inertia = 1e-5
traction = 0.02
""",
        (),
    ),
    "elastic flight": (
        held(150.0)
        + """
[effects.vibration]
masses = [{ mass = 1.1, stiffness = 300, damping = 0.25 }]
limit = 0.1
[effects.lift-off]
restitution = 0.45
margin = 20
[effects.drive-torque]
""",
        (),
    ),
    "train of two under load": (
        held(900.0)
        + """
[effects.friction]
guide = 0.1
[effects.load]
segments = [0, 200, 30]
[effects.vibration]
output = 1
masses = [
  { mass = 0.5, stiffness = 900, viscous = 0.05 },
  { mass = 0.3, stiffness = 500, damping = 0.04, ground_stiffness = 20, ground_viscous = 0.02 },
]
[effects.drive-torque]
fluctuation = 0.1
""",
        (),
    ),
    "elastic train under load": (
        held(900.0)
        + """
[effects.load]
segments = [0, 200, 30]
[effects.vibration]
stiffness = 300
damping = 0.1
second = { natural_frequency = 300, mass_ratio = 0.2, damping = 0.03 }
[effects.power-balance]
[effects.reactions]
""",
        (),
    ),
    "elastic train": (
        held(900.0)
        + """
[effects.vibration]
masses = [
  { mass = 0.4, stiffness = 700, damping = 0.04 },
  { mass = 0.3, stiffness = 500, viscous = 0.03, ground_stiffness = 9 },
  { mass = 0.2, stiffness = 300, damping = 0.06 },
]
[effects.shock-spectrum]
highest_ratio = 4
""",
        (),
    ),
    "stall": (
        held(900.0)
        + """
[effects.kinematics]
[effects.speed-fluctuation]
moment_of_inertia = 0.002
no_load_speed = 300
stall_torque = 4
""",
        (WITHOUT_SPEED,),
    ),
    "labouring motor": (
        held(300.0)
        + """
[effects.friction]
guide = 0.2
guide_viscous = 0.05
[effects.kinematics]
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.004
file = "motor.csv"
limit = 0.2
""",
        (WITHOUT_SPEED,),
    ),
    "motor before a train": (
        held(600.0)
        + """
[effects.vibration]
natural_frequency = 80
damping = 0.05
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.02
no_load_speed = 500
stall_torque = 60
""",
        (WITHOUT_SPEED,),
    ),
    "jamming": (
        held(900.0)
        + """
[effects.friction]
guide = 0.3
guide_length = 20
guide_overhang = 110
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.02
no_load_speed = 500
stall_torque = 60
""",
        (),
    ),
    "all but jamming": (
        held(900.0)
        + """
[effects.friction]
guide = 0.3
guide_length = 25
guide_overhang = 90
[effects.kinematics]
[effects.shock-spectrum]
highest_ratio = 2
[effects.balance]
counterweight_radius = 25
grade = 40
""",
        (),
    ),
    "resonance": ("[effects.vibration]\nnatural_frequency = 30\n", ()),
    "wound spring": (
        """
[effects.inertia]
mass = 0.4
[effects.spring]
preload = 90
[effects.spring.wire]
diameter = 3
coil_diameter = 24
active_coils = 6
total_coils = 8
free_length = 52
density = 7900
shear_modulus = 79000
strength = 700
[effects.spring-surge]
[effects.lift-off]
[effects.contact-pressure]
width = 5
safety = 1.5
rating = 900
bearing = "ball"
life = 500
""",
        (),
    ),
    "jumps of the velocity": (
        "[effects.shock-spectrum]\nhighest_ratio = 3\ndamping = 0.05\n",
        (('"polynomial-345"', '"straight-line"'),),
    ),
    "windup": (
        held(500.0)
        + """
[effects.friction]
guide_viscous = 0.02
[effects.drive-torque]
[effects.camshaft-windup]
stiffness = 200
moment_of_inertia = 0.001
damping = 0.1
limit = 0.5
""",
        (),
    ),
    "windup before a train": (
        held(900.0)
        + """
[effects.vibration]
natural_frequency = 70
damping = 0.1
[effects.drive-torque]
[effects.camshaft-windup]
stiffness = 900
moment_of_inertia = 0.002
damping = 0.1
""",
        (),
    ),
}
"""Effects of the small scene, and its changes."""

OF_FIXTURES: Final[dict[str, tuple[str, str]]] = {
    "trimmed disc": (
        "cut_lobe",
        held(2000.0).replace("1.5", "50") + TOLD.replace("width = 8", "width = 5"),
    ),
    "trimmed ring": ("trimmed_ring", TURNED.replace("[60, -30]", "[90, 0]") + TOLD),
    "pair": (
        "conjugate_carriage",
        """
[effects.inertia]
mass = 4
[effects.gravity]
[effects.load]
constant = 60
[effects.friction]
guide = 0.12
roller_pin = 0.01
roller_pin_diameter = 9
[effects.kinematics]
[effects.contact-force]
[effects.reactions]
[effects.lift-off]
backlash = 0.04
restitution = 0.2
[effects.drive-torque]
[effects.contact-pressure]
width = 9
rating = 5000
[effects.power-balance]
[effects.vibration]
natural_frequency = 70
damping = 0.02
[state]
output = "rigid"
""",
    ),
    "groove with clearance": (
        "groove_clearance",
        """
[effects.inertia]
mass = 3
[effects.contact-force]
[effects.lift-off]
restitution = 0.5
[effects.drive-torque]
[effects.friction]
guide = 0.15
guide_viscous = 0.02
rolling = 0.02
[effects.roller-spin]
moment_of_inertia = 2e-5
traction = 0.05
""",
    ),
    "jamming in a groove": (
        "groove_clearance",
        """
[effects.inertia]
mass = 3
[effects.contact-force]
[effects.friction]
guide = 0.4
guide_length = 20
guide_overhang = 110
""",
    ),
    "faces of a yoke": (
        "constant_breadth",
        """
[effects.inertia]
mass = 2
[effects.gravity]
[effects.friction]
face = 0.1
guide = 0.1
guide_length = 60
guide_overhang = 30
[effects.contact-force]
[effects.reactions]
bearings = [-20, 30]
[effects.lift-off]
[effects.drive-torque]
[effects.contact-pressure]
width = 8
[effects.power-balance]
""",
    ),
    "face of a rocker": (
        "flat_rocker",
        TURNED.replace("\nroller_mass = 0.1", "")
        + TOLD.replace("rating = 4000\n", "")
        + "[effects.friction]\nface = 0.1\npivot = 0.1\npivot_diameter = 15\npivot_viscous = 0.01\n"
        "[effects.balance]\nhole_radius = 25\nhole_diameter = 9\n",
    ),
    "rocker and slider": (
        "querhub",
        """
[effects.inertia]
mass = 1.2
moment_of_inertia = 0.02
coupler_mass = 0.3
coupler_centre = 0.4
coupler_moment = 0.0005
[effects.gravity]
[effects.spring]
stiffness = 4
preload = 500
[effects.friction]
slider = 5
guide_viscous = 0.02
pivot = 0.1
pivot_diameter = 20
"""
        + TOLD,
    ),
    "crank driven by a slider": (
        "crank_slider",
        """
[effects.inertia]
mass = 1.2
coupler_mass = 0.3
output_moment = 0.003
[effects.gravity]
[effects.load]
segments = [0, 2, 0, -1, 0]
[effects.spring]
stiffness = 4
preload = 300
[effects.friction]
guide = 0.1
[effects.vibration]
torsional_stiffness = 60
damping = 0.06
"""
        + TOLD.replace("[effects.lift-off]\n", ""),
    ),
    "speed curve": (
        "points",
        held(200.0)
        + TOLD.replace("[effects.lift-off]\n", "")
        + """
[effects.kinematics]
[effects.vibration]
natural_frequency = 40
damping = 0.1
""",
    ),
    "motor that the pivot stops": (
        "shuttle",
        TURNED.replace("[60, -30]", "[40, 20]")
        + """
[effects.friction]
pivot = 0.3
pivot_diameter = 40
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.01
no_load_speed = 200
stall_torque = 1
""",
    ),
    "motor before a pivot": (
        "setzhub",
        TURNED.replace("[60, -30]", "[40, 20]")
        + """
[effects.friction]
pivot = 0.1
pivot_diameter = 20
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.01
no_load_speed = 200
stall_torque = 60
""",
    ),
    "rocker before a train of moments": (
        "shuttle",
        TURNED.replace("[60, -30]", "[100, 10]")
        + """
[effects.friction]
rolling = 0.02
[effects.vibration]
limit_angle = 0.2
[[effects.vibration.moments]]
moment = 0.004
torsional_stiffness = 3000
viscous_torque = 0.02
[[effects.vibration.moments]]
moment = 0.006
torsional_stiffness = 900
damping = 0.05
ground_torsional_stiffness = 20
ground_viscous_torque = 0.01
[effects.drive-torque]
""",
    ),
}
"""Effects of scenes of the fixtures."""

RAN: Final = "[effects.kinematics]\n[effects.contact-force]\n[effects.drive-torque]\n"

OF_STATES: Final[dict[str, tuple[str, str, dict[str, str]]]] = {
    "written contour": (
        "plate_translating",
        held(400.0) + RAN.replace("[effects.contact-force]\n", ""),
        {"contour": "arcs"},
    ),
    "written polyline behind a linkage": (
        "crank_slider",
        "[effects.inertia]\nmass = 2\n[effects.load]\nconstant = 3\n" + RAN,
        {"contour": "polyline"},
    ),
    "written flank of a groove": (
        "groove",
        "[effects.inertia]\nmoment_of_inertia = 0.05\n[effects.lift-off]\n" + RAN,
        {"contour": "arcs", "flank": "outer"},
    ),
    "written disc of a pair": (
        "conjugate_lever",
        "[effects.inertia]\nmoment_of_inertia = 0.05\n" + RAN,
        {"contour": "spline", "flank": "return"},
    ),
}
"""Effects of scenes of the fixtures for the motion that their written contours make."""

TRIMMED: Final = {"trimmed " + name.replace("_", " "): name for name in STEEPER}
"""Discs that do not make the whole motion of a linkage or a face."""

DEFAULT_SPEED: Final = {"flat_rocker": 240}
"""Of scenes that have none."""


def text_of(name: str) -> str:
    effects, changes = OF_SMALL[name]
    return changed(f"{SMALL}{effects}", *changes)


def small(name: str) -> Design:
    """The small scene with the effects of `OF_SMALL`."""
    return Design(parse_scene(text_of(name), str(SCENES.parent / "results" / "small.toml")))


def of_fixture(name: str) -> Design:
    """A scene of the fixtures with the effects of `OF_FIXTURES`."""
    scene, effects = OF_FIXTURES[name]
    speed = DEFAULT_SPEED.get(scene)
    return design(scene, effects, *([("[cam]\n", f"[cam]\nspeed = {speed}\n")] if speed else []))


def of_state(name: str) -> Design:
    """One of `OF_STATES` or of `TRIMMED`."""
    if name in TRIMMED:
        return trimmed(TRIMMED[name])
    scene, effects, state = OF_STATES[name]
    edits = {f"state.{key}": each for key, each in ({"motion": "written"} | state).items()}
    return Design(design(scene, effects).scene.with_values({**edits, "output.tolerance": 0.01}))
