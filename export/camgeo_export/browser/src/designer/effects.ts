// The effects that can be computed, each switched on or off.

import { el, fresh, type Kept, keyed, say, shown } from "../dom";
import type { Effect } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

export class Effects {
  readonly element = el("div", { class: "effects" });
  private readonly list = el("div", { class: "fields" });
  private readonly none = el("p", { hidden: true }, t("effects.none"));
  private readonly show: (items: readonly Effect[]) => void;

  constructor(private readonly session: Session) {
    this.element.append(this.none, this.list);
    this.show = keyed(this.list, (effect) => effect.name, (effect) => this.row(effect));
    session.on(["effects", "curves"], () => this.update());
  }

  private update(): void {
    const { effects } = this.session;
    shown(this.none, effects.length === 0);
    this.show(effects);
  }

  private row(effect: Effect): Kept<Effect> {
    const id = fresh();
    const box = el("input", { id, type: "checkbox", "data-effect": effect.name, "aria-describedby": `${id}-about` });
    box.addEventListener("change", () => this.session.change({ effect: { name: effect.name, on: box.checked } }));
    const [label, about] = [el("label", { for: id }), el("p", { id: `${id}-about`, class: "about" })];
    return {
      element: el("div", { class: "field flag effect" }, el("div", { class: "entry" }, box, label), about),
      update: (next) => {
        say(label, next.title ?? next.name);
        say(about, next.sentence);
        box.checked = this.session.curves?.effects?.includes(next.name) ?? false;
      },
    };
  }
}
