// The diagrams but that of the motion: each with a cursor at the cam angle, its sentence and its table.

import { Chart } from "../chart";
import { beside, CHART, chartOf, Extremes } from "./compare";
import { el, type Kept, keyed, say, shown } from "../dom";
import type { Chart as Drawable } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

export class Charts {
  readonly element = el("div", { class: "charts" });
  private readonly none = el("p", { hidden: true }, t("charts.none"));
  private readonly list = el("div", { class: "cards" });
  private readonly show: (items: readonly Drawable[]) => void;

  constructor(
    private readonly session: Session,
    private readonly stop: () => void,
  ) {
    this.element.append(this.none, this.list);
    this.show = keyed(this.list, (chart) => `${chart.name} ${chart.title}`, (chart) => this.card(chart));
    session.on(["curves", "moved", "findings"], () => this.update());
  }

  private update(): void {
    const charts = [...(this.session.curves?.charts ?? []), ...(this.session.findings?.charts ?? [])].filter((chart) => chart.name !== CHART);
    shown(this.none, charts.length === 0);
    this.element.classList.toggle("old", this.session.stale);
    this.show(charts);
  }

  // A diagram is drawn only while it is to be seen.
  private card(first: Drawable): Kept<Drawable> {
    const own = new Chart(this.session.angle, this.stop);
    own.svg.setAttribute("aria-label", first.title);
    const sentence = el("span");
    const extremes = new Extremes(this.session);
    const element = el("figure", { class: "chart", "data-chart": first.name }, own.svg, el("figcaption", {}, el("strong", {}, first.title), ": ", sentence), extremes.element);
    let now = first;
    let seen = false;
    let stale = true;
    const draw = (): void => {
      stale = !seen;
      if (!seen && this.session.held) return; // it follows when the drag ends
      say(sentence, now.sentence);
      extremes.update(now);
      if (!seen) return;
      const pinned = chartOf(this.session.pinned, now.name, now.title);
      own.update({ figure: beside(now.figure, pinned?.figure), sentence: now.sentence }, this.session.held !== "");
    };
    new IntersectionObserver((entries) => {
      seen = entries.at(-1)?.isIntersecting ?? false;
      if (seen && stale) draw();
    }, { rootMargin: "100px" }).observe(element);
    return {
      element,
      update: (next) => {
        now = next;
        draw();
      },
    };
  }
}
