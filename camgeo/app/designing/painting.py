"""What is painted while the designer edits: the turning mechanism, and diagrams.

Lines have as few points as are seen, see `camgeo.pictures.thinned`.
"""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np

from camgeo.app.answers.answer import in_a_line
from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.edits import changed
from camgeo.app.designing.faults import faults_as_data
from camgeo.app.designing.form import form, plan
from camgeo.app.designing.handles import handles
from camgeo.app.designing.recent import Recent
from camgeo.design.design import Design
from camgeo.errors import CamgeoError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.charts import (
    MOTION,
    Chart,
    Reading,
    disc_diagrams,
    motion_diagram,
    of_effects,
    plain,
    readings,
    shown,
)
from camgeo.pictures.mechanism import Animation, animation
from camgeo.pictures.model import Figure, figure_data, listed
from camgeo.pictures.thinned import thinned, thinned_turn
from camgeo.scene.values import Document


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
            return {"faults": faults_as_data(error), "form": [], "plan": []}
        return {"faults": faults_as_data(error), **_stated(found, recent)}
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
    held: list[dict[str, Any]] = []
    with suppress(CamgeoError):  # the findings say why
        held = [each.to_data() for each in handles(design)]
    return {"handles": held}


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
        return {"text": job.text, "refused": in_a_line(error), "faults": faults_as_data(error)}
    after = replace(job, text=found.text)
    if found.scene is not None:
        recent.made(after, found.scene)
    if job.arguments.get("moving") is True and found.scene is not None:
        head = {"text": found.text, "moving": True, "label": found.label}
        return {**head, **_moved(after, recent)}
    return {"text": found.text, "label": found.label, **curves(after, recent)}


def _stated(found: Document, recent: Recent) -> dict[str, Any]:
    # Joints are dragged more often than anything else, and the form does not show them.
    shown = repr({key: value for key, value in found.exact.items() if key != "motion"})
    return {
        "form": recent.kept("form", (shown,), lambda: form(found)),
        "plan": plan(found),
        "effects": sorted(effects) if isinstance(effects := found.at(("effects",)), dict) else [],
    }


def painted(design: Design, recent: Recent, *, moving: bool = False) -> dict[str, Any]:
    """A design as pictures; if it is `moving`, as of `camgeo.pictures.mechanism.animation`.

    `animation` is None if there is no disc or the mechanism has no position somewhere; a diagram
    that cannot be computed is left out: the findings say why.
    """
    scene = design.scene
    turn = None
    if scene.follower is not None:
        with suppress(CamgeoError):
            turn = packed(thinned_turn(animation(design.disc, moving=moving)))
    charts = []
    for make in _wanted(design, recent):
        with suppress(CamgeoError):
            charts.append(make())
    return {"name": scene.name, "unit": scene.unit, "animation": turn, "charts": charts}


def effect_charts(design: Design) -> list[dict[str, Any]]:
    """The diagrams of the scene's effects, which take longer than those of `painted`."""
    if design.scene.follower is None or not design.scene.effects:
        return []
    try:
        wanted = list(of_effects(design.disc))
    except CamgeoError:  # the findings say why
        return []
    charts = []
    for number, (title, make) in enumerate(wanted, start=1):
        with suppress(CamgeoError):
            charts.append(_chart(f"effects-{number}", title, make))
    return charts


def _wanted(design: Design, recent: Recent) -> Iterator[Callable[[], dict[str, Any]]]:
    """What makes each diagram that is soon made."""
    scene, drive = design.scene, design.drive
    moved = design.name, scene.unit, drive, scene.lift_unit
    chart = partial(_chart, "motion", MOTION, partial(motion_diagram, design))
    yield partial(recent.kept, "motion", moved, chart)
    if scene.follower is not None:
        yield from (partial(_chart, *each) for each in disc_diagrams(design))


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


# -- packing --------------------------------------------------------------------------------------
# Pictures as JSON data, their long lists of numbers packed: digits take longer to write and to
# read than all else that is done for a frame of a drag.


FEWEST: Final = 32
"""Numbers that are packed; fewer are a list."""

APART: Final = 1e-6
"""By which packed numbers may be off, relative to the extent of theirs along each axis."""

ROUNDING: Final = 2.0**-24
LEAST: Final = 2.0**-150
"""Most by which a single float is off, relative to its value and at all."""

LARGEST: Final = float(np.finfo(np.float32).max)
"""Beyond it there is no single float."""


def packed(picture: Figure | Animation) -> dict[str, Any]:
    """As `picture.to_data()`, with long arrays packed: in `numbers`, in base 64, all of them as
    binary numbers in the order of the array, of the type `packed`, "f4" or "f8", the lowest byte
    first; `shape` is that of the array. A gap is not a number.
    """
    data: dict[str, Any] = figure_data(picture, _packed)
    return data


def _packed(array: FloatArray) -> Any:
    if array.size < FEWEST:
        return listed(array)
    rows = array.reshape(-1, array.shape[-1] if array.ndim > 1 else 1)
    low, high = np.fmin.reduce(rows), np.fmax.reduce(rows)  # leave gaps out
    size = np.maximum(-low, high)
    fine = np.maximum(ROUNDING * size, LEAST) <= APART * (high - low)
    kind = "f4" if bool(np.all(fine & (size <= LARGEST))) else "f8"
    text = b64encode(array.astype(f"<{kind}").tobytes()).decode("ascii")
    return {"packed": kind, "shape": list(array.shape), "numbers": text}
