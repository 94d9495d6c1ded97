"""camgeo: from a scene file to cams that machines and CAD programs take.

import camgeo
design = camgeo.load("scene.toml")
design.findings                      # checks
design.write("out", ["dxf", "3mf"])  # files, with their certificate
"""

from __future__ import annotations

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
from camgeo.scene.open import load

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
