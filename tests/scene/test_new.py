"""The scenes of `camgeo new` load, and explain every key they use."""

from __future__ import annotations

import re

import pytest

from camgeo.design import Design
from camgeo.errors import UnknownNameError
from camgeo.scene.load import parse_scene
from camgeo.scene.new import KINDS, template
from camgeo.scene.scene import Scene
from tests.findings import effect_findings


@pytest.mark.parametrize("kind", KINDS)
def test_template_loads(kind: str) -> None:
    scene = parse_scene(template(kind))
    assert isinstance(scene, Scene)
    assert scene.name == kind
    member = None if scene.linkage is None else scene.linkage.member
    members = {"slider-crank": "slider", "slider-driven-crank": "crank", "four-bar": "lever"}
    assert member == members.get(kind)
    assert (scene.contact == "groove") == (kind == "groove")
    assert (scene.returning is not None) == kind.startswith("conjugate-")


@pytest.mark.parametrize("kind", KINDS)
def test_template_explains_each_key(kind: str) -> None:
    known: set[str] = set()
    for line in template(kind).splitlines():
        key, _, rest = line.partition("=")
        if not rest or line.lstrip().startswith("#"):
            continue
        # A key that comes again needs no second comment.
        assert "#" in rest or key.strip() in known or key.strip() in ("thickness", "roller_radius")
        known.add(key.strip())


@pytest.mark.parametrize("kind", KINDS)
def test_effects_that_are_offered_work(kind: str) -> None:
    """Taken out of their comments as the template says, they break no limit."""
    head, mark, rest = template(kind).partition("# Effects:")
    offered, output, tail = rest.partition("\n[output]\n")
    asked = re.sub(r"^# (?=\[|\w+ = )", "", offered, flags=re.MULTILINE)
    text = head + mark + asked + output + tail
    design = Design(parse_scene(text))
    # Most effects are for rollers, and some for a single contact.
    flat = not design.cam.follower.rolls
    core = {"kinematics"} if flat else {"inertia", "drive-torque"}
    if not flat and len(design.discs) == 1:
        core |= {"contact-force", "lift-off"}
    assert core <= set(design.scene.effects)
    assert [f for f in effect_findings(design) if f.severity not in ("ok", "warning")] == []


@pytest.mark.parametrize("kind", KINDS)
def test_template_fits_a_screen(kind: str) -> None:
    assert max(map(len, template(kind).splitlines())) <= 100


def test_unknown_kind() -> None:
    with pytest.raises(UnknownNameError, match='no template "elephant"; there are translating'):
        template("elephant")
