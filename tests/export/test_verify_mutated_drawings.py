"""Every group in the entities of our drawings is changed in turn, and verify reports it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.scene.formats.dxf import DxfSpec
from camgeo_export.dxf.writer import WRITER
from camgeo_export.verify.dxf import VERIFIER
from tests.export import verified
from tests.export.stub_product import StubProduct
from tests.export.verified import TOLERANCE, checked

ADDED = {
    6: "DASHED", 38: "5.0", 39: "5.0", 40: "0.5", 41: "0.5", 43: "0.5", 48: "2.0", 60: "1",
    62: "1", 67: "1", 210: "0.5", 220: "0.5", 230: "-1.0", 330: "99", 370: "100", 420: "255",
}  # fmt: skip
"""Groups that our polylines do not have: line type, elevation, thickness, widths, scale of the line
type, invisibility, colour, paper space, extrusion, a further owner, line weight, true colour."""

TEXTS = (0, 5, 6, 8, 100, 330)
"""Groups whose values are texts."""

CHECKED_HEADER = {"$ACADVER", "$INSBASE", "$INSUNITS", "$MEASUREMENT", "$TILEMODE"}
"""Header variables that say what the drawing is. All others set how a program shows and edits it;
no coordinate of an entity depends on them."""

CHECKED_LAYER = {2, 6, 62, 70}
"""Groups in the record of a layer that say whether it is seen: name, line type, colour (negative if
it is off), flags. The others are handles, line weight and references to plot styles and materials,
none of which moves a line."""


@cache
def product(entity: str) -> Product:
    if entity == "arcs":
        return StubProduct(dxf=DxfSpec("arcs"))
    scene = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"
    return camgeo.loads(f'{scene.read_text("utf-8")}\n[output.dxf]\nentity = "{entity}"\n').disc


@cache
def drawing(entity: str) -> tuple[str, ...]:
    text = WRITER.write(product(entity), TOLERANCE).data.decode()
    return tuple(text.split("\n"))


def faults(entity: str, lines: Sequence[str]) -> list[Check]:
    return verified.faults(VERIFIER, product(entity), "\n".join(lines).encode())


def with_line(lines: Sequence[str], place: int, line: str) -> list[str]:
    """The lines with another one at `place`."""
    return [*lines[:place], line, *lines[place + 1 :]]


def groups(entity: str, section: str) -> Iterator[tuple[int, str, str]]:
    """Index of the value, kind of the record and group code, of all tags of a section."""
    lines = drawing(entity)
    k, kind = lines.index(section) + 1, ""
    while (lines[k].strip(), lines[k + 1].strip()) != ("0", "ENDSEC"):
        code = lines[k].strip()
        kind = lines[k + 1].strip() if code in ("0", "9") else kind
        yield k + 1, kind, code
        k += 2


def changed(code: str, value: str) -> str:
    """Another value of the group."""
    if int(code) in TEXTS or not value.strip().replace("-", "").replace(".", "").isdigit():
        return f"{value.strip()}1"
    return repr(float(value) + 1.0) if "." in value else f"{int(value) + 1}"


def test_good_drawings_pass() -> None:
    for entity in ("arcs", "spline"):
        assert not faults(entity, drawing(entity))


HARMLESS = {("changed", "5"), ("left out", "30"), ("left out", "31")}
"""Another handle that no entity has; heights, which are 0 when left out."""


def test_each_group_of_each_kind_of_entity() -> None:
    """Each is changed, and each is left out."""
    lines = drawing("arcs")
    first: dict[tuple[str, str, str], int] = {}
    layer = ""
    for k, kind, code in groups("arcs", "ENTITIES"):
        layer = lines[k].strip() if code == "8" else layer
        first.setdefault((kind, code, layer if code in ("10", "42") else ""), k)
    unseen = set()
    for (_, code, _), k in first.items():
        other = with_line(lines, k, changed(code, lines[k]))
        shorter = [*lines[: k - 1], *lines[k + 1 :]]
        for what, given in (("changed", other), ("left out", shorter)):
            if not faults("arcs", given):
                unseen.add((what, code))
    assert unseen == HARMLESS


@pytest.mark.parametrize("code", ["8", "10", "20", "30", "40", "70", "71", "72", "73", "74", "100"])
def test_each_group_of_a_spline(code: str) -> None:
    lines = drawing("spline")
    at = groups("spline", "ENTITIES")
    place = next(k for k, kind, group in at if (kind, group) == ("SPLINE", code))
    assert faults("spline", with_line(lines, place, changed(code, lines[place])))


@pytest.mark.parametrize("code", ADDED)
def test_groups_that_a_polyline_should_not_have(code: int) -> None:
    lines = drawing("arcs")
    start = next(k for k, kind, _ in groups("arcs", "ENTITIES") if kind == "LWPOLYLINE")
    place = lines.index("AcDbPolyline", start) + 1
    found = faults("arcs", [*lines[:place], f"{code:>3}", ADDED[code], *lines[place:]])
    assert found
    flat = {38: "elevation", 39: "thickness", 40: "width", 41: "width", 43: "width"}
    if code in flat:
        failed = {check.name: check for check in found}
        assert failed[flat[code]].value == float(ADDED[code])
        assert "LWPOLYLINE on layer CUT" in failed[flat[code]].note
        assert f"LWPOLYLINE has the group {code}" in failed["contents"].note
    else:
        assert any(f"group {code}" in check.note for check in found) or code == 67


@pytest.mark.parametrize(("code", "name"), [(38, "elevation"), (39, "thickness"), (43, "width")])
def test_foreign_drawings_lie_flat_too(code: int, name: str) -> None:
    """Within the tolerance; their other groups do not matter."""
    lines = drawing("arcs")
    place = lines.index("AcDbPolyline") + 1
    for value, expected in (("0.5", {name}), ("0.005", set())):
        other = [*lines[:place], f"{code:>3}", value, " 62", "1", *lines[place:]]
        foreign = Reading("a.dxf", ours=False)
        checks = checked(VERIFIER, product("arcs"), "\n".join(other).encode(), foreign)
        assert {name for (name, _), check in checks.items() if check.ok is False} == expected


def test_the_header() -> None:
    """Units, version and space are checked; the rest is how a program shows the drawing."""
    lines = drawing("arcs")
    seen, everything = set(), set()
    for k, kind, code in groups("arcs", "HEADER"):
        if code == "9":
            everything.add(kind)
        elif kind in CHECKED_HEADER or len(everything) % 20 == 0:  # a sample of the others
            found = faults("arcs", with_line(lines, k, changed(code, lines[k])))
            seen |= {kind} if found else set()
    assert seen == CHECKED_HEADER
    assert everything > CHECKED_HEADER


def test_the_layers() -> None:
    """A layer is there, on, thawed, unlocked and plotted with full lines."""
    lines = drawing("arcs")
    place = next(
        k for k, kind, code in groups("arcs", "TABLES") if kind == "LAYER" and lines[k] == "CUT"
    )
    seen = set()
    for k, kind, code in groups("arcs", "TABLES"):
        if kind == "LAYER" and place <= k and lines[k] != "LAYER":
            if lines[k] == "PITCH_CURVE":
                break
            other = "-7" if code == "62" else changed(code, lines[k])
            if faults("arcs", with_line(lines, k, other)):
                seen.add(int(code))
    assert seen == CHECKED_LAYER


@pytest.mark.parametrize(
    ("kind", "code", "value", "text"),
    [
        ("LWPOLYLINE", "70", "129", "LWPOLYLINE has 129 as its group 70"),
        ("CIRCLE", "30", "5.0", "elevation"),
        ("LINE", "31", "5.0", "elevation"),
        ("LINE", "8", "CUT", "loose end"),
        ("LINE", "100", "AcDbLines", "has other subclasses"),
        ("CIRCLE", "5", "37", "has no handle of its own"),
        ("CIRCLE", "330", "99", "have 2 owners"),
    ],
)
def test_what_is_reported_on_an_entity(kind: str, code: str, value: str, text: str) -> None:
    lines = drawing("arcs")
    handles = [lines[k] for k, each, c in groups("arcs", "ENTITIES") if c == "5" and each == "LINE"]
    place = next(
        k for k, each, c in groups("arcs", "ENTITIES") if each == kind and c == code
        and (code != "100" or lines[k] != "AcDbEntity")
    )  # fmt: skip
    found = faults("arcs", with_line(lines, place, handles[0] if code == "5" else value))
    assert any(text in f"{check.name}: {check.note}" for check in found)
