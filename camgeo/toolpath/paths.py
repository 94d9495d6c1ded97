"""Exact cutter paths: which parallel of the pitch curve the cutter's centre runs on."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.contour.contour import Contour
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.part.part import Part
from camgeo.part.spec import Contact, PartSpec


@dataclass(frozen=True, slots=True)
class CutterPath:
    """The closed path of the cutter's centre for one operation.

    Attributes
    ----------
    name : of the operation.
    curve : the exact path, or None if it is `circle`.
    circle : the exact path of a bore.
    free_side : +1 if the lead-in comes from outside of the path (away from the cam axis), -1 from
        inside, 0 if the cutter fills the groove and plunges on the path itself.
    room : largest radius of the arcs that lead onto the path [mm].
    depth : to which is cut [mm], positive.
    note : what the person at the machine should know, or empty.
    """

    name: str
    curve: WorkingCurve | None
    circle: Contour | None
    free_side: int
    room: float
    depth: float
    note: str = ""


def cutter_paths(
    contact: Contact, pitch: PitchCurve, part: Part, spec: PartSpec, tool_radius: float
) -> tuple[CutterPath, ...]:
    """The operations of a part, the bore first: it is cut while the blank is whole.

    Raises
    ------
    GeometryError
        With the key of the scene, if the cutter does not fit or the thickness is missing.
    """
    if part.thickness is None:
        raise GeometryError("milling needs the thickness of the part", key="part.thickness")
    roller = pitch.follower.roller_radius
    paths: list[CutterPath] = []
    if spec.bore is not None and contact != "outer":
        radius = spec.bore / 2.0 - tool_radius
        if radius <= 0.0:
            raise GeometryError(
                f"the cutter must be smaller than the bore, {spec.bore:g} mm",
                key="output.gcode.tool_diameter",
                value=f"{2.0 * tool_radius:g}",
            )
        circle = Contour.circle(radius)
        note = "the keyway is left to be broached" if spec.keyway is not None else ""
        paths.append(CutterPath("bore", None, circle, -1, radius / 2.0, part.thickness, note))
    if contact == "inner":
        curve = WorkingCurve(pitch, tool_radius - roller)
        paths.append(CutterPath("outline", curve, None, 1, tool_radius, part.thickness))
    elif contact == "outer":
        curve = WorkingCurve(pitch, roller - tool_radius)
        paths.append(CutterPath("outline", curve, None, -1, tool_radius, part.thickness))
    else:
        paths += _groove_paths(pitch, roller, tool_radius, part.groove_depth)
    return tuple(paths)


def _groove_paths(
    pitch: PitchCurve, roller: float, tool_radius: float, depth: float
) -> list[CutterPath]:
    side = roller - tool_radius
    if side < 0.0 or 2.0 * tool_radius < roller:
        raise GeometryError(
            "the cutter of a groove must not be larger than the roller, and at least half as large,"
            f" so that two rounds clear it: from {roller:g} to {2.0 * roller:g} mm",
            key="output.gcode.tool_diameter",
            value=f"{2.0 * tool_radius:g}",
        )
    if side == 0.0:
        return [CutterPath("groove", WorkingCurve(pitch, 0.0), None, 0, 0.0, depth)]
    return [
        CutterPath("outer flank", WorkingCurve(pitch, side), None, -1, side / 2.0, depth),
        CutterPath("inner flank", WorkingCurve(pitch, -side), None, 1, side / 2.0, depth),
    ]
