"""What camgeo says of mechanisms made up at random, against `independent` and against itself.

Commands are run as a user runs them. Each of them ends in good time, text and JSON agree, and no
verdict contradicts what is laid out there; a verdict too near to its limit for that is left out.
`CAMGEO_RANDOM_SCENES` says how many scenes; half of them are near a dead centre, a cusp or a joint.
"""

from __future__ import annotations

import contextlib
import copy
import io
import json
import math
import os
import signal
import tomllib
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import pytest
import tomlkit

from camgeo.cli.main import main
from tests.end_to_end.independent import ACCURACY, Model
from tests.end_to_end.random_mechanisms import Drawn, Values, drawn

COUNT: Final = int(os.environ.get("CAMGEO_RANDOM_SCENES", "10"))

STRIDE: Final = 13
"""From scene to scene: ten of them have every mechanism, and six are near something critical."""

PATIENCE: Final = 10.0
"""CPU that a command may take on up to 50 segments [s]."""

CURED: Final = ("cusp-", "undercut-", "global-undercut-", "lobe-", "lost-stroke-", "convexity")

NONE: Final = ("invalid", "no-disc")

SIZED: Final = (*CURED, "transmission-angle", "radius-ratio-", "outline-", "face-over-axis")
"""Beginnings of the names of findings that `camgeo size` answers for."""


class TooLongError(Exception):
    """A command took more than `PATIENCE`."""


@contextlib.contextmanager
def _in_time() -> Generator[None]:
    def stop(*_: object) -> None:
        raise TooLongError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@dataclass(frozen=True)
class Run:
    """What a command answered."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        return json.loads(self.out)


def run(*words: str | Path) -> Run:
    """A command in this process; its time is limited."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _in_time():
        try:
            code = main([str(word) for word in words])
        except SystemExit as exit_:
            code = exit_.code if isinstance(exit_.code, int) else 1
    return Run(code, out.getvalue(), err.getvalue())


def edited(values: Values, changes: dict[str, Any]) -> Values:
    """The scene with values at paths such as "motion[2].span"."""
    found = copy.deepcopy(values)
    for path, value in changes.items():
        *tables, last = path.replace("]", "").replace("[", ".").split(".")
        node: Any = found
        for name in tables:
            node = node[int(name) - 1] if name.isdigit() else node.setdefault(name, {})
        if last.isdigit():
            node[int(last) - 1] = value
        else:
            node[last] = value
    return found


def written(values: Values, path: Path) -> Path:
    path.write_text(tomlkit.dumps(values), encoding="utf-8")
    assert tomllib.loads(path.read_text(encoding="utf-8"))["name"] == values["name"]
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
    runs = {}
    for command in (
        ("check", path),
        ("check", path, "--json"),
        ("size", path, "--json", "--force", "--scene", folder / "sized.toml"),
        ("plot", path, "cam", "--force", "-o", folder / "cam.svg"),
    ):
        name = " ".join(command[:1] + tuple(word for word in command if word == "--json"))
        try:
            runs[name] = run(*command)
        except TooLongError:
            wrong.append(f"{name}: takes more than {PATIENCE:g} s")
        except Exception as error:
            wrong.append(f"{name}: {type(error).__name__}: {error}")
    text, document = runs.get("check"), runs.get("check --json")
    if text is None or document is None:
        return wrong
    if text.code != document.code:
        wrong.append(f"check exits with {text.code}, --json with {document.code}")
    answer = document.document
    if "findings" not in answer:
        refused = Model(scene.values).spare > 1e-3 and "does not close" in document.out
        return [*wrong, f"refused: {document.out}"] if refused else wrong
    if "nan" in document.out.lower().replace("dominan", "") or "Infinity" in document.out:
        wrong.append("a number that is none in the document")
    wrong += contradicted(answer["findings"], scene)
    sized = runs.get("size --json")
    if sized is not None and sized.code == 0:
        wrong += _unsized(folder)
    wrong += _uncured(answer, scene.values, folder)
    return wrong


def _unsized(folder: Path) -> list[str]:
    """What `check` finds wrong with the size of the scene that `size` has written."""
    try:
        found = run("check", folder / "sized.toml", "--json").document
    except TooLongError:
        return ["check of the smallest cam takes too long"]
    if "findings" not in found:
        return [f"the smallest cam is a wrong scene: {found}"]
    return [
        f"the smallest cam: {each['sentence']}"
        for each in found["findings"]
        if each["name"].startswith(SIZED) and each["severity"] in (*NONE, "broken")
    ]


def _uncured(answer: Any, values: Values, folder: Path) -> list[str]:
    """Cures that do not cure, applied as they are stated."""
    before = {
        each["name"].removeprefix("return: ")
        for each in answer["findings"]
        if each["severity"] in NONE and each["name"].removeprefix("return: ").startswith(CURED)
    }
    wrong = []
    for cure in answer["cures"]:
        if cure["to"] is None:
            continue
        changes = {cure["key"]: _beyond(cure)}
        changes |= {each["key"]: each["to"] for each in cure["also"]}
        path = written(edited(values, changes), folder / "cured.toml")
        try:
            after = run("check", path, "--json")
        except TooLongError:
            wrong.append(f"check of the cure {cure['sentence']!r} takes too long")
            continue
        found = after.document
        if "findings" not in found:
            wrong.append(f"the cure {cure['sentence']!r} makes a wrong scene: {after.out[:300]}")
            continue
        left = [
            each["sentence"]
            for each in found["findings"]
            if each["severity"] in NONE and each["name"].startswith(tuple(before))
        ]
        if left:
            wrong.append(f"{cure['sentence']!r} does not cure: {left[0]}")
    return wrong


def _beyond(cure: Any) -> Any:
    """The value of a cure, and for a length, which is the limit itself, a little beyond it."""
    to, present = cure["to"], cure["from"]
    if cure["unit"] != "mm":
        return to
    return to + math.copysign(1e-6 * max(abs(to), 1.0), to - present)


@pytest.mark.parametrize("number", range(0, STRIDE * COUNT, STRIDE))
def test_no_verdict_is_contradicted(number: int, tmp_path: Path) -> None:
    assert not complaints(number, tmp_path)


# The model contradicts what is wrong --------------------------------------------------------------


def test_a_wrong_angle_and_an_undercut_that_is_not_seen_are_contradicted(tmp_path: Path) -> None:
    scene = drawn(122)
    found = run("check", written(scene.values, tmp_path / "scene.toml"), "--json").document
    assert not contradicted(found["findings"], scene)
    for key, complaint in (("arm", "transmission angle"), ("roller_radius", "roller reaches")):
        factor = {"arm": 0.95, "roller_radius": 4.5}[key]
        other = edited(scene.values, {f"follower.{key}": factor * scene.values["follower"][key]})
        wrong = contradicted(found["findings"], Drawn(other, None))
        assert any(complaint in each for each in wrong)


def test_a_passed_dead_centre_that_is_not_seen_is_contradicted(tmp_path: Path) -> None:
    scene = drawn(1)
    assert Model(scene.values).leverage < 0.0
    found = run("check", written(scene.values, tmp_path / "scene.toml"), "--json").document
    seen = [each for each in found["findings"] if each["name"] != "linkage-transmission-angle"]
    assert len(seen) < len(found["findings"])
    assert not contradicted(found["findings"], scene)
    assert any("dead centre" in each for each in contradicted(seen, scene))
