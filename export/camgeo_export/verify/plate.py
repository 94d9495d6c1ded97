"""The bodies of a plate, each compared with what it should be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from xml.etree import ElementTree as ET

from camgeo.product.plate import Piece
from camgeo.verifying.verification import Check, failed
from camgeo_export.threemf.parts import packed
from camgeo_export.threemf.writer import CORE, MODEL_PATH
from camgeo_export.verify.body import checks_of_body, mesh_in


def plate_checks(
    plate: Sequence[Piece],
    parts: Mapping[str, bytes],
    model: bytes,
    scale: float,
    tolerance: float,
) -> list[Check]:
    """All checks of the bodies in a package, each as if it were the only one, and not moved.

    Parameters
    ----------
    plate : what the package should hold.
    parts : of the package.
    model : that which it leads to; `scale` [mm] is its unit.
    tolerance : [mm].
    """
    count = len(ET.fromstring(model).findall(f"{{{CORE}}}resources/{{{CORE}}}object"))
    if count != len(plate):
        return [failed("bodies", f"{count}, expected {len(plate)}")]
    checks: list[Check] = []
    for number, piece in enumerate(plate):
        alone = packed({f"/{MODEL_PATH}": _alone(model, number), **parts})
        checks += [
            replace(each, of=f"{piece.name}: {each.of}" if each.of else piece.name)
            for each in _checks(piece, alone, scale, tolerance)
        ]
    return checks


def _checks(piece: Piece, data: bytes, scale: float, tolerance: float) -> list[Check]:
    mesh = mesh_in(data, scale)
    if isinstance(mesh, Check):
        return [mesh]
    return checks_of_body(piece.part, piece.reach, *mesh, tolerance)


def _alone(model: bytes, number: int) -> bytes:
    """The model with one of its objects only, not transformed."""
    root = ET.fromstring(model)
    resources = root.find(f"{{{CORE}}}resources")
    build = root.find(f"{{{CORE}}}build")
    assert resources is not None  # it has objects
    kept = resources.findall(f"{{{CORE}}}object")[number]
    for each in resources.findall(f"{{{CORE}}}object"):
        if each is not kept:
            resources.remove(each)
    if build is not None:
        root.remove(build)
    own = ET.SubElement(root, f"{{{CORE}}}build")
    ET.SubElement(own, f"{{{CORE}}}item", {"objectid": kept.get("id", "")})
    found: bytes = ET.tostring(root, "UTF-8", xml_declaration=True)
    return found
