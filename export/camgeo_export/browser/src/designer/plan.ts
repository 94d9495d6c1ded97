// The motion plan as a table: a row for each segment, with its fields and what can be done with it.

import { attribute, button, el, type Kept, keyed, say, shown } from "../dom";
import { FieldView } from "./field";
import type { Field, Segment } from "./model";
import type { Session } from "./session";
import { type Key, number, t, told } from "./strings";

// What can be done with a segment, in the order of the buttons.
const ACTIONS = ["insert", "split", "up", "down", "remove", "to-dwell", "to-move"] as const;

const MAIN = /(^|\.)(dwell|span|to|law)$/; // keys that are shown at once, stated or not

export class Plan {
  readonly element: HTMLElement;
  private readonly show: (items: readonly Segment[]) => void;
  private readonly hidden: HTMLElement;

  constructor(
    private readonly session: Session,
    private readonly chooseLaw: (segment: Segment, from: HTMLElement) => void,
  ) {
    const body = el("tbody");
    const heads = (["plan.number", "plan.kind", "plan.from", "plan.to", "plan.values"] as Key[]).map((key) => el("th", { scope: "col" }, t(key)));
    this.hidden = el("p", { hidden: true }, t("motion.none"));
    this.element = el(
      "div",
      { class: "wide plan", role: "group", tabindex: 0, "aria-label": t("plan.title") },
      el("table", {}, el("thead", {}, el("tr", {}, ...heads)), body),
      this.hidden,
    );
    this.show = keyed(body, (segment) => `${segment.index} ${segment.kind}`, (segment) => this.row(segment));
  }

  update(segments: Segment[]): void {
    const focus = document.activeElement;
    const row = this.element.contains(focus) ? focus?.closest("tr")?.dataset["segment"] : undefined;
    this.show(segments);
    if (row !== undefined && !focus?.isConnected) this.keep(Number(row), (focus as HTMLElement).dataset["action"]);
    shown(this.hidden, segments.length === 0);
    const rows = [...this.element.querySelectorAll("tbody tr")];
    rows.forEach((row, k) => {
      for (const [action, end] of [["up", 0], ["down", rows.length - 1]] as const) {
        const found = row.querySelector<HTMLButtonElement>(`[data-action="${action}"]`);
        if (found) found.disabled = k === end;
      }
      const remove = row.querySelector<HTMLButtonElement>('[data-action="remove"]');
      if (remove) remove.disabled = rows.length < 2;
    });
  }

  // The focus goes on in the row that is in the place of one that is gone, at the same button.
  private keep(index: number, action = ""): void {
    const rows = this.element.querySelectorAll("tbody tr");
    const row = rows[Math.min(index, rows.length - 1)];
    const same = row?.querySelector<HTMLElement>(`[data-action="${action}"]`);
    (same ?? row?.querySelector<HTMLElement>("button:not([hidden])"))?.focus();
  }

  private row(segment: Segment): Kept<Segment> {
    let now = segment;
    const n = segment.index + 1;
    const [from, to] = [el("td", { class: "number" }), el("td", { class: "number" })];
    const fields = el("div", { class: "fields" });
    const rest = el("div", { class: "fields" });
    const more = el("details", {}, el("summary", { "aria-label": t("plan.more-label", { n }) }, t("plan.more")), rest);
    const [list, others] = [fields, rest].map((holder) =>
      keyed<Field>(holder, (field) => `${field.key} ${field.type}`, (field) => {
        return new FieldView(this.session, field, { compact: true, slider: false, name: `${field.title}, ${t("plan.segment", { n })}` });
      }),
    );
    const laws = button(t("plan.laws"), () => this.chooseLaw(now, laws), { "aria-label": t("plan.laws-label", { n }), class: "laws" });
    const actions = ACTIONS.filter((action) => !(action === "to-dwell" && segment.kind === "dwell") && !(action === "to-move" && segment.kind === "move"));
    const buttons = actions.map((action) =>
      button(t(`plan.${action}`), () => this.session.change({ segment: { action, at: now.index } }), { "data-action": action, "aria-label": t(`plan.${action}-label`, { n }) }),
    );
    const element = el(
      "tr",
      { "data-segment": segment.index },
      el("th", { scope: "row" }, String(n)),
      el("td", {}, told(`plan.kind-${segment.kind}`, segment.kind)),
      from,
      to,
      el("td", {}, fields, el("div", { class: "actions" }, laws, ...buttons), more),
    );
    return {
      element,
      update: (next) => {
        now = next;
        say(from, next.from === null ? "" : `${number(next.from)}°`);
        say(to, next.to === null ? "" : `${number(next.to)}°`);
        const first = next.fields.filter((field) => field.stated !== false || MAIN.test(field.key));
        const second = next.fields.filter((field) => !first.includes(field));
        list?.(first);
        others?.(second);
        shown(more, second.length > 0);
        shown(laws, next.fields.some((field) => /(^|\.)law$/.test(field.key)));
        attribute(element, "class", this.session.faultsAt(`motion[${next.index + 1}]`).length > 0 ? "faulty" : null);
      },
    };
  }
}
