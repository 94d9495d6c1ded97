// The smallest cam that keeps its limits, looked for and taken at a click.

import { button, el, say, shown, table } from "../dom";
import type { Session } from "./session";
import { number, t, told } from "./strings";

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
    const unit = this.session.curves?.unit ?? "";
    const names = [...new Set(sizes.flatMap((each) => Object.keys(each)))].filter((name) => name !== "name");
    const stated = (value: number | string | null | undefined): string => (typeof value === "number" ? number(value) : (value ?? ""));
    const rows = names.map((name) => [told(`size.${name}`, name.replaceAll("_", " ")).replace("{unit}", unit), ...sizes.map((each) => stated(each[name]))]);
    this.sizes.replaceChildren(table(t("size.title"), [t("size.size"), ...sizes.map((each) => each.name)], rows, [1, 2, 3]));
  }
}
