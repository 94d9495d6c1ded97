// Draws figures, data of camgeo.figure.model, as SVG. Lengths are points, 72 to the inch; nothing
// here decides what is shown. All texts become text nodes: none of them is ever read as markup.

const SVG = "http://www.w3.org/2000/svg";
const POINTS = 72;
const GRID = "#d4d4d4";
const LETTER = 0.58; // width of a letter, in sizes of the text: a generous estimate
const LINE_HEIGHT = 1.2;
let clips = 0;

function make(name, attributes, parent, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text !== undefined) element.textContent = text;
  if (parent) parent.append(element);
  return element;
}

function fixed(value) {
  return Number(value.toFixed(2));
}

// A map of the values of an axis to points between two ends.
function scale(axis, start, end) {
  const of = axis.log ? Math.log10 : (value) => value;
  const [low, high] = axis.limits.map(of);
  return (value) => start + ((of(value) - low) / (high - low)) * (end - start);
}

function ticks(axis, length) {
  if (axis.ticks) return axis.ticks;
  const [low, high] = [Math.min(...axis.limits), Math.max(...axis.limits)];
  const found = [];
  if (axis.log) {
    for (let k = Math.ceil(Math.log10(low) - 1e-9); 10 ** k <= high * (1 + 1e-9); k++) found.push(10 ** k);
    return found;
  }
  const least = (high - low) / Math.max(3, Math.floor(length / 22));
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 2.5, 5, 10].map((each) => each * power).find((each) => each >= least * (1 - 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function numeral(value) {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

// How the numbers at the ticks are written, and the power of ten that they share, if any.
function numerals(axis, places) {
  if (axis.names) return [axis.names, ""];
  if (axis.log) return [places.map((each) => (each < 1e5 && each > 1e-5 ? numeral(each) : each.toExponential(0))), ""];
  const largest = Math.max(...axis.limits.map(Math.abs));
  const power = Math.floor(Math.log10(largest));
  const [least, most] = axis.powers ?? [-4, 7];
  if (power >= least && power < most) return [places.map(numeral), ""];
  return [places.map((each) => numeral(each / 10 ** power)), `×10^${power}`.replace("-", "−")];
}

// Text with subscripts between "$_" and "$".
function words(parent, text, attributes) {
  const element = make("text", attributes, parent);
  let raised = false;
  for (const part of text.split(/(\$_[^$]*\$)/)) {
    if (!part) continue;
    const below = part.startsWith("$_");
    const shift = below ? { dy: "0.25em", "font-size": "0.75em" } : raised ? { dy: "-0.19em" } : {};
    make("tspan", shift, element, below ? part.slice(2, -1) : part);
    raised = below;
  }
  return element;
}

function stroke(style) {
  const found = { stroke: style.width ? style.color : "none", "stroke-width": style.width, fill: "none" };
  if (style.dashes.length) found["stroke-dasharray"] = style.dashes.map((each) => fixed(each * style.width)).join(" ");
  found["stroke-linejoin"] = style.join;
  if (!style.dashes.length) found["stroke-linecap"] = style.cap === "projecting" ? "square" : style.cap;
  return found;
}

function area(style) {
  const found = {
    fill: style.face || "none",
    "fill-rule": "evenodd",
    stroke: style.width && style.edge ? style.edge : "none",
    "stroke-width": style.width,
    opacity: style.opacity,
  };
  if (style.dashes.length) found["stroke-dasharray"] = style.dashes.map((each) => fixed(each * style.width)).join(" ");
  return found;
}

const SHAPES = {
  o: null,
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

function marker(parent, style, x, y) {
  const half = 0.5 * style.size;
  const look = {
    fill: style.face || style.color,
    stroke: style.edge || style.color,
    "stroke-width": fixed(style.edge_width / (style.marker === "o" ? 1 : half)),
  };
  if (style.marker === "o") make("circle", { cx: fixed(x), cy: fixed(y), r: half, ...look }, parent);
  else make("path", { d: SHAPES[style.marker], transform: `translate(${fixed(x)} ${fixed(y)}) scale(${half})`, ...look }, parent);
}

function course(points, place) {
  let path = "";
  let open = false;
  for (const [x, y] of points) {
    if (x === null || y === null) {
      open = false;
      continue;
    }
    path += `${open ? "L" : "M"}${fixed(place.x(x))} ${fixed(place.y(y))}`;
    open = true;
  }
  return path;
}

// Each draws a mark of that kind; `place` has x and y in points, k points per unit, the panel's box.
const DRAW = {
  line(mark, parent, place) {
    const inside = make("g", mark.clipped && place.clip ? { "clip-path": `url(#${place.clip})` } : {}, parent);
    if (mark.style.width && mark.points.length > 1) make("path", { d: course(mark.points, place), ...stroke(mark.style) }, inside);
    if (mark.style.marker) for (const [x, y] of mark.points) if (y !== null) marker(inside, mark.style, place.x(x), place.y(y));
  },
  rule(mark, parent, place) {
    const { left, top, right, bottom } = place.box;
    const at = fixed(mark.axis === "x" ? place.x(mark.at) : place.y(mark.at));
    const ends = mark.axis === "x" ? { x1: at, x2: at, y1: top, y2: bottom } : { x1: left, x2: right, y1: at, y2: at };
    make("line", { ...ends, ...stroke(mark.style), "clip-path": `url(#${place.clip})` }, parent);
  },
  band(mark, parent, place) {
    const pairs = mark.places.map((each, k) => [each, mark.low[k], mark.high[k]]).filter((each) => each[1] !== null);
    const at = (each, end) => (mark.axis === "x" ? [each[0], each[end]] : [each[end], each[0]]);
    const ring = [...pairs.map((each) => at(each, 1)), ...pairs.reverse().map((each) => at(each, 2))];
    make("path", { d: `${course(ring, place)}Z`, ...area(mark.style), "clip-path": `url(#${place.clip})` }, parent);
  },
  area(mark, parent, place) {
    const end = mark.closed ? "Z" : "";
    make("path", { d: mark.rings.map((ring) => course(ring, place) + end).join(""), ...area(mark.style) }, parent);
  },
  circle(mark, parent, place) {
    const [x, y] = mark.centre;
    make("circle", { cx: fixed(place.x(x)), cy: fixed(place.y(y)), r: fixed(mark.radius * place.k), ...area(mark.style) }, parent);
  },
  text(mark, parent, place) {
    const { left, top, right, bottom } = place.box;
    let [x, y] = mark.at;
    if (mark.of === "data") [x, y] = [place.x(x), place.y(y)];
    else [x, y] = [left + x * (right - left), bottom - y * (bottom - top)];
    if (mark.offset) [x, y] = [x + mark.offset[0], y - mark.offset[1]];
    const lines = mark.text.split("\n");
    const step = mark.size * (mark.spacing ?? LINE_HEIGHT);
    // Written upwards, its length lies along what `up` aligns, and its lines along `across`.
    const [along, over] = mark.turned
      ? [{ bottom: "start", baseline: "start", center: "middle", top: "end" }[mark.up], { left: "top", center: "center", right: "bottom" }[mark.across]]
      : [{ left: "start", center: "middle", right: "end" }[mark.across], mark.up];
    const below = { bottom: -0.2 - ((lines.length - 1) * step) / mark.size, baseline: 0, center: 0.35 - ((lines.length - 1) * step) / mark.size / 2, top: 0.8 };
    const first = below[over] * mark.size;
    const anchor = along;
    const group = make("g", { transform: `translate(${fixed(x)} ${fixed(y)})${mark.turned ? " rotate(-90)" : ""}` }, parent);
    const wide = Math.max(...lines.map((line) => line.length)) * LETTER * mark.size;
    if (mark.box && mark.box.ring) make("circle", { r: fixed(0.5 * wide + mark.size * (0.35 + mark.box.pad)), fill: "white", stroke: "black", "stroke-width": 0.7 }, group);
    else if (mark.box) {
      const from = { start: 0, middle: -wide / 2, end: -wide }[anchor];
      make("rect", { x: fixed(from), y: fixed(first - 0.85 * mark.size), width: fixed(wide), height: fixed(lines.length * step), fill: "white", opacity: mark.box.opacity }, group);
    }
    lines.forEach((line, k) => {
      words(group, line, { y: fixed(first + k * step), "text-anchor": anchor, "font-size": mark.size, "font-weight": mark.bold ? "bold" : "normal" });
    });
  },
};

function drawMarks(marks, parent, place) {
  const order = marks.map((mark, k) => [mark, k]).sort((a, b) => a[0].layer - b[0].layer || a[1] - b[1]);
  for (const [mark] of order) DRAW[mark.kind](mark, parent, place);
}

function legend(found, parent, box, curves) {
  const { size, columns } = found;
  const rows = Math.ceil(found.entries.length / columns);
  const widths = [];
  for (let k = 0; k < columns; k++) {
    const own = found.entries.slice(k * rows, (k + 1) * rows).map((each) => each.label.replaceAll("$", "").length);
    widths.push((Math.max(0, ...own) * LETTER + 3.5) * size);
  }
  const step = size * (1.1 + found.spacing);
  const wide = widths.reduce((a, b) => a + b, 0) + size;
  const high = rows * step + found.pad * size;
  const gap = found.gap * size;
  const corners = {
    "upper left": [box.left + gap, box.top + gap],
    "upper right": [box.right - wide - gap, box.top + gap],
    "lower left": [box.left + gap, box.bottom - high - gap],
    "lower right": [box.right - wide - gap, box.bottom - high - gap],
    "upper center": [(box.left + box.right - wide) / 2, box.top + gap],
    "lower center": [(box.left + box.right - wide) / 2, box.bottom - high - gap],
  };
  let [x, y] = corners[found.place] ?? corners["upper left"];
  if (found.anchor) {
    const [across, up] = [box.left + found.anchor[0] * (box.right - box.left), box.bottom - found.anchor[1] * (box.bottom - box.top)];
    x = found.place.endsWith("center") ? across - wide / 2 : across;
    y = found.place.startsWith("lower") ? up - high : up;
  } else if (found.place === "best") {
    const covered = ([a, b]) => curves.filter(([u, v]) => u > a && u < a + wide && v > b && v < b + high).length;
    [x, y] = Object.values(corners).slice(0, 4).reduce((best, each) => (covered(each) < covered(best) ? each : best));
  }
  const group = make("g", { transform: `translate(${fixed(x)} ${fixed(y)})` }, parent);
  make("rect", { width: fixed(wide), height: fixed(high), fill: "white", stroke: "#a0a0a0", "stroke-width": 0.7 }, group);
  let left = 0.5 * size;
  found.entries.forEach((entry, k) => {
    if (k && k % rows === 0) left += widths[k / rows - 1];
    const middle = ((k % rows) + 0.5) * step + (found.pad * size) / 2;
    if (entry.style.kind === "style") {
      if (entry.style.width) make("line", { x1: left, x2: left + 2.2 * size, y1: middle, y2: middle, ...stroke(entry.style) }, group);
      if (entry.style.marker) marker(group, entry.style, left + 1.1 * size, middle);
    } else make("rect", { x: left, y: middle - 0.4 * size, width: 2.2 * size, height: 0.8 * size, ...area(entry.style) }, group);
    words(group, entry.label, { x: fixed(left + 2.8 * size), y: fixed(middle + 0.35 * size), "font-size": size });
  });
}

function axes(panel, parent, box, place) {
  const grid = make("g", { stroke: GRID, "stroke-width": 0.5 }, parent);
  const labels = make("g", { "font-size": 9 }, parent);
  const across = ticks(panel.x, (box.right - box.left) / 1.6);
  const [names] = numerals(panel.x, across);
  across.forEach((at, k) => {
    const x = fixed(place.x(at));
    make("line", { x1: x, x2: x, y1: box.top, y2: box.bottom }, grid);
    if (panel.x.numbered) make("text", { x, y: box.bottom + 11, "text-anchor": "middle" }, labels, names[k]);
  });
  const up = ticks(panel.y, box.bottom - box.top);
  const [heights, power] = numerals(panel.y, up);
  up.forEach((at, k) => {
    const y = fixed(place.y(at));
    make("line", { x1: box.left, x2: box.right, y1: y, y2: y }, grid);
    if (panel.y.numbered) make("text", { x: box.left - 4, y: y + 3, "text-anchor": "end" }, labels, heights[k]);
  });
  if (power) make("text", { x: box.left, y: box.top - 3 }, labels, power);
  const middle = (box.top + box.bottom) / 2;
  words(labels, panel.x.label, { x: (box.left + box.right) / 2, y: box.bottom + 26, "text-anchor": "middle", "font-size": panel.x.label_size });
  const away = box.left - (panel.y.label_place === null ? 40 : panel.y.label_place * POINTS) + 4;
  words(labels, panel.y.label, { transform: `translate(${fixed(away)} ${fixed(middle)}) rotate(-90)`, "text-anchor": "middle", "font-size": panel.y.label_size });
  if (panel.right) {
    const y = scale(panel.right, box.bottom, box.top);
    const found = ticks(panel.right, box.bottom - box.top);
    const [sizes] = numerals(panel.right, found);
    found.forEach((at, k) => {
      make("line", { x1: box.right - 4, x2: box.right, y1: y(at), y2: y(at), stroke: "black", "stroke-width": 0.7 }, parent);
      make("text", { x: box.right + 4, y: fixed(y(at) + 3) }, labels, sizes[k]);
    });
    const beside = box.right + (panel.right.label_place ?? 0.55) * POINTS + 6;
    words(labels, panel.right.label, { transform: `translate(${fixed(beside)} ${fixed(middle)}) rotate(-90)`, "text-anchor": "middle", "font-size": panel.right.label_size });
  }
}

function drawPanel(panel, parent, size) {
  let [left, bottom, right, top] = panel.frame;
  let box = { left: left * size[0], right: right * size[0], top: (1 - top) * size[1], bottom: (1 - bottom) * size[1] };
  if (panel.equal) {
    const [wide, high] = [Math.abs(panel.x.limits[1] - panel.x.limits[0]), Math.abs(panel.y.limits[1] - panel.y.limits[0])];
    const unit = Math.min((box.right - box.left) / wide, (box.bottom - box.top) / high);
    const [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
    box = { left: x - (unit * wide) / 2, right: x + (unit * wide) / 2, top: y - (unit * high) / 2, bottom: y + (unit * high) / 2 };
  }
  const place = { x: scale(panel.x, box.left, box.right), y: scale(panel.y, box.bottom, box.top), box, clip: `clip-${++clips}` };
  place.k = Math.abs(place.x(panel.x.limits[0] + 1) - place.x(panel.x.limits[0]));
  const frame = { x: fixed(box.left), y: fixed(box.top), width: fixed(box.right - box.left), height: fixed(box.bottom - box.top) };
  make("rect", frame, make("clipPath", { id: place.clip }, parent));
  if (!panel.bare) axes(panel, parent, box, place);
  drawMarks(panel.marks, parent, place);
  if (!panel.bare) make("rect", { ...frame, fill: "none", stroke: "black", "stroke-width": 0.7 }, parent);
  if (panel.title) words(parent, panel.title, { x: (box.left + box.right) / 2, y: box.top - panel.title_gap, "text-anchor": "middle", "font-size": panel.title_size });
  const lines = panel.marks.filter((mark) => mark.kind === "line");
  if (panel.legend && panel.legend.entries.length) {
    const curves = lines.flatMap((mark) => mark.points).filter((at) => at[1] !== null).map(([x, y]) => [place.x(x), place.y(y)]);
    legend(panel.legend, parent, box, curves);
  }
  return { panel, box, place, curves: lines.filter((mark) => mark.points.length > 100) };
}

// The figure as an SVG element, and its panels over the cam angle.
function drawFigure(figure, label) {
  const size = figure.size.map((each) => each * POINTS);
  const svg = make("svg", { viewBox: `0 0 ${size[0]} ${size[1]}`, role: "img", "aria-label": label });
  const panels = figure.panels.map((panel) => drawPanel(panel, svg, size));
  const page = { left: 0, right: size[0], top: 0, bottom: size[1] };
  drawMarks(figure.texts, svg, { box: page });
  if (figure.legend) legend(figure.legend, svg, page, []);
  const turns = panels.filter(({ panel }) => !panel.bare && panel.x.limits[0] === 0 && panel.x.limits[1] === 360);
  return { svg, turns };
}
