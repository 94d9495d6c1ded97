"""The only entry to the computations of the designer: from a job to JSON data, with pictures."""

from __future__ import annotations

import base64
import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any, Final

import numpy as np

from camgeo.app.answers.answer import MARKS, findings_summary, one_line, text
from camgeo.app.answers.build import poor_findings
from camgeo.app.answers.check import Check, check
from camgeo.app.answers.report import Advised, advised, coarse_solids, triangles
from camgeo.app.answers.size import CamSize
from camgeo.app.answers.size import size as size_of
from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.edits import changed
from camgeo.app.designing.faults import faults_as_data
from camgeo.app.designing.form import Fields
from camgeo.app.designing.handles import handles
from camgeo.check.cures.remedies import Cure
from camgeo.check.finding import RETURN, Finding
from camgeo.check.sizing.smallest import Rating
from camgeo.design.design import Design
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.dynamics.effects.registry import effect_names, find_effect
from camgeo.errors import CamgeoError, GeometryError, SceneError
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.laws import FAMILIES, OPTIONS
from camgeo.kinematics.laws.comparison import law_entry
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import task_ends
from camgeo.kinematics.plan import FULL_TURN, MotionPlan, joints
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, frozen
from camgeo.pictures import laws as picture
from camgeo.pictures.mechanism import Animation, animation
from camgeo.pictures.model import Area, Figure, Line, Panel, figure_data
from camgeo.pictures.model import listed as nested
from camgeo.pictures.motion import CURVE_POINTS, CurveExtremes, format_value, plain, readings
from camgeo.pictures.plots import MOTION_TITLE, Chart, disc_diagrams, motion_diagram, of_effects
from camgeo.scene.scene import Scene, parse_scene
from camgeo.scene.toml import TEMPLATE_KINDS, template
from camgeo.scene.values import (
    Document,
    Source,
    document,
    document_of_tree,
    encode_scene,
    with_edits,
)
from camgeo.units import MM_PER, TURN, in_unit, listed

# -- recent ----------------------------------------------------------------------------------------
# Results that jobs reuse: the last design, for scenes that are edits of it.


