"""All findings, remedies and sizes of designs that break every limit, as they are kept.

That values are right is proved elsewhere; here no field, place, sentence or verdict of any of them
changes unnoticed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

from camgeo.app.answers.size import size
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.scene.scene import load_scene
from tests.answers.documents import document as answered
from tests.kept import compare, document
from tests.thinned import WHOLE, share

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

Edits = dict[str, Any]


def moves(law: str) -> Edits:
    """Both moves of a scene by one law."""
    return {"motion[2].law": law, "motion[4].law": law}


FINDINGS: Final[tuple[tuple[str, Edits], ...]] = (
    ("scenes/plate_translating", {"limits.radius_ratio": 0.1, "limits.transmission_angle": 80}),
    ("scenes/plate_translating", {"follower.offset": 50, "follower.base_radius": 50}),
    ("scenes/plate_translating", {"follower.offset": -30, **moves("quadratic-parabola")}),
    ("scenes/plate_translating", {"follower.roller_radius": 60}),
    ("scenes/plate_translating", {"follower.roller_radius": 48, "follower.offset": 40}),
    ("scenes/plate_translating", {"cam.speed": 30, "limits.transmission_angle": None}),
    ("scenes/querhub", {"cam.speed": 30, "limits": None}),
    ("scenes/querhub", {"cam.speed": 30.001, "limits": None}),
    ("scenes/querhub", moves("straight-line")),
    ("scenes/querhub", {**moves("straight-line"), "limits.undercut": "trim"}),
    ("scenes/inch", {"follower.roller_radius": 1.9}),
    ("scenes/inch", {"follower.roller_radius": 1.9, "limits.undercut": "trim"}),
    ("scenes/ring", {"motion[2].to": 60, "follower.roller_radius": 30}),
    ("scenes/groove", {"follower.side_clearance": 1.5, "motion[2].to": 60}),
    ("scenes/groove", {"follower.side_clearance": 1.5, "motion[2].to": 35}),
    ("scenes/groove_clearance", {}),
    ("scenes/schnitt", {"follower.roller_radius": 32, "limits.radius_ratio": None}),
    ("scenes/schnitt", {"follower.roller_radius": 32, "limits.undercut": "trim"}),
    ("scenes/straight_moves", {"limits.undercut": None}),
    ("scenes/knife_edge", {}),
    ("scenes/measured", {}),
    ("scenes/points", {"follower.base_radius": 22}),
    ("scenes/tappet", {"follower.base_radius": 9, "limits.undercut": "trim"}),
    ("scenes/tappet", {"follower.base_radius": 9}),
    ("scenes/tappet", {"follower.direction": "inward", "follower.base_radius": 12}),
    ("scenes/tappet", moves("straight-line")),
    ("scenes/flat_rocker", {"follower.face": [75, 84], "limits.transmission_angle": 89}),
    ("scenes/flat_rocker", {"follower.base_radius": 15, "follower.face_offset": -6}),
    ("scenes/flat_rocker", {"motion[2].span": 10, "motion[2].to": 40}),
    ("scenes/flat_rocker", {"follower.base_radius": 80, "motion[2].to": 40}),
    ("scenes/constant_breadth", {"follower.yoke.breadth": 65.5}),
    ("scenes/constant_breadth", moves("modified-sine") | {"motion[2].span": 120,
                                                          "motion[1].dwell": 60}),
    ("scenes/conjugate_lever", {"limits.closing_error": 0.001}),
    ("scenes/conjugate_lever", {"follower.return.arm_angle": 20}),
    ("scenes/conjugate_lever", {"follower.return.arm_angle": -20}),
    ("scenes/conjugate_carriage", {"follower.return.roller_radius": 60}),
    ("scenes/setzhub", {"linkage.branch": "cw", "follower.direction": None}),
    ("scenes/setzhub", {"limits.linkage_transmission_angle": 60, "limits.transmission_angle": 60}),
    ("scenes/setzhub", {"cam.speed": 20, "limits": None}),
    ("scenes/four_bar", {"motion[2].to": 60}),
    ("scenes/four_bar", {"motion[2].to": -48}),
    ("scenes/crank_slider", {"cam.speed": None}),
    ("refused/drop", {}),
    ("refused/drop", {"limits.undercut": "trim"}),
    ("refused/global_undercut", {}),
    ("refused/global_undercut", {"limits.undercut": "trim"}),
    ("refused/undercut_tappet", {}),
    ("found/dead_centre", {}),
    ("found/driven_crank_dead", {}),
    ("found/near_dead_centre", {}),
)  # fmt: skip
"""Without what concerns the motion alone, and joints that close: their gaps are rounding."""

MOTIONS: Final[tuple[tuple[str, Edits], ...]] = (
    ("scenes/plate_translating", {"motion[2].inflection": 0.45}),
    ("scenes/querhub", moves("straight-line")),
    ("scenes/plate_translating", {**moves("quadratic-parabola"), "motion[2].inflection": 0.4}),
    ("scenes/four_bar", {"motion[2].to": 20, "motion[2].inflection": 0.6}),
    ("scenes/flat_rocker", {"motion[4].inflection": 0.6}),
    ("scenes/measured", {}),
    ("scenes/points", {}),
)
"""With laws whose extremes differ up and down: of equal ones rounding decides which is named."""

REMEDIES: Final[tuple[tuple[str, Edits], ...]] = (
    ("refused/global_undercut", {}),
    ("refused/return_undercut", {}),
    ("refused/return_undercut", {"follower.roller_radius": 58}),
    ("refused/undercut_tappet", {}),
    ("scenes/inch", {"follower.roller_radius": 1.9}),
    ("scenes/schnitt", {"follower.roller_radius": 40}),
    ("scenes/groove", {"follower.side_clearance": 1.5, "motion[2].to": 60}),
    ("scenes/tappet", {"follower.direction": "inward", "follower.base_radius": 12}),
    (
        "scenes/plate_translating",
        {
            "motion[2].span": 60,
            "motion[1].dwell": 70,
            "follower.base_radius": 30,
            "follower.roller_radius": 18,
        },
    ),
)

SIZES: Final[tuple[tuple[str, Edits, dict[str, Any]], ...]] = (
    ("scenes/plate_translating", {}, {}),
    ("scenes/plate_translating", {"follower.direction": "inward"}, {"radius_ratio": 0.3}),
    ("scenes/inch", {}, {"transmission_angle": 0.6, "radius_ratio": 0.9}),
    ("scenes/ring", {}, {}),
    ("scenes/groove_clearance", {}, {"radius_ratio": 1.0}),
    ("scenes/knife_edge", {}, {}),
    ("scenes/measured", {}, {}),
    ("scenes/straight_moves", {}, {}),
    ("scenes/constant_breadth", {}, {"radius_of_curvature": 3.0}),
    ("scenes/tappet", {}, {}),
    ("scenes/conjugate_carriage", {}, {}),
    ("scenes/crank_slider", {}, {}),
    (
        "scenes/flat_rocker",
        {"cam.rotation": "ccw"},
        {"radius_of_curvature": 5.0, "transmission_angle": 1.1},
    ),
    ("scenes/flat_rocker", {}, {"transmission_angle": 1.5}),
    ("scenes/four_bar", {}, {}),
    ("scenes/querhub", {}, {"transmission_angle": 1.5}),
    ("scenes/vorschub", {}, {}),
    ("found/dead_centre", {}, {}),
)


def designs(every: Sequence[tuple[str, Edits]]) -> Iterator[tuple[str, Design | CamgeoError]]:
    for name, edits in every:
        head = f"{name} {edits or ''}".rstrip()
        try:
            scene = load_scene(FIXTURES / f"{name}.toml")
            yield head, Design(scene.with_values(edits) if edits else scene)
        except CamgeoError as error:
            yield head, error


def place(angle: float | None) -> str:
    """A cam angle [rad] as it is kept: an extreme is flat, its place has half the digits."""
    return "-" if angle is None else f"{angle:.7f}"


def told(findings: Iterable[Finding]) -> list[str]:
    return [
        f"{each.severity} {each.name}: {document([each.value, each.limit])} {each.unit}, at"
        f" {place(each.cam_angle)}, {[*map(place, each.cam_range or ())]}: {each.sentence}"
        for each in findings
    ]


def findings_of(design: Design | CamgeoError) -> str:
    if isinstance(design, CamgeoError):
        return str(design)
    judged = design.judgement
    moving = judged.by_check["motion"]
    lines = told(
        each
        for each in design.findings
        if each not in moving and not (each.severity == "ok" and "closure" in each.name)
    )
    try:
        judged.require_outline(design.cam)
    except CamgeoError as error:
        lines.append(f"refused: {error}")
    return "\n".join(lines)


def remedies_of(design: Design | CamgeoError) -> str:
    assert isinstance(design, Design)
    return "\n".join(
        f"{each.knob}: {each.key} {each.old_value} -> {each.new_value} {each.unit}, cost"
        f" {document([each.cost, each.limit])}, also {[*map(str, each.also)]}: {each.sentence}"
        for each in design.judgement.cures
    )


def test_findings_are_as_kept() -> None:
    compare("check/findings.txt", ((head, findings_of(each)) for head, each in designs(FINDINGS)))


def test_findings_on_motions_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for head, design in designs(MOTIONS):
            assert isinstance(design, Design)
            yield head, "\n".join(told(design.judgement.by_check["motion"]))

    compare("check/motions.txt", parts())


def test_remedies_are_as_kept() -> None:
    parts = ((head, remedies_of(each)) for head, each in designs(share(REMEDIES, 4)))
    compare("check/remedies.txt", parts, whole=WHOLE)


def test_sizes_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name, edits, asked in share(SIZES, 3):
            ((head, design),) = designs(((name, edits),))
            assert isinstance(design, Design)
            found = answered(size(design, **asked))
            del found["scene"]
            yield f"{head} {asked or ''}".rstrip(), document(found)

    compare("check/sizes.txt", parts(), whole=WHOLE)
