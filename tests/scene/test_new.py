"""The scenes of `camgeo new` load, and explain every key they use."""

from __future__ import annotations

import pytest

from camgeo.scene.load import parse_scene
from camgeo.scene.model import Scene
from camgeo.scene.new import KINDS, template


@pytest.mark.parametrize("kind", KINDS)
def test_template_loads(kind: str) -> None:
    scene = parse_scene(template(kind))
    assert isinstance(scene, Scene)
    assert scene.name == kind
    assert (scene.linkage is not None) == (kind == "slider-crank")
    assert (scene.contact == "groove") == (kind == "groove")


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
def test_template_fits_a_screen(kind: str) -> None:
    assert max(map(len, template(kind).splitlines())) <= 100


def test_unknown_kind() -> None:
    with pytest.raises(KeyError, match="elephant"):
        template("elephant")
