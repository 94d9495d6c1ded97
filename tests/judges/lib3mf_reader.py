"""lib3mf, the reference reader of the 3MF Consortium, reads bodies without a warning."""

from __future__ import annotations

import importlib.util
from typing import Final

import numpy as np

from tests.judges.files import Given
from tests.judges.programs_of_others import Refusal

NEAR: Final = 1e-6
"""Relative difference of volumes: coordinates have as many decimals as the tolerance needs."""


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return "" if importlib.util.find_spec("lib3mf") else "lib3mf is not installed"


def judge(given: Given) -> float:
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
