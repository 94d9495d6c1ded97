// Draws figures, data of camgeo.pictures.model, as SVG, and draws them anew in place.

import { drawAxes, POINTS, scale, valueAt } from "./axes";
import type { Figure, Legend, Line, Panel } from "./data";
import { attribute } from "./dom";
import { type Box, drawMarks, filled, LETTER, marker, type Plane, stroke, words } from "./marks";
import { element, fixed, Node } from "./svg";

// A panel as it has been drawn; lengths are points from the upper left corner of the picture.
export interface Drawn {
  index: number; // among the panels of its figure
  panel: Panel;
  plane: Plane;
  turn: boolean; // whether its x axis is one turn of the cam, in degrees
  curves: Line[]; // those that are not rules or aids
  legend: string; // the corner in which its legend is; empty if none covers it
}

const FEWEST = 100; // points of a curve

let drawings = 0;

// A figure as SVG. `overlay` lies over it and stays when it is drawn anew.
export class Drawing {
  readonly svg = element("svg", { class: "drawn" });
  readonly overlay = element("g");
  panels: Drawn[] = [];
  private readonly picture = new Node("g");
  private readonly serial = ++drawings; // tells its clips from those of others
  private corners: (string | undefined)[] = []; // where legends are that choose for themselves

  constructor() {
    this.svg.setAttribute("role", "img");
    this.svg.append(this.picture.element, this.overlay);
  }

  // All but what lies over it.
  get drawn(): SVGElement {
    return this.picture.element;
  }

  // `held`: legends stay in the corners that they are in, as they should during a drag.
  update(figure: Figure, label: string, held = false): void {
    if (!held) this.corners = [];
    const size = figure.size.map((each) => each * POINTS) as [number, number];
    attribute(this.svg, "viewBox", `0 0 ${fixed(size[0])} ${fixed(size[1])}`);
    attribute(this.svg, "aria-label", label);
    const box = { left: 0, right: size[0], top: 0, bottom: size[1] };
    const page: Plane = { x: (value) => value, y: (value) => value, k: 1, box, clip: "" };
    this.picture.redraw((into) => {
      this.panels = figure.panels.map((panel, index) => this.panel(panel, index, into, size));
      drawMarks(figure.texts, into.add("g"), page);
      if (figure.legend) drawLegend(figure.legend, into, box, figure.legend.place);
    });
  }

  // The values of both axes of a panel at a place on the screen, and the place in points.
  at(drawn: Drawn, clientX: number, clientY: number): { values: [number, number]; place: [number, number] } | null {
    const matrix = this.svg.getScreenCTM();
    if (!matrix) return null;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
    const { left, right, top, bottom } = drawn.plane.box;
    const { panel } = drawn;
    return { values: [valueAt(panel.x, left, right, x), valueAt(panel.y, bottom, top, y)], place: [x, y] };
  }

  private panel(panel: Panel, index: number, into: Node, size: [number, number]): Drawn {
    const box = inside(panel, size);
    const [x, y] = [scale(panel.x, box.left, box.right), scale(panel.y, box.bottom, box.top)];
    const k = Math.abs(x(panel.x.limits[0] + 1) - x(panel.x.limits[0]));
    const plane: Plane = { x, y, k, box, clip: `clip-${this.serial}-${index}` };
    const group = into.add("g");
    const frame = {
      x: fixed(box.left), y: fixed(box.top), width: fixed(box.right - box.left), height: fixed(box.bottom - box.top),
    };
    group.add("clipPath", { id: plane.clip }).add("rect", frame);
    if (!panel.bare) drawAxes(panel, group.add("g"), plane);
    drawMarks(panel.marks, group.add("g"), plane);
    if (!panel.bare) group.add("rect", { ...frame, fill: "none", stroke: "black", "stroke-width": 0.7 });
    if (panel.title) {
      const above = { x: fixed((box.left + box.right) / 2), y: fixed(box.top - panel.title_gap) };
      words(group, panel.title, { ...above, "text-anchor": "middle", "font-size": panel.title_size });
    }
    const lines = panel.marks.filter((mark) => mark.kind === "line");
    const legend = panel.legend?.entries.length ? panel.legend : null;
    let place = legend?.place ?? "";
    if (legend && place === "best") place = this.corners[index] ??= emptiest(legend, box, lines, plane);
    if (legend) drawLegend(legend, group, box, place);
    const turn = !panel.bare && panel.x.limits[0] === 0 && panel.x.limits[1] === 360;
    const curves = lines.filter((mark) => mark.points.length > FEWEST);
    return { index, panel, plane, turn, curves, legend: legend?.anchor ? "" : place };
  }
}

