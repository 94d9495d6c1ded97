// Draws the marks of a figure, and text. Nothing here decides what is shown.

import { course, type Scale } from "./course";
import type { Area, Band, Circle, Fill, Line, Mark, Rule, Style, Text } from "./data";
import { type Attributes, fixed, type Node } from "./svg";

export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

// Where marks are: the scales of both axes, in points, `k` points to a unit, and the panel.
export interface Plane {
  x: Scale;
  y: Scale;
  k: number;
  box: Box;
  clip: string; // identifier of what cuts lines off at the panel's edges; empty for nothing
}

export const LETTER = 0.58; // width of a letter, in sizes of the text: a generous estimate
const LINE_HEIGHT = 1.2;

// Text with subscripts between "$_" and "$".
export function words(parent: Node, text: string, attributes: Attributes): void {
  if (!text.includes("$_")) {
    parent.add("text", attributes, text);
    return;
  }
  const line = parent.add("text", attributes);
  let lowered = false;
  for (const part of text.split(/(\$_[^$]*\$)/)) {
    if (!part) continue;
    const below = part.startsWith("$_");
    const shift: Attributes = below ? { dy: "0.25em", "font-size": "0.75em" } : lowered ? { dy: "-0.19em" } : {};
    line.add("tspan", shift, below ? part.slice(2, -1) : part);
    lowered = below;
  }
}

function dashed(style: Style | Fill): Attributes {
  if (!style.dashes.length) return {};
  return { "stroke-dasharray": style.dashes.map((each) => fixed(each * style.width)).join(" ") };
}

export function stroke(style: Style): Attributes {
  return {
    stroke: style.width ? style.color : "none",
    "stroke-width": style.width,
    fill: "none",
    "stroke-linejoin": style.join,
    "stroke-linecap": style.dashes.length ? "butt" : style.cap === "projecting" ? "square" : style.cap,
    ...dashed(style),
  };
}

export function filled(style: Fill): Attributes {
  return {
    fill: style.face || "none",
    "fill-rule": "evenodd",
    stroke: style.width && style.edge ? style.edge : "none",
    "stroke-width": style.width,
    opacity: style.opacity,
    ...dashed(style),
  };
}

const SHAPES: Record<Exclude<Style["marker"], "" | "o">, string> = {
  s: "M-1-1H1V1H-1Z",
  D: "M0-1.4L1.4 0L0 1.4L-1.4 0Z",
  "^": "M0-1.1L1.1 1H-1.1Z",
  v: "M0 1.1L1.1-1H-1.1Z",
  "<": "M-1.1 0L1-1.1V1.1Z",
  "+": "M-1 0H1M0-1V1",
  x: "M-1-1L1 1M-1 1L1-1",
  P: "M-1 0H1M0-1V1",
  X: "M-1-1L1 1M-1 1L1-1",
  "*": "M-1 0H1M0-1V1M-.7-.7L.7.7M-.7.7L.7-.7",
};

export function marker(parent: Node, style: Style, x: number, y: number): void {
  const half = 0.5 * style.size;
  const look = { fill: style.face || style.color, stroke: style.edge || style.color };
  if (!style.marker) return;
  if (style.marker === "o") {
    parent.add("circle", { cx: fixed(x), cy: fixed(y), r: half, ...look, "stroke-width": style.edge_width });
    return;
  }
  const transform = `translate(${fixed(x)} ${fixed(y)}) scale(${half})`;
  parent.add("path", { d: SHAPES[style.marker], transform, ...look, "stroke-width": fixed(style.edge_width / half) });
}

function clipped(plane: Plane): Attributes {
  return plane.clip ? { "clip-path": `url(#${plane.clip})` } : {};
}

function line(mark: Line, parent: Node, plane: Plane): void {
  const inside = parent.add("g", mark.clipped ? clipped(plane) : {});
  if (mark.style.width && mark.points.length > 1) {
    inside.add("path", { d: course(mark.points, plane.x, plane.y), ...stroke(mark.style) });
  }
  if (!mark.style.marker) return;
  for (const [x, y] of mark.points) {
    if (x !== null && y !== null) marker(inside, mark.style, plane.x(x), plane.y(y));
  }
}

