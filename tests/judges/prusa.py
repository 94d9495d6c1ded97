"""PrusaSlicer reads bodies: closed, of one part, of the volume that we wrote; and slices them
without a warning, with perimeters that run along the exact part at half their width."""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np
import shapely

from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Layer
from tests.judges.files import TOLERANCE, Given
from tests.judges.programs_of_others import Program, Refusal

SLICER: Final = Program("CAMGEO_PRUSA_SLICER", "prusa-slicer", "PrusaSlicer")

REPAIRS: Final = (
    "open_edges", "facets_reversed", "backwards_edges", "degenerate_facets", "facets_removed",
    "edges_fixed",
)  # fmt: skip
"""What it says if it had to mend a body."""


def judge(given: Given) -> float:
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

STEP: Final = 0.25
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
        points = shapely.get_coordinates(shapely.segmentize(shapely.LinearRing(_rows(wall)), STEP))
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
