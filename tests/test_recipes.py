"""The recipes of CONTRIBUTING.md, followed to the letter in a copy of the tree: a writer, a plot, a
command and a milling strategy; those of laws, mechanisms and effects have tests of their own.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.copies import check_page, check_refused, commands, copied, replaced

ROOT = Path(__file__).resolve().parents[1]

MILLED = ROOT / "fixtures" / "milling"

FORMAT = '''"""XYZ: points of the pitch curve."""

from dataclasses import dataclass

from camgeo.scene.formats.format import Format


@dataclass(frozen=True)
class XyzSpec:
    """`[output.xyz]`: decimals of the coordinates."""

    decimals: int = 4


def parse(table):
    return XyzSpec(**table)


FORMAT = Format(
    "xyz",
    ".xyz",
    parse,
    schema={
        "description": "Points of the pitch curve.",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "decimals": {
                "description": "Of coordinates.",
                "type": "integer",
                "minimum": 1,
                "maximum": 9,
                "x-unit": "1",
            }
        },
    },
    needs=("follower",),
)
'''

WRITER = '''"""XYZ: points of the pitch curve, a line each, in mm."""

import numpy as np

from camgeo.design.writing import Written
from camgeo.scene.formats.xyz import FORMAT
from camgeo.units import MM_PER


class XyzWriter:
    format = FORMAT

    def points(self, product):
        table = product.tabulated.table()
        columns = dict(zip(table.names, table.values.T))
        names = (f"pitch {axis} [{product.unit}]" for axis in "xy")
        return MM_PER[product.unit] * np.column_stack([columns[name] for name in names])

    def write(self, product, tolerance):
        decimals = product.options[FORMAT].decimals
        points = self.points(product)
        lines = [f"{x:.{decimals}f} {y:.{decimals}f} 0\\n" for x, y in points]
        return Written("".join(lines).encode(), {"points": len(points)})

    def measure(self, product, data):
        read = np.array([line.split()[:2] for line in data.decode().splitlines()], dtype=float)
        return float(np.max(np.abs(read - self.points(product))))


WRITER = XyzWriter()
'''

ENTRY_POINT = "[camgeo.writers]\nxyz = camgeo_export.xyz:WRITER\n"

PLOT = '''"""The lift of a follower over the cam angle."""

import numpy as np

from camgeo.pictures.model import Axis, Figure, Line, Panel, Style


def figure(product, size=(6.0, 4.0)):
    phi = np.linspace(0.0, 2.0 * np.pi, 361)
    lift = product.cam.drive.motion.jet(phi)[0]
    line = Line(np.column_stack([np.degrees(phi), lift]), Style("#000000"))
    x, y = Axis((0.0, 360.0), "cam angle"), Axis((float(min(lift)), float(max(lift))), "lift")
    return Figure(size, (Panel((0.1, 0.1, 0.9, 0.9), x, y, (line,), "bare lift"),))
'''

COMMAND = '''"""What `camgeo stroke` finds: how far the follower moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.app.answers.answer import SCENE, Answer, Key
from camgeo.app.cli.command import SCENE_FILE, opened, show
from camgeo.scene.scene import Scene


@dataclass(frozen=True)
class Stroke(Answer):
    scene: Scene
    stroke: float


def stroke(design):
    lift = design.cam.drive.motion.jet(np.linspace(0.0, 2.0 * np.pi, 361))[0]
    return Stroke(design.scene, float(np.ptp(lift)))


DOCUMENT = Key(
    "How far the follower moves.",
    {"scene": SCENE, "stroke_mm": "From its lowest position to its highest."},
    type=Stroke,
)


def text(answer):
    return f"{answer.scene.name} moves its follower by {answer.stroke:g} mm"


# -- command line ----------------------------------------------------------------------------------

EXAMPLE = "camgeo stroke toy.toml"
ARGUMENTS = (SCENE_FILE,)


def run(arguments):
    return show(stroke(opened(arguments)), arguments)
'''

STRATEGY = '''def stepped(builder, tolerance, effort):
    """As a slot; a strategy of its own would make other moves."""
    slot(builder, tolerance, effort)


