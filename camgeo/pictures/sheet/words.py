"""The words on a sheet, in each language."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.part.spec import BOTH, LOWER, UPPER
from camgeo.scene.formats.drawing import Language


@dataclass(frozen=True, slots=True)
class Words:
    """Labels of the title block, headings and notes; braces are for values."""

    owner: str
    creator: str
    approver: str
    date: str
    revision: str
    document_type: str
    title: str
    number: str
    sheet: str
    material: str
    hardness: str
    tolerances: str
    edges: str
    surface: str
    scale: str
    size: str
    language: str
    dimensions: str
    table: str
    motion: str
    angle_head: str
    swing_head: str
    lift_head: str
    at_head: str
    angle: str
    notes: str
    design: str
    return_disc: str
    roller: str
    knife_edge: str
    flat_face: str
    guided: str
    rocking: str
    base: str
    clearance: str
    mark: str
    engraving: str
    counterbore: str
    chamfers: str
    set_screw: str
    pair: str
    pair_design: str
    main_disc: str
    other_disc: str
    upper: str
    lower: str
    zero: str
    sense: str
    ccw: str
    cw: str
    curve: str
    polar: str
    centre_polar: str
    next_sheet: str
    reference: str
    scene: str
    pitch: str
    base_circle: str
    left_out: str


ENGLISH: Final = Words(
    owner="Legal owner",
    creator="Created by",
    approver="Approved by",
    date="Date of issue",
    revision="Rev.",
    document_type="Document type",
    title="Title",
    number="Identification number",
    sheet="Sheet",
    material="Material",
    hardness="Hardness",
    tolerances="General tolerances",
    edges="Edges ISO 13715",
    surface="Surface",
    scale="Scale",
    size="Size",
    language="Lang.",
    dimensions="Dimensions in",
    table="Polar coordinates",
    motion="Motion diagram",
    angle_head="Angle °",
    swing_head="Swing °",
    lift_head="Lift",
    at_head="at °",
    angle="Cam angle in degrees",
    notes="Notes",
    design="Design {name}",
    return_disc="Design {name}, return disc",
    roller="roller %%c{diameter}",
    knife_edge="knife edge",
    flat_face="flat face",
    guided="Follower: {touching} on a guide, offset {offset}",
    rocking="Follower: {touching} on a rocker, pivot at ({x} / {y})",
    base="Base circle radius {radius}",
    clearance="groove wider than the roller by {clearance}",
    mark="Timing mark {size}, {depth} deep, its middle at radius {radius} and {angle}°",
    engraving=(
        "Engraving in DejaVu Sans, capital letters {height} high, {depth} deep, its middle at"
        " radius {radius} and {angle}°"
    ),
    counterbore="Counterbores %%c{diameter}, {depth} deep from the upper end of the holes"
    " %%c{hole}.",
    chamfers="Chamfers of 45°: {edges}.",
    set_screw="Hole %%c{diameter} for a set screw, radial through the hub at {angle}°, its middle"
    " {height} from the {face} face of the disc (not drawn)",
    pair="Both discs in one piece: the zero of the return disc at {angle}° to that of the main"
    " disc, gap {gap}, spacer %%c{spacer}, {upper} above.",
    pair_design="Design {name}, both discs",
    main_disc="main disc",
    other_disc="return disc",
    upper="upper",
    lower="lower",
    zero="The zero mark is cam angle 0; polar angles count from it, counter-clockwise in the view.",
    sense="The cam turns {sense} in the view.",
    ccw="counter-clockwise",
    cw="clockwise",
    curve="The flanks are the exact curve of the motion; this sheet shows it within {tolerance}"
    " {unit}. Manufacture from the CAD or NC data of the same scene.",
    polar="r: point of contact on the flank.",
    centre_polar="R: centre of the roller.",
    next_sheet="Table of polar coordinates: next sheet.",
    reference="Dimensions in brackets are auxiliary.",
    scene="Scene SHA-256 {scene}",
    pitch="Pitch curve: long-dashed dotted line; base circle: double-dotted.",
    base_circle="Base circle: long-dashed double-dotted line.",
    left_out="Pitch curve and base circle are far larger than the part and are not drawn.",
)

GERMAN: Final = Words(
    owner="Gesetzlicher Eigentümer",
    creator="Erstellt von",
    approver="Genehmigt von",
    date="Ausgabedatum",
    revision="Änd.",
    document_type="Dokumentenart",
    title="Titel",
    number="Sachnummer",
    sheet="Blatt",
    material="Werkstoff",
    hardness="Härte",
    tolerances="Allgemeintoleranzen",
    edges="Kanten ISO 13715",
    surface="Oberfläche",
    scale="Maßstab",
    size="Format",
    language="Spr.",
    dimensions="Maße in",
    table="Polarkoordinaten",
    motion="Bewegungsdiagramm",
    angle_head="Winkel °",
    swing_head="Schwenk °",
    lift_head="Hub",
    at_head="bei °",
    angle="Kurvenwinkel in Grad",
    notes="Bemerkungen",
    design="Entwurf {name}",
    return_disc="Entwurf {name}, Gegenscheibe",
    roller="Rolle %%c{diameter}",
    knife_edge="Schneide",
    flat_face="Tellerfläche",
    guided="Abtrieb: {touching}, gerade geführt, Versatz {offset}",
    rocking="Abtrieb: {touching} am Schwinghebel, Drehpunkt ({x} / {y})",
    base="Grundkreisradius {radius}",
    clearance="Nut um {clearance} breiter als die Rolle",
    mark="Zeitmarke {size}, {depth} tief, Mitte auf Radius {radius} bei {angle}°",
    engraving=(
        "Gravur in DejaVu Sans, Großbuchstaben {height} hoch, {depth} tief, Mitte auf Radius"
        " {radius} bei {angle}°"
    ),
    counterbore="Flachsenkungen %%c{diameter}, {depth} tief vom oberen Ende der Bohrungen"
    " %%c{hole}.",
    chamfers="Fasen unter 45°: {edges}.",
    set_screw="Bohrung %%c{diameter} für einen Gewindestift, radial durch die Nabe bei {angle}°,"
    " Mitte {height} von der {face} Fläche der Scheibe (nicht gezeichnet)",
    pair="Beide Scheiben in einem Teil: Null der Gegenscheibe unter {angle}° zur Null der"
    " Hauptscheibe, Abstand {gap}, Zwischenbund %%c{spacer}, {upper} oben.",
    pair_design="Entwurf {name}, beide Scheiben",
    main_disc="Hauptscheibe",
    other_disc="Gegenscheibe",
    upper="oberen",
    lower="unteren",
    zero="Die Nullmarke ist Kurvenwinkel 0; Polarwinkel zählen von ihr aus gegen den Uhrzeigersinn"
    " der Ansicht.",
    sense="Die Kurve dreht in der Ansicht {sense}.",
    ccw="gegen den Uhrzeigersinn",
    cw="im Uhrzeigersinn",
    curve="Die Flanken sind die exakte Kurve der Bewegung; dieses Blatt zeigt sie auf {tolerance}"
    " {unit} genau. Fertigung nach den CAD- oder NC-Daten derselben Szene.",
    polar="r: Berührpunkt auf der Flanke.",
    centre_polar="R: Rollenmittelpunkt.",
    next_sheet="Tabelle der Polarkoordinaten: nächstes Blatt.",
    reference="Eingeklammerte Maße sind Hilfsmaße.",
    scene="Szene SHA-256 {scene}",
    pitch="Rollenmittelpunktsbahn: Strichpunktlinie; Grundkreis: Strich-Zweipunktlinie.",
    base_circle="Grundkreis: Strich-Zweipunktlinie.",
    left_out="Rollenmittelpunktsbahn und Grundkreis, viel größer als das Teil, sind nicht"
    " gezeichnet.",
)

WORDS: Final[dict[Language, Words]] = {"en": ENGLISH, "de": GERMAN}


CHAMFERED: Final[dict[Language, dict[str, str]]] = {
    "en": {
        "outline": "flanks",
        "rim": "rim",
        "bore": "bore",
        "hub": "hub",
        "bolt_circle": "bolt holes",
        "lightening_holes": "lightening holes",
        UPPER: "{edge} {width} on the upper side",
        LOWER: "{edge} {width} on the lower side",
        BOTH: "{edge} {width}",
    },
    "de": {
        "outline": "Flanken",
        "rim": "Rand",
        "bore": "Bohrung",
        "hub": "Nabe",
        "bolt_circle": "Schraubenlöcher",
        "lightening_holes": "Erleichterungslöcher",
        UPPER: "{edge} {width} oben",
        LOWER: "{edge} {width} unten",
        BOTH: "{edge} {width}",
    },
}
"""What has chamfers, by the keys of the scene, and on which side."""
