"""The scenes that sizing is tested with, and what they require."""

from __future__ import annotations

from pathlib import Path

import camgeo
from camgeo.check.sizing.task import Task
from camgeo.mechanism.kinds import require_roller

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
EASY = ["plate_translating", "setzhub", "ring", "querhub", "straight_moves"]
BENT = ["schnitt", "groove", "vorschub"]
"""Where the transmission angle alone decides, and where the curvature does too."""


def required(name: str) -> tuple[Task, float, float]:
    design = camgeo.load(SCENES / f"{name}.toml")
    follower = require_roller(design.follower)
    task = Task(design.motion, follower, design.rotation, design.contact)
    limits = design.specification.limits
    return task, design.transmission_angle_limit, limits.radius_ratio
