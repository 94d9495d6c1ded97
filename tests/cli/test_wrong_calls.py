"""Calls that are wrong: exit code 2, what is allowed is said, and nothing is printed or written.

Those of `test_kept.py` are kept with all that is said of them; these are told by a few words.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.calling import FIXTURES, called

PLATE = "scenes/plate_translating.toml"

LEVER = "slotted-lever --frame 150 --swing 60 --speed 90"

TABLE = f"{LEVER} --table"

EQUAL = "slotted-lever --frame 150 --crank 150 --speed 90"

FAMILY = (
    "sweep scenes/setzhub.toml --vary follower.base_radius=40:60:4"
    " --vary motion.2.law=modified-sine,polynomial-345 --ask laws"
)

SEARCH = "optimise scenes/setzhub.toml --vary follower.base_radius=45:55"

LAW = "table --law modified-sine"

WRONG = {
    "": "COMMAND",
    "bild": "invalid choice: 'bild'",
    "check": "required: SCENE",
    f"build {PLATE} --tolerance x": "--tolerance: 'x' is not a finite number",
    f"build {PLATE} --tolerance nan": "--tolerance: 'nan' is not a finite number",
    f"build {PLATE} --tolerance=-inf": "--tolerance: '-inf' is not a finite number",
    f"build {PLATE} --tolerance {'1' * 400}": "is too large for a number",
    f"build {PLATE} --tolerance=-1e999": "is too large for a number",
    f"build {PLATE} --tolerance=-1": "tolerance = -1: must be a length",
    f"build {PLATE} --tolerance 1e-8": "tolerance = 1e-08: must be a length",
    f"build {PLATE} --only ,": "format: no format is named; the formats are 3mf, ",
    f"verify {PLATE} --tolerance 0": "--tolerance: must be a length above 0",
    f"verify {PLATE} --tolerance=-1": "--tolerance: must be a length above 0",
    f"verify {PLATE} --tolerance wide": "--tolerance: 'wide' is not a finite number",
    f"accuracy {PLATE} --tolerances 1e-3,fine": "'fine' must be a length of 1e-07 to 1 mm",
    f"accuracy {PLATE} --tolerances nan": "'nan' must be a length",
    f"accuracy {PLATE} -o a.bmp": "'a.bmp' must end in one of .png, .svg, .pdf",
    f"compare {' '.join([PLATE] * 9)}": "2 to 8 designs can be compared",
    f"compare {PLATE} {PLATE} --ask mu": 'ask for "peak:mu"',
    f"inspect {PLATE} p.csv --align best": "'best'",
    f"inspect {PLATE} p.csv --unit cm": "'cm'",
    f"inspect {PLATE} p.csv --ball nan": "is not a finite number",
    f"inspect {PLATE} p.csv --tolerance 0": "must be a number from",
    f"inspect {PLATE} p.csv -o x.txt": "must end in one of .csv, .png",
    "laws --law modified-sin": "is not a motion law; did you mean modified-sine?",
    "laws --task X-X": "'X-X'",
    "laws --inflection x": "--inflection: 'x' is not a finite number",
    "laws --law simple-sine --inflection 0": "simple-sine: not possible: inflection = 0.0: the",
    "laws --law scca simple-sine --inflection 0": "scca, simple-sine: not possible: inflection",
    "laws --task G-U --law straight-line": "not possible: straight-line is made for R-R, G-G",
    "laws --speed 0 --span 60 --stroke 1": "speed = 0.0: must be a number above 0",
    "laws --speed 1 --span 361 --stroke 1": "span = 361: cannot be more than one",
    "laws --task all --v0 1 --places": "--v0, --places: allowed with one task only",
    "laws --task all -o {}/x.svg": "-o: allowed with one task only",
    "laws -o laws.gif": "'laws.gif' must end in one of .png, .svg, .pdf",
    f"{SEARCH} --least diametre": 'did you mean "diameter"?',
    f"{SEARCH} --least diameter --evaluations 1000000000": "must be from 1 to 1,000,000",
    f"{SEARCH} --least diameter --seed -1": "must be a whole number from 0",
    f"{SEARCH} --least diameter --seconds 0": "must be above 0",
    f"{SEARCH} --least diameter --workers 1000": "workers = 1000: must be from 1 to 512",
    f"{SEARCH} --least diameter -o best.xls": "'best.xls' must end in one of .toml",
    "optimise scenes/setzhub.toml --least diameter": "nothing varies",
    "optimise scenes/measured.toml --vary follower.base_radius=45:55 --least diameter"
    " -o {}/best.toml": "must be in the folder of SCENE",
    f"probe {PLATE} --step 0": "from 0.01 to 30 are allowed",
    f"probe {PLATE} --ball -1": "must be a number, 0 or more",
    f"probe {PLATE} -o points.png": "must end in one of .csv",
    f"probe {PLATE} -o {{}}/a.csv --lift {{}}/b/a.csv": "in the same folder",
    "probe scenes/groove.toml --step 30 -o {}/p.csv --lift {}/p-inner.csv": "the file of a flank",
    f"lint {PLATE} --machine fanuk": "machine = 'fanuk'",
    f"lint {PLATE} --machine fanuk --stock-top 1": "did you mean fanuc?",
    f"lint {PLATE} --machine fanuc --clearance -1": "--clearance: is below the top of the stock",
    f"lint {PLATE} --machine fanuc --radius 1": "is not an offset and its radius",
    f"lint {PLATE} --machine fanuc --radius 1=x": "'x' is not a finite number",
    "machines hass": "did you mean haas?",
    f"replay {PLATE} --step x": "'x' is not a finite number",
    f"replay {PLATE} --gap -1": "argument --gap",
    f"replay {PLATE} --unit cm": "'cm'",
    f"replay {PLATE} --flank left": "'left'",
    f"replay {PLATE} -o a.txt": "must end in one of",
    f"replay {PLATE} outline.step": "the name must end in one of .csv, .dxf",
    f"replay {PLATE} none.csv": "cannot be read",
    f"replay {PLATE} found/drawings/shaft2.dxf --unit inch": "which is not inch",
    f"replay {PLATE} a.dxf b.dxf": "at most one file is allowed, because the scene has one disc",
    "replay scenes/conjugate_lever.toml a.dxf b.dxf c.dxf": (
        "at most two files are allowed, one for each disc"
    ),
    f"size {PLATE} --transmission-angle 0": "transmission_angle = 0: must be above 0",
    f"size {PLATE} --radius-ratio 0": "radius_ratio = 0: must be above 0",
    f"size {PLATE} --arm 40 60": "follower.kind = translating-roller",
    "size scenes/tappet.toml --arm 40 60": "only an oscillating roller follower has an arm",
    "size scenes/tappet.toml --radius-of-curvature -1": "radius_of_curvature = -1: must be a",
    f"size {PLATE} -o size.gif": "'size.gif' must end in one of",
    f"size {PLATE} -o {{}}/a/size.png --scene {{}}/b/sized.toml": "in the same folder",
    "size scenes/measured.toml --scene {}/sized.toml": "must be in the folder of SCENE",
    "slotted-lever --frame 0 --swing 60 --speed 90": "frame = 0: must be from",
    "slotted-lever --frame 1e999 --swing 60 --speed 90": "frame = 1E+999: must be from",
    "slotted-lever --frame 150 --crank 0 --speed 90": "crank = 0: must be from",
    "slotted-lever --frame 150 --swing 0 --speed 90": "swing = 0: ",
    "slotted-lever --frame 150 --swing 180.5 --speed 90": "at most 180 degrees",
    "slotted-lever --frame 150 --swing 179.9999999999 --speed 90": "give the crank",
    "slotted-lever --frame 1e-99 --swing 0.1 --speed 90": "swing = 0.1: makes a crank",
    "slotted-lever --frame 150 --swing 60 --speed -90": "speed = -90: must be from",
    f"{TABLE} --step 0": "step = 0: ",
    f"{TABLE} --step 91": "must be 0.001 to 90 degrees",
    f"{TABLE} --step 1.0000000000001": "at most 12 decimals",
    f"{TABLE} --from 360": "from = 360: ",
    f"{TABLE} --from -1": "from = -1: ",
    f"{TABLE} --from 20 --to 20": "to = 20: ",
    f"{TABLE} --to 361": "at most 360 degrees",
    f"{EQUAL} --table": "from = 0: ",
    f"{EQUAL} --table --from 1": "to = 360: ",
    "slotted-lever --frame 150 --speed 90": "--swing --crank is required",
    f"{LEVER} --crank 75": "--crank",
    f"{LEVER} --step 2 --printed": "--step, --printed: allowed with --table",
    f"{LEVER} --csv {{}}/lever.png -o {{}}/lever.png": "the same file",
    "sweep scenes/setzhub.toml --vary follower.base_radis=1,2 --ask laws": "did you mean follower",
    "sweep scenes/setzhub.toml --vary cam.speed=3:3:5 --ask laws": "is an empty range",
    "sweep scenes/setzhub.toml --vary cam.speed=1:2:1000000000 --ask laws": "designs are more",
    "sweep scenes/setzhub.toml --vary cam.speed=1,2": "names nothing: state what to ask",
    "sweep scenes/setzhub.toml --ask laws": "nothing varies",
    f"{FAMILY} -o runs.xls": "'runs.xls' must end in one of .sqlite, .csv, .json",
    f"{FAMILY} -o {{}}/a.csv -o {{}}/a.csv": "must name different files",
    f"{FAMILY} --picture a.bmp": "'a.bmp' must end in one of .png, .svg, .pdf",
    f"{FAMILY} --picture {{}}/a.png --least laws": "two objectives or more",
    f"{FAMILY} --samples 0": "must be at least 1",
    f"table {PLATE} --law modified-sine": "SCENE and --law are both given",
    f"table {PLATE} --inflection 0.4 --task R-R": "--task, --inflection: allowed with",
    f"table {PLATE} --step nan": "--step: 'nan' is not a finite number",
    "table --law Cycloid": "did you mean cycloidal?",
    f"{LAW} --step 0": "must be a step of z from 0.000001 to 0.5",
    f"{LAW} --step 0.6": "must be a step of z from 0.000001 to 0.5",
    f"{LAW} --v0 inf": "--v0: 'inf' is not a finite number",
    f"{LAW} --inflection 1.5": "inflection = 1.5: ",
    f"{LAW} --task X-R": "'X-R'",
    "table --law polynomial-345 --task G-U": "polynomial-345 is made for R-R",
    "tolerance tolerance/lever.toml -o errors.toml": "must end in one of .csv, .json, .png",
    "watch a.toml --runs 1.5": "--runs",
    "watch a.toml --runs -1": "--runs",
    "design none.toml --no-browser": "there is no such file",
    "design .. --no-browser": "there is no such file",
    "design --port -1 --no-browser": "from 0 to 65535",
    "design --port x --no-browser": "from 0 to 65535",
}


@pytest.mark.parametrize("call", WRONG)
def test_a_wrong_call_is_refused(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FIXTURES)
    found = called(*call.replace("{}", str(tmp_path)).split())
    assert (found.code, found.out) == (2, "")
    assert WRONG[call] in found.err
    assert list(tmp_path.iterdir()) == []
