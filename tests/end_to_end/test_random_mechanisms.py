"""What camgeo says of mechanisms made up at random, against `independent`.

No verdict contradicts what is laid out there; one that is too near to its limit for that is left
out. `CAMGEO_RANDOM_SCENES` says how many scenes; half of them are near a dead centre, a cusp or a
joint. `tests.fuzz` runs commands on such scenes.
"""

from __future__ import annotations

import math
import os
from typing import Final

import pytest

from camgeo.check.finding import NO_OUTLINE, Finding
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.scene.scene import Scene
from tests.end_to_end.independent import ACCURACY, Model
from tests.end_to_end.random_mechanisms import Values, drawn
from tests.findings import known

COUNT: Final = int(os.environ.get("CAMGEO_RANDOM_SCENES", "10"))

STRIDE: Final = 13
"""From scene to scene: ten of them have every mechanism, and six are near something critical."""

By = dict[str, Finding]
"""Findings by their names."""


def findings_of(values: Values) -> tuple[Finding, ...]:
    return Design(Scene(values)).findings


def contradicted(found: tuple[Finding, ...], values: Values) -> list[str]:
    """What the findings of a scene say against the model."""
    model = Model(values)
    by_name = {finding.name: finding for finding in found}
    none = [finding for finding in found if finding.severity in NO_OUTLINE]
    wrong = []
    if model.linkage is not None:
        wrong += _of_linkage(model, by_name, none)
        if any(each.name == "dead-centre" for each in none):
            return wrong
    angle = by_name.get("transmission-angle")
    if angle is not None:
        expected = math.degrees(model.transmission_angle)
        # Near 90 degrees the sine hardly changes; between two places the angle is a parabola.
        if abs(known(angle.value) - expected) > 0.05 + 2e-3 * (90.0 - expected):
            wrong.append(f"transmission angle {angle.value} for {expected}")
    return wrong + (_of_face(model, by_name) if model.is_flat else _of_flanks(model, by_name, none))


def _of_linkage(model: Model, by_name: By, none: list[Finding]) -> list[str]:
    wrong = []
    dead = any(each.name == "dead-centre" for each in none)
    if model.leverage < -ACCURACY and not none:
        wrong.append(f"ok though the driven member is passed at dead centre ({model.leverage})")
    if dead and model.spare > 1e-3 and model.leverage > 1e-2:
        wrong.append(f"a dead centre, though {model.spare} mm are to spare")
    return wrong


def _of_face(model: Model, by_name: By) -> list[str]:
    convexity = by_name.get("convexity")
    if convexity is None or convexity.unit != "mm":
        ok = convexity is not None and convexity.severity == "ok"
        return ["the face turns back"] if ok and model.face_margin < 0 else []
    place = known(convexity.cam_angle)
    margin = min(model.face_margin, model.face_margin_next_to(place))
    if (
        math.isfinite(margin)
        and abs(margin) > 1e-2
        and abs(known(convexity.value) - margin) > 0.05 * (1.0 + abs(margin))
    ):
        return [f"radius of curvature {convexity.value} for {margin}"]
    if margin < -1e-2 and convexity.severity == "ok":
        return ["convex though it is not"]
    return []


def _of_flanks(model: Model, by_name: By, none: list[Finding]) -> list[str]:
    wrong = []
    contact = model.follower["contact"]
    for name, side in (("inner", -1), ("outer", 1)):
        if contact not in (name, "groove"):
            continue
        local, reach = model.cusp_margin(side), model.reach(side)
        cut = [
            each
            for each in none
            if each.name.removeprefix("return: ").removesuffix(f"-{name}")
            in ("cusp", "undercut", "global-undercut", "outline")
        ]
        others = [each for each in none if each not in cut]
        if (local < -1e-3 or reach < -1e-3) and not none:
            wrong.append(f"{name}: ok, though 1 + d kappa = {local} and the roller reaches {reach}")
        if local > 1e-3 and reach > -1e-7 and cut and not others:
            wrong.append(f"{name}: {cut[0].sentence}, though 1 + d kappa = {local}, {reach}")
    return wrong


@pytest.mark.parametrize("number", range(0, STRIDE * COUNT, STRIDE))
def test_no_verdict_is_contradicted(number: int) -> None:
    values = drawn(number)
    try:
        wrong = contradicted(findings_of(values), values)
    except SceneError as error:
        closes = Model(values).spare > 1e-3
        wrong = [str(error)] if closes and "does not close" in str(error) else []
    assert wrong == []


def test_a_wrong_angle_and_an_undercut_that_is_not_seen_are_contradicted() -> None:
    values = drawn(122)
    found = findings_of(values)
    assert not contradicted(found, values)
    for key, complaint in (("arm", "transmission angle"), ("roller_radius", "roller reaches")):
        factor = {"arm": 0.95, "roller_radius": 4.5}[key]
        follower = values["follower"]
        other = {**values, "follower": {**follower, key: factor * follower[key]}}
        wrong = contradicted(found, other)
        assert any(complaint in each for each in wrong)


def test_a_passed_dead_centre_that_is_not_seen_is_contradicted() -> None:
    values = drawn(1)
    assert Model(values).leverage < 0.0
    found = findings_of(values)
    seen = tuple(each for each in found if each.name != "linkage-transmission-angle")
    assert len(seen) < len(found)
    assert not contradicted(found, values)
    assert any("dead centre" in each for each in contradicted(seen, values))
