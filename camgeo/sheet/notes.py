"""The notes on a sheet: what it shows, and by what it was made."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Final

from camgeo.formats.drawing import DrawingSpec
from camgeo.part.chamfers import Chamfers
from camgeo.part.faces import LOWER
from camgeo.part.pair_spec import MAIN
from camgeo.part.spec import PartSpec
from camgeo.product.product import Product
from camgeo.product.relation import ANGLE
from camgeo.sheet.lettering import wrapped
from camgeo.sheet.marks import Label, Mark
from camgeo.sheet.views import Drawn
from camgeo.sheet.words import CHAMFERED, WORDS, Words
from camgeo.units import MM_PER

LETTER = 2.5

STEP = 3.6
"""From line to line [mm]."""

SPARING: Final = 0.96
"""How much of a line is used: fonts that programs take in place of ours may be wider."""

Length = Callable[[float], str]
"""Writes a length [mm] in the unit of the drawing."""


def notes_of(
    product: Product,
    spec: DrawingSpec,
    tolerance: float,
    length: Length,
    *,
    apart: bool,
    drawn: Drawn,
) -> list[str]:
    """The sentences, in the language of the sheet; `apart` says that the table is on the next one,
    `drawn` which curves there are and whether dimensions are in brackets.
    """
    words, cam = WORDS[spec.language], product.cam
    name = product.scene.name
    if product.is_pair:
        found = [words.pair_design.format(name=name)]
        legend: list[str] = []
    else:
        found = [(words.return_disc if product.position else words.design).format(name=name)]
        found.append(_follower(product, spec, words, length))
        legend = _legend(product, spec, words, apart=apart, drawn=drawn)
    found += _features(product.drawn.spec, words, length, spec)
    found += _pair(product.scene.part, words, length)
    sense = words.sense.format(sense=words.ccw if cam.rotation > 0 else words.cw)
    found.append(f"{words.zero} {sense}")
    shown = f"{tolerance / MM_PER[product.unit]:.9f}".rstrip("0")
    if spec.language == "de":
        shown = shown.replace(".", ",")
    found.append(words.curve.format(tolerance=shown, unit=product.unit))
    if drawn.shape.outermost.circle is None:
        legend.append(words.reference)
    if legend:
        found.append(" ".join(legend))
    found.append(words.scene.format(scene=product.scene_hash))
    return found


def _follower(product: Product, spec: DrawingSpec, words: Words, length: Length) -> str:
    """What touches the disc, how it is guided, and the base circle."""
    cam, follower = product.cam, product.cam.follower
    touching = words.flat_face
    if follower.rolls:
        radius = follower.roller_radius
        touching = (
            words.roller.format(diameter=length(2.0 * radius)) if radius else words.knife_edge
        )
    if follower.pivot is None:
        found = words.guided.format(touching=touching, offset=length(follower.offset))
    else:
        x, y = length(follower.pivot.real), length(follower.pivot.imag)
        found = words.rocking.format(touching=touching, x=x, y=y)
    base = words.base.format(radius=length(follower.base_radius))
    if cam.contact.closed_by_form and cam.clearance:
        base += f"; {words.clearance.format(clearance=length(cam.clearance))}"
    return f"{found}; {base[0].lower() if spec.language == 'en' else base[0]}{base[1:]}"


def _legend(
    product: Product, spec: DrawingSpec, words: Words, *, apart: bool, drawn: Drawn
) -> list[str]:
    """What lines and columns are."""
    cam, follower = product.cam, product.cam.follower
    legend = [words.pitch if drawn.pitch is not None else words.base_circle]
    if drawn.base_radius is None:
        legend = [words.left_out]
    if spec.step:
        if not cam.contact.closed_by_form:
            legend.append(words.polar)
        if follower.has_pitch_curve and (spec.sheet == "A3" or apart or cam.contact.closed_by_form):
            legend.append(words.centre_polar)
    if apart:
        legend.append(words.next_sheet)
    return legend


def _features(
    part: PartSpec | None, words: Words, length: Length, spec: DrawingSpec
) -> Iterator[str]:
    """What views and dimensions leave open: a timing mark, counterbores, and the hole of a
    set screw.
    """
    if part is None:
        return

    def degrees(angle: float) -> str:
        text = f"{math.degrees(angle):.6g}"
        return text.replace(".", ",") if spec.language == "de" else text

    if part.mark is not None:
        mark = part.mark
        size = f"%%c{length(mark.width)}"
        if mark.length is not None:
            size = f"{length(mark.width)} x {length(mark.length)}"
        yield words.mark.format(
            size=size,
            radius=length(mark.radius),
            depth=length(mark.depth),
            angle=degrees(mark.angle),
        )
    if part.bolt_circle is not None and part.bolt_circle.counterbore is not None:
        wide = part.bolt_circle.counterbore
        yield words.counterbore.format(
            diameter=length(wide.diameter),
            depth=length(wide.depth),
            hole=length(part.bolt_circle.hole),
        )
    if part.chamfers is not None:
        names = CHAMFERED[spec.language]
        stated = ((field.name, getattr(part.chamfers, field.name)) for field in fields(Chamfers))
        edges = (
            names[each.edges].format(edge=names[name], width=length(each.width))
            for name, each in stated
            if each is not None
        )
        yield words.chamfers.format(edges="; ".join(edges))
    for text in part.engraving:
        yield words.engraving.format(
            height=length(text.height),
            depth=length(text.depth),
            radius=length(text.radius),
            angle=degrees(text.angle),
        )
    if part.set_screw is not None and part.hub is not None:
        screw = part.set_screw
        yield words.set_screw.format(
            diameter=length(screw.diameter),
            height=length(screw.height),
            angle=degrees(screw.angle),
            face=words.lower if part.hub.side == LOWER else words.upper,
        )


def _pair(part: PartSpec | None, words: Words, length: Length) -> Iterator[str]:
    """How the disc stands to the other one of a pair in one piece."""
    if part is None or part.pair is None:
        return
    pair = part.pair
    yield words.pair.format(
        angle=f"{ANGLE:g}",
        gap=length(pair.gap),
        spacer=length(pair.spacer),
        upper=words.main_disc if pair.upper == MAIN else words.other_disc,
    )


def lines_of(notes: list[str], width: float) -> list[tuple[str, bool]]:
    """The notes in lines at most `width` [mm] wide, and whether each begins a note."""
    found = []
    for note in notes:
        first, *rest = wrapped(note, LETTER, SPARING * (width - 6.0))
        found += [(first, True), *((text, False) for text in rest)]
    return found


def height_of(lines: list[tuple[str, bool]]) -> float:
    """Height of the notes with their heading [mm]."""
    return 7.0 + STEP * len(lines)


def marks_of(lines: list[tuple[str, bool]], heading: str, top: complex, width: float) -> list[Mark]:
    """The notes, numbered, below `top`."""
    marks: list[Mark] = [Label(heading, top - 4.5j, 3.5)]
    number = 0
    for row, (text, begins) in enumerate(lines):
        at = top - 1j * (6.0 + STEP * row + LETTER)
        if begins:
            number += 1
            marks.append(Label(f"{number}", at, LETTER))
        marks.append(Label(text, at + 5.0, LETTER, width=width - 5.0))
    return marks
