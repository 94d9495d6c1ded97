// The laws that fit a segment, as pictures to choose from.

import type { Figure, Panel } from "../data";
import { Drawing } from "../figure";
import { button, el, fresh, say } from "../dom";
import type { Law, Segment } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

const SHOWN = 3; // panels: velocity, acceleration, jerk
const [WIDE, HIGH] = [3.2, 1.15]; // inches of the picture, and of each panel with its title

// A law's figure in the shape of a stamp: its first panels above each other, without what the text
// beside the picture says.
function stamp({ panels }: Figure): Figure {
  const high = HIGH * SHOWN;
  const own = panels.slice(0, SHOWN).map((panel, k, all): Panel => {
    const top = 1 - (HIGH * k + 0.3) / high;
    const marks = panel.marks.filter((mark) => mark.kind !== "text");
    const x = { ...panel.x, label: "", numbered: k === all.length - 1 };
    return { ...panel, frame: [0.16, top - (HIGH - 0.5) / high, 0.97, top], marks, x, legend: null };
  });
  return { size: [WIDE, high], panels: own, texts: [], legend: null };
}

export class Laws {
  readonly element: HTMLDialogElement;
  private readonly title: HTMLElement;
  private readonly list = el("ul", { class: "laws-list" });
  private segment: Segment | null = null;

  constructor(private readonly session: Session) {
    const id = fresh();
    this.title = el("h2", { id });
    this.element = el("dialog", { "aria-labelledby": id, class: "laws-dialog" }, this.title, this.list, el("div", { class: "actions" }, button(t("dialog.cancel"), () => this.element.close())));
    session.on("laws", () => this.show());
  }

  ask(segment: Segment, from: HTMLElement): void {
    this.segment = segment;
    this.element.addEventListener("close", () => from.isConnected && from.focus(), { once: true });
    this.session.send({ kind: "laws", segment: segment.index });
  }

  private show(): void {
    const { laws } = this.session;
    if (!laws || !this.segment) return;
    say(this.title, t("laws.title", { n: this.segment.index + 1 }));
    this.list.replaceChildren(...laws.laws.map((law) => el("li", {}, this.choice(law))));
    if (!this.element.open) this.element.showModal();
    this.element.querySelector<HTMLElement>('[aria-pressed="true"]')?.focus();
  }

  private choice(law: Law): HTMLElement {
    const title = law.title ?? law.name;
    const now = law.name === this.segment?.law;
    const facts = (law.facts ?? []).map((each) => `${each.name} ${each.value}`).join("; ");
    const element = button("", () => this.take(law), { class: "law", "aria-pressed": String(now), "data-law": law.name });
    element.append(el("strong", {}, now ? `${title} (${t("laws.now")})` : title));
    if (law.figure) {
      const drawing = new Drawing();
      drawing.update(stamp(law.figure), t("laws.picture", { title }));
      drawing.svg.setAttribute("aria-hidden", "true"); // the button has its name and its facts
      element.append(drawing.svg);
    }
    if (facts) element.append(el("span", { class: "facts" }, facts));
    return element;
  }

  private take(law: Law): void {
    this.element.close();
    if (law.edits) this.session.change({ edits: law.edits });
  }
}
