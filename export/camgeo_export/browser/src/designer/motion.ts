// The motion plan and the motion diagrams, with the joints to be dragged.

import { Chart } from "../chart";
import type { Figure } from "../data";
import { beside, CHART, chartOf, Extremes } from "./compare";
import { el, fresh, shown } from "../dom";
import { Handles, type View } from "./handles";
import { Laws } from "./laws";
import type { Handle, Chart as Drawable } from "./model";
import { Plan } from "./plan";
import type { Session } from "./session";
import { t } from "./strings";

const SPACE = "plan";

export class MotionView {
  readonly element = el("div", { class: "motion" });
  private readonly chart: Chart;
  private readonly handles: Handles;
  readonly plan: Plan;
  private readonly laws: Laws;
  private readonly table: Extremes;
  private readonly picture: HTMLElement;
  private readonly none = el("p", { hidden: true }, t("motion.none"));
  private readonly sentence = el("p", { class: "sentence", id: fresh() });
  private shown: Drawable | undefined;
  private held: { panel: number; x: [number, number]; y: [number, number] } | null = null;

  constructor(
    private readonly session: Session,
    stop: () => void,
  ) {
    this.chart = new Chart(session.angle, stop);
    this.handles = new Handles(session, SPACE, t("motion.help"), stop);
    this.laws = new Laws(session);
    this.table = new Extremes(session);
    this.plan = new Plan(session, (segment, from) => this.laws.ask(segment, from));
    this.picture = el("div", { class: "picture" }, this.chart.svg, this.handles.layer);
    this.element.append(this.none, this.handles.exact, el("div", { class: "wide", tabindex: 0, role: "group", "aria-label": t("motion.picture") }, this.picture), this.sentence, this.table.element, this.laws.element);
    session.on(["curves", "faults"], () => this.update());
    session.on("moved", () => {
      if (chartOf(session.curves, CHART, "") !== this.shown) this.draw();
    });
  }

  private update(): void {
    this.plan.update(this.session.curves?.plan ?? []);
    this.draw();
  }

  private draw(): void {
    const { curves, pinned, held } = this.session;
    const found = chartOf(curves, CHART, "");
    this.shown = found;
    shown(this.none, !found);
    shown(this.picture, Boolean(found));
    this.picture.classList.toggle("old", this.session.faults.length > 0);
    if (!found) return;
    const handles = (curves?.handles ?? []).filter((each) => each.space === SPACE);
    const figure = this.steady(beside(found.figure, chartOf(pinned, CHART, "")?.figure), handles, held === SPACE);
    this.chart.update({ figure, sentence: found.sentence || found.title }, held === SPACE);
    if (this.sentence.textContent !== found.sentence) this.sentence.textContent = found.sentence;
    this.handles.update(handles, (handle) => this.view(handle));
    this.table.update(found);
  }

  // While a joint is dragged its panel keeps its scales: what is under the pointer stays there.
  private steady(figure: Figure, handles: Handle[], held: boolean): Figure {
    const index = handles[0]?.panel ?? -1;
    const panel = figure.panels[index];
    if (!held || !panel) this.held = panel ? { panel: index, x: panel.x.limits, y: panel.y.limits } : null;
    const own = this.held;
    if (!held || !panel || own?.panel !== index) return figure;
    const kept = { ...panel, x: { ...panel.x, limits: own.x }, y: { ...panel.y, limits: own.y } };
    return { ...figure, panels: figure.panels.map((each, k) => (k === index ? kept : each)) };
  }

  private view(handle: Handle): View | null {
    const { drawing } = this.chart;
    const drawn = drawing.panels[handle.panel ?? -1];
    if (!drawn) return null;
    const { width, height } = drawing.svg.viewBox.baseVal;
    const { box, x, y } = drawn.plane;
    const [xs, ys] = [drawn.panel.x.limits, drawn.panel.y.limits];
    return {
      part: ([a, b]) => [x(a) / width, y(b) / height],
      values: ([a, b]) => drawing.at(drawn, a, b)?.values ?? null,
      pixel: () => {
        const screen = drawing.svg.getBoundingClientRect().width / width || 1;
        return [(xs[1] - xs[0]) / ((box.right - box.left) * screen), (ys[1] - ys[0]) / ((box.bottom - box.top) * screen)];
      },
    };
  }
}

