"""Runs inside FreeCAD: reads the file that CAMGEO_JUDGED names and prints what it is, as JSON."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

MODULES = Path("/usr/lib/freecad-python3/lib")
"""Where Debian has FreeCAD's modules; folders of the same names would be found before them."""

if MODULES.is_dir():
    sys.path.insert(0, str(MODULES))


def drawing(path: str) -> dict[str, Any]:
    """Size of all curves of a DXF file [mm]."""
    import FreeCAD  # type: ignore[import-not-found]  # only there inside FreeCAD
    import Import  # type: ignore[import-not-found]  # only there inside FreeCAD
    import Part  # type: ignore[import-not-found]  # only there inside FreeCAD

    FreeCAD.newDocument("judged")
    Import.readDXF(path, "judged")
    shapes = [getattr(each, "Shape", None) for each in FreeCAD.getDocument("judged").Objects]
    edges = [edge for shape in shapes if shape is not None for edge in shape.Edges]
    if not edges:
        return {"error": "it has no curves"}
    box = Part.Compound(edges).optimalBoundingBox()
    return {"size": [box.XLength, box.YLength]}


def solid(path: str) -> dict[str, Any]:
    """Whether the body of an STL file is closed, and its volume."""
    import Mesh  # type: ignore[import-not-found]  # only there inside FreeCAD

    mesh = Mesh.Mesh(path)
    closed = mesh.isSolid() and not mesh.hasNonManifolds() and mesh.countComponents() == 1
    turned = mesh.countNonUniformOrientedFacets()
    return {"solid": bool(closed and not turned), "volume": mesh.Volume}


def shape(path: str) -> dict[str, Any]:
    """Whether a STEP file is one valid solid, its faces and its volume."""
    import Part  # only there inside FreeCAD

    read = Part.Shape()
    read.read(path)
    read.check(True)  # raises where isValid, which looks less closely, may not
    one = read.ShapeType == "Solid" and len(read.Solids) == 1 and read.isValid()
    told = {"solid": bool(one), "volume": read.Volume, "faces": len(read.Faces)}
    again = os.environ.get("CAMGEO_EXPORTED")
    if again:
        read.removeSplitter().exportStep(again)  # it spoils what it is made of
    return told


READERS = {".dxf": drawing, ".stl": solid, ".step": shape}


def main(path: str) -> None:
    """Print the line that tests/judges/cad.py reads."""
    try:
        told = READERS[Path(path).suffix](path)
    except Exception as error:  # whatever it raises is what it says of the file
        told = {"error": f"{type(error).__name__}: {error}"}
    sys.stdout.write(f"\ncamgeo: {json.dumps(told)}\n")  # behind what it says of its progress
    sys.stdout.flush()


main(os.environ["CAMGEO_JUDGED"])
