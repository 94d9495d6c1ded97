// What is drawn, as Python hands it over: camgeo.pictures.model, camgeo.pictures.model and
// camgeo.pictures.mechanism as JSON. Widths and sizes of text are points, 72 to the inch; a gap in a
// line is null.

export type Place = [number, number];
export type Gap = [number | null, number | null];

export interface Style {
  kind: "style";
  color: string;
  width: number;
  dashes: number[];
  marker: "" | "o" | "s" | "D" | "^" | "v" | "<" | "+" | "x" | "P" | "X" | "*";
  size: number;
  face: string;
  edge: string;
  edge_width: number;
  cap: "butt" | "round" | "projecting";
  join: "round" | "miter";
}

export interface Fill {
  kind: "fill";
  face: string;
  edge: string;
  width: number;
  dashes: number[];
  hatched: boolean;
  opacity: number;
}

export interface Line {
  kind: "line";
  points: Gap[];
  style: Style;
  label: string;
  layer: number;
  clipped: boolean;
}

export interface Rule {
  kind: "rule";
  axis: "x" | "y";
  at: number;
  style: Style;
  label: string;
  layer: number;
}

export interface Band {
  kind: "band";
  axis: "x" | "y";
  places: number[];
  low: (number | null)[];
  high: (number | null)[];
  style: Fill;
  label: string;
  layer: number;
}

export interface Area {
  kind: "area";
  rings: Gap[][];
  style: Fill;
  label: string;
  layer: number;
  closed: boolean;
}

export interface Circle {
  kind: "circle";
  centre: Place;
  radius: number;
  style: Fill;
  layer: number;
}

export interface Text {
  kind: "text";
  text: string;
  at: Place;
  size: number;
  of: "data" | "panel" | "figure";
  offset: Place | null;
  across: "left" | "center" | "right";
  up: "bottom" | "baseline" | "center" | "top";
  turned: boolean;
  bold: boolean;
  spacing: number | null;
  box: { pad: number; opacity: number; ring: boolean } | null;
  layer: number;
}

// Arrow, Field and Inset are in figures that no page shows.
export type Mark = Line | Rule | Band | Area | Circle | Text;

export interface Axis {
  limits: Place;
  label: string;
  log: boolean;
  ticks: number[] | null;
  names: string[] | null;
  numbered: boolean;
  powers: Place | null;
  label_size: number;
  label_place: number | null;
}

export interface Legend {
  entries: { label: string; style: Style | Fill }[];
  place: string;
  anchor: Place | null;
  columns: number;
  size: number;
  gap: number;
  pad: number;
  spacing: number;
}

export interface Panel {
  frame: [number, number, number, number];
  x: Axis;
  y: Axis;
  marks: Mark[];
  title: string;
  title_size: number;
  title_gap: number;
  legend: Legend | null;
  right: Axis | null;
  equal: boolean;
  bare: boolean;
}

export interface Figure {
  size: Place;
  panels: Panel[];
  texts: Text[];
  legend: Legend | null;
}

// A turn of the mechanism, in mm, in the fixed frame with its origin in the cam axis. `places` has
// one list for each of equally many steps of the cam angle: points of links, ends of faces, centres
// of rollers, joints, sliders on guides.
export interface Animation {
  low: Place;
  high: Place;
  rotation: 1 | -1;
  turning: Mark[];
  note: string;
  links: number[];
  rollers: number[];
  faces: number;
  joints: number;
  shafts: Place[];
  guides: { start: Place; end: Place; block: boolean }[];
  places: Place[][];
  lifts: number[];
  lift_unit: string;
}

export interface Charted {
  figure: Figure;
  sentence: string;
}

// Triangles of a body: nine coordinates [mm] of each, as single floats in base 64.
export interface Body {
  places: string;
}
