"""What the designer is told of scenes and of changes of them, whole."""

from __future__ import annotations

import base64
import difflib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.app.answers.answer import one_line
from camgeo.app.designing.children import Job
from camgeo.app.designing.edits import ACTIONS, changed
from camgeo.app.designing.handles import handles
from camgeo.app.designing.work import run
from camgeo.errors import CamgeoError
from tests import kept
from tests.designing.scenes import FIXTURES, design, job

SCENES: Final = ("scenes/inch", "scenes/setzhub", "scenes/points", "effects/yoke")

STEPS: Final = (0.05, 2.0)
"""Steps of a drag."""


def file_of(name: str) -> Path:
    """The file of a scene of fixtures."""
    return FIXTURES / f"{name}.toml"


INCH: Final = file_of("scenes/inch")


def short(data: Any) -> Any:
    """Data with sums in place of many numbers, packed or not, and of long texts their lengths."""
    if isinstance(data, dict):
        if "packed" in data:
            numbers = base64.b64decode(data["numbers"])
            return kept.summary(np.frombuffer(numbers, f"<{data['packed']}"))
        if data.get("kind") == "figure":  # tests.figure keeps them
            return [[each["title"], len(each["marks"])] for each in data["panels"]]
        return {key: short(each) for key, each in data.items() if key != "description"}
    if isinstance(data, list):
        flat = np.array(data).ravel() if data and isinstance(data[0], (int, float, list)) else None
        if flat is not None and flat.size > 12 and flat.dtype.kind in "if":
            return kept.summary(flat)
        return [short(each) for each in data]
    return data


def rows(form: list[dict[str, Any]]) -> Iterator[str]:
    """Tables of a form, each of their fields in a line."""
    for table in form:
        head = (table["key"], table["title"], table["stated"], table["kind"])
        kinds = [each["value"] for each in table["kinds"] or ()]
        yield " ".join((kept.document(list(head)), *kinds))
        for field in table["fields"]:
            own = {key: value for key, value in field.items() if key not in ("description", "key")}
            yield f"  {field['key']}: {kept.document(own).replace(chr(10), '')}"


def changes(name: str) -> Iterator[tuple[str, str]]:
    """What becomes of a scene's text: edits of keys, segments, kinds and effects, and drags."""
    own, text = design(file_of(name)), file_of(name).read_text("utf-8")
    segments = range(len(own.scene.plan.segments))
    wanted: list[dict[str, Any]] = [
        *({"segment": {"action": action, "at": at}} for at in segments for action in ACTIONS),
        *({"handle": each.name, "to": [each.place[0] + 1.3, each.place[1] - 0.7], "step": step}
          for each in handles(own) for step in (None, list(STEPS))),
    ]  # fmt: skip
    if name == SCENES[0]:
        wanted += [
            *({"table": {"key": "follower", "kind": kind}}
              for kind in ("oscillating-roller", "translating-flat", "oscillating-flat", "no")),
            *({"effect": {"name": effect, "on": True}}
              for effect in ("kinematics", "spring", "roller-spin", "inertia", "no")),
            {"edits": {"follower.base_radius": 2.5, "follower.offset": 0.1, "cam.speed": None}},
            {"edits": {"follower.contact": "groove"}},
            {"edits": {"motion[1].span": 120}},
            {"edits": {"motion[1].span": 181}},
            {"edits": {"motion[2].dwell": 67.25}},
            {"edits": {"motion[3].law": "polynomial-345"}},
            {"edits": {}},
            {"sized": {"follower.base_radius": 1.5}},
            {"segment": {"action": "none", "at": 0}},
            {"segment": {"action": "split", "at": 4}},
            {"cure": 0},
            {},
        ]  # fmt: skip
    for each in wanted:
        try:
            found = changed(text, str(file_of(name)), None, each, own)
        except CamgeoError as error:
            yield f"{name}: {each}", one_line(error)
            continue
        lines = difflib.unified_diff(text.splitlines(), found.text.splitlines(), n=0)
        told = [line for line in lines if not line.startswith(("---", "+++", "@@"))]
        valid = "valid" if found.scene is not None else "not valid"
        yield f"{name}: {each}", "\n".join([f"{found.label}: {valid}", *told])


def test_forms_plans_and_handles_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name in SCENES:
            found = run(job("curves", file_of(name)))
            yield f"{name}: form", "\n".join(rows(found["form"]))
            plan = [
                [each[key] for key in ("index", "kind", "from", "to", "start", "end", "law")]
                + [field["key"] for field in each["fields"]]
                for each in found["plan"]
            ]
            yield f"{name}: plan", "\n".join(map(kept.document, plan))
            handles = (kept.document(each).replace("\n", "") for each in found["handles"])
            yield f"{name}: handles", "\n".join(handles)
            pictures = [found["animation"], *found["charts"]] if name == SCENES[1] else []
            yield f"{name}: pictures", "\n".join(kept.document(short(each)) for each in pictures)

    kept.compare("designing/curves.txt", parts())


def test_changes_are_as_kept() -> None:
    kept.compare("designing/changes.txt", (each for name in SCENES for each in changes(name)))


def test_findings_and_offers_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name in ("refused/global_undercut", "effects/conjugate_lever"):
            found = run(job("findings", file_of(name), machining=False))
            yield f"findings of {name}", kept.document(short(found))
        yield (
            "laws of inch",
            kept.document(short(run(job("laws", INCH, segment=0)))),
        )
        yield "size of inch", kept.document(short(run(job("size", INCH))))
        yield "effects", kept.document(run(Job("effects")))
        bare = job("curves", INCH).text.replace("roller_radius", "roler_radius")
        yield "a scene with a fault", kept.document(run(Job("curves", bare))["faults"])
        yield "no TOML", kept.document(run(Job("curves", "camgeo = ")))

    kept.compare("designing/findings.txt", parts())
