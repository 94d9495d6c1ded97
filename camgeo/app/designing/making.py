"""What the designer makes of a scene: its files, its solids, and the smallest cam."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np

from camgeo.app.answers.answer import MARKS, text, verdict_on
from camgeo.app.answers.build import poor_findings
from camgeo.app.answers.check import Check, check
from camgeo.app.answers.report import Advised, advised, coarse_solids, triangles
from camgeo.app.answers.size import CamSize, edits_with
from camgeo.app.answers.size import size as size_of
from camgeo.app.designing.children import Job
from camgeo.app.designing.painting import effect_charts
from camgeo.app.designing.recent import Arguments, Recent
from camgeo.check.cures.remedies import Cure
from camgeo.check.finding import RETURN, Finding
from camgeo.check.sizing.smallest import Rating
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank
from camgeo.units import MM_PER, TURN, in_unit, listed

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
        "charts": effect_charts(design),
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
