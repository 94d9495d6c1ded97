"""Each fault is reported with key, value, what is allowed, and the line."""

from __future__ import annotations

import errno
import math
import os
import pathlib
import re
from collections.abc import Iterator
from decimal import Decimal
from typing import Final

import pytest

from camgeo.errors import SceneError
from camgeo.scene.formats.format import find_format
from camgeo.scene.formats.gcode import FORMAT
from camgeo.scene.scene import Scene, load_scene, parse_scene
from tests import kept
from tests.findings import known
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, PLATE, ROCKER, leaves, refusal_of, spoilt

Change = tuple[str, str]

TOOL = PLATE[PLATE.index("[[tool]]") : PLATE.index("[holding]")]


def engraved(keys: str) -> Change:
    """Adds a text with these keys, and others that are right unless they give a height."""
    others = "" if keys.startswith("height") else "height = 4\nradius = 20\ndepth = 0.3\n"
    return "[part]", f"[[part.engraving]]\n{others}{keys}\n[part]"


ABSENT = os.strerror(errno.ENOENT)

FAULTS: list[tuple[str, list[Change], str]] = [
    # the frame of the format
    (PLATE, [("camgeo = 1\n", "")], "camgeo: is missing: Version"),
    (PLATE, [("camgeo = 1", "camgeo = 2")], "line 1: camgeo = 2: must be 1, the format version"),
    (PLATE, [("camgeo = 1", "camgeo = true")], "camgeo = true: must be 1"),
    (PLATE, [('"plate"', '"../plate"')], r'line 2: name = "\.\./plate": .* no path'),
    (PLATE, [('"plate"', '"plate.toml"')], "no suffix"),
    (PLATE, [('"plate"', '""')], "1 to 100 letters"),
    (PLATE, [('"plate"', '"' + 101 * "a" + '"')], "1 to 100 letters"),
    (PLATE, [('"plate"', '"plate\\n"')], "1 to 100 letters"),
    (PLATE, [('"plate"', '"CoM1"')], 'name = "CoM1": .* and none of con, .* Windows keeps for dev'),
    (
        PLATE,
        [('"plate"', '"nul"')],
        'name = "nul": .* and none of con, prn, aux, nul, com0 to com9',
    ),
    (PLATE, [('"plate"', '"-rf"')], 'name = "-rf": .* not begin with -'),
    (PLATE, [('name = "plate"', "name = 7")], "name = 7: must be 1 to 100 letters"),
    # keys
    (
        PLATE,
        [("base_radius", "base_radus")],
        r"line 10: follower.base_radus = 50: is not a known key \(did you mean base_radius\?\)",
    ),
    (PLATE, [("[limits]", "[limit]")], r"line 28: limit: .*did you mean limits\?"),
    (PLATE, [("speed = 60", "zzz = 60")], "cam.zzz = 60: is not a known key; known here: rotation"),
    (PLATE, [('"ccw"\n', '"ccw"\nname = "x"\n')], r"belongs to the top of the file; .*\[cam\]"),
    (PLATE, [("base_radius = 50\n", "")], "line 8: follower.base_radius: is missing: r_G"),
    (PLATE, [("[limits]", "[effects.sprung]")], "effects.sprung: .*did you mean spring"),
    # values
    (
        PLATE,
        [("base_radius = 50", 'base_radius = "50"')],
        r'base_radius = "50": must be a positive number.*leave out the quotes',
    ),
    (PLATE, [("radius = 10", "radius = -10")], "roller_radius = -10: must be 0 .a knife edge., or"),
    (PLATE, [("radius = 10", "radius = 1e-10")], "roller_radius = 1e-10: must be 0, or 1e-09 to"),
    (PLATE, [("radius = 10", "radius = 10\nside_clearance = 0.1")], "belongs to contact .groove."),
    (GROOVE, [("radius = 8", "radius = 0")], "roller_radius = 0: must be above 0: a groove holds"),
    (GROOVE, [("radius = 8", "radius = 8\nside_clearance = -1")], "side_clearance = -1: must be 0"),
    (
        GROOVE,
        [("radius = 8", "radius = 8\nside_clearance = 16")],
        "side_clearance = 16: must be less than the roller's diameter, 16",
    ),
    (
        GROOVE,
        [("radius = 8", "radius = 8\nside_clearance = 0.1"), ("ter = 10", "ter = 16.2")],
        "diameter = 16.2: must not exceed the width of the groove, .*side_clearance 16.1",
    ),
    (PLATE, [("radius = 50", "radius = 1e10")], "base_radius = 1e10: .* 1e-9 to 1e9"),
    (PLATE, [("radius = 50", "radius = true")], "base_radius = true: must be a positive number"),
    (PLATE, [("offset = 12", "offset = nan")], "follower.offset = nan: must be a finite number"),
    (PLATE, [("offset = 12", "offset = -inf")], "follower.offset = -inf: must be a finite number"),
    (PLATE, [("offset = 12", "offset = 1e400")], "offset = 1e400: is too large for a number"),
    (PLATE, [("speed = 60", "speed = 1979-05-27")], "1979-05-27: a date or time has no place"),
    (PLATE, [("speed = 60", "speed = 07:32:00")], "07:32:00: a date or time has no place"),
    (PLATE, [("speed = 60", "speed = 0")], r"must be a number above 0 to 1e\+06 \(rev/min\)"),
    (PLATE, [("speed = 60", f"speed = 0x{500 * 'f'}")], "0xfff.*: is too large for a number"),
    (PLATE, [('"ccw"', '"CCW"')], r'must be one of "cw", "ccw" \(did you mean "ccw"\?\)'),
    (PLATE, [('"mm"', '"cm"')], 'units.length = "cm": must be one of "mm", "inch"'),
    (PLATE, [("[cam]", "[[cam]]")], r"line 5: cam: must be a table"),
    (PLATE, [("ratio = 0.7", "ratio = 1.5")], "must be a number from 1e-09 to 1$"),
    (PLATE, [("angle = 60", "angle = 91")], r"must be a number above 0 to 90 \(degrees\)"),
    # the follower
    (
        PLATE,
        [("translating-roller", "translating-flat"), ("offset = 12", "face = [-9, 9]")],
        "roller_radius = 10: belongs to a translating-roller follower; this is a translating-flat",
    ),
    (
        PLATE,
        [("offset = 12", "arm = 12")],
        "belongs to an oscillating-roller follower; this is a translating-roller follower",
    ),
    (PLATE, [("offset = 12", "offset = 50.001")], "line 12: .*must not exceed the base radius, 50"),
    (ROCKER, [("radius = 55", "radius = 40")], "base_radius = 40: .*form no triangle.*40 and 200"),
    (ROCKER, [("[-96, -72]", "[-96]")], r"pivot = \[-96\]: must be two numbers, \[x, y\]"),
    (ROCKER, [("[-96, -72]", '[-96, "y"]')], r'pivot\[2\] = "y": must be a number'),
    (ROCKER, [("to = 25", "to = 200")], "must lie between -180 and 180: .* in degrees"),
    # the linkage
    (LINKED, [("coupler", "copler")], r"linkage.copler = 75.38: .*did you mean coupler\?"),
    (LINKED, [('leans = "away"', 'leans = "left"')], 'must be one of "away", "toward"'),
    (LINKED, [("to = 5.5", "to = 60")], "line 12: linkage: the linkage does not close"),
    (LINKED, [('"outward"', '"inward"')], "contradicts the linkage, which moves the roller outwa"),
    (
        PLATE,
        [("[[motion]]\ndwell = 30", '[linkage]\nkind = "four-bar"\n[[motion]]\ndwell = 30')],
        'a four-bar turns a rocker: it needs kind = "oscillating-roller" or "oscillating-flat"',
    ),
    # the motion
    (PLATE, [("span = 100", "span = 99.999")], "line 13: motion: the spans add up to 359.999 deg"),
    (PLATE, [("span = 100", "span = 100.0000000000000000001")], "360.0000000000000000001 degrees"),
    (PLATE, [("span = 100", f"span = 100.{70 * '0'}1")], "more digits than can be added exactly"),
    (PLATE, [("span = 100", "span = 0")], r"line 17: motion\[2\].span = 0: .*a move needs a span"),
    (PLATE, [("span = 100", "span = -1")], r"motion\[2\].span = -1: must be a number from 1e-6"),
    (PLATE, [("dwell = 30", "dwell = 1e-9")], r"motion\[1\].dwell = 1e-9: must be 0, or from 1e-6"),
    (PLATE, [("to = 0", "to = 1")], r"line 24: motion\[4\].to = 1: .*must return to 0"),
    (PLATE, [("inflection = 0.4", "inflection = 1")], "inflection = 1: must lie between 0 and 1"),
    (PLATE, [("dwell = 40", "dwell = 40\nto = 5")], r"motion\[3\].to = 5: belongs to a move; this"),
    (PLATE, [("dwell = 40", "dwel = 40")], r"motion\[3\].dwel = 40: .*did you mean dwell\?"),
    (PLATE, [("dwell = 40", "law = 40")], r"motion\[3\].span: is missing: Span of the cam angle"),
    (PLATE, [('"modified-sine"', '"modified-sin"')], r'did you mean "modified-sine"\?'),
    (PLATE, [('"modified-sine"', '"tabel"')], 'law = "tabel": .*did you mean "table"'),
    (PLATE, [("to = 20", "to = 20\nvelocity = 3")], r"motion\[2\].velocity = 3: must be 0 at the"),
    (PLATE, [("[limits]", "[[motion]]\n[limits]")], r"line 28: motion\[6\].law: is missing"),
    # part and output
    (PLATE, [("bore = 20\n", "")], r"part.keyway: needs \[part\] bore"),
    (PLATE, [("width = 6", "width = 20")], "line 34: part.keyway.width = 20: .*less than the bore"),
    (PLATE, [("{ width = 6, depth = 2.8 }", "6")], r"keyway = 6: must be a table, e\.g\."),
    (PLATE, [("bore = 20", "bore = 20\nrim = 99")], 'rim = 99: belongs to contact "outer" or "gro'),
    (PLATE, [("bore = 20", "bore = 20\ngroove_depth = 9")], 'belongs to contact "groove"'),
    (PLATE, [("[part]", "[part.hub]\ndiameter = 20\nheight = 4\n[part]")], "must be more than the"),
    (
        PLATE,
        [("[part]", "[part.mark]\nradius = 20\nwidth = 2\nlength = 2\ndepth = 1\n[part]")],
        "part.mark.length = 2: must be more than the width, 2",
    ),
    (
        PLATE,
        [engraved("height = 4\nradius = 2\ndepth = 0.3")],
        r"part.engraving\[1\].radius = 2: must be more than half the height of the letters, 2",
    ),
    (
        PLATE,
        [engraved("height = 4\nradius = 20\ndepth = 12")],
        r"part.engraving\[1\].depth = 12: must be less than the thickness, 12",
    ),
    (
        PLATE,
        [engraved('text = "\u51f8"')],
        r'part.engraving\[1\].text = "\u51f8": DejaVu Sans has no "\u51f8" \(U\+51F8\)',
    ),
    (PLATE, [engraved('text = ""')], r"text = \"\": must be a text of 1 to 100 characters"),
    (PLATE, [engraved("turn = 9")], r'engraving\[1\].turn = 9: belongs to along = "straight"'),
    (
        PLATE,
        [engraved('along = "straight"\ntops = "inward"\nturn = 9')],
        r"part.engraving\[1\].turn = 9: contradicts tops; state only one of them",
    ),
    (PLATE, [engraved("heigth = 9")], "heigth = 9: is not a known key; known here: text, height"),
    (PLATE, [engraved("height = 4\ndepth = 1")], r"part.engraving\[1\].radius: is missing"),
    (
        PLATE,
        [("[part]", "[part.mark]\nradius = 20\nwidth = 2\ndepth = 12\n[part]")],
        "part.mark.depth = 12: must be less than the thickness, 12",
    ),
    (
        PLATE,
        [("depth = 2.8", 'standard = "DIN 6885-1"')],
        "width = 6: contradicts standard",
    ),
    (PLATE, [("width = 6,", "")], r"part.keyway: needs width, or standard"),
    (
        PLATE,
        [("bore = 20", "bore = 6"), ("width = 6, depth = 2.8", 'standard = "DIN 6885-1"')],
        "part.keyway.standard = .DIN 6885-1.: is for bores above 6 mm, up to 440 mm; width and",
    ),
    (PLATE, [("offset = 12", 'contact = "outer"')], "part.bore = 20: has no place"),
    (GROOVE, [("rim = 200\n", "")], r'contact = "groove": needs \[part\] rim'),
    (GROOVE, [("groove_depth = 10", "groove_depth = 20")], "must be less than the thickness, 20"),
    (
        GROOVE,
        [("diameter = 10", "diameter = 16.1")],
        "must not exceed the width of the gro.* 16",
    ),
    (PLATE, [("diameter = 10", "diameter = 20")], "must be less than the bore to be milled, 20"),
    (PLATE, [("\ndiameter = 10", "")], r"tool\[1\].diameter: is missing: Diameter of the cutting"),
    (PLATE, [('"svg"', '"swg"')], r'output.formats\[6\] = "swg": .*did you mean "svg"'),
    (PLATE, [('"svg"', '"dxf"')], "must be a list of formats, each named once"),
    (PLATE, [('"arcs"', '"splines"')], r'"splines": .*did you mean "spline"\?'),
    (PLATE, [("tolerance = 0.001", 'fit = "best"')], 'output.fit = "best": .*"fewest"'),
    (PLATE, [('"linuxcnc"', '"grbll"')], r'did you mean "grbl"\?'),
    (PLATE, [('"linuxcnc"', '"grbl"\ncoolant = "mist"')], 'one of "off", "flood" for Grbl'),
    (
        PLATE,
        [('"linuxcnc"', '"linuxcnc"\ncoolant = "through"')],
        'coolant = "through": must be one of "off", "flood", "mist" for LinuxCNC',
    ),
    (PLATE, [('"linuxcnc"', '"linuxcnc"\ncoolant = "water"')], '"off", "flood", "mist", "through"'),
    (PLATE, [('"linuxcnc"', '"linuxcnc"\nwork_offset = "G60"')], '"G60": must be one of "G54"'),
    (PLATE, [('"linuxcnc"', '"linuxcnc"\nspin_up = -1')], "must be a number from 0 to 600"),
    (PLATE, [('"linuxcnc"', '"linuxcnc"\nprogram_number = 0')], "whole number from 1 to 9999"),
    (PLATE, [('"linuxcnc"', '"linuxcn"')], r'did you mean "linuxcnc"\?'),
    (
        PLATE,
        [('"linuxcnc"', '"no.toml"')],
        f'"no.toml": cannot be read: {ABSENT}',
    ),
    (PLATE, [('"linuxcnc"', '"../no.toml"')], "must not leave the folder of the scene"),
    (PLATE, [('"linuxcnc"', '"/etc/no.toml"')], "must not leave the folder of the scene"),
    (PLATE, [("tolerance = 0.001", "tolerance = 1e-15")], "tolerance = 1e-15: .* 1e-7 mm to 1 mm"),
    (PLATE, [("tolerance = 0.001", "tolerance = 2")], "tolerance = 2: .* 1e-7 mm to 1 mm"),
    (
        PLATE,
        [("tolerance = 0.001", "tolerance = 0.5"), ('"mm"', '"inch"')],
        'tolerance = 0.5: .* to 0.03937 inch; it is given in the scene\'s unit, "inch"',
    ),
    (PLATE, [("base_radius = 50", "base_radius = 1e9")], "at least 1e-10 of the largest length"),
    (ROCKER, [("radius = 55", "radius = 1e-3")], "default, 0.001 mm, must be at most 0.1 of the b"),
    (
        PLATE,
        [('"dxf"', '"pdf"')],
        r'"pdf": must be .*"dxf".*\(PDFs are drawn by: camgeo plot',
    ),
    (PLATE, [("step = 0.5", "step = 1e-9")], "csv.step = 1e-9: must be a number from 0.001 to 90"),
    (PLATE, [("step = 0.5", "step = 1e9")], "csv.step = 1e9: must be a number from 0.001 to 90"),
    (PLATE, [("step = 0.5", "step = 0")], "csv.step = 0: must be a number from 0.001 to 90"),
]


