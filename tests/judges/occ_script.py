"""Runs in a Python that has OCP, the bindings of OpenCASCADE: reads STEP files whose names it gets,
and prints what each is, as a line of JSON."""

from __future__ import annotations

import json
import sys
from typing import Any


def told(path: str) -> dict[str, Any]:
    """Solids, faces, whether the shape is valid, and its volume [mm^3]."""
    from OCP.BRepCheck import (  # type: ignore[import-not-found]  # only there in that Python
        BRepCheck_Analyzer,
    )
    from OCP.BRepGProp import BRepGProp  # type: ignore[import-not-found]  # only there
    from OCP.GProp import GProp_GProps  # type: ignore[import-not-found]  # only there
    from OCP.IFSelect import IFSelect_RetDone  # type: ignore[import-not-found]  # only there
    from OCP.STEPControl import STEPControl_Reader  # type: ignore[import-not-found]  # only there
    from OCP.TopAbs import (  # type: ignore[import-not-found]  # only there
        TopAbs_FACE,
        TopAbs_SHELL,
        TopAbs_SOLID,
    )
    from OCP.TopExp import TopExp_Explorer  # type: ignore[import-not-found]  # only there

    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return {"error": "it is not read"}
    reader.TransferRoots()
    shape = reader.OneShape()

    def count(kind: Any) -> int:
        explorer, number = TopExp_Explorer(shape, kind), 0
        while explorer.More():
            number += 1
            explorer.Next()
        return number

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return {
        "solids": count(TopAbs_SOLID),
        "shells": count(TopAbs_SHELL),
        "faces": count(TopAbs_FACE),
        "valid": bool(BRepCheck_Analyzer(shape, True).IsValid()),
        "volume": properties.Mass(),
    }


for name in sys.argv[1:]:
    try:
        answer = told(name)
    except Exception as error:  # whatever it raises is what it says of the file
        answer = {"error": f"{type(error).__name__}: {error}"}
    sys.stdout.write(f"\ncamgeo: {json.dumps(answer)}\n")  # behind what it says of its progress
