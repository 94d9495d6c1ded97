// Makes the files of the scene, and offers them for download.

import { button, el, say, shown, table } from "../dom";
import type { Session } from "./session";
import { number, t } from "./strings";
import { worded } from "./text";

const FORMATS = "output.formats"; // the key of the scene with what it asks for

export class Build {
  readonly element = el("div", { class: "build" });
  private readonly formats = el("fieldset", {}, el("legend", {}, t("build.formats")));
  private readonly said = el("p", { class: "sentence" });
  private readonly files = el("div");
  private listed: object | null = null; // what the files are of

  constructor(private readonly session: Session) {
    this.element.append(el("p", {}, t("build.intro")), this.formats, button(t("build.build"), () => this.build(), { id: "build-files", class: "main" }), this.said, this.files);
    session.on(["built", "curves"], () => this.update());
    session.on(["state", "curves"], () => this.offer());
  }

  private build(): void {
    const boxes = [...this.formats.querySelectorAll<HTMLInputElement>("input")];
    const ticked = boxes.filter((box) => box.checked).map((box) => box.value);
    // As the scene lists them: the certificate has files in this order.
    const formats = [...this.asked().filter((each) => ticked.includes(each)), ...ticked.filter((each) => !this.asked().includes(each))];
    this.session.send({ kind: "build", ...(boxes.length ? { formats } : {}) });
  }

  // What the scene asks for, in its order.
  private asked(): string[] {
    const stated = this.session.curves?.form?.flatMap((section) => section.fields).find((field) => field.key === FORMATS)?.value;
    return Array.isArray(stated) ? stated.map(String) : [];
  }

  // A box for each format; those that the scene asks for are ticked.
  private offer(): void {
    const formats = this.session.state?.formats ?? [];
    const asked = this.asked();
    const text = JSON.stringify([formats, asked]);
    shown(this.formats, formats.length > 0);
    if (this.formats.dataset["shown"] === text) return;
    this.formats.dataset["shown"] = text;
    const boxes = formats.map((each) => el("label", { class: "box" }, el("input", { type: "checkbox", value: each, checked: asked.includes(each) || !asked.length }), ` ${each}`));
    this.formats.replaceChildren(el("legend", {}, t("build.formats")), ...boxes);
  }

  private update(): void {
    const { built, revision } = this.session;
    if (!built) return;
    const old = built.revision < revision;
    this.files.classList.toggle("old", old);
    say(this.said, old ? t("build.old") : built.message || built.faults.map(worded).join("; ") || t(built.files.length ? "build.done" : "build.none", { n: built.files.length }));
    this.said.classList.toggle("bad", !old && built.faults.length > 0);
    if (this.listed === built) return;
    this.listed = built;
    const stated = (value: number | null | undefined): string => (value === null || value === undefined ? "" : number(value, 3));
    const rows = built.files.map((file) => [el("a", { href: file.url, download: file.name }, file.name), t("build.bytes", { n: file.size.toLocaleString("en") }), stated(file.deviation), stated(file.tolerance)]);
    const unit = this.session.curves?.unit ?? "";
    const heads = [t("build.file"), t("build.size"), t("build.deviation", { unit }), t("build.tolerance", { unit })];
    const findings = built.findings.map((each) => el("li", {}, `! ${each}`));
    this.files.replaceChildren(rows.length ? table(t("build.title"), heads, rows, [1, 2, 3]) : "", findings.length ? el("ul", { class: "list" }, ...findings) : "");
  }
}
