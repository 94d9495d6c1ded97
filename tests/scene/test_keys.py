"""The scanner finds the line of every key that tomllib finds."""

from __future__ import annotations

import tomllib

import pytest

from camgeo.scene.keys import key_lines, line_of, spelled
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, PLATE, ROCKER, values_in

TRICKY = '''
# [not.a.table]
a = 1 # b = 2
"quoted key" = 'x # y'
c.d."e f" = """
[inside]
f = 1
"""
g = [
  1, # [h]
  [2, 3],
  { i = 4 },
]
[table]   # comment
j = "]"
[ table . sub ]
k = { l = [1], m = "}" }
[[array]]
n = 1
[array.inner]
o = \'\'\'
[[array]]
\'\'\'
[[array]]
[[array.deep]]
p = 1
[[array.deep]]
p = 2
'''

EXPECTED = {
    ("a",): 3,
    ("quoted key",): 4,
    ("c",): 5,
    ("c", "d"): 5,
    ("c", "d", "e f"): 5,
    ("g",): 9,
    ("g", 0): 10,
    ("g", 1): 11,
    ("g", 2): 12,
    ("table",): 14,
    ("table", "j"): 15,
    ("table", "sub"): 16,
    ("table", "sub", "k"): 17,
    ("array",): 18,
    ("array", 0): 18,
    ("array", 0, "n"): 19,
    ("array", 0, "inner"): 20,
    ("array", 0, "inner", "o"): 21,
    ("array", 1): 24,
    ("array", 1, "deep"): 25,
    ("array", 1, "deep", 0): 25,
    ("array", 1, "deep", 0, "p"): 26,
    ("array", 1, "deep", 1): 27,
    ("array", 1, "deep", 1, "p"): 28,
}


def test_tricky_file() -> None:
    tomllib.loads(TRICKY)
    assert key_lines(TRICKY) == EXPECTED


def test_nearest_line_around_a_key() -> None:
    lines = key_lines(TRICKY)
    assert line_of(("table", "sub", "k", "l", 0), lines) == 17
    assert line_of(("array", 1, "deep", 1, "q"), lines) == 27
    assert line_of(("nothing",), lines) is None
    without_header = key_lines("a = 1\n[effects.spring]\n[effects.load]\n")
    assert line_of(("effects", "inertia"), without_header) == 2
    assert line_of((), lines) is None


def test_gives_up_on_an_escape_in_a_key() -> None:
    assert key_lines('a = 1\n"b\\n" = 2\nc = 3\n') == {("a",): 1}


def test_paths_are_counted_from_one() -> None:
    assert spelled(("motion", 1, "span")) == "motion[2].span"
    assert spelled(("odd key", "a.b", 0)) == '"odd key"."a.b"[1]'
    assert spelled((200 * "x",)) == '"' + 60 * "x" + '..."'
    assert spelled(()) == ""


SCENES = [PLATE, ROCKER, LINKED, GROOVE, *(f.read_text() for f in sorted(FIXTURES.glob("*.toml")))]


@pytest.mark.parametrize("text", SCENES, ids=range(len(SCENES)))
def test_every_key_has_its_line(text: str) -> None:
    lines = key_lines(text)
    rows = text.splitlines()
    for path, _ in values_in(tomllib.loads(text)):
        if isinstance(path[-1], str):
            line = line_of(path, lines)
            assert line is not None
            assert path[-1] in rows[line - 1]
