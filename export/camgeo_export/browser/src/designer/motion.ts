// The motion plan and the motion diagrams, with the joints to be dragged.

import { Chart } from "../chart";
import type { Figure, Panel } from "../data";
import { beside, CHART, chartOf, Extremes, within } from "./compare";
import { el, fresh, say, shown } from "../dom";
import { Handles, type View } from "./handles";
import { Laws } from "./laws";
import type { Handle, Chart as Drawable } from "./model";
import { Plan } from "./plan";
import type { Session } from "./session";
import { t } from "./strings";

const SPACE = "plan";
const MORE = 0.25; // of the range that is shown, where there was no room for it

// Limits in which what needs `now` has room: those from `before`, or wider ones.
function roomy(before: [number, number], now: [number, number]): [number, number] {
  const more = MORE * (now[1] - now[0]);
  return [now[0] < before[0] ? now[0] - more : before[0], now[1] > before[1] ? now[1] + more : before[1]];
}

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
  private steadied: Panel[] = []; // as they were drawn last

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
    this.picture.classList.toggle("old", this.session.stale);
    if (!found) return;
    const handles = (curves?.handles ?? []).filter((each) => each.space === SPACE);
    const figure = this.steady(beside(found.figure, chartOf(pinned, CHART, "")?.figure), handles, held === SPACE);
    this.chart.update({ figure, sentence: found.sentence || found.title }, held === SPACE);
    if (!held) say(this.sentence, found.sentence);
    this.handles.update(handles, (handle) => this.view(handle));
    this.table.update(found);
  }

  // While a joint is dragged its panel keeps its place and scales: what is under the pointer stays
  // there. The other panels keep theirs as long as there is room in them.
  private steady(figure: Figure, handles: Handle[], held: boolean): Figure {
    const plan = handles[0]?.panel ?? -1;
    const same = held && this.steadied.length === figure.panels.length;
    this.steadied = !same ? figure.panels : figure.panels.map((panel, k) => {
      const { frame, y } = this.steadied[k]!;
      return { ...within(panel, k === plan ? y.limits : roomy(y.limits, panel.y.limits)), frame };
    });
    return { ...figure, panels: this.steadied };
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

