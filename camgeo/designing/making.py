"""What the designer makes of a scene: its files, its solids, and the smallest cam."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Mapping
from typing import Any, Final

from camgeo.answers.build import told
from camgeo.answers.render import text
from camgeo.answers.report import coarse_solids
from camgeo.answers.report.triangles import triangles
from camgeo.answers.size import CamSize
from camgeo.answers.size import size as size_of
from camgeo.answers.size.writing import edits_with
from camgeo.check.sizing.smallest import Rating
from camgeo.designing.arguments import Arguments
from camgeo.designing.job import Job
from camgeo.designing.recent import Recent
from camgeo.units import MM_PER, in_unit
from camgeo.wording import listed
from camgeo.writing.write import CERTIFICATE, make_files

BASE_RADIUS: Final = "follower.base_radius"
"""The key of the size that is as small as possible."""


def build(job: Job, recent: Recent) -> dict[str, Any]:
    """The files of the scene, the bytes that `camgeo build` writes; none of them is written.

    Argument `formats`: names of writers; by default those of the scene. Without an outline there
    are no files, and `findings` say why. Deviations are in the unit of the scene.
    """
    formats = Arguments(job).texts("formats")
    design = recent.design(job)
    poor = [each.sentence for each in told(design)]
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