// Where a panel is; smaller than its frame if a unit is equally long on both axes.
function inside(panel: Panel, [width, height]: [number, number]): Box {
  const [left, bottom, right, top] = panel.frame;
  const box = { left: left * width, right: right * width, top: (1 - top) * height, bottom: (1 - bottom) * height };
  if (!panel.equal) return box;
  const [wide, high] = [panel.x, panel.y].map(({ limits }) => Math.abs(limits[1] - limits[0])) as [number, number];
  const unit = Math.min((box.right - box.left) / wide, (box.bottom - box.top) / high);
  const [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
  return { left: x - (unit * wide) / 2, right: x + (unit * wide) / 2, top: y - (unit * high) / 2, bottom: y + (unit * high) / 2 };
}

interface Extent {
  rows: number;
  widths: number[];
  step: number;
  wide: number;
  high: number;
}

function extent({ entries, columns, size, spacing, pad }: Legend): Extent {
  const rows = Math.ceil(entries.length / columns);
  const widths = [];
  for (let k = 0; k < columns; k++) {
    const own = entries.slice(k * rows, (k + 1) * rows).map((each) => each.label.replaceAll("$", "").length);
    widths.push((Math.max(0, ...own) * LETTER + 3.5) * size);
  }
  const step = size * (1.1 + spacing);
  return { rows, widths, step, wide: widths.reduce((a, b) => a + b, 0) + size, high: rows * step + pad * size };
}

const CORNERS = ["upper left", "upper right", "lower left", "lower right"];

// The upper left corner of a legend at a named place.
function corner(legend: Legend, place: string, box: Box, { wide, high }: Extent): [number, number] {
  const gap = legend.gap * legend.size;
  const x = place.endsWith("left") ? box.left + gap : place.endsWith("right") ? box.right - wide - gap : (box.left + box.right - wide) / 2;
  return [x, place.startsWith("lower") ? box.bottom - high - gap : box.top + gap];
}

// The corner in which a legend covers least of the curves.
function emptiest(legend: Legend, box: Box, lines: Line[], plane: Plane): string {
  const size = extent(legend);
  const covered = (place: string) => {
    const [left, top] = corner(legend, place, box, size);
    let count = 0;
    for (const { points } of lines) {
      for (const [a, b] of points) {
        if (a === null || b === null) continue;
        const [x, y] = [plane.x(a), plane.y(b)];
        if (x > left && x < left + size.wide && y > top && y < top + size.high) count++;
      }
    }
    return count;
  };
  const counts = CORNERS.map(covered);
  return CORNERS[counts.indexOf(Math.min(...counts))]!;
}

function drawLegend(legend: Legend, parent: Node, box: Box, place: string): void {
  const found = extent(legend);
  const { rows, widths, step, wide, high } = found;
  const { size, anchor } = legend;
  let [x, y] = corner(legend, place, box, found);
  if (anchor) {
    const [across, up] = [box.left + anchor[0] * (box.right - box.left), box.bottom - anchor[1] * (box.bottom - box.top)];
    x = place.endsWith("center") ? across - wide / 2 : across;
    y = place.startsWith("lower") ? up - high : up;
  }
  const group = parent.add("g", { transform: `translate(${fixed(x)} ${fixed(y)})` });
  group.add("rect", { width: fixed(wide), height: fixed(high), fill: "white", stroke: "#a0a0a0", "stroke-width": 0.7 });
  let left = 0.5 * size;
  legend.entries.forEach(({ label, style }, k) => {
    if (k && k % rows === 0) left += widths[k / rows - 1]!;
    const middle = fixed(((k % rows) + 0.5) * step + (legend.pad * size) / 2);
    if (style.kind === "style") {
      if (style.width) group.add("line", { x1: left, x2: left + 2.2 * size, y1: middle, y2: middle, ...stroke(style) });
      if (style.marker) marker(group, style, left + 1.1 * size, middle);
    } else group.add("rect", { x: left, y: middle - 0.4 * size, width: 2.2 * size, height: 0.8 * size, ...filled(style) });
    words(group, label, { x: fixed(left + 2.8 * size), y: fixed(middle + 0.35 * size), "font-size": size });
  });
}
