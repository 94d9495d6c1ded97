"""What camgeo says of mechanisms made up at random, against `independent` and against itself.

Commands are run as a user runs them. Each of them ends in good time, text and JSON agree, and no
verdict contradicts what is laid out there; a verdict too near to its limit for that is left out.
`CAMGEO_RANDOM_SCENES` says how many scenes; half of them are near a dead centre, a cusp or a joint.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.errors import SceneError
from camgeo.scene.scene import Scene, load_scene
from tests.end_to_end.independent import ACCURACY, Model
from tests.end_to_end.random_mechanisms import Drawn, Values, drawn
from tests.fuzz.case import toml
from tests.fuzz.invariants import LONG, Broken, Hang, parsed, sound_call

COUNT: Final = int(os.environ.get("CAMGEO_RANDOM_SCENES", "10"))

STRIDE: Final = 13
"""From scene to scene: ten of them have every mechanism, and six are near something critical."""

CURED: Final = ("cusp-", "undercut-", "global-undercut-", "lobe-", "lost-stroke-", "convexity")

NONE: Final = ("invalid", "no-disc")

SIZED: Final = (*CURED, "transmission-angle", "radius-ratio-", "outline-", "face-over-axis")
"""Beginnings of the names of findings that `camgeo size` answers for."""


@dataclass(frozen=True)
class Run:
    """What a command answered; `document` in JSON, if it was asked for."""

    code: int
    document: Any = None


def run(wrong: list[str], *words: str | Path) -> Run | None:
    """A command in this process; None, and a complaint, if it does not end as commands must."""
    step = tuple(map(str, words))
    name = " ".join(word for word in step if word in (step[0], "--json"))
    try:
        code, out, _ = sound_call(step)
        return Run(code, parsed(out) if "--json" in step else None)
    except Hang:
        wrong.append(f"{name}: takes too long")
    except Broken as broken:
        kind, detail = broken.args
        wrong.append(f"{name}: {kind}: {detail}")
    return None


def written(values: Values, path: Path) -> Path:
    path.write_text(toml(values), encoding="utf-8")
    return path


# Verdicts -----------------------------------------------------------------------------------------


def contradicted(found: list[dict[str, Any]], scene: Drawn) -> list[str]:
    """What the findings of a scene say against the model."""
    model = Model(scene.values)
    by_name = {finding["name"]: finding for finding in found}
    none = [finding for finding in found if finding["severity"] in NONE]
    wrong = []
    if model.linkage is not None:
        wrong += _of_linkage(model, by_name, none)
        if any(each["name"] == "dead-centre" for each in none):
            return wrong
    angle = by_name.get("transmission-angle")
    if angle is not None:
        expected = math.degrees(model.transmission_angle)
        # Near 90 degrees the sine hardly changes; between two places the angle is a parabola.
        if abs(angle["value"] - expected) > 0.05 + 2e-3 * (90.0 - expected):
            wrong.append(f"transmission angle {angle['value']} for {expected}")
    return wrong + (_of_face(model, by_name) if model.is_flat else _of_flanks(model, by_name, none))


def _of_linkage(model: Model, by_name: dict[str, Any], none: list[dict[str, Any]]) -> list[str]:
    wrong = []
    dead = any(each["name"] == "dead-centre" for each in none)
    if model.leverage < -ACCURACY and not none:
        wrong.append(f"ok though the driven member is passed at dead centre ({model.leverage})")
    if dead and model.spare > 1e-3 and model.leverage > 1e-2:
        wrong.append(f"a dead centre, though {model.spare} mm are to spare")
    return wrong


def _of_face(model: Model, by_name: dict[str, Any]) -> list[str]:
    convexity = by_name.get("convexity")
    if convexity is None or convexity["unit"] != "mm":
        ok = convexity is not None and convexity["severity"] == "ok"
        return ["the face turns back"] if ok and model.face_margin < 0 else []
    place = math.radians(convexity["cam_angle_deg"])
    margin = min(model.face_margin, model.face_margin_next_to(place))
    if (
        math.isfinite(margin)
        and abs(margin) > 1e-2
        and abs(convexity["value"] - margin) > 0.05 * (1.0 + abs(margin))
    ):
        return [f"radius of curvature {convexity['value']} for {margin}"]
    if margin < -1e-2 and convexity["severity"] == "ok":
        return ["convex though it is not"]
    return []


def _of_flanks(model: Model, by_name: dict[str, Any], none: list[dict[str, Any]]) -> list[str]:
    wrong = []
    contact = model.follower["contact"]
    for name, side in (("inner", -1), ("outer", 1)):
        if contact not in (name, "groove"):
            continue
        local, reach = model.cusp_margin(side), model.reach(side)
        cut = [
            each
            for each in none
            if each["name"].removeprefix("return: ").removesuffix(f"-{name}")
            in ("cusp", "undercut", "global-undercut", "outline")
        ]
        others = [each for each in none if each not in cut]
        if (local < -1e-3 or reach < -1e-3) and not none:
            wrong.append(f"{name}: ok, though 1 + d kappa = {local} and the roller reaches {reach}")
        if local > 1e-3 and reach > -1e-7 and cut and not others:
            wrong.append(f"{name}: {cut[0]['sentence']}, though 1 + d kappa = {local}, {reach}")
    return wrong


# Commands -----------------------------------------------------------------------------------------


def complaints(number: int, folder: Path) -> list[str]:
    """All that is wrong with what camgeo says of the scene with this number."""
    scene = drawn(number)
    path = written(scene.values, folder / f"random-{number}.toml")
    wrong: list[str] = []
    text = run(wrong, "check", path)
    document = run(wrong, "check", path, "--json")
    sized = run(wrong, "size", path, "--json", "--force", "--scene", folder / "sized.toml")
    run(wrong, "plot", path, "cam", "--force", "-o", folder / "cam.svg")
    if text is None or document is None:
        return wrong
    if text.code != document.code:
        wrong.append(f"check exits with {text.code}, --json with {document.code}")
    answer = document.document
    if "findings" not in answer:
        said = str(answer)
        refused = Model(scene.values).spare > 1e-3 and "does not close" in said
        return [*wrong, f"refused: {said}"] if refused else wrong
    wrong += contradicted(answer["findings"], scene)
    if sized is not None and sized.code == 0:
        wrong += _unsized(folder)
    return wrong + _uncured(answer, load_scene(path), folder)


def _unsized(folder: Path) -> list[str]:
    """What `check` finds wrong with the size of the scene that `size` has written."""
    wrong: list[str] = []
    found = run(wrong, "check", folder / "sized.toml", "--json")
    if found is None:
        return wrong
    if "findings" not in found.document:
        return [f"the smallest cam is a wrong scene: {found.document}"]
    return [
        f"the smallest cam: {each['sentence']}"
        for each in found.document["findings"]
        if each["name"].startswith(SIZED) and each["severity"] in (*NONE, "broken")
    ]


def _uncured(answer: Any, scene: Scene, folder: Path) -> list[str]:
    """Cures that do not cure, applied exactly as they are printed."""
    before = {
        each["name"].removeprefix("return: ")
        for each in answer["findings"]
        if each["severity"] in NONE and each["name"].removeprefix("return: ").startswith(CURED)
    }
    wrong: list[str] = []
    for cure in answer["cures"]:
        if cure["to"] is None:
            continue
        try:
            cured = scene.with_values({each["key"]: each["to"] for each in (cure, *cure["also"])})
        except SceneError as error:
            wrong.append(f"the cure {cure['sentence']!r} makes a wrong scene: {error}")
            continue
        path = folder / "cured.toml"
        path.write_text(cured.to_toml(), encoding="utf-8")
        after = run(wrong, "check", path, "--json")
        if after is None:
            continue
        left = [
            each["sentence"]
            for each in after.document["findings"]
            if each["severity"] in NONE and each["name"].startswith(tuple(before))
        ]
        if left:
            wrong.append(f"{cure['sentence']!r} does not cure: {left[0]}")
    return wrong


@pytest.mark.parametrize("number", range(0, STRIDE * COUNT, STRIDE))
def test_no_verdict_is_contradicted(number: int, tmp_path: Path) -> None:
    wrong = complaints(number, tmp_path)
    test = f"tests/end_to_end/test_random_mechanisms.py::test_no_verdict_is_contradicted[{number}]"
    count = number // STRIDE + 1
    assert not wrong, f"repeat with: CAMGEO_RANDOM_SCENES={count} python -m pytest '{test}'"


# What is wrong is found ---------------------------------------------------------------------------


def found_by_check(values: Values, folder: Path) -> list[dict[str, Any]]:
    """The findings of a scene."""
    wrong: list[str] = []
    answer = run(wrong, "check", written(values, folder / "scene.toml"), "--json")
    assert answer is not None, wrong
    found: list[dict[str, Any]] = answer.document["findings"]
    return found


def crash(_: argparse.Namespace) -> int:
    return 1 // 0


def busy(_: argparse.Namespace) -> int:
    while True:
        pass


@pytest.mark.parametrize(
    ("broken", "complaint"),
    [(crash, "plot: ZeroDivisionError"), (busy, "plot: takes too long")],
)
def test_a_crash_and_a_hang_of_any_command_are_complaints(
    broken: Callable[[argparse.Namespace], int],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("camgeo.app.cli.plot.run", broken)
    monkeypatch.setitem(LONG, "plot", 0.2)
    (found,) = complaints(2 * STRIDE, tmp_path)
    assert found.startswith(complaint)


def test_a_wrong_angle_and_an_undercut_that_is_not_seen_are_contradicted(tmp_path: Path) -> None:
    scene = drawn(122)
    found = found_by_check(scene.values, tmp_path)
    assert not contradicted(found, scene)
    for key, complaint in (("arm", "transmission angle"), ("roller_radius", "roller reaches")):
        factor = {"arm": 0.95, "roller_radius": 4.5}[key]
        follower = scene.values["follower"]
        other = {**scene.values, "follower": {**follower, key: factor * follower[key]}}
        wrong = contradicted(found, Drawn(other, None))
        assert any(complaint in each for each in wrong)


def test_a_passed_dead_centre_that_is_not_seen_is_contradicted(tmp_path: Path) -> None:
    scene = drawn(1)
    assert Model(scene.values).leverage < 0.0
    found = found_by_check(scene.values, tmp_path)
    seen = [each for each in found if each["name"] != "linkage-transmission-angle"]
    assert len(seen) < len(found)
    assert not contradicted(found, scene)
    assert any("dead centre" in each for each in contradicted(seen, scene))
