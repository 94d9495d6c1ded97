"""camgeo: from a scene file to cams that machines and CAD programs take.

import camgeo
design = camgeo.load("scene.toml")
design.findings                      # checks
design.write("out", ["dxf", "3mf"])  # files, with their certificate
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgeo._version import __version__
from camgeo.check.finding import Finding
from camgeo.check.limits import Limits
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.design import Design
from camgeo.errors import (
    CamgeoError,
    Fault,
    GeometryError,
    OutputError,
    SceneError,
    ToleranceError,
    UndercutError,
)
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.plan import Dwell, MotionPlan, Move

if TYPE_CHECKING:
    from pathlib import Path


def load(path: str | Path) -> Design:
    """Read a scene file and return its design; nothing is computed yet.

    Raises
    ------
    SceneError
        If anything in the file is wrong; all faults at once.
    """
    from camgeo.scene.load import load_scene  # the engine works without scene files

    return Design(load_scene(path))


__all__ = [
    "CamgeoError",
    "Design",
    "Dwell",
    "Fault",
    "Finding",
    "GeometryError",
    "Limits",
    "LinkedMotion",
    "MotionPlan",
    "Move",
    "OscillatingRoller",
    "OutputError",
    "PitchCurve",
    "SceneError",
    "SliderCrank",
    "ToleranceError",
    "TranslatingRoller",
    "UndercutError",
    "WorkingCurve",
    "__version__",
    "load",
]
