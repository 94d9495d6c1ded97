"""Machines whose tolerances are analysed in tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from camgeo.design.design import Design
from camgeo.geometry.outline.path import Flank
from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.tolerancing.linear import Linear, replay_machines
from camgeo.studies.tolerancing.stated import (
    Deviations,
    NominalMachine,
    Sensitivities,
    StatedTolerances,
    UnitDeviation,
)

FIXTURES = Path(__file__).parents[2] / "fixtures"

LEVER = FIXTURES / "tolerance" / "lever.toml"

ANGLES = np.radians(np.arange(0.37, 360.0, 6.0))
"""Off the joints of the motions."""

ROUND = 40.0
"""Base radius [mm] of the round cams."""

FOLLOWERS: dict[str, dict[str, Any]] = {
    "translating-roller": {"roller_radius": 8, "offset": 6, "guide_angle": 70},
    "oscillating-roller": {"roller_radius": 8, "pivot": [70, 20], "arm": 60, "arm_side": "cw"},
    "translating-flat": {"guide_angle": 70},
    "oscillating-flat": {"pivot": [-75, 10], "face_offset": 5, "arm_side": "cw"},
}
"""A follower of each kind."""


def sensitivities(scene: Scene, phi: np.ndarray[Any, Any] = ANGLES) -> Sensitivities:
    """Of a scene's machine, on its main flank."""
    cam = Design(scene).cam
    return Sensitivities(NominalMachine(cam, Flank(cam.contact.main)), phi)


def fixture(name: str) -> Sensitivities:
    """The same of a scene in fixtures/scenes."""
    return sensitivities(load_scene(FIXTURES / "scenes" / f"{name}.toml"))


def round_cam(kind: str, contact: dict[str, str] | None = None, **tables: Any) -> Sensitivities:
    """A round disc, whose follower of that kind rests all round, perhaps on another flank."""
    return sensitivities(
        Scene({
            "camgeo": 1,
            "name": "round",
            "cam": {"rotation": "cw"},
            "follower": {"kind": kind, "base_radius": ROUND, **FOLLOWERS[kind], **(contact or {})},
            "motion": [{"dwell": 360}],
            **tables,
        })
    )  # fmt: skip


def errors(nominal: Sensitivities, unit: UnitDeviation, *sizes: float) -> np.ndarray[Any, Any]:
    """(machines, angles) of the position, of machines that deviate by `sizes` of a dimension."""
    deviations = Deviations(len(sizes), {unit.freedom: np.array(sizes) * unit.factor})
    return np.asarray(replay_machines(nominal, deviations).position[0] - nominal.positions[0])


def turned(place: complex, nominal: Sensitivities) -> np.ndarray[Any, Any]:
    """(angles,) a place on the cam, in the frame."""
    return np.asarray(place * np.exp(1j * nominal.machine.cam.rotation * nominal.phi))


def linear_of(scene: Scene) -> Linear:
    """Its linear analysis."""
    return Linear(StatedTolerances.from_design(Design(scene)))


def lifter(
    *dimensions: dict[str, Any], motion: list[dict[str, Any]] | None = None, **table: Any
) -> Linear:
    """A flat face, on a round disc unless it has a motion; its [tolerance] has this `table`."""
    return linear_of(
        Scene({
            "camgeo": 1,
            "name": "lifter",
            "cam": {"rotation": "ccw"},
            "follower": {
                "kind": "translating-flat", "base_radius": ROUND, **FOLLOWERS["translating-flat"],
            },
            "motion": motion or [{"dwell": 360}],
            "tolerance": {"dimension": list(dimensions), **table},
        })
    )  # fmt: skip