@pytest.mark.parametrize(("scene", "changes", "message"), FAULTS, ids=[f[2] for f in FAULTS])
def test_fault_is_reported(scene: str, changes: list[Change], message: str) -> None:
    text = spoilt(scene, *changes)
    caught = refusal_of(text, "scene.toml")
    assert str(caught).startswith("scene.toml: ")
    assert any(re.search(message, str(fault)) for fault in caught.faults), str(caught)
    for fault in caught.faults:
        parts = re.findall(r"[A-Za-z0-9_-]+", re.sub(r"\[\d+\]", "", fault.key))
        line = "" if fault.line is None else text.splitlines()[fault.line - 1]
        assert fault.line is None or any(part in line for part in parts), str(fault)


@pytest.mark.parametrize(
    ("scene", "change", "name", "message"),
    [
        (PLATE, ("thickness = 12\n", ""), "gcode", "needs [part] thickness"),
        (PLATE, ("thickness = 12\n", ""), "3mf", "needs [part] thickness"),
        (GROOVE, ("groove_depth = 10\n", ""), "stl", "needs [part] groove_depth, for the cam"),
        (PLATE, (TOOL, ""), "gcode", "needs [[tool]]: a tool, and how it is run"),
    ],
)
def test_what_a_format_lacks_is_no_fault_of_the_scene(
    scene: str, change: Change, name: str, message: str
) -> None:
    text = spoilt(scene, change)
    (fault,) = parse_scene(text).lacking([find_format(name)])
    assert fault.message.startswith(message)
    assert fault.value == f'"{name}"'
    assert text.splitlines()[known(fault.line) - 1].startswith("formats = ")


