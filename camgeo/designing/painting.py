"""What is painted while the designer edits: the turning mechanism, and diagrams.

Lines have as few points as are seen, see `camgeo.figure.thinned`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from camgeo.answers.report import Chart
from camgeo.answers.report.readings import Reading, plain, readings, shown
from camgeo.design import Design
from camgeo.designing.job import Job
from camgeo.designing.recent import Recent
from camgeo.errors import CamgeoError
from camgeo.figure import diagrams, motion
from camgeo.figure.animation import animation
from camgeo.figure.model import Figure, data_of
from camgeo.figure.thinned import thinned, thinned_turn


def curves(job: Job, recent: Recent) -> dict[str, Any]:
    """The scene as pictures; see `painted`. SceneError if it is not valid."""
    return painted(recent.design(job))


def painted(design: Design) -> dict[str, Any]:
    """A design as pictures.

    `animation` is None if there is no disc or the mechanism has no position somewhere; a diagram
    that cannot be computed is left out: the findings say why.
    """
    scene = design.scene
    turn = None
    if scene.follower is not None:
        turn = _tried(lambda: thinned_turn(animation(design.disc)).to_data())
    charts = [
        chart
        for name, title, make in _wanted(design)
        if (chart := _tried(partial(_chart, name, title, make))) is not None
    ]
    return {"name": scene.name, "unit": scene.unit, "animation": turn, "charts": charts}


def _wanted(design: Design) -> Iterator[tuple[str, str, Callable[[], Figure]]]:
    """Name, title and maker of each diagram that is soon made."""
    scene = design.scene
    make = partial(motion.of_drive, design.name, scene.unit, design.drive, scene.lift_unit)
    yield "motion", "motion plan and diagrams", make
    if scene.follower is None:
        return
    for disc in design.discs:
        own = disc is design.disc
        name, of = ("", "") if own else ("-return", f" of {disc.name}")
        yield (
            f"transmission{name}",
            f"transmission angle{of}",
            partial(diagrams.transmission_angle, disc),
        )
        yield f"curvature{name}", f"curvature{of}", partial(diagrams.curvature, disc)


def _tried(make: Callable[[], dict[str, Any]]) -> dict[str, Any] | None:
    try:
        return make()
    except CamgeoError:
        return None


def _chart(name: str, title: str, make: Callable[[], Figure]) -> dict[str, Any]:
    figure = make()
    chart = Chart(title, figure, readings(figure))
    return {
        "name": name,
        "title": title,
        "figure": data_of(thinned(figure)),
        "sentence": chart.sentence,
        "readings": [_reading(each) for each in chart.readings],
    }


def _reading(found: Reading) -> dict[str, Any]:
    """Extremes as they are read, and their cam angles in degrees."""
    return {
        "name": plain(found.name),
        "low": shown(found.low),
        "low_at": round(math.degrees(found.low_at), 3),
        "high": shown(found.high),
        "high_at": round(math.degrees(found.high_at), 3),
        "limits": [[name, shown(value)] for name, value in found.limits],
    }
