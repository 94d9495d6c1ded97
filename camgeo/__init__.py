"""camgeo: from a scene file to cams for machines and CAD programs.

import camgeo
design = camgeo.load("scene.toml")
design.findings                      # checks
design.write("out", ["dxf", "3mf"])  # files, with their certificate

larger = camgeo.Design(design.scene.with_values({"follower.base_radius": 40}))
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from camgeo._version import __version__
from camgeo.earlier import keep_earlier_names
from camgeo.errors import (
    CamgeoError,
    Fault,
    GeometryError,
    OutputError,
    SceneError,
    ToleranceError,
    UndercutError,
)

if TYPE_CHECKING:
    from pathlib import Path

    from camgeo.check.finding import Finding, Limits
    from camgeo.design.design import Design
    from camgeo.geometry.pitch_curve import PitchCurve
    from camgeo.geometry.working_curve import WorkingCurve
    from camgeo.kinematics.mechanism.four_bar import FourBar
    from camgeo.kinematics.mechanism.linkage import LinkedMotion
    from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
    from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
    from camgeo.kinematics.mechanism.slider_crank import SliderCrank
    from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
    from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
    from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
    from camgeo.kinematics.plan import Dwell, MotionPlan, Move
    from camgeo.scene.scene import Scene

WHEN_ASKED: Final = {
    "Design": "camgeo.design.design",
    "Dwell": "camgeo.kinematics.plan",
    "Finding": "camgeo.check.finding",
    "FourBar": "camgeo.kinematics.mechanism.four_bar",
    "Limits": "camgeo.check.finding",
    "LinkedMotion": "camgeo.kinematics.mechanism.linkage",
    "MotionPlan": "camgeo.kinematics.plan",
    "Move": "camgeo.kinematics.plan",
    "OscillatingFlat": "camgeo.kinematics.mechanism.oscillating_flat",
    "OscillatingRoller": "camgeo.kinematics.mechanism.oscillating_roller",
    "PitchCurve": "camgeo.geometry.pitch_curve",
    "Scene": "camgeo.scene.scene",
    "SliderCrank": "camgeo.kinematics.mechanism.slider_crank",
    "SliderDrivenCrank": "camgeo.kinematics.mechanism.slider_driven_crank",
    "TranslatingFlat": "camgeo.kinematics.mechanism.translating_flat",
    "TranslatingRoller": "camgeo.kinematics.mechanism.translating_roller",
    "WorkingCurve": "camgeo.geometry.working_curve",
}
"""Public names by module, imported on first use: a run needs only a few, and the command line must
be ready for Ctrl-C before it imports anything large."""


keep_earlier_names()


def __getattr__(name: str) -> Any:
    if name in WHEN_ASKED:
        return getattr(import_module(WHEN_ASKED[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def load(path: str | Path) -> Design:
    """Read a scene file and return its design; nothing is computed yet.

    Raises
    ------
    SceneError
        If anything in the file is wrong; all faults at once.
    """
    from camgeo.design.design import Design
    from camgeo.scene.scene import load_scene

    return Design(load_scene(path))


def loads(text: str, *, folder: str | Path | None = None) -> Design:
    """Return the design of a scene's TOML text; `folder` holds the files that the scene names.

    Raises
    ------
    SceneError
        If anything in the text is wrong; all faults at once.
    """
    from camgeo.design.design import Design
    from camgeo.scene.scene import parse_scene

    return Design(parse_scene(text, folder=folder))


__all__ = [
    "CamgeoError",
    "Design",
    "Dwell",
    "Fault",
    "Finding",
    "FourBar",
    "GeometryError",
    "Limits",
    "LinkedMotion",
    "MotionPlan",
    "Move",
    "OscillatingFlat",
    "OscillatingRoller",
    "OutputError",
    "PitchCurve",
    "Scene",
    "SceneError",
    "SliderCrank",
    "SliderDrivenCrank",
    "ToleranceError",
    "TranslatingFlat",
    "TranslatingRoller",
    "UndercutError",
    "WorkingCurve",
    "__version__",
    "load",
    "loads",
]
