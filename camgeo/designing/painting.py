"""What is painted while the designer edits: the turning mechanism, and diagrams."""

from __future__ import annotations

from typing import Any

from camgeo.designing.job import Job
from camgeo.designing.recent import Recent
from camgeo.errors import CamgeoError
from camgeo.figure import motion
from camgeo.figure.animation import animation


def curves(job: Job, recent: Recent) -> dict[str, Any]:
    """The scene as pictures."""
    design = recent.design(job)
    scene = design.scene
    turn = None
    if scene.follower is not None:
        try:
            turn = animation(design.disc).to_data()
        except CamgeoError:  # the findings say so
            turn = None
    figure = motion.of_drive(design.name, scene.unit, design.drive, scene.lift_unit)
    charts = [{"name": "motion", "figure": figure.to_data()}]
    return {"name": design.name, "unit": scene.unit, "animation": turn, "charts": charts}
