"""Programs that read drawings and solids: FreeCAD, OpenCASCADE, LibreCAD, PrusaSlicer, lib3mf."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import zlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
import shapely

from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Layer
from tests.judges.files import TOLERANCE, Given
from tests.judges.programs_of_others import Program, Refusal, answer

# FreeCAD imports drawings, bodies and solids: of our size, closed, and of our volume --------------


FREECAD: Final = Program("CAMGEO_FREECAD", "freecadcmd", "FreeCADCmd", "freecad.cmd")

FREECAD_SCRIPT: Final = Path(__file__).with_name("freecad_script.py")

SIZE = 0.02
"""How far a size may be from ours [mm]."""


def judged_by_freecad(given: Given, exported: Path | None = None) -> float:
    """The difference of size [mm] or of volume, relative; Refusal if it finds fault.

    A solid is written again as a STEP file into `exported`, each cylinder as one face.
    """
    again = {} if exported is None else {"CAMGEO_EXPORTED": str(exported)}
    path = given.path
    said = FREECAD.run([str(FREECAD_SCRIPT)], path.parent, CAMGEO_JUDGED=str(path), **again)
    read = answer(said, path)
    if "size" in read:
        apart: float = max(abs(a - b) for a, b in zip(read["size"], given.size, strict=True))
        if apart > SIZE:
            raise Refusal(f"{path.name} is {read['size']} mm large, not {given.size}")
        return apart
    if not read["solid"]:
        raise Refusal(f"{path.name} is not one closed body: {read}")
    return given.compare(read["volume"], read.get("faces", 0))


# OpenCASCADE itself reads solids: one valid solid, of our faces and our volume --------------------


OCC: Final = Program("CAMGEO_OCC", what="Python that has OCP")

OCC_SCRIPT: Final = Path(__file__).with_name("occ_script.py")


def occ_missing() -> str:
    """Why it cannot judge here; empty if it can."""
    if absent := OCC.absent():
        return absent
    has = subprocess.run([OCC.path, "-c", "import OCP"], capture_output=True, check=False)
    return f"{OCC.path} has no OCP" if has.returncode else ""


def judged_by_occ(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    read = answer(OCC.run([str(OCC_SCRIPT), str(given.path)], given.path.parent), given.path)
    if (read["solids"], read["shells"], read["valid"]) != (1, 1, True):
        raise Refusal(f"{given.path.name} is not one valid solid: {read}")
    return given.compare(read["volume"], read["faces"])


# LibreCAD draws drawings as PDF at 1:1; its paper has dots of 1/1200 inch, so this judges what it
# reads and in which unit, not how closely


LIBRECAD: Final = Program("CAMGEO_LIBRECAD", "librecad")

POINT: Final = 25.4 / 72.0
"""Of a PDF [mm]."""

DOTS: Final = 0.1
"""What a size may differ by [mm]: ends are rounded to dots of 0.02 mm, arcs are drawn as chords."""


def judged_by_librecad(given: Given) -> float:
    """The largest difference of width and height [mm]; Refusal if it is too large."""
    with TemporaryDirectory() as name:
        words = ["dxf2pdf", "-c", "-s", "1", "-t", name, str(given.path)]
        said = LIBRECAD.run(words, Path(name))
        paper = Path(name, f"{given.path.stem}.pdf")
        if not paper.is_file():
            raise Refusal(f"{given.path.name} is not drawn: {said[-300:].strip()}")
        size = stroked(paper.read_bytes())
    apart = max(abs(size[0] - given.size[0]), abs(size[1] - given.size[1]))
    if apart > DOTS:
        raise Refusal(f"{given.path.name} is drawn {size} mm large, not {given.size}")
    return apart


def stroked(paper: bytes) -> tuple[float, float]:
    """Width and height of all that is stroked on the first page of its PDF [mm]."""
    stream = re.search(rb"stream\r?\n(.*?)endstream", paper, re.DOTALL)
    if stream is None:
        raise Refusal("its PDF is not read")
    scale = POINT
    xs: list[float] = []
    ys: list[float] = []
    path: list[float] = []
    for line in zlib.decompress(stream[1]).decode("ascii", "replace").splitlines():
        *numbers, word = line.split() or [""]
        if word == "cm":
            scale *= abs(float(numbers[0]))
        elif word in ("m", "l", "c"):
            path += map(float, numbers)
        elif word == "S":
            xs += path[::2]
            ys += path[1::2]
            path = []
        elif word in ("n", "f", "f*", "B", "W*"):
            path = []
    if not xs:
        raise Refusal("nothing is drawn")
    return scale * (max(xs) - min(xs)), scale * (max(ys) - min(ys))


# PrusaSlicer reads bodies, of one part and our volume; and slices them without a warning, with
# perimeters that run along the exact part at half their width


SLICER: Final = Program("CAMGEO_PRUSA_SLICER", "prusa-slicer", "PrusaSlicer")

REPAIRS: Final = (
    "open_edges", "facets_reversed", "backwards_edges", "degenerate_facets", "facets_removed",
    "edges_fixed",
)  # fmt: skip
"""What it says if it had to mend a body."""


def judged_by_slicer(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    said = SLICER.run(["--info", str(given.path)], given.path.parent)
    values = dict(re.findall(r"^(\w+) = +(\S+)$", said, re.MULTILINE))
    if values.get("manifold") != "yes" or values.get("number_of_parts") != "1":
        raise Refusal(f"{given.path.name} is not one closed body: {said[-300:].strip()}")
    mended = [each for each in REPAIRS if int(values.get(each, 0))]
    if mended:
        raise Refusal(f"{given.path.name}: {', '.join(mended)}")
    return given.compare(float(values["volume"]))


WIDTH: Final = 1.0
"""Of the extrusion [mm]: a perimeter runs at half of it from the wall."""

OPTIONS: Final = {
    "dont-arrange": "", "bed-shape": "-400x-400,400x-400,400x400,-400x400",
    "max-print-height": "400", "nozzle-diameter": "1", "layer-height": "0.8",
    "first-layer-height": "0.8", "perimeters": "1", "fill-density": "0", "top-solid-layers": "0",
    "bottom-solid-layers": "0", "skirts": "0", "elefant-foot-compensation": "0", "resolution": "0",
    "gcode-resolution": "0.001", "slice-closing-radius": "0", "perimeter-generator": "classic",
    "extrusion-width": "1", "first-layer-extrusion-width": "1", "start-gcode": "",
    "external-perimeter-extrusion-width": "1", "perimeter-extrusion-width": "1", "end-gcode": "",
    "use-relative-e-distances": "",
}  # fmt: skip
"""One perimeter and nothing else, where the part is, and nothing compensated or simplified."""

RESOLUTION: Final = 0.005
"""Three decimals of its coordinates, on both ends, and what it simplifies [mm]."""

FINE: Final = 1e-4
"""Tolerance of the contours with which perimeters are compared [mm]."""

APART: Final = 0.25
"""Between points of a wall [mm]."""

SHARP: Final = 0.3
"""Turn of a corner [rad]; about it a perimeter is farther off."""

SAID: Final = re.compile(r"warn|error|repair|empty|unable|outside", re.IGNORECASE)

MOVE: Final = re.compile(r"^G1 X(\S+) Y(\S+)(?: E(\S+))?", re.MULTILINE)


def slice_(given: Given) -> float:
    """How far perimeters are from where they should be [mm]; Refusal if it finds fault."""
    target = given.path.with_name(f"{given.path.name}.gcode")
    options = [each for key, value in OPTIONS.items() for each in _option(key, value)]
    words = ["--export-gcode", *options, "--output", str(target), str(given.path)]
    said = SLICER.run(words, given.path.parent)
    if told := [line for line in said.splitlines() if SAID.search(line)]:
        raise Refusal(f"{given.path.name}: {told[0]}")
    assert given.part is not None
    sliced = perimeters(target.read_text("utf-8"))
    low, worst = given.part.layers[0].z0, 0.0
    for layer in given.part.layers:
        there = [z for z in sliced if layer.z0 < z + low < layer.z1]
        if not there and layer.z1 - layer.z0 > float(OPTIONS["layer-height"]):
            raise Refusal(f"{given.path.name}: there is no layer in the {layer.name}")
        if there:
            worst = max(worst, _apart(layer, sliced[there[len(there) // 2]], given.path.name))
    return worst


def _option(key: str, value: str) -> list[str]:
    """Its words; a shape begins with a dash, and would be taken for an option."""
    flags = ("dont-arrange", "use-relative-e-distances")
    return [f"--{key}"] if key in flags else [f"--{key}={value}"]


def perimeters(text: str) -> dict[float, list[ComplexArray]]:
    """The loops of each layer [mm], by the height at which it was cut."""
    found: dict[float, list[ComplexArray]] = {}
    for part in text.split(";LAYER_CHANGE\n")[1:]:
        top, height = (float(word) for word in re.findall(r"^;(?:Z|HEIGHT):(\S+)$", part, re.M)[:2])
        loops: list[list[complex]] = [[]]
        for x, y, pushed in MOVE.findall(part):
            if not pushed:
                loops.append([])
            loops[-1].append(complex(float(x), float(y)))
        found[top - 0.5 * height] = [np.array(loop) for loop in loops if len(loop) > 1]
    return found


def _apart(layer: Layer, loops: list[ComplexArray], name: str) -> float:
    """The largest distance of a perimeter from where it should be [mm]."""
    if len(loops) != len(layer.boundaries):
        raise Refusal(f"{name}: {len(loops)} perimeters in the {layer.name}")
    walls = [each.polyline(FINE).contour.vertices for each in layer.boundaries]
    material: Any = shapely.Polygon()
    for wall in walls:
        material = material.symmetric_difference(shapely.Polygon(_rows(wall)))
    path = shapely.MultiLineString([_rows(np.append(loop, loop[0])) for loop in loops])
    on_path = shapely.points(shapely.get_coordinates(path))
    if not bool(np.all(shapely.contains(material, on_path))):
        raise Refusal(f"{name}: a perimeter runs outside the {layer.name}")
    near = shapely.distance(material.boundary, on_path)
    worst = float(np.max(0.5 * WIDTH - near))
    for wall in walls:
        points = shapely.get_coordinates(shapely.segmentize(shapely.LinearRing(_rows(wall)), APART))
        turns = np.angle((np.roll(wall, -1) - wall) / (wall - np.roll(wall, 1)))
        corners = wall[np.abs(turns) > SHARP]
        smooth = points[:, 0] + 1j * points[:, 1]
        for corner in corners:
            smooth = smooth[np.abs(smooth - corner) > WIDTH]
        if len(smooth):
            far = shapely.distance(path, shapely.points(_rows(smooth)))
            worst = max(worst, float(np.max(far)) - 0.5 * WIDTH)
    if worst > TOLERANCE + RESOLUTION:
        raise Refusal(f"{name}: a perimeter of the {layer.name} is {worst:.3g} mm off")
    return max(worst, 0.0)


def _rows(points: ComplexArray) -> Any:
    return np.column_stack((points.real, points.imag))


# lib3mf, the reference reader of the 3MF Consortium, reads bodies without a warning ---------------


NEAR: Final = 1e-6
"""Relative difference of volumes: coordinates have as many decimals as the tolerance needs."""


def lib3mf_missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return "" if importlib.util.find_spec("lib3mf") else "lib3mf is not installed"


def judged_by_lib3mf(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    import lib3mf  # type: ignore[import-untyped]  # it has no types

    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(given.path))
    said = [reader.GetWarning(number)[1] for number in range(reader.GetWarningCount())]
    meshes = model.GetMeshObjects()
    if said or meshes.Count() != 1:
        raise Refusal(f"{given.path.name}: {meshes.Count()} bodies, {said}")
    meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    if not (mesh.IsValid() and mesh.IsManifoldAndOriented()):
        raise Refusal(f"{given.path.name} is not closed and oriented")
    scale = {lib3mf.ModelUnit.MilliMeter: 1.0, lib3mf.ModelUnit.Inch: 25.4}[model.GetUnit()]
    points = np.array([tuple(point.Coordinates) for point in mesh.GetVertices()])
    corners = points[[tuple(triangle.Indices) for triangle in mesh.GetTriangleIndices()]]
    six = float(np.sum(np.linalg.det(corners)))
    return given.compare(six / 6.0 * scale**3, near=NEAR)
