// The smallest cam that keeps its limits, looked for and taken at a click.

import { button, el, say, shown, table } from "./dom";
import type { Session } from "./session";
import { number, t } from "./strings";

export class SizeView {
  readonly element = el("div", { class: "size" });
  private readonly sentence = el("p", { class: "sentence" });
  private readonly sizes = el("div");
  private readonly take: HTMLButtonElement;

  constructor(private readonly session: Session) {
    this.take = button(t("size.take"), () => this.session.sized?.edits && this.session.change({ sized: this.session.sized.edits }), { id: "take-sizes", hidden: true });
    this.element.append(el("p", {}, t("size.intro")), button(t("size.ask"), () => this.session.send({ kind: "size" }), { id: "find-sizes" }), this.sentence, this.sizes, this.take);
    session.on(["sized", "curves"], () => this.update());
  }

  private update(): void {
    const { sized, revision } = this.session;
    if (!sized) return;
    const old = sized.revision < revision;
    const faults = (sized.faults ?? []).map((each) => each.message).join(" ");
    say(this.sentence, old ? t("size.old") : sized.sentence || faults || t("size.none"));
    shown(this.take, !old && Boolean(sized.edits && Object.keys(sized.edits).length));
    const sizes = sized.sizes ?? [];
    shown(this.sizes, sizes.length > 0);
    const text = JSON.stringify(sizes);
    if (this.sizes.dataset["shown"] === text) return;
    this.sizes.dataset["shown"] = text;
    const stated = (value: number | null | undefined, unit = ""): string => (value === null || value === undefined ? "" : `${number(value)} ${unit}`.trim());
    const rows = sizes.map((each) => [each.title ?? each.label ?? each.key ?? "", stated(each.now, each.unit), stated(each.value, each.unit)]);
    this.sizes.replaceChildren(table(t("size.title"), [t("size.size"), t("size.now"), t("size.found")], rows, [1, 2]));
  }
}
