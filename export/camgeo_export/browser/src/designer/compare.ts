// A pinned variant beside the present one: its curves behind them in grey, and their numbers.

import type { Area, Axis, Figure, Line, Panel } from "../data";
import { el, shown, table } from "../dom";
import { written } from "./field";
import type { Chart, Curves, Field, Reading } from "./model";
import type { Session } from "./session";
import { number, PLAYER, t } from "./strings";

export const CHART = "motion"; // the diagram that has joints

export const GREY = "#8a9099";
const BEHIND = 0.5; // layer

// Curves as areas without a face: they are drawn, but have no value at the cursor.
function ghost(line: Line): Area {
  const style = { kind: "fill" as const, face: "", edge: GREY, width: Math.min(1.2, line.style.width), dashes: [], hatched: false, opacity: 1 };
  return { kind: "area", rings: [line.points], style, label: "", layer: BEHIND, closed: false };
}

function lines(panel: Panel): Line[] {
  return panel.marks.filter((mark): mark is Line => mark.kind === "line" && mark.style.width > 0 && mark.points.length > 1);
}

// A panel with other limits, its second scale stretched with them.
export function within(panel: Panel, limits: [number, number]): Panel {
  const [low, high] = panel.y.limits;
  if (panel.y.log || low >= high || limits[0] >= limits[1]) return panel;
  const y = { ...panel.y, limits };
  if (!panel.right) return { ...panel, y };
  const [a, b] = panel.right.limits;
  const right = limits.map((each) => a + ((each - low) / (high - low)) * (b - a)) as [number, number];
  return { ...panel, y, right: { ...panel.right, limits: right } };
}

const alike = (one: Axis, two: Axis): boolean => one.limits[0] === two.limits[0] && one.limits[1] === two.limits[1];

// The figure with the curves of another one behind those of its panels that are over the same range.
export function beside(figure: Figure, pinned: Figure | undefined): Figure {
  if (!pinned || pinned.panels.length !== figure.panels.length) return figure;
  const panels = figure.panels.map((panel, k) => {
    const other = pinned.panels[k];
    if (!other || panel.bare || other.bare || panel.equal || !alike(panel.x, other.x) || panel.y.label !== other.y.label) return panel;
    const [one, two] = [panel.y.limits, other.y.limits];
    const both = within(panel, two[0] < two[1] ? [Math.min(one[0], two[0]), Math.max(one[1], two[1])] : one);
    return { ...both, marks: [...lines(other).map(ghost), ...panel.marks] };
  });
  return { ...figure, panels };
}

export const chartOf = (curves: Curves | null, name: string, title: string): Chart | undefined => curves?.charts?.find((each) => each.name === name && each.title === title) ?? curves?.charts?.find((each) => each.name === name);

export const plain = (text: string): string => text.replace(/\$_?/g, "");

export function reading(value: number | string | null): string {
  return typeof value === "number" ? number(value, 5) : value === null ? "∞" : value;
}

function fields(curves: Curves): Map<string, { name: string; field: Field }> {
  const found = new Map<string, { name: string; field: Field }>();
  for (const section of curves.form ?? []) for (const field of section.fields) found.set(field.key, { name: t("form.field", { section: section.title, title: field.title }), field });
  return found;
}

const extremes = (curves: Curves): Map<string, Reading> => new Map((curves.charts ?? []).flatMap((chart) => chart.readings.map((each) => [`${chart.title}, ${plain(each.name)}`, each] as const)));

// The extremes of a diagram as a table, with those of the pinned variant beside them.
export class Extremes {
  private readonly rows = el("div");
  readonly element = el("details", {}, el("summary", {}, PLAYER.extremes), this.rows);
  private chart: Chart | null = null;

  constructor(private readonly session: Session) {
    this.element.addEventListener("toggle", () => this.draw());
  }

  update(chart: Chart): void {
    this.chart = chart;
    shown(this.element, chart.readings.length > 0);
    this.draw();
  }

  private draw(): void {
    const { chart } = this;
    if (!chart || !this.element.open) return;
    const pinned = new Map(chartOf(this.session.pinned, chart.name, chart.title)?.readings.map((each) => [each.name, each]) ?? []);
    const heads = [...PLAYER.extremesOf];
    if (pinned.size) heads.push(t("charts.pinned-low"), t("charts.pinned-high"));
    heads.push(t("charts.limits"));
    const row = (each: Reading): string[] => {
      const twin = pinned.get(each.name);
      const cells = [plain(each.name), reading(each.low), `${number(each.low_at, 5)}°`, reading(each.high), `${number(each.high_at, 5)}°`];
      if (pinned.size) cells.push(twin ? reading(twin.low) : "", twin ? reading(twin.high) : "");
      return [...cells, each.limits.map(([name, value]) => `${plain(name)}: ${reading(value)}`).join("; ")];
    };
    const numeric = pinned.size ? [1, 2, 3, 4, 5, 6] : [1, 2, 3, 4];
    this.rows.replaceChildren(table(t("charts.table-of", { title: chart.title }), heads, chart.readings.map(row), numeric));
  }
}

export class Comparison {
  readonly element = el("div", { class: "comparison", hidden: true });

  constructor(private readonly session: Session) {}

  update(): void {
    const { curves, pinned } = this.session;
    if (this.session.held) return;
    shown(this.element, pinned !== null);
    if (!pinned || !curves) return this.element.replaceChildren();
    const [now, then] = [fields(curves), fields(pinned)];
    const of = (each: { field: Field } | undefined): string => (each ? `${written(each.field.value ?? each.field.default ?? null)} ${each.field.unit ?? ""}`.trim() || t("form.none") : t("form.none"));
    const rows: string[][] = [];
    for (const key of new Set([...now.keys(), ...then.keys()])) {
      const [a, b] = [now.get(key), then.get(key)];
      if (of(a) !== of(b)) rows.push([(a ?? b)?.name ?? key, of(a), of(b)]);
    }
    const [own, other] = [extremes(curves), extremes(pinned)];
    for (const [name, each] of own) {
      const twin = other.get(name);
      if (!twin) continue;
      const pair = (found: Reading): string => `${reading(found.low)} … ${reading(found.high)}`;
      if (pair(each) !== pair(twin)) rows.push([name, pair(each), pair(twin)]);
    }
    const heads = [t("compare.what"), t("compare.now"), t("compare.pinned")];
    this.element.replaceChildren(
      el("p", {}, t("pin.note")),
      rows.length ? table(t("compare.title"), heads, rows, [1, 2]) : el("p", {}, t("compare.same")),
    );
  }
}