def test_all_faults_at_once_in_the_order_of_the_file() -> None:
    text = spoilt(
        PLATE,
        ("base_radius", "base_radus"),
        ('"modified-sine"', '"modified-sin"'),
        ("to = 0", "to = 3"),
        ("keyway = { width = 6", "keyway = { width = 26"),
        ("tolerance = 0.001", "tolerance = nan"),
        ("step = 0.5", 'step = "fine"'),
    )
    with pytest.raises(SceneError, match="6 faults") as caught:
        parse_scene(text)
    assert [fault.key for fault in caught.value.faults] == [
        "follower.base_radus",
        "motion[2].law",
        "motion[4].to",
        "part.keyway.width",
        "output.tolerance",
        "output.csv.step",
    ]


def test_one_mistake_is_one_fault() -> None:
    single = [
        spoilt(PLATE, ("base_radius", "base_radus")),
        spoilt(PLATE, ("dwell = 40", "dwel = 40")),
        spoilt(PLATE, ("[part]", "[prat]")),
        spoilt(PLATE, ("[output.gcode]", "[output.gcod]")),
        spoilt(PLATE, ("offset = 12", "offset = 2000-01-01")),
        spoilt(PLATE, ("span = 100", "span = 99")),
        spoilt(PLATE, ("to = 0", "to = 9")),
        spoilt(PLATE, ("camgeo = 1", "camgeo = 3"), ("base_radius", "radius_of_base")),
        spoilt(LINKED, ("[linkage]", "[linkge]"), ("to = 5.5", "to = 200")),
        spoilt(GROOVE, ("radius = 8", "radius = 0")),
    ]
    for text in single:
        with pytest.raises(SceneError, match="1 fault\n"):
            parse_scene(text)