function rule(mark: Rule, parent: Node, plane: Plane): void {
  const { left, top, right, bottom } = plane.box;
  const at = fixed(mark.axis === "x" ? plane.x(mark.at) : plane.y(mark.at));
  const ends = mark.axis === "x" ? { x1: at, x2: at, y1: top, y2: bottom } : { x1: left, x2: right, y1: at, y2: at };
  parent.add("line", { ...ends, ...stroke(mark.style), ...clipped(plane) });
}

function band(mark: Band, parent: Node, plane: Plane): void {
  const there = [...mark.places.keys()].filter((k) => mark.low[k] !== null && mark.high[k] !== null);
  const along = (values: (number | null)[], k: number): [number, number] => {
    const [place, value] = [mark.places[k]!, values[k]!];
    return mark.axis === "x" ? [place, value] : [value, place];
  };
  const ring = [...there.map((k) => along(mark.low, k)), ...there.reverse().map((k) => along(mark.high, k))];
  parent.add("path", { d: `${course(ring, plane.x, plane.y)}Z`, ...filled(mark.style), ...clipped(plane) });
}

function area(mark: Area, parent: Node, plane: Plane): void {
  const end = mark.closed ? "Z" : "";
  const d = mark.rings.map((ring) => course(ring, plane.x, plane.y) + end).join("");
  parent.add("path", { d, ...filled(mark.style) });
}

function circle(mark: Circle, parent: Node, plane: Plane): void {
  const [x, y] = mark.centre;
  const place = { cx: fixed(plane.x(x)), cy: fixed(plane.y(y)), r: fixed(mark.radius * plane.k) };
  parent.add("circle", { ...place, ...filled(mark.style) });
}

// Written upwards, the length of a text lies along what `up` aligns, and its lines along `across`.
const UPWARDS = { bottom: "start", baseline: "start", center: "middle", top: "end" } as const;
const OVER = { left: "top", center: "center", right: "bottom" } as const;
const ANCHOR = { left: "start", center: "middle", right: "end" } as const;

function text(mark: Text, parent: Node, plane: Plane): void {
  const { left, top, right, bottom } = plane.box;
  let [x, y] = mark.at;
  if (mark.of === "data") [x, y] = [plane.x(x), plane.y(y)];
  else [x, y] = [left + x * (right - left), bottom - y * (bottom - top)];
  if (mark.offset) [x, y] = [x + mark.offset[0], y - mark.offset[1]];
  const { size } = mark;
  const lines = mark.text.split("\n");
  const step = size * (mark.spacing ?? LINE_HEIGHT);
  const anchor = mark.turned ? UPWARDS[mark.up] : ANCHOR[mark.across];
  const more = ((lines.length - 1) * step) / size;
  const below = { bottom: -0.2 - more, baseline: 0, center: 0.35 - more / 2, top: 0.8 };
  const first = below[mark.turned ? OVER[mark.across] : mark.up] * size;
  const turned = mark.turned ? " rotate(-90)" : "";
  const group = parent.add("g", { transform: `translate(${fixed(x)} ${fixed(y)})${turned}` });
  const wide = Math.max(...lines.map((each) => each.length)) * LETTER * size;
  if (mark.box?.ring) {
    const r = fixed(0.5 * wide + size * (0.35 + mark.box.pad));
    group.add("circle", { r, fill: "white", stroke: "black", "stroke-width": 0.7 });
  } else if (mark.box) {
    const from = { start: 0, middle: -wide / 2, end: -wide }[anchor];
    group.add("rect", {
      x: fixed(from), y: fixed(first - 0.85 * size), width: fixed(wide), height: fixed(lines.length * step),
      fill: "white", opacity: mark.box.opacity,
    });
  }
  const weight = mark.bold ? "bold" : "normal";
  lines.forEach((each, k) => {
    const y = fixed(first + k * step);
    words(group, each, { y, "text-anchor": anchor, "font-size": size, "font-weight": weight });
  });
}

function draw(mark: Mark, parent: Node, plane: Plane): void {
  switch (mark.kind) {
    case "line":
      return line(mark, parent, plane);
    case "rule":
      return rule(mark, parent, plane);
    case "band":
      return band(mark, parent, plane);
    case "area":
      return area(mark, parent, plane);
    case "circle":
      return circle(mark, parent, plane);
    case "text":
      return text(mark, parent, plane);
  }
}

// By layers; within one, later marks on top.
export function drawMarks(marks: readonly Mark[], parent: Node, plane: Plane): void {
  const order = [...marks].sort((a, b) => a.layer - b.layer);
  for (const mark of order) draw(mark, parent, plane);
}
