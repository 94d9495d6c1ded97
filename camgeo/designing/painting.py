"""What is painted while the designer edits: the turning mechanism, and diagrams.

Lines have as few points as are seen, see `camgeo.figure.thinned`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any, Final

from camgeo.answers.report import Chart, of_effects
from camgeo.answers.report.readings import Reading, plain, readings, shown
from camgeo.design import Design
from camgeo.designing.edits import changed
from camgeo.designing.faults import sentence, told
from camgeo.designing.form import form
from camgeo.designing.handles import handles
from camgeo.designing.job import Job, JobError
from camgeo.designing.packing import packed
from camgeo.designing.plan import plan
from camgeo.designing.recent import Recent
from camgeo.errors import CamgeoError, SceneError
from camgeo.figure import diagrams, motion
from camgeo.figure.animation import animation
from camgeo.figure.model import Figure
from camgeo.figure.thinned import thinned, thinned_turn
from camgeo.scene.document import Document

MOTION: Final = "motion"
"""Key of the scene's segments."""


def curves(job: Job, recent: Recent) -> dict[str, Any]:
    """The scene as pictures, and all that can be changed in it.

    With faults there are no pictures; form and plan are there as long as the text is TOML.
    """
    try:
        design = recent.design(job)
    except SceneError as error:
        try:
            found = recent.document(job)
        except SceneError:  # no TOML, which has no form
            return {"faults": told(error), "form": [], "plan": []}
        return {"faults": told(error), **_stated(found, recent)}
    stated = _stated(design.scene.stated.scene, recent)
    return {**painted(design, recent), **_held(design), **stated}


def _moved(job: Job, recent: Recent) -> dict[str, Any]:
    """Of the `curves` what moves in a drag: without the fields of the scene, and without a diagram
    that is the last one.
    """
    drawn = recent.last("motion")
    found = painted(design := recent.design(job), recent, moving=True)
    if drawn is not None and recent.last("motion") is drawn:
        found["charts"] = [each for each in found["charts"] if each is not drawn]
    return {**found, **_held(design)}


def _held(design: Design) -> dict[str, Any]:
    held = _tried(lambda: {"handles": [each.to_data() for each in handles(design)]})
    return held or {"handles": []}


def change(job: Job, recent: Recent) -> dict[str, Any]:
    """The text with the change that the arguments ask for, its name, and the `curves` of the text.

    A change that cannot be made leaves the text as it is: `refused` says why, in a sentence. One
    after which the scene is not valid is made, and `faults` say what is wrong.

    With the argument `moving`, for a change that is one of many, `moving` is true if the scene is
    valid, and of the `curves` there is only what differs or is soon made, see `_moved`.
    """
    try:
        design = recent.design(job)
    except SceneError:  # such a text can be changed too
        design = None
    try:
        found = changed(job.text, job.file, job.folder or None, job.arguments, design)
    except JobError:
        raise
    except CamgeoError as error:
        return {"text": job.text, "refused": sentence(error), "faults": told(error)}
    after = replace(job, text=found.text)
    if found.scene is not None:
        recent.made(after, found.scene)
    if job.arguments.get("moving") is True and found.scene is not None:
        head = {"text": found.text, "moving": True, "label": found.label}
        return {**head, **_moved(after, recent)}
    return {"text": found.text, "label": found.label, **curves(after, recent)}


def _stated(found: Document, recent: Recent) -> dict[str, Any]:
    # Joints are dragged more often than anything else, and the form does not show them.
    shown = repr({key: value for key, value in found.exact.items() if key != MOTION})
    return {
        "form": recent.kept("form", (shown,), lambda: [each.to_data() for each in form(found)]),
        "plan": [each.to_data() for each in plan(found)],
        "effects": sorted(effects) if isinstance(effects := found.at(("effects",)), dict) else [],
    }


def painted(design: Design, recent: Recent, *, moving: bool = False) -> dict[str, Any]:
    """A design as pictures; if it is `moving`, as of `camgeo.figure.animation.animation`.

    `animation` is None if there is no disc or the mechanism has no position somewhere; a diagram
    that cannot be computed is left out: the findings say why.
    """
    scene = design.scene
    turn = None
    if scene.follower is not None:
        turn = _tried(lambda: packed(thinned_turn(animation(design.disc, moving=moving))))
    charts = [chart for make in _wanted(design, recent) if (chart := _tried(make)) is not None]
    return {"name": scene.name, "unit": scene.unit, "animation": turn, "charts": charts}


def effect_charts(design: Design) -> list[dict[str, Any]]:
    """The diagrams of the scene's effects, which take longer than those of `painted`."""
    if design.scene.follower is None or not design.scene.effects:
        return []
    try:
        wanted = list(of_effects(design.disc))
    except CamgeoError:  # the findings say why
        return []
    made = (
        _tried(partial(_chart, f"effects-{number}", title, make))
        for number, (title, make) in enumerate(wanted, start=1)
    )
    return [chart for chart in made if chart is not None]


def _wanted(design: Design, recent: Recent) -> Iterator[Callable[[], dict[str, Any]]]:
    """What makes each diagram that is soon made."""
    scene, drive = design.scene, design.drive
    moves = partial(motion.of_drive, design.name, scene.unit, drive, scene.lift_unit)
    moved = design.name, scene.unit, drive, scene.lift_unit
    chart = partial(_chart, "motion", "motion plan and diagrams", moves)
    yield partial(recent.kept, "motion", moved, chart)
    if scene.follower is None:
        return
    for disc in design.discs:
        own = disc is design.disc
        name, of = ("", "") if own else ("-return", f" of {disc.name}")
        angles = partial(diagrams.transmission_angle, disc)
        yield partial(_chart, f"transmission{name}", f"transmission angle{of}", angles)
        bends = partial(diagrams.curvature, disc)
        yield partial(_chart, f"curvature{name}", f"curvature{of}", bends)


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
        "figure": packed(thinned(figure)),
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