def test_machine_profile_in_the_folder_of_the_scene(tmp_path: pathlib.Path) -> None:
    profile = tmp_path / "mill.toml"
    profile.write_text("")
    text = spoilt(PLATE, ('"linuxcnc"', '"mill.toml"'))
    scene = parse_scene(text, str(tmp_path / "scene.toml"))
    assert scene.output.options[FORMAT].machine == str(profile.resolve())


@pytest.mark.parametrize("name", ["a", "_", "con-1", "nula", "0", "com10", "a-rf", 100 * "a"])
def test_names_that_are_allowed(name: str) -> None:
    assert parse_scene(spoilt(PLATE, ('"plate"', f'"{name}"'))).name == name


NEAR: Final = 1e-6
"""Relative distance of values on both sides of a limit."""

USUAL: Final = (-1.0, 0.0, 1e-10, 1e-9, 90.0, 180.0, 360.0, 1e9, 1e10)
"""Values that are tried of every number."""

HUBBED: Final = {
    "part.hub.height": 8,
    "part.set_screw": {"diameter": 4, "height": 4},
    "part.bolt_circle.counterbore": {"diameter": 8, "depth": 3},
    "part.engraving": [{"text": "A", "height": 4, "radius": 20, "depth": 0.2}],
    "part.keyway": {"width": 5, "depth": 2.3, "angle": 90},
    "limits.mass": 2,
    "part.density": 7850,
}
"""Edits of a scene with a hub."""


