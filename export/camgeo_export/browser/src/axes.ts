// Ticks, numbers and labels of a panel's axes.

import type { Scale } from "./course";
import type { Axis, Panel } from "./data";
import { type Plane, words } from "./marks";
import { fixed, type Node } from "./svg";

export const POINTS = 72;
const GRID = "#d4d4d4";

// A map of the values of an axis to points between two ends.
export function scale(axis: Axis, start: number, end: number): Scale {
  const of = axis.log ? Math.log10 : (value: number) => value;
  const low = of(axis.limits[0]);
  const k = (end - start) / (of(axis.limits[1]) - low);
  return axis.log ? (value) => start + (Math.log10(value) - low) * k : (value) => start + (value - low) * k;
}

// The value of an axis at a place between its two ends, in points.
export function valueAt(axis: Axis, start: number, end: number, place: number): number {
  const share = (place - start) / (end - start);
  const [low, high] = axis.limits;
  return axis.log ? low * (high / low) ** share : low + share * (high - low);
}

function ticks(axis: Axis, length: number): number[] {
  if (axis.ticks) return axis.ticks;
  const [low, high] = [Math.min(...axis.limits), Math.max(...axis.limits)];
  const found: number[] = [];
  if (axis.log) {
    for (let k = Math.ceil(Math.log10(low) - 1e-9); 10 ** k <= high * (1 + 1e-9); k++) found.push(10 ** k);
    return found;
  }
  const least = (high - low) / Math.max(3, Math.floor(length / 22));
  if (!(least > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * ([1, 2, 2.5, 5].find((each) => each * power >= least * (1 - 1e-9)) ?? 10);
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

const RAISED: Record<string, string> = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

export function numeral(value: number): string {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

// How the numbers at the ticks are written, and the power of ten that they share, if any.
function numerals(axis: Axis, places: number[]): [string[], string] {
  if (axis.names) return [axis.names, ""];
  if (axis.log) return [places.map((each) => (each < 1e5 && each > 1e-5 ? numeral(each) : each.toExponential(0))), ""];
  const power = Math.floor(Math.log10(Math.max(...axis.limits.map(Math.abs))));
  const [least, most] = axis.powers ?? [-4, 7];
  if (power >= least && power < most) return [places.map(numeral), ""];
  return [places.map((each) => numeral(each / 10 ** power)), `×10${[...String(power)].map((each) => RAISED[each] ?? each).join("")}`];
}

export function drawAxes(panel: Panel, parent: Node, { box, x, y }: Plane): void {
  const grid = parent.add("g", { stroke: GRID, "stroke-width": 0.5 });
  const labels = parent.add("g", { "font-size": 9 });
  const across = ticks(panel.x, (box.right - box.left) / 1.6);
  const [names] = numerals(panel.x, across);
  across.forEach((at, k) => {
    const place = fixed(x(at));
    grid.add("line", { x1: place, x2: place, y1: box.top, y2: box.bottom });
    if (panel.x.numbered) labels.add("text", { x: place, y: box.bottom + 11, "text-anchor": "middle" }, names[k]);
  });
  const up = ticks(panel.y, box.bottom - box.top);
  const [heights, power] = numerals(panel.y, up);
  up.forEach((at, k) => {
    const place = fixed(y(at));
    grid.add("line", { x1: box.left, x2: box.right, y1: place, y2: place });
    if (panel.y.numbered) labels.add("text", { x: box.left - 4, y: place + 3, "text-anchor": "end" }, heights[k]);
  });
  if (power) labels.add("text", { x: box.left, y: box.top - 3 }, power);
  const middle = (box.top + box.bottom) / 2;
  words(labels, panel.x.label, {
    x: (box.left + box.right) / 2, y: box.bottom + 26, "text-anchor": "middle", "font-size": panel.x.label_size,
  });
  const sideways = (label: Axis, at: number) => words(labels, label.label, {
    transform: `translate(${fixed(at)} ${fixed(middle)}) rotate(-90)`, "text-anchor": "middle", "font-size": label.label_size,
  });
  sideways(panel.y, box.left - (panel.y.label_place === null ? 40 : panel.y.label_place * POINTS) + 4);
  if (!panel.right) return;
  const other = scale(panel.right, box.bottom, box.top);
  const found = ticks(panel.right, box.bottom - box.top);
  const [sizes] = numerals(panel.right, found);
  found.forEach((at, k) => {
    const place = fixed(other(at));
    parent.add("line", { x1: box.right - 4, x2: box.right, y1: place, y2: place, stroke: "black", "stroke-width": 0.7 });
    labels.add("text", { x: box.right + 4, y: place + 3 }, sizes[k]);
  });
  sideways(panel.right, box.right + (panel.right.label_place ?? 0.55) * POINTS + 6);
}
