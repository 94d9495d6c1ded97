// The solid in three dimensions, made when it is asked for.

import type { Solid } from "../solid";
import { button, el, say, shown } from "../dom";
import type { Session } from "./session";
import { type Key, PLAYER, t } from "./strings";

const VIEWS = ["left", "right", "up", "down", "closer", "farther", "back"] as const;

let script: Promise<boolean> | null = null;

// Whether the script that draws solids is there; it is loaded when the first one is wanted.
function loaded(): Promise<boolean> {
  script ??= new Promise((resolve) => {
    const error = (): void => {
      script = null; // to be tried again
      resolve(false);
    };
    document.head.append(el("script", { src: "solid.js", load: () => resolve(true), error }));
  });
  return script;
}

export class SolidView {
  readonly element = el("div", { class: "solid" });
  private readonly ask: HTMLButtonElement;
  private readonly said = el("p", { class: "sentence" });
  private readonly bodies = el("div");
  private shown: Solid[] = [];

  constructor(private readonly session: Session) {
    this.ask = button(t("solid.show"), () => this.request(), { id: "show-solid" });
    this.element.append(this.ask, this.said, this.bodies);
    session.on("solid", () => void this.draw());
    session.on(["solid", "curves"], () => this.tell());
  }

  private request(): void {
    this.session.send({ kind: "solid" });
    void loaded(); // meanwhile
  }

  private tell(): void {
    const { solid, revision } = this.session;
    if (!solid) return;
    const old = solid.revision < revision;
    say(this.ask, t(old ? "solid.again" : "solid.show"));
    say(this.said, old ? t("solid.old") : solid.solids.length ? "" : t("solid.none"));
    this.bodies.classList.toggle("old", old);
  }

  private async draw(): Promise<void> {
    const own = this.session.solid;
    const there = await loaded();
    if (this.session.solid !== own) return; // a later one is drawn
    for (const each of this.shown) each.dispose();
    this.shown = [];
    this.bodies.replaceChildren(there ? "" : t("solid.not-loaded"));
    if (!there) return;
    for (const { name, places } of own?.solids ?? []) {
      const canvas = el("canvas", { width: 1280, height: 800, role: "img", "aria-label": t("solid.label", { name }) });
      const views = el("div", { class: "actions", role: "group", "aria-label": t("view.of", { name }) });
      this.bodies.append(el("figure", {}, canvas, views, el("figcaption", {}, name)));
      const solid = camgeoSolid.Solid.on(canvas);
      if (!solid) {
        canvas.replaceWith(PLAYER.noWebGL);
        shown(views, false);
        continue;
      }
      this.shown.push(solid);
      solid.show(camgeoSolid.singles(places));
      views.append(...VIEWS.map((way) => button(t(`view.${way}` as Key), () => solid.go(way), { value: way })));
    }
  }
}