class Recent:
    """The design of the last scene that was valid, unless it names files, which may change."""

    def __init__(self) -> None:
        self._place: tuple[str, str, str] = ("", "", "")
        self._design: Design | None = None
        self._cache: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def cached(self, name: str, inputs: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """The last result of that name, if its inputs were equal texts and the same objects; else
        that of `make`, which is kept.

        Nobody must change it.
        """
        known = self._cache.get(name)
        if known is None or not all(map(_same, known[0], inputs)):
            known = self._cache[name] = inputs, make()
        return known[1]

    def last(self, name: str) -> Any:
        """The last result of that name, see `cached`; None if there is none."""
        known = self._cache.get(name)
        return None if known is None else known[1]

    def design(self, job: Job) -> Design:
        """The design of a job's scene; SceneError if it is not valid."""
        place = job.text, job.file, job.folder
        if self._design is not None and place == self._place:
            return self._design
        return self._remember(job, self._new_design(job))

    def restate(self, job: Job, error: CamgeoError) -> None:
        """Put the lengths of an error into the unit of the job's scene, if that is the last one."""
        if self._design is not None and (job.text, job.file, job.folder) == self._place:
            self._design.scene.restate(error)

    def note_scene(self, job: Job, scene: Scene) -> None:
        """Remember the scene of a job, an edit of the last one that shares its unchanged parts."""
        if self._design is not None and (job.file, job.folder) == self._place[1:]:
            self._remember(job, self._sharing(scene, self._design))

    def _remember(self, job: Job, design: Design) -> Design:
        self._place = job.text, job.file, job.folder
        self._design = None if design.scene.files else design
        return design

    def _sharing(self, scene: Scene, earlier: Design) -> Design:
        """The design of an edited scene; it has the drive of the earlier one if their motions
        agree.
        """
        design = Design(scene)
        if _moves_alike(scene, earlier.scene):
            design.__dict__["drive"] = earlier.drive
        return design

    def _new_design(self, job: Job) -> Design:
        """The design of the job's scene, which shares unchanged parts with the last one."""
        earlier = self._design
        if earlier is None or (job.file, job.folder) != self._place[1:]:
            return Design(parse_scene(job.text, job.file, job.folder or None))
        values = self.document(job)
        source = Source.from_file(job.file, job.folder or None, job.text)
        scene = Scene.from_document(_grafted(values, earlier.scene), source, earlier.scene)
        return self._sharing(scene, earlier)

    def document(self, job: Job) -> Document:
        """The values of a job's text, right or wrong; SceneError if it is not TOML."""
        return document(encode_scene(job.text))

    def edited(self, job: Job, edits: Mapping[str, Any]) -> Scene:
        """The scene of a job with other values; SceneError unless these make it valid."""
        values = document_of_tree(with_edits(self.document(job).exact, edits))
        return Scene.from_document(values, Source.from_file(job.file, job.folder or None, job.text))


def _same(one: Any, other: Any) -> bool:
    return one is other or (isinstance(one, str) and one == other)


def _grafted(scene_values: Document, earlier: Scene) -> Document:
    """The document with its tables replaced by equal ones of the `earlier` scene.

    What has been built from a table is then recognized and not built again.
    """
    then = earlier.stated.scene.exact
    # What Python prints tells 1 from true, and 1.0 from 1.00.
    exact: dict[str, Any] = {
        key: then[key] if key in then and repr(then[key]) == repr(value) else value
        for key, value in scene_values.exact.items()
    }
    return replace(scene_values, exact=exact)


def _moves_alike(scene: Scene, other: Scene) -> bool:
    """Whether the drives of two scenes are the same."""
    return (
        scene.plan is other.plan
        and scene.linkage is other.linkage
        and scene.lift_unit == other.lift_unit
        and scene.speed == other.speed
        and scene.speed_curve is other.speed_curve
    )


# -- arguments ------------------------------------------------------------------------------------
# The arguments of jobs, which are checked when they are read.


class Arguments:
    """The arguments of a job; each method raises JobError unless the argument is of its type."""

    def __init__(self, job: Job) -> None:
        self._given = job.arguments

    def flag(self, name: str, *, otherwise: bool) -> bool:
        """True or false; `otherwise` if it is not given."""
        value = self._given.get(name, otherwise)
        if not isinstance(value, bool):
            raise self._wrong(name, "true or false")
        return value

    def number(self, name: str) -> float | None:
        """A finite number; None if it is not given."""
        value = self._given.get(name)
        return None if value is None else self._finite(name, value)

    def pair(self, name: str) -> tuple[float, float] | None:
        """Two finite numbers; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or len(value) != 2 or None in value:
            raise self._wrong(name, "two numbers")
        low, high = (self._finite(name, item) for item in value)
        return low, high

    def index(self, name: str) -> int:
        """The position of something in a list, from 0."""
        value = self._given.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**31:
            raise self._wrong(name, "a position from 0")
        return value

    def texts(self, name: str) -> tuple[str, ...] | None:
        """A list of texts; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or not all(isinstance(item, str) for item in value):
            raise self._wrong(name, "a list of texts")
        return tuple(value)

    def _finite(self, name: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._wrong(name, "a number")
        if not abs(value) <= sys.float_info.max:
            raise self._wrong(name, "a finite number")
        return float(value)

    def _wrong(self, name: str, allowed: str) -> JobError:
        return JobError(f"{name} must be {allowed}")


# -- painting --------------------------------------------------------------------------------------
# Pictures while the designer edits: the turning mechanism, and diagrams.
#
# Lines have only as many points as can be seen, see `thinned`.


def curves(job: Job, recent: Recent) -> dict[str, Any]:
    """The pictures of the scene, and everything that can be changed in it.

    With faults there are no pictures; form and plan are there as long as the text is TOML.
    """
    try:
        design = recent.design(job)
    except SceneError as error:
        try:
            values = recent.document(job)
        except SceneError:  # no TOML, which has no form
            return {"faults": faults_as_data(error), "form": [], "plan": []}
        return {"faults": faults_as_data(error), **_stated(values, recent)}
    stated = _stated(design.scene.stated.scene, recent)
    return {**painted(design, recent), **_held(design), **stated}


def _moved(job: Job, recent: Recent) -> dict[str, Any]:
    """The parts of `curves` that move in a drag: no fields, and no diagram that has not changed."""
    previous = recent.last("motion")
    pictures = painted(design := recent.design(job), recent, moving=True)
    if previous is not None and recent.last("motion") is previous:
        pictures["charts"] = [chart for chart in pictures["charts"] if chart is not previous]
    return {**pictures, **_held(design)}


def _held(design: Design) -> dict[str, Any]:
    held: list[dict[str, Any]] = []
    with suppress(CamgeoError):  # the findings say why
        held = [handle.to_data() for handle in handles(design)]
    return {"handles": held}


def change(job: Job, recent: Recent) -> dict[str, Any]:
    """The text after the change that the arguments request, its label, and the `curves` of the
    text.

    A change that cannot be made leaves the text as it is: `refused` says why, in a sentence. One
    after which the scene is not valid is made, and `faults` say what is wrong.

    With the argument `moving`, for one of many changes during a drag, `moving` is true if the scene
    is valid, and of the `curves` there is only what differs or is computed quickly, see `_moved`.
    """
    try:
        design = recent.design(job)
    except SceneError:  # such a text can be changed too
        design = None
    try:
        outcome = changed(job.text, job.file, job.folder or None, job.arguments, design)
    except JobError:
        raise
    except CamgeoError as error:
        return {"text": job.text, "refused": one_line(error), "faults": faults_as_data(error)}
    next_job = replace(job, text=outcome.text)
    if outcome.scene is not None:
        recent.note_scene(next_job, outcome.scene)
    if job.arguments.get("moving") is True and outcome.scene is not None:
        head = {"text": outcome.text, "moving": True, "label": outcome.label}
        return {**head, **_moved(next_job, recent)}
    return {"text": outcome.text, "label": outcome.label, **curves(next_job, recent)}


def _stated(values: Document, recent: Recent) -> dict[str, Any]:
    # Joints are dragged more often than anything else, and the form does not show them.
    fields = repr({key: value for key, value in values.exact.items() if key != "motion"})
    named = values.exact_value(("effects",))
    return {
        "form": recent.cached("form", (fields,), lambda: Fields(values).form()),
        "plan": Fields(values).plan(),
        "effects": sorted(named) if isinstance(named, dict) else [],
    }


def painted(design: Design, recent: Recent, *, moving: bool = False) -> dict[str, Any]:
    """The pictures of a design; for `moving` see `camgeo.pictures.mechanism.animation`.

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
    """A function for each diagram that is computed quickly."""
    scene, drive = design.scene, design.drive
    moved = design.name, scene.unit, drive, scene.lift_unit
    chart = partial(_chart, "motion", MOTION_TITLE, partial(motion_diagram, design))
    yield partial(recent.cached, "motion", moved, chart)
    if scene.follower is not None:
        yield from (partial(_chart, *diagram) for diagram in disc_diagrams(design))


def _chart(name: str, title: str, make: Callable[[], Figure]) -> dict[str, Any]:
    figure = make()
    chart = Chart(title, figure, readings(figure))
    return {
        "name": name,
        "title": title,
        "figure": packed(thinned(figure)),
        "sentence": chart.sentence,
        "readings": [_reading(reading) for reading in chart.readings],
    }


def _reading(reading: CurveExtremes) -> dict[str, Any]:
    """Extremes as texts, and their cam angles in degrees."""
    return {
        "name": plain(reading.name),
        "low": format_value(reading.low),
        "low_at": round(math.degrees(reading.low_angle), 3),
        "high": format_value(reading.high),
        "high_at": round(math.degrees(reading.high_angle), 3),
        "limits": [[name, format_value(value)] for name, value in reading.limits],
    }


# -- packing --------------------------------------------------------------------------------------
# Pictures as JSON data, with long lists of numbers packed in binary form: writing and reading
# digits would take longer than everything else that is done for a frame of a drag.


FEWEST: Final = 32
"""Fewest numbers that are packed; fewer stay a list."""

PACKING_ERROR: Final = 1e-6
"""Largest error of packed numbers, relative to the extent of their array along each axis."""

ROUNDING: Final = 2.0**-24
LEAST: Final = 2.0**-150
"""Largest rounding error of a 32-bit float, relative to its value, and for numbers near 0 absolute.
"""

LARGEST: Final = float(np.finfo(np.float32).max)
"""Largest 32-bit float."""


def packed(picture: Figure | Animation) -> dict[str, Any]:
    """The picture as `picture.to_data()`, with long arrays packed.

    A packed array has its elements in `numbers`, in base 64, as little-endian binary numbers of the
    type `packed`, "f4" or "f8", in the order of the array; `shape` is that of the array. A gap in a
    line is NaN.
    """
    data: dict[str, Any] = figure_data(picture, _packed)
    return data


def _packed(array: FloatArray) -> Any:
    if array.size < FEWEST:
        return nested(array)
    rows = array.reshape(-1, array.shape[-1] if array.ndim > 1 else 1)
    low, high = np.fmin.reduce(rows), np.fmax.reduce(rows)  # leave gaps out
    size = np.maximum(-low, high)
    # 32 bits suffice where their rounding is too small to be seen and nothing overflows.
    fine = np.maximum(ROUNDING * size, LEAST) <= PACKING_ERROR * (high - low)
    kind = "f4" if bool(np.all(fine & (size <= LARGEST))) else "f8"
    text = _text(array.astype(f"<{kind}").tobytes())
    return {"packed": kind, "shape": list(array.shape), "numbers": text}


# -- making ---------------------------------------------------------------------------------------
# What the designer makes from a scene: its files, its solids, and the smallest cam.


BASE_RADIUS: Final = "follower.base_radius"
"""The key of the size that is as small as possible."""


def build(job: Job, recent: Recent) -> dict[str, Any]:
    """The files of the scene with the bytes that `camgeo build` would write; none is written.

    Argument `formats`: names of writers; by default those of the scene. Without an outline there
    are no files, and `findings` say why. Deviations are in the unit of the scene.
    """
    formats = Arguments(job).texts("formats")
    design = recent.design(job)
    poor = [finding.sentence for finding in poor_findings(design)]
    if not design.judgement.has_outline:
        return {"files": [], "certificate": None, "findings": poor}
    output = design.scene.output
    names, unit = output.formats if formats is None else formats, MM_PER[design.scene.unit]
    contents, reports = make_files(design.discs, names, output.tolerance)
    files = [
        {
            "name": report.name,
            "format": report.format,
            "size": report.size,
            "tolerance": report.tolerance / unit,
            "deviation": None if report.deviation is None else report.deviation / unit,
            "bytes": _text(contents[report.name]),
        }
        for report in reports
    ]
    certificate = contents[CERTIFICATE]
    files.append(
        {
            "name": CERTIFICATE,
            "format": "certificate",
            "size": len(certificate),
            "tolerance": None,
            "deviation": None,
            "bytes": _text(certificate),
        }
    )
    poor += [finding.sentence for report in reports for finding in report.findings]
    return {"files": files, "certificate": json.loads(certificate), "findings": poor}


def solid(job: Job, recent: Recent) -> dict[str, Any]:
    """The bodies as `triangles`, coarser than they are made; none if the part has no thickness."""
    solids = coarse_solids(recent.design(job))
    return {"solids": [{"name": name, "places": triangles(data)} for name, data in solids.items()]}


def size(job: Job, recent: Recent) -> dict[str, Any]:
    """The smallest cam, and the `edits` of the scene that give it; empty if there is no such scene.

    Optional arguments: `transmission_angle` [degrees], `radius_ratio`, `radius_of_curvature` and
    `arm`, the shortest and the longest [unit of the scene].
    """
    arguments = Arguments(job)
    design = recent.design(job)
    unit = MM_PER[design.scene.unit]
    angle, arms = arguments.number("transmission_angle"), arguments.pair("arm")
    cam_size = size_of(
        design,
        transmission_angle=None if angle is None else math.radians(angle),
        radius_ratio=arguments.number("radius_ratio"),
        radius_of_curvature=unit * (arguments.number("radius_of_curvature") or 0.0),
        arms=None if arms is None else (unit * arms[0], unit * arms[1]),
    )
    sizes = [
        _rating(name, rating, unit)
        for name, rating in (
            ("present design", cam_size.present),
            ("smallest", cam_size.best.written),
        )
        if rating is not None
    ]
    return {
        "sizes": sizes,
        "sentence": _sentence(cam_size),
        "text": text(cam_size),
        "edits": cam_size.edits,
    }


def _sentence(answer: CamSize) -> str:
    """A sentence on the smallest base radius and other changes, or on why there is none."""
    if answer.best.written is None:
        only_just = (
            "No scene is certain to meet the requirements: they are met only at the exact limit."
        )
        return in_unit(answer.best.infeasible or only_just, answer.scene.unit)
    unit = MM_PER[answer.scene.unit]
    now = answer.best.written.base_radius / unit
    sentence = f"The smallest base radius is {now:.6g} {answer.scene.unit}"
    if answer.present is not None:
        sentence += f" instead of {answer.present.base_radius / unit:.6g} {answer.scene.unit}"
    others = [
        f"{key} = {json.dumps(value)}" for key, value in answer.edits.items() if key != BASE_RADIUS
    ]
    return f"{sentence}, with {listed(others)}." if others else f"{sentence}."


def _rating(name: str, rating: Rating, unit: float) -> dict[str, Any]:
    """The sizes of a cam; lengths in the unit of the scene, angles in degrees."""
    return {
        "name": name,
        "base_radius": rating.base_radius / unit,
        "arm_side": rating.arm_side,
        "transmission_angle": math.degrees(rating.transmission_angle.value),
        "radius_ratio": rating.radius_ratio.value,
    }


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


# -- judging --------------------------------------------------------------------------------------
# Findings on a scene with their next steps and places, and remedies.


KEYS: Final[Mapping[str, str]] = {
    "transmission-angle": "limits.transmission_angle",
    "linkage-transmission-angle": "limits.linkage_transmission_angle",
    "radius-ratio": "limits.radius_ratio",
    "closing-error": "limits.closing_error",
    "undercut": "follower.roller_radius",
    "global-undercut": "follower.roller_radius",
    "convexity": "follower.base_radius",
    "cusp": "follower.roller_radius",
    "outline": "follower.roller_radius",
    "lost-stroke": "limits.undercut",
    "lobe": "limits.undercut",
    "dead-centre": "linkage",
    "linkage-branch": "linkage",
    "format": "output.formats",
}
"""Key of the scene that a finding concerns, by the name of the finding or its beginning."""

KINDS: Final[Mapping[str, str]] = {
    "undercut": "undercut",
    "global-undercut": "undercut",
    "convexity": "undercut",
    "cusp": "cusp",
}
"""Kinds of places by the names of findings or their beginning; all others are of kind "limit"."""

RANGE: Final = 33
"""Points in a range of the cam angle: more than its picture needs."""


def findings(job: Job, recent: Recent) -> dict[str, Any]:
    """The findings with their next steps and places, remedies, and the diagrams of effects.

    Argument `machining`: whether milling programs are planned and simulated too; true by default.
    """
    machining = Arguments(job).flag("machining", otherwise=True)
    design = recent.design(job)
    checked = check(design, machining=machining)
    listed = advised(checked)
    return {
        "verdict": f"{findings_summary(entry.finding for entry in listed)}.",
        "findings": [_finding(entry) for entry in listed],
        "cures": [_cure(index, cure) for index, cure in enumerate(checked.cures)],
        "places": list(_places(checked)),
        "charts": effect_charts(design),
    }


def _finding(entry: Advised) -> dict[str, Any]:
    finding = entry.finding
    return {
        "about": entry.subject,
        "name": finding.name,
        "severity": finding.severity,
        "verdict": finding.verdict,
        "mark": MARKS[finding.verdict],
        "sentence": finding.sentence,
        "value": _finite(finding.value),
        "limit": _finite(finding.limit),
        "unit": finding.unit,
        "at_degrees": None
        if finding.cam_angle is None
        else _finite(math.degrees(finding.cam_angle)),
        "key": _key(finding.name),
        "step": entry.step,
    }


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _key(name: str) -> str:
    names = [key_name for key_name in KEYS if name.removeprefix(f"{RETURN}: ").startswith(key_name)]
    return KEYS[max(names, key=len)] if names else ""


def _cure(index: int, cure: Cure) -> dict[str, Any]:
    sentence = f"{cure.fault}: {cure.sentence}"
    return {"sentence": sentence, "works": cure.works, "index": index, "key": cure.key}


def _places(checked: Check) -> Iterator[dict[str, Any]]:
    """The places on the discs, at cam angle 0 [mm], of findings that are not "ok".

    A place is a point; for a range of the cam angle it is the middle of that piece of the flank,
    with `points` along it.
    """
    if not checked.curves:
        return
    for finding in checked.findings:
        if finding.severity == "ok":
            continue
        angles = _angles(finding)
        if angles is None:
            continue
        name = finding.name.removeprefix(f"{RETURN}: ")
        disc = list(checked.curves.values())[-1 if name != finding.name else 0]
        flank = next((side for side in Flank if name.endswith(f"-{side}")), None)
        curve = disc.flanks[0][1] if flank is None else disc.curve(flank)
        try:
            points = curve.point(angles)
        except GeometryError:  # the roller centre stands still in the cam
            continue
        if not np.all(np.isfinite(points)):
            continue
        middle = points[len(points) // 2]
        place: dict[str, Any] = {
            "x": round(float(middle.real), 4),
            "y": round(float(middle.imag), 4),
            "kind": next((KINDS[kind] for kind in KINDS if name.startswith(kind)), "limit"),
            "label": f"{finding.name} at {math.degrees(angles[len(angles) // 2]) % 360.0:.1f}°",
            "severity": finding.severity,
        }
        if len(points) > 1:
            place["points"] = [[round(float(z.real), 4), round(float(z.imag), 4)] for z in points]
        yield place


def _angles(finding: Finding) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """Cam angles [rad] of the place of a finding; None if it concerns the whole turn."""
    if finding.cam_range is not None:
        start, end = finding.cam_range
        # A range that passes cam angle 0 ends below its start.
        return np.linspace(start, end if end > start else end + TURN, RANGE)
    return None if finding.cam_angle is None else np.array([finding.cam_angle])


# -- offers ---------------------------------------------------------------------------------------
# Choices that the designer offers: laws that fit a segment, scenes to start from, and effects.


FACTS: Final = {
    "C_v": (("velocity",), ("velocity",)),
    "C_a": (("least_acceleration", "largest_acceleration"), ("acceleration", "deceleration")),
    "C_j": (("least_jerk", "largest_jerk"), ("jerk", "braking_jerk")),
}
"""Figures of a law by symbol: names of its extremes over the whole move, which are those of the
motion whatever parts the law has, and the characteristic values that are unbounded if the extremes
are."""


def laws(job: Job, recent: Recent) -> dict[str, Any]:
    """The laws that the segment can have in a valid scene, with the `edits` for each.

    Argument `segment`: its position, from 0. The scene itself may have faults; SceneError if its
    text is not TOML.
    """
    segment = Arguments(job).index("segment")
    motion = recent.document(job).exact_value(("motion",))
    if not isinstance(motion, list) or segment >= len(motion):
        raise JobError("segment must be one of the motion")
    stated = motion[segment]
    if not isinstance(stated, dict) or "dwell" in stated:
        raise JobError("segment must be a move: a dwell has no law")
    offers = []
    for name in FAMILIES:
        for edits in _edits(name, stated, f"motion[{segment + 1}]"):
            law = _law(job, recent, edits, segment)
            if law is not None:
                offers.append(_law_offer(name, law, edits))
                break
    return {"laws": offers, "law": stated.get("law")}


def _edits(name: str, stated: Any, key: str) -> Iterator[dict[str, Any]]:
    """Edits that give the segment the law: first with its present parameters, then without those
    that the law does not take.
    """
    yield {f"{key}.law": name}
    law_options = {option.name for option in FAMILIES[name].options}
    others = [option for option in stated if option in OPTIONS and option not in law_options]
    if others:
        yield {f"{key}.law": name} | {f"{key}.{option}": None for option in others}


def _law(job: Job, recent: Recent, edits: dict[str, Any], segment: int) -> Law | None:
    try:
        plan = recent.edited(job, edits).plan
    except SceneError:
        return None
    law = getattr(plan.segments[segment], "law", None)
    return _law_in_plan(law, plan, segment) if isinstance(law, Law) else None


def _law_in_plan(law: Law, plan: MotionPlan, segment: int) -> Law:
    """The law with the task that it has in the plan.

    Where the velocity jumps at a joint, the move begins or ends like one from or to a rest.
    """
    ends = []
    for class_, angle in zip(task_ends(law.task), plan.joints_deg[segment:], strict=False):
        place = math.radians(float(angle % FULL_TURN))
        joint = min(joints(plan), key=lambda candidate: abs(candidate.cam_angle - place))
        ends.append("R" if joint.order < 1 else class_)
    return replace(law, task="-".join(ends))


def _law_offer(name: str, law: Law, edits: dict[str, Any]) -> dict[str, Any]:
    entry = law_entry(law)
    facts = []
    for symbol, (names, quantities) in FACTS.items():
        extremes = dict.fromkeys(format_value(getattr(entry.values, name).value) for name in names)
        bounded = entry.unbounded.isdisjoint(quantities)
        facts.append({"name": symbol, "value": " to ".join(extremes) if bounded else "∞"})
    return {
        "name": name,
        "title": name.replace("-", " "),
        "figure": figure_data(thinned(picture.figure((entry,)))),
        "facts": facts,
        "edits": edits,
    }


def templates(_: Job, __: Recent) -> dict[str, Any]:
    """Scenes to start from."""
    return {
        "templates": [
            {"name": name, "title": name.replace("-", " "), "text": template(name)}
            for name in TEMPLATE_KINDS
        ]
    }


def effects(_: Job, __: Recent) -> dict[str, Any]:
    """The effects that can be computed beyond the geometry."""
    declared = [find_effect(name) for name in effect_names()]
    return {
        "effects": [
            {"name": effect.name, "title": effect.title, "sentence": effect.schema["description"]}
            for effect in declared
        ]
    }


# -- work -----------------------------------------------------------------------------------------


Work = Callable[[Job, Recent], dict[str, Any]]
"""Does a job; JobError if its arguments are wrong, any other CamgeoError states faults."""

WORK: Final[Mapping[str, Work]] = {
    "curves": curves,
    "change": change,
    "findings": findings,
    "build": build,
    "size": size,
    "solid": solid,
    "laws": laws,
    "templates": templates,
    "effects": effects,
}
"""The function for each kind of job."""


def run(job: Job, recent: Recent | None = None) -> dict[str, Any]:
    """The result of a job: finite numbers, texts, lists, tables, None, True and False.

    Parameters
    ----------
    recent : results of earlier jobs for reuse; they affect the time only.

    Returns
    -------
    The result with `faults`, a list that is empty if the scene is valid: faults of a scene are
    never raised.

    Raises
    ------
    JobError
        If there is no such kind of job, or its arguments are wrong.
    """
    if job.kind not in WORK:
        raise JobError(f"there is no job {job.kind[:60]!r}; there are {', '.join(WORK)}")
    recent = recent or Recent()
    try:
        return {"faults": [], **WORK[job.kind](job, recent)}
    except JobError:
        raise
    except CamgeoError as error:
        recent.restate(job, error)
        return {"faults": faults_as_data(error, job.text)}


def prepared() -> Callable[[Job], dict[str, Any]]:
    """A function that does jobs one after the other, warmed up with a small scene."""
    text = template(TEMPLATE_KINDS[0])
    for kind in ("curves", "findings"):
        run(Job(kind, text))
    run(Job("change", text, arguments={"edits": {"name": "warm"}}))
    return partial(run, recent=Recent())


# -- thinned ---------------------------------------------------------------------------------------
# Figures with only as many points as can be seen, for the browser, which redraws them with every
# change.
#
# A thinned line passes through some of the points of the line, and each of the others is within a
# distance of it on paper: `READ` in diagrams, `SEEN` in an animation. Coordinates are rounded by at
# most a quarter of that. So where the line was within d of a curve, the thinned one is within d
# plus 1.25 times that distance.


READ: Final = 1.0 / 3200.0
"""Distance [inch] with which values read off a diagram are accurate to a few ten-thousandths of the
height of its panel."""

SEEN: Final = 1.0 / 1600.0
"""Distance [inch] that nobody sees, an eighth of a dot of 200 per inch."""

SHARE: Final = 0.25
"""Largest share of these distances by which rounding moves a point; 1 / sqrt(2) of it per axis."""

AIM: Final = 0.7
"""Share of the distance for which points are placed at first; chords that are off by more get
further points."""


Scale = tuple[float, float]


def thinned(figure: Figure) -> Figure:
    """The figure with fewer points and shorter numbers; panels with logarithmic axes are kept."""
    plain = [not (panel.x.log or panel.y.log) for panel in figure.panels]
    linear = [panel for panel, is_plain in zip(figure.panels, plain, strict=True) if is_plain]
    scales = [_scale(panel, figure.size) for panel in linear]
    fewer = iter(_thinned([panel.marks for panel in linear], scales, READ))
    panels = tuple(
        replace(panel, marks=next(fewer)) if is_plain else panel
        for panel, is_plain in zip(figure.panels, plain, strict=True)
    )
    return replace(figure, panels=panels, rows=tuple(map(thinned, figure.rows)))


PAPER: Final = 8.0
"""Longer side of an animation on paper [inch]."""


def thinned_turn(turn: Animation) -> Animation:
    """The animation with fewer points and shorter numbers, for a picture `PAPER` wide or high."""
    extent = turn.high - turn.low
    scale = PAPER / max(extent.real, extent.imag)
    digits = _digits((scale, scale), SEEN)[0]
    return replace(
        turn,
        turning=_thinned([turn.turning], [(scale, scale)], SEEN)[0],
        places=frozen(np.round(turn.places, digits) + 0.0, np.float64),
    )


def _thinned(
    panels: Sequence[Sequence[Any]], scales: Sequence[Scale], most: float
) -> list[tuple[Any, ...]]:
    """The marks of panels with fewer points; marks that are neither lines nor areas stay.

    Parameters
    ----------
    scales : of each panel, inches on paper per unit of each axis.
    most : largest distance of a point from its thinned line on paper [inch].
    """
    both = list(zip(panels, scales, strict=True))
    lines = [
        (mark.points, scale) for marks, scale in both for mark in marks if isinstance(mark, Line)
    ]
    selections = iter(_select_points(lines, most))
    thinned_panels: list[tuple[Any, ...]] = []
    for marks, scale in both:
        digits = _digits(scale, most)
        fewer: list[Any] = []
        for mark in marks:
            if isinstance(mark, Line):
                fewer.append(replace(mark, points=_rounded(mark.points[next(selections)], digits)))
            elif isinstance(mark, Area):
                rings = tuple(_rounded(ring, digits) for ring in mark.rings)
                fewer.append(replace(mark, rings=rings))
            else:
                fewer.append(mark)
        thinned_panels.append(tuple(fewer))
    return thinned_panels


def _scale(panel: Panel, size: tuple[float, float]) -> Scale:
    """Inches on paper per unit of each axis."""
    (left, low, right, high), (width, height) = panel.frame, size
    across = (right - left) * width / abs(panel.x.limits[1] - panel.x.limits[0])
    upward = (high - low) * height / abs(panel.y.limits[1] - panel.y.limits[0])
    return across, upward


def _digits(scale: tuple[float, float], most: float) -> tuple[int, int]:
    """Decimals of both coordinates with which rounding stays within its share of `most`."""
    step = 2.0 * SHARE * most / math.sqrt(2.0)
    return math.ceil(math.log10(scale[0] / step)), math.ceil(math.log10(scale[1] / step))


def _rounded(points: FloatArray, digits: tuple[int, int]) -> FloatArray:
    rounded = [np.round(points[:, axis], digits[axis]) + 0.0 for axis in (0, 1)]
    return frozen(np.column_stack(rounded), np.float64)


def _select_points(
    lines: Iterable[tuple[FloatArray, Scale]], most: float
) -> list[slice | IntArray]:
    """Indices of the points of each of `lines` that are kept, both ends among them."""
    selections: list[slice | IntArray] = []
    long: list[tuple[int, ComplexArray]] = []
    for number, (points, scale) in enumerate(lines):
        selections.append(slice(None))
        if len(points) > CURVE_POINTS + 1 and bool(np.all(np.isfinite(points))):
            # On paper, x and y as one complex number: a view of the same memory.
            long.append((number, (points * np.array(scale)).view(np.complex128)[:, 0]))
    if long:
        ends = np.cumsum([0, *(len(points) for _, points in long)])
        chosen = thin_lines(np.concatenate([points for _, points in long]), ends, most)
        parts = np.split(chosen, np.searchsorted(chosen, ends[1:-1]))
        for (number, _), part, first in zip(long, parts, ends[:-1], strict=True):
            selections[number] = part - first
    return selections


def thin_lines(points: ComplexArray, ends: IntArray, most: float) -> IntArray:
    """Indices, ascending, of those points of several lines whose polygon is near all points.

    Parameters
    ----------
    points : (n,) of all lines, one line after the other.
    ends : where each line begins, and n.
    most : largest distance of any point from its chord.
    """
    chosen = _placed(points, ends, AIM * most)
    while True:
        distance = _chord_distances(points, chosen)
        # The largest distance over each chord; where it is too large, its point is kept as well.
        worst = np.maximum.reduceat(distance, chosen)
        wrong = np.nonzero(worst > most)[0]
        if not len(wrong):
            return chosen
        stops = np.append(chosen[1:], len(points))
        more = [chosen[k] + int(np.argmax(distance[chosen[k] : stops[k]])) for k in wrong]
        chosen = np.union1d(chosen, more)


def _placed(points: ComplexArray, ends: IntArray, aim: float) -> IntArray:
    """Indices of points about as dense as a smooth curve needs.

    A chord over m steps is off by m^2 |d| / 8, where d is the second difference of the points.
    """
    bend = np.zeros(len(points))
    bend[1:-1] = np.abs(points[2:] - 2.0 * points[1:-1] + points[:-2])
    # Second differences at the ends mix points of two lines.
    bend[ends[:-1]] = bend[ends[1:] - 1] = 0.0
    density = np.minimum(np.sqrt(bend / (8.0 * aim)), 1.0)
    # Whatever its bends, each line keeps more than CURVE_POINTS points.
    for first, last in pairwise(ends):
        density[first:last] = np.maximum(density[first:last], (CURVE_POINTS + 4.0) / (last - first))
    # A point is chosen wherever the integral of the density passes a whole number.
    stations = np.floor(np.cumsum(density))
    chosen = np.nonzero(np.diff(stations, prepend=-1.0) > 0.0)[0]
    return np.union1d(chosen, np.concatenate((ends[:-1], ends[1:] - 1)))


def _chord_distances(points: ComplexArray, chosen: IntArray) -> FloatArray:
    """(n,) distance of each point from the chord between the kept points around it; 0 between two
    lines.
    """
    # The chord of each point, from the kept point before it to the next one.
    number = np.repeat(np.arange(len(chosen)), np.diff(np.append(chosen, len(points))))
    start = points[chosen]
    way = np.append(start[1:], start[-1:]) - start
    # Not 0, so that equal points give no division by 0; their share of the way does not matter.
    square = np.maximum(way.real**2 + way.imag**2, np.finfo(np.float64).tiny)
    along = points - start[number]
    share = np.clip((along * way.conj()[number]).real / square[number], 0.0, 1.0)
    distance: FloatArray = np.abs(along - share * way[number])
    return distance
