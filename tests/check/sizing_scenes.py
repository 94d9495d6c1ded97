"""The scenes for the tests of sizing, and their requirements."""

from __future__ import annotations

from pathlib import Path

import camgeo
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing.task import Task, task_of

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
EASY = ["plate_translating", "setzhub", "ring", "querhub", "straight_moves"]
BENT = ["schnitt", "groove", "vorschub"]
"""Where the transmission angle alone decides, and where the curvature does too."""


def required(name: str) -> tuple[Task, float, float]:
    design = camgeo.load(SCENES / f"{name}.toml")
    limits = design.scene.limits
    angle = transmission_angle_limit(design.cam, limits)
    return task_of(design.cam), angle, limits.radius_ratio
