"""`camgeo tolerance`: files, messages, wrong input."""

from __future__ import annotations

from pathlib import Path

import pytest

from camgeo.app.cli.main import main
from tests.tolerancing.machines import FIXTURES, LEVER

FEW = ("--count", "128")

Capture = pytest.CaptureFixture[str]


@pytest.mark.long  # tests/answers/test_kept.py has table and record whole
def test_table_and_record_are_the_same_bytes_again(tmp_path: Path, capsys: Capture) -> None:
    for name in ("errors.csv", "errors.json"):
        files = [tmp_path / each / name for each in ("one", "two")]
        for file in files:
            file.parent.mkdir(exist_ok=True)
            assert main(["tolerance", str(LEVER), *FEW, "-o", str(file)]) == 0
        assert files[0].read_bytes() == files[1].read_bytes()
    out, err = capsys.readouterr()
    assert out.startswith("lever: position of the follower on the inner flank, 7 sources\n")
    assert "errors.csv: 360 rows" in err
    other = tmp_path / "errors.csv"
    assert main(["tolerance", str(LEVER), *FEW, "--seed", "2", "-o", str(other)]) == 0
    assert other.read_bytes() != (tmp_path / "one" / "errors.csv").read_bytes()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--count", "127"), "count = 127: must be from 128 to 16,384"),
        (("--count", "1000000000"), "must be from 128 to 16,384"),
        (("--seed", "-1"), "seed = -1: must be a whole number from 0"),
        (("-o", "errors.toml"), "must end in one of .csv, .json, .png"),
    ],
)
def test_what_cannot_be_drawn(words: tuple[str, str], said: str, capsys: Capture) -> None:
    try:
        code = main(["tolerance", str(LEVER), *words])
    except SystemExit as stopped:  # a wrong option
        code = int(stopped.code or 0)
    assert code == 2
    assert said in capsys.readouterr().err


@pytest.mark.long  # tests/figure/test_kept.py has its marks
def test_a_picture(tmp_path: Path, capsys: Capture) -> None:
    picture = tmp_path / "errors.png"
    assert main(["tolerance", str(LEVER), *FEW, "-o", str(picture)]) == 0
    assert capsys.readouterr().err == f"{picture}: errors over the cam angle\n"
    assert picture.read_bytes().startswith(b"\x89PNG")


def replaced(tmp_path: Path, old: str, new: str) -> str:
    path = tmp_path / "other.toml"
    text = LEVER.read_text("utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), "utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            '"follower.arm"', '"follower.am"',
            '"follower.am": is no dimension of this oscillating-roller machine; it has',
        ),
        ('"follower.arm"', '"follower.am"', "(did you mean follower.arm?)"),
        ('"follower.arm"', '"linkage.crank"', "is no dimension of this oscillating-roller machine"),
        ('class = "h6"', 'class = "h17"', 'grade from IT1 to IT16, e.g. "H7"'),
        ('class = "h6"', 'clas = "h6"', "did you mean class?"),
        ('class = "h6"', "", 'must have one of "plus_minus", "limits" and "class"'),
        ('"mounting.angle"\nplus_minus = 0.05', '"mounting.angle"\nclass = "h6"',
         "belongs to lengths: this dimension takes plus_minus or limits"),
        ("plus_minus = 0.03", "plus_minus = -0.03", "must be a number above 0 to 1000"),
        ("plus_minus = 0.03", "limits = [0.02, 0.01]", "must end above where it begins"),
        ('"follower.pivot[2]"', '"follower.pivot[1]"', "has a tolerance already"),
        ('distribution = "uniform"', 'distribution = "gauss"', 'must be one of "normal"'),
        ('distribution = "uniform"', 'distribution = "uniform"\nsigma = 0.01',
         'belongs to distribution "normal"'),
        ('shaft = "g6"', 'shaft = "n6"', "is no fit with clearance: H7/n6 may interfere by 28 mic"),
        ('shaft = "g6"', 'shaft = "G6"', "must begin with a small letter"),
        ('at = "cam"', 'at = "roller"', 'needs "size", the nominal diameter of the pin'),
        ("waves = 12", "waves = 0", "must be a whole number from 1 to 1000"),
        ("plus_minus = 0.01\nwaves = 12", "plus_minus = 5\nwaves = 60", "form[1]: "),
    ],
)  # fmt: skip
def test_what_a_machine_does_not_have(
    tmp_path: Path, capsys: Capture, old: str, new: str, said: str
) -> None:
    file = tmp_path / "errors.csv"
    assert main(["tolerance", replaced(tmp_path, old, new), "-o", str(file)]) == 2
    assert said in capsys.readouterr().err
    assert not file.exists()