'''

CUT = """        if self.spec.strategy == Roughing.STEPPED:
            made = rough_around(bench, wall, tool, self._top(wall), self.spec.allowance)
            return replace(made, strategy="stepped")
"""

LINES = {
    "scene/formats/format.py": [('    "gcode": "gcode:FORMAT",\n', '    "xyz": "xyz:FORMAT",\n')],
    "pictures/plots.py": [("    EFFECTS: ", '    "bare-lift": "bare_lift:figure",\n')],
    "app/cli/main.py": [('    "new": ', '    "stroke": "say how far the follower moves",\n')],
    "milling/strategies.py": [
        ("Strategy = Callable", STRATEGY),
        ('    "profile": profile,\n', '    "stepped": stepped,\n'),
    ],
    "milling/milling.py": [('    SPIRAL = "spiral"\n', '    STEPPED = "stepped"\n')],
    "milling/milling.json": [('"trochoidal",\n', '"stepped",\n')],
    "milling/stated.py": [("        if self.spec.strategy == Roughing.TROCHOIDAL:\n", CUT)],
}
"""What stands in a module of the copy before a line of it."""

SCENE = """camgeo = 1
name = "toy"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
[[motion]]
law = "polynomial-345"
span = 180
to = 12
[[motion]]
law = "polynomial-345"
span = 180
to = 0
[output]
formats = ["xyz"]
[output.xyz]
decimals = 3
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of both packages and of docs with the four toys."""
    tree = tmp_path_factory.mktemp("recipes")
    camgeo = copied(tree)
    shutil.copytree(ROOT / "export" / "camgeo_export", tree / "camgeo_export")
    shutil.copytree(ROOT / "docs", tree / "docs")
    (tree / "toy-1.0.dist-info").mkdir()
    for path, text in {
        "camgeo/scene/formats/xyz.py": FORMAT,
        "camgeo_export/xyz.py": WRITER,
        "toy-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n",
        "toy-1.0.dist-info/entry_points.txt": ENTRY_POINT,
        "camgeo/pictures/bare_lift.py": PLOT,
        "camgeo/app/answers/stroke.py": COMMAND,
        "toy.toml": SCENE,
    }.items():
        (tree / path).write_text(text, encoding="utf-8")
    for path, changes in LINES.items():
        replaced(camgeo / path, *((line, f"{new}{line}") for line, new in changes))
    return tree


def test_a_writer_is_a_format_an_object_and_an_entry_point(tree: Path) -> None:
    (built,) = commands(tree, ["build", "toy.toml", "-o", "out"])
    assert built[0] == 0, built[2]
    (file,) = json.loads((tree / "out" / "certificate.json").read_text("utf-8"))["files"]
    assert file["points"] == 360
    assert 1e-4 < file["deviation_mm"] <= 0.5e-3
    message = "output.xyz.decimals = 12: must be a whole number from 1 to 9"
    check_refused(tree, SCENE, [("decimals = 3", "decimals = 12", message)])


def test_a_milling_strategy_is_named_by_an_operation(tree: Path) -> None:
    shutil.copytree(MILLED / "tools", tree / "tools")
    scene = (MILLED / "steel_plate_cam.toml").read_text("utf-8")
    scene = scene.replace('kind = "rough"\n', 'kind = "rough"\nstrategy = "stepped"\n')
    (tree / "stepped.toml").write_text(scene, encoding="utf-8")
    built, sheet = commands(
        tree,
        ["build", "stepped.toml", "--only", "gcode", "-o", "milled"],
        ["setup", "stepped.toml"],
    )
    assert built[0] == 0, built[2]
    assert "rough outline" in sheet[1]


def test_a_plot_is_a_function_and_a_line(tree: Path) -> None:
    drawn, misspelt = commands(
        tree, ["plot", "toy.toml", "bare-lift", "-o", "lift.svg"], ["plot", "toy.toml", "bare-left"]
    )
    assert drawn[0] == 0, drawn[2]
    assert "<!-- bare lift -->" in (tree / "lift.svg").read_text("utf-8")
    assert 'did you mean "bare-lift"?' in misspelt[2]


def test_a_command_is_a_module_and_a_line(tree: Path) -> None:
    said, document, listed = commands(
        tree, ["stroke", "toy.toml"], ["stroke", "toy.toml", "--json"], ["--help"]
    )
    assert said[:2] == (0, "toy moves its follower by 12 mm\n")
    assert json.loads(document[1])["stroke_mm"] == pytest.approx(12.0, abs=1e-12)
    assert "say how far the follower moves" in listed[1]


def test_pages_are_made_with_them(tree: Path) -> None:
    check_page(tree, "scene", "## `[output.xyz]`")
    check_page(tree, "answers", "`stroke_mm`")
