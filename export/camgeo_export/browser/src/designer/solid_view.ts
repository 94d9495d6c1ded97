// The solid in three dimensions, made when it is asked for.

import { singles, Solid } from "../solid";
import { button, el, say, shown } from "./dom";
import type { Session } from "./session";
import { type Key, PLAYER, t } from "./strings";

const VIEWS = ["left", "right", "up", "down", "closer", "farther", "back"] as const;

export class SolidView {
  readonly element = el("div", { class: "solid" });
  private readonly ask: HTMLButtonElement;
  private readonly said = el("p", { class: "sentence" });
  private readonly bodies = el("div");
  private shown: Solid[] = [];

  constructor(private readonly session: Session) {
    this.ask = button(t("solid.show"), () => session.send({ kind: "solid" }), { id: "show-solid" });
    this.element.append(this.ask, this.said, this.bodies);
    session.on("solid", () => this.draw());
    session.on(["solid", "curves"], () => this.tell());
  }

  private tell(): void {
    const { solid, revision } = this.session;
    if (!solid) return;
    const old = solid.revision < revision;
    say(this.ask, t(old ? "solid.again" : "solid.show"));
    say(this.said, old ? t("solid.old") : solid.solids.length ? "" : t("solid.none"));
    this.bodies.classList.toggle("old", old);
  }

  private draw(): void {
    for (const each of this.shown) each.dispose();
    this.shown = [];
    this.bodies.replaceChildren();
    for (const { name, places } of this.session.solid?.solids ?? []) {
      const canvas = el("canvas", { width: 1280, height: 800, role: "img", "aria-label": t("solid.label", { name }) });
      const views = el("div", { class: "actions", role: "group", "aria-label": t("view.of", { name }) });
      this.bodies.append(el("figure", {}, canvas, views, el("figcaption", {}, name)));
      const solid = Solid.on(canvas);
      if (!solid) {
        canvas.replaceWith(PLAYER.noWebGL);
        shown(views, false);
        continue;
      }
      this.shown.push(solid);
      solid.show(singles(places));
      views.append(...VIEWS.map((way) => button(t(`view.${way}` as Key), () => solid.go(way), { value: way })));
    }
  }
}
