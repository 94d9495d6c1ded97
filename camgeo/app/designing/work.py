"""The one door of what the designer computes: a job to JSON data."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np

from camgeo.app.answers.answer import MARKS, text, verdict_on
from camgeo.app.answers.build import poor_findings
from camgeo.app.answers.check import Check, check
from camgeo.app.answers.report import Advised, advised, coarse_solids, triangles
from camgeo.app.answers.size import CamSize, edits_with
from camgeo.app.answers.size import size as size_of
from camgeo.app.designing import painting
from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.faults import faults_as_data
from camgeo.app.designing.recent import Arguments, Recent
from camgeo.check.cures.remedies import Cure
from camgeo.check.finding import RETURN, Finding
from camgeo.check.sizing.smallest import Rating
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.dynamics.effects.registry import effect_names, find_effect
from camgeo.errors import CamgeoError, GeometryError, SceneError
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.laws import FAMILIES, OPTIONS
from camgeo.kinematics.laws.comparison import entry_of
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import ends_of
from camgeo.kinematics.plan import FULL_TURN, MotionPlan, joints
from camgeo.pictures import laws as picture
from camgeo.pictures.charts import shown
from camgeo.pictures.model import figure_data
from camgeo.pictures.thinned import thinned
from camgeo.scene.toml import TEMPLATE_KINDS, template
from camgeo.units import MM_PER, TURN, in_unit, listed

# -- making ---------------------------------------------------------------------------------------
# What the designer makes of a scene: its files, its solids, and the smallest cam.


BASE_RADIUS: Final = "follower.base_radius"
"""The key of the size that is as small as possible."""


def build(job: Job, recent: Recent) -> dict[str, Any]:
    """The files of the scene, the bytes that `camgeo build` writes; none of them is written.

    Argument `formats`: names of writers; by default those of the scene. Without an outline there
    are no files, and `findings` say why. Deviations are in the unit of the scene.
    """
    formats = Arguments(job).texts("formats")
    design = recent.design(job)
    poor = [each.sentence for each in poor_findings(design)]
    if not design.judgement.has_outline:
        return {"files": [], "certificate": None, "findings": poor}
    output = design.scene.output
    names, unit = output.formats if formats is None else formats, MM_PER[design.scene.unit]
    contents, reports = make_files(design.discs, names, output.tolerance)
    files = [
        {
            "name": each.name,
            "format": each.format,
            "size": each.size,
            "tolerance": each.tolerance / unit,
            "deviation": None if each.deviation is None else each.deviation / unit,
            "bytes": _text(contents[each.name]),
        }
        for each in reports
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
    poor += [finding.sentence for each in reports for finding in each.findings]
    return {"files": files, "certificate": json.loads(certificate), "findings": poor}


def solid(job: Job, recent: Recent) -> dict[str, Any]:
    """The bodies as `triangles`, coarser than they are made; none if the part has no thickness."""
    found = coarse_solids(recent.design(job))
    return {"solids": [{"name": name, "places": triangles(data)} for name, data in found.items()]}


def size(job: Job, recent: Recent) -> dict[str, Any]:
    """The smallest cam, and the `edits` of the scene that make it; none if there is no such scene.

    Optional arguments: `transmission_angle` [degrees], `radius_ratio`, `radius_of_curvature` and
    `arm`, the shortest and the longest [unit of the scene].
    """
    given = Arguments(job)
    design = recent.design(job)
    unit = MM_PER[design.scene.unit]
    angle, arms = given.number("transmission_angle"), given.pair("arm")
    found = size_of(
        design,
        transmission_angle=None if angle is None else math.radians(angle),
        radius_ratio=given.number("radius_ratio"),
        radius_of_curvature=unit * (given.number("radius_of_curvature") or 0.0),
        arms=None if arms is None else (unit * arms[0], unit * arms[1]),
    )
    made = found.best.made
    sizes = [
        _rating(name, each, unit)
        for name, each in (("present design", found.present), ("smallest", found.written))
        if each is not None
    ]
    edits = {} if made is None else edits_with(found.scene, made)
    return {
        "sizes": sizes,
        "sentence": _sentence(found, edits),
        "text": text(found),
        "edits": edits,
    }


def _sentence(found: CamSize, edits: Mapping[str, Any]) -> str:
    """The smallest base radius, and what else changes with it."""
    if found.written is None:
        only_just = "The requirement can only just be met: no scene surely keeps it."
        return in_unit(found.infeasible or only_just, found.scene.unit)
    unit = MM_PER[found.scene.unit]
    now = found.written.base_radius / unit
    sentence = f"The smallest base radius is {now:.6g} {found.scene.unit}"
    if found.present is not None:
        sentence += f" instead of {found.present.base_radius / unit:.6g} {found.scene.unit}"
    others = [f"{key} = {json.dumps(edits[key])}" for key in edits if key != BASE_RADIUS]
    return f"{sentence}, with {listed(others)}." if others else f"{sentence}."


def _rating(name: str, rating: Rating, unit: float) -> dict[str, Any]:
    """Lengths in the unit of the scene, angles in degrees."""
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
# What is found in a scene: findings with next steps and where they are, and cures.


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
"""Key of the scene that a finding is about, by the name of the finding or its beginning."""

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
    """The findings, what to do about them, where they are, and the diagrams of effects.

    Argument `machining`: whether milling programs are planned and simulated too; true by default.
    """
    machining = Arguments(job).flag("machining", otherwise=True)
    design = recent.design(job)
    found = check(design, machining=machining)
    listed = advised(found)
    return {
        "verdict": f"{verdict_on(each.finding for each in listed)}.",
        "findings": [_finding(each) for each in listed],
        "cures": [_cure(index, each) for index, each in enumerate(found.cures)],
        "places": list(_places(found)),
        "charts": painting.effect_charts(design),
    }


def _finding(each: Advised) -> dict[str, Any]:
    found = each.finding
    return {
        "about": each.about,
        "name": found.name,
        "severity": found.severity,
        "verdict": found.verdict,
        "mark": MARKS[found.verdict],
        "sentence": found.sentence,
        "value": _finite(found.value),
        "limit": _finite(found.limit),
        "unit": found.unit,
        "at_degrees": None if found.cam_angle is None else _finite(math.degrees(found.cam_angle)),
        "key": _key(found.name),
        "step": each.step,
    }


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _key(name: str) -> str:
    found = [each for each in KEYS if name.removeprefix(f"{RETURN}: ").startswith(each)]
    return KEYS[max(found, key=len)] if found else ""


def _cure(index: int, cure: Cure) -> dict[str, Any]:
    sentence = f"{cure.fault}: {cure.sentence}"
    return {"sentence": sentence, "works": cure.works, "index": index, "key": cure.key}


def _places(found: Check) -> Iterator[dict[str, Any]]:
    """Where the findings that are not "ok" are on the discs at cam angle 0 [mm]: a point, or for a
    range of the cam angle the middle of that piece of the flank, and `points` along it.
    """
    if not found.curves:
        return
    for finding in found.findings:
        if finding.severity == "ok":
            continue
        angles = _angles(finding)
        if angles is None:
            continue
        name = finding.name.removeprefix(f"{RETURN}: ")
        disc = list(found.curves.values())[-1 if name != finding.name else 0]
        flank = next((each for each in Flank if name.endswith(f"-{each}")), None)
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
            "kind": next((KINDS[each] for each in KINDS if name.startswith(each)), "limit"),
            "label": f"{finding.name} at {math.degrees(angles[len(angles) // 2]) % 360.0:.1f}°",
            "severity": finding.severity,
        }
        if len(points) > 1:
            place["points"] = [[round(float(z.real), 4), round(float(z.imag), 4)] for z in points]
        yield place


def _angles(finding: Finding) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """Cam angles [rad] of its place; None if it concerns the whole turn."""
    if finding.cam_range is not None:
        start, end = finding.cam_range
        return np.linspace(start, end if end > start else end + TURN, RANGE)
    return None if finding.cam_angle is None else np.array([finding.cam_angle])


# -- offers ---------------------------------------------------------------------------------------
# What the designer offers: laws that fit a segment, scenes to start from, and effects.


FACTS: Final = {
    "C_v": (("velocity",), ("velocity",)),
    "C_a": (("least_acceleration", "largest_acceleration"), ("acceleration", "deceleration")),
    "C_j": (("least_jerk", "largest_jerk"), ("jerk", "braking_jerk")),
}
"""By its symbol what is shown of a law: its extremes over the whole move, which are those of the
motion, whatever parts the law has, and the characteristic values that are unbounded if they are."""


def laws(job: Job, recent: Recent) -> dict[str, Any]:
    """The laws that the segment can have in a valid scene, with the `edits` for each.

    Argument `segment`: its position, from 0. The scene itself may have faults; SceneError if its
    text is not TOML.
    """
    segment = Arguments(job).index("segment")
    motion = recent.document(job).at(("motion",))
    if not isinstance(motion, list) or segment >= len(motion):
        raise JobError("segment must be one of the motion")
    stated = motion[segment]
    if not isinstance(stated, dict) or "dwell" in stated:
        raise JobError("segment must be a move: a dwell has no law")
    found = []
    for name in FAMILIES:
        for edits in _edits(name, stated, f"motion[{segment + 1}]"):
            law = _law(job, recent, edits, segment)
            if law is not None:
                found.append(_told(name, law, edits))
                break
    return {"laws": found, "law": stated.get("law")}


def _edits(name: str, stated: Any, key: str) -> Iterator[dict[str, Any]]:
    """Edits that give the segment that law: first with its parameters as they are, then without
    those that only other laws have.
    """
    yield {f"{key}.law": name}
    own = {option.name for option in FAMILIES[name].options}
    others = [each for each in stated if each in OPTIONS and each not in own]
    if others:
        yield {f"{key}.law": name} | {f"{key}.{each}": None for each in others}


def _law(job: Job, recent: Recent, edits: dict[str, Any], segment: int) -> Law | None:
    try:
        plan = recent.edited(job, edits).plan
    except SceneError:
        return None
    law = getattr(plan.segments[segment], "law", None)
    return _in_place(law, plan, segment) if isinstance(law, Law) else None


def _in_place(law: Law, plan: MotionPlan, segment: int) -> Law:
    """The law for the task that it has in the plan: from or to a rest where the velocity jumps."""
    ends = []
    for class_, angle in zip(ends_of(law.task), plan.joints_deg[segment:], strict=False):
        place = math.radians(float(angle % FULL_TURN))
        joint = min(joints(plan), key=lambda each: abs(each.cam_angle - place))
        ends.append("R" if joint.order < 1 else class_)
    return replace(law, task="-".join(ends))


def _told(name: str, law: Law, edits: dict[str, Any]) -> dict[str, Any]:
    entry = entry_of(law)
    facts = []
    for symbol, (names, quantities) in FACTS.items():
        extremes = dict.fromkeys(shown(getattr(entry.values, name).value) for name in names)
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
    """What can be computed beyond the geometry."""
    found = [find_effect(name) for name in effect_names()]
    return {
        "effects": [
            {"name": each.name, "title": each.title, "sentence": each.schema["description"]}
            for each in found
        ]
    }


# -- work -----------------------------------------------------------------------------------------


Work = Callable[[Job, Recent], dict[str, Any]]
"""Does a job; JobError if its arguments are wrong, any other CamgeoError tells faults."""

WORK: Final[Mapping[str, Work]] = {
    "curves": painting.curves,
    "change": painting.change,
    "findings": findings,
    "build": build,
    "size": size,
    "solid": solid,
    "laws": laws,
    "templates": templates,
    "effects": effects,
}
"""What is done for each kind of job."""


def run(job: Job, recent: Recent | None = None) -> dict[str, Any]:
    """The result of a job: finite numbers, texts, lists, tables, None, True and False.

    Parameters
    ----------
    recent : what earlier jobs left to be used again; it changes the time alone.

    Returns
    -------
    With `faults`, a list that is empty if the scene is valid: what is wrong in it never raises.

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
    """What does jobs one after the other, warm: imported, and tried with a small scene."""
    text = template(TEMPLATE_KINDS[0])
    for kind in ("curves", "findings"):
        run(Job(kind, text))
    run(Job("change", text, arguments={"edits": {"name": "warm"}}))
    return partial(run, recent=Recent())
