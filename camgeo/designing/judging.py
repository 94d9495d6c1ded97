"""What is found in a scene: findings with next steps and where they are, and cures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np

from camgeo.answers.answer import MARKS, verdict_on
from camgeo.answers.check import Check, check
from camgeo.answers.report import Advised, advised
from camgeo.check.cures.cure import Cure
from camgeo.check.finding import RETURN, Finding
from camgeo.designing.arguments import Arguments
from camgeo.designing.job import Job
from camgeo.designing.painting import effect_charts
from camgeo.designing.recent import Recent
from camgeo.errors import GeometryError
from camgeo.outline.path import Flank
from camgeo.units import TURN

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