def test_messages_are_as_kept() -> None:
    def messages() -> Iterator[tuple[str, str]]:
        for scene, changes, _ in FAULTS:
            head = "; ".join(f"{old!r} is {new!r}" for old, new in changes)
            yield head[:200], str(refusal_of(spoilt(scene, *changes)))

    kept.compare("scene/messages.txt", messages())


def verdicts(scene: Scene, key: str) -> Iterator[str]:
    """From which value to which one a number may be changed, and what is said where it may not."""
    table = key.partition(".")[0]
    numbers = {
        float(value)
        for name, value in leaves(scene.values).items()
        if type(value) in (int, Decimal) and name.partition(".")[0] == table
    }
    near = (number * (1.0 + side * NEAR) for number in numbers for side in (-1.0, 0.0, 1.0))
    halves = (0.5 * number for number in numbers)
    runs: list[tuple[float, float, str]] = []
    for value in sorted({*near, *halves, *USUAL}):
        whole = type(leaves(scene.values)[key]) is int and value == math.floor(value)
        try:
            scene.with_values({key: int(value) if whole else value})
            said = "allowed"
        except SceneError as error:
            faults = [
                f"{'it' if each.key == key else each.key} {each.message}" for each in error.faults
            ]
            said = "; ".join(faults).replace(f" {value:g}", " it")
        if runs and runs[-1][2] == said:
            runs[-1] = (runs[-1][0], value, said)
        else:
            runs.append((value, value, said))
    return (f"{kept.short(low)} to {kept.short(high)}: {said}" for low, high, said in runs)


def test_limits_of_each_number_are_as_kept() -> None:
    """Just below, at and just above each number of the same table, and its half."""

    def limits() -> Iterator[tuple[str, str]]:
        for scene, tables in (
            (load_scene(FIXTURES / "hub_and_holes.toml").with_values(HUBBED), ("part", "follower")),
            (parse_scene(GROOVE), ("part", "follower")),
            (parse_scene(LINKED), ("linkage", "follower", "limits")),
        ):
            for key, value in leaves(scene.values).items():
                if type(value) in (int, Decimal) and key.startswith(tables):
                    yield f"{scene.name}: {key} = {value}", "\n".join(verdicts(scene, key))

    kept.compare("scene/limits.txt", limits())
