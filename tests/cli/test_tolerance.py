"""`camgeo tolerance`: files, messages, wrong input."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.calling import FIXTURES, SCENES, called, changed

LEVER, PAIR = FIXTURES / "tolerance" / "lever.toml", FIXTURES / "tolerance" / "pair.toml"

PUSHED = """
[[tolerance.dimension]]
key = "{}"
plus_minus = 0.01
[[tolerance.form]]
plus_minus = 0.02
waves = 60
"""

RETURNING = '\n[[tolerance.form]]\nplus_minus = 0.01\nwaves = 3\nside = "return"\n'


@pytest.mark.parametrize(
    ("scene", "old", "new", "said"),
    [
        (LEVER, '"follower.arm"', '"follower.am"',
         '"follower.am": is no dimension of this oscillating-roller machine; it has'),
        (LEVER, '"follower.arm"', '"follower.am"', "(did you mean follower.arm?)"),
        (LEVER, '"follower.arm"', '"linkage.crank"', "is no dimension of this oscillating-roller"),
        (LEVER, 'class = "h6"', 'class = "h17"', 'grade from IT1 to IT16, e.g. "H7"'),
        (LEVER, 'class = "h6"', 'clas = "h6"', "did you mean class?"),
        (LEVER, 'class = "h6"', "", 'must have one of "plus_minus", "limits" and "class"'),
        (LEVER, '"mounting.angle"\nplus_minus = 0.05', '"mounting.angle"\nclass = "h6"',
         "belongs to lengths: this dimension takes plus_minus or limits"),
        (LEVER, "plus_minus = 0.03", "plus_minus = -0.03", "must be a number above 0 to 1000"),
        (LEVER, "plus_minus = 0.03", "limits = [0.02, 0.01]",
         "must be [from, to], with from below to"),
        (LEVER, '"follower.pivot[2]"', '"follower.pivot[1]"', "has a tolerance already"),
        (LEVER, '"uniform"', '"gauss"', 'must be one of "normal"'),
        (LEVER, '"uniform"', '"uniform"\nsigma = 0.01', 'belongs to distribution "normal"'),
        (LEVER, 'shaft = "g6"', 'shaft = "n6"',
         "is no fit with clearance: H7/n6 may interfere by 28 mic"),
        (LEVER, 'shaft = "g6"', 'shaft = "G6"', "must begin with a small letter"),
        (LEVER, 'at = "cam"', 'at = "roller"', 'needs "size", the nominal diameter of the pin'),
        (LEVER, "waves = 12", "waves = 0", "must be a whole number from 1 to 1000"),
        (LEVER, "plus_minus = 0.01\nwaves = 12", "plus_minus = 5\nwaves = 60", "form[1]: "),
        (LEVER, "limit = 0.055  # degrees", 'flank = "outer"',
         'tolerance.flank = outer: is not a flank on which the follower runs; must be "inner"'),
        (PAIR, 'side = "return"\nhole', 'side = "second"\nhole',
         'must be one of "main", "return"'),
        (PAIR, '"follower.return.arm"', '"follower.return.spacing"', "is no dimension of this"),
        (PAIR, '"follower.return.arm"', '"follower.yoke.breadth"', "is no dimension of this"),
    ],
)  # fmt: skip
def test_what_a_machine_does_not_have(
    scene: Path, old: str, new: str, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "errors.csv"
    found = called("tolerance", changed(scene, tmp_path / "other.toml", (old, new)), "-o", file)
    assert found.code == 2
    assert said in found.err
    assert not file.exists()


@pytest.mark.parametrize(
    ("scene", "offset", "more", "said"),
    [
        ("plate_translating", "", RETURNING, 'form[1].side = "return": belongs to two'),
        ("constant_breadth", "", RETURNING, 'form[1].side = "return": belongs to two'),
        ("setzhub", "", "", "tolerance: is missing: it states the tolerances, see docs/tolerance"),
        ("cut_lobe", "", PUSHED.format("mounting.x"),
         "the inner flank of this translating-roller follower has corners"),
        ("plate_translating", "offset = 50", PUSHED.format("follower.base_radius"),
         "the cam cannot move the follower at cam angle"),
        ("tappet", "", PUSHED.format("shaft.x"), "form[1]: a flat face cannot touch all of a flan"),
    ],
)  # fmt: skip
def test_machines_that_are_not_analysed(
    scene: str, offset: str, more: str, said: str, tmp_path: Path
) -> None:
    changes = [("offset = 12", offset)] if offset else []
    made = changed(SCENES / f"{scene}.toml", tmp_path / "scene.toml", *changes, more=more)
    found = called("tolerance", made)
    assert found.code == 2
    assert said in found.err