def test_a_pair_has_play(tmp_path: Path, capsys: Capture) -> None:
    table = tmp_path / "errors.csv"
    assert main(["tolerance", str(LEVER.parent / "pair.toml"), "-o", str(table)]) == 0
    said = capsys.readouterr().out
    assert "play between both sides, mean and 3 sigma: -0.01514 deg at cam angle 96.3889" in said
    assert "95.61% of machines squeeze the follower somewhere" in said
    head, *rows = table.read_text("utf-8").splitlines()
    names = head.split(",")
    low, high = (names.index(f"play {sign} 3 sigma [deg]") for sign in "-+")
    values = [[float(each) for each in row.split(",")] for row in rows]
    assert min(row[low] for row in values) == pytest.approx(-0.01514, rel=0.01)
    assert all(row[low] < row[high] for row in values)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('side = "return"\nhole', 'side = "second"\nhole', 'must be one of "main", "return"'),
        ('"follower.return.arm"', '"follower.return.spacing"', "is no dimension of this"),
        ('"follower.return.arm"', '"follower.yoke.breadth"', "is no dimension of this"),
    ],
)
def test_what_a_pair_does_not_have(
    tmp_path: Path, capsys: Capture, old: str, new: str, said: str
) -> None:
    path = tmp_path / "pair.toml"
    text = (LEVER.parent / "pair.toml").read_text("utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), "utf-8")
    assert main(["tolerance", str(path)]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("scene", ["plate_translating", "constant_breadth"])
def test_a_side_belongs_to_two_discs(tmp_path: Path, capsys: Capture, scene: str) -> None:
    path = tmp_path / "scene.toml"
    text = (FIXTURES / "scenes" / f"{scene}.toml").read_text("utf-8")
    text += '\n[[tolerance.form]]\nplus_minus = 0.01\nwaves = 3\nside = "return"\n'
    path.write_text(text, "utf-8")
    assert main(["tolerance", str(path)]) == 2
    assert 'form[1].side = "return": belongs to two' in capsys.readouterr().err


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("setzhub", "tolerance: is missing: it states the tolerances, see docs/tolerance.md"),
        ("cut_lobe", "the inner flank of this translating-roller follower has corners"),
    ],
)
def test_machines_that_are_not_analysed(
    tmp_path: Path, capsys: Capture, scene: str, said: str
) -> None:
    path = tmp_path / "scene.toml"
    text = (FIXTURES / "scenes" / f"{scene}.toml").read_text("utf-8")
    if "is missing" not in said:
        text += '\n[[tolerance.dimension]]\nkey = "mounting.x"\nplus_minus = 0.01\n'
    path.write_text(text, "utf-8")
    assert main(["tolerance", str(path)]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("scene", "old", "new", "table", "said"),
    [
        (
            "plate_translating", "offset = 12", "offset = 50", 'key = "follower.base_radius"',
            "the cam cannot move the follower at cam angle",
        ),
        ("tappet", "", "", 'key = "shaft.x"', "form[1]: a flat face cannot touch all of a flank"),
    ],
)  # fmt: skip
def test_machines_without_an_answer(
    tmp_path: Path, capsys: Capture, scene: str, old: str, new: str, table: str, said: str
) -> None:
    path = tmp_path / "scene.toml"
    text = (FIXTURES / "scenes" / f"{scene}.toml").read_text("utf-8")
    assert old in text
    text = text.replace(old, new) + f"\n[[tolerance.dimension]]\n{table}\nplus_minus = 0.01\n"
    path.write_text(f"{text}\n[[tolerance.form]]\nplus_minus = 0.02\nwaves = 60\n", "utf-8")
    assert main(["tolerance", str(path)]) == 2
    assert said in capsys.readouterr().err


def test_a_flank_that_carries_nothing(tmp_path: Path, capsys: Capture) -> None:
    scene = replaced(tmp_path, "limit = 0.055  # degrees", 'flank = "outer"')
    assert main(["tolerance", scene]) == 2
    assert 'tolerance.flank = outer: is not where the follower runs; must be "inner"' in (
        capsys.readouterr().err
    )
