"""The hash of a scene's text, which earlier files name, covers everything except effects."""

from __future__ import annotations

import hashlib
import tomllib

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from camgeo.dynamics.effects import registry
from camgeo.dynamics.effects.registry import EFFECTS
from camgeo.scene import effects as tables
from camgeo.scene.scene import parse_scene, without_effects
from camgeo.scene.values import document
from tests.effects.fakes import fake
from tests.scene.scenes import GROOVE, PLATE

SPRING = "[effects.spring]\npreload = 40\nstiffness = 2.5\n"


@pytest.fixture(autouse=True)
def _fakes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which effects there are is no matter of the hash."""
    found = {name: fake(name) for name in EFFECTS}
    monkeypatch.setattr(registry, "find_effect", found.__getitem__)
    monkeypatch.setattr(tables, "find_effect", found.__getitem__)


@pytest.fixture(scope="module")
def of_plate() -> str:
    return parse_scene(PLATE).made_before


def kept(text: str) -> str:
    data = text.encode()
    return without_effects(data, document(data)).decode()


def hash_of(text: str) -> str:
    """Of the bytes themselves: text would have its line ends translated."""
    found = parse_scene(text).made_before
    assert found == hashlib.sha256(kept(text).encode()).hexdigest()
    return found


def test_without_effects_it_is_the_hash_of_the_file() -> None:
    assert hash_of(PLATE) == hashlib.sha256(PLATE.encode()).hexdigest()
    # Not even a comment or an empty line is left out.
    text = f"# no [effects]\n\n{PLATE}\n\n# end\n\n"
    assert hash_of(text) == hashlib.sha256(text.encode()).hexdigest()


HEADS = [
    "",
    "\n",
    "\n\n# The spring.\n# It is strong.\n",
    "\n# one\n# two\n",
]

BODIES = [
    SPRING,
    "[effects]\n",
    "[effects.gravity]\n",
    "[ effects . gravity ]  # weights\n",
    '["effects".gravity]\n',
    "[effects.load]\nsegments = [\n    1, 2,  # two\n\n    # of five\n    3, 4, 5,\n]\n",
    "[effects.spring]\n# the preload\npreload = 40  # N\n\n# the rate\nstiffness = 2.5\n",
    "[effects]\ngravity = {}\nspring = { preload = 40, stiffness = 2.5 }\n",
    "[effects]\nspring.preload = 40\nspring.stiffness = 2.5\ngravity.angle = -90\n",
    "[effects.spring]\npreload = 40\n\n[effects.gravity]\nangle = -90\n\n[effects.balance]\n",
    "[effects.vibration]\n[effects.vibration.second]\nnatural_frequency = 9\nmass_ratio = 0.5\n",
    '[effects.balance]\nmaterial = """steel"""\n',
]


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("body", BODIES)
def test_at_the_end(head: str, body: str, of_plate: str) -> None:
    assert hash_of(f"{PLATE}{head}{body}") == of_plate


@pytest.mark.parametrize(
    "text",
    [
        "effects.spring.preload = 40\neffects.gravity = {}\n",
        "effects = { spring = { preload = 40 } }\n",
        "# forces\neffects.load.segments = [1, 2,\n# more\n3, 4, 5]\n\n",
    ],
)
def test_dotted_keys_at_the_top(text: str) -> None:
    head, rest = PLATE.split("[units]\n")
    assert hash_of(f"{head}{text}[units]\n{rest}") == hash_of(PLATE)


def test_with_the_line_ends_of_windows() -> None:
    """A file with them has a hash of its own, and keeps it."""
    plain = PLATE.replace("\n", "\r\n")
    for head in HEADS:
        for body in BODIES:
            text = f"{PLATE}{head}{body}".replace("\n", "\r\n")
            assert kept(text) == plain, text
    assert hash_of(plain) != hash_of(PLATE)


def test_comments_of_what_comes_after_stay() -> None:
    before, after = PLATE.split("[limits]\n")
    commented = f"{before}# what is allowed\n[limits]\n{after}"
    assert kept(f"{before}{SPRING}\n# what is allowed\n[limits]\n{after}") == commented
    assert kept(f"{before}{SPRING}# what is allowed\n[limits]\n{after}") == commented


def test_empty_lines_between_others_stay() -> None:
    before, after = PLATE.split("[limits]\n")
    assert kept(f"{before}\n\n{SPRING}\n[limits]\n{after}") == f"{before}\n\n[limits]\n{after}"


def test_a_last_line_without_an_end() -> None:
    assert kept(f"{PLATE}\n{SPRING}".rstrip("\n")) == PLATE


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("base_radius = 50", "base_radius = 51"),
        ("[limits]", "# limits\n[limits]"),
        ("[limits]", "\n[limits]"),
        ('name = "plate"', 'name = "plates"'),
        ("inflection = 0.4", "inflection = 0.40"),
    ],
)
def test_a_change_elsewhere_changes_it(old: str, new: str) -> None:
    assert PLATE.count(old) == 1
    changed = PLATE.replace(old, new)
    assert hash_of(changed) != hash_of(PLATE)
    assert hash_of(f"{changed}\n{SPRING}") == hash_of(changed)
    assert hash_of(f"{changed}\n{SPRING}") != hash_of(f"{PLATE}\n{SPRING}")


def sections(scene: str) -> list[str]:
    """A scene cut before each of its headers."""
    parts = scene.replace("\n[", "\n\x00[").split("\x00")
    assert "".join(parts) == scene
    return parts


@settings(deadline=None)
@given(
    scene=st.sampled_from([PLATE, GROOVE]),
    place=st.integers(1, 30),
    body=st.sampled_from(BODIES),
    head=st.sampled_from(["", "# a comment\n", "# what moves\n", "# [effects]\n#\n"]),
    tail=st.sampled_from(["", "\n", "\n\n\n"]),
)
@example(scene=PLATE, place=1, body=BODIES[0], head="", tail="")
def test_wherever_they_stand(scene: str, place: int, body: str, head: str, tail: str) -> None:
    parts = sections(scene)
    place = min(place, len(parts))
    # Keys of `[units]` under `[effects]`: a header of its own follows each part.
    text = "".join((*parts[:place], head, body, tail, *parts[place:]))
    left = kept(text)
    assert left == scene
    assert "effects" not in tomllib.loads(left)
