// The text of the scene: edited beside the picture, with its faults at their lines.

import { attribute, button, el, say, shown } from "../dom";
import type { Fault } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

// A fault in words: its key with the value that is wrong, what is wrong, and what may help.
export function worded({ key, value, message, hint }: Fault): string {
  const place = key && !message.includes(key) ? `${key}${value ? ` = ${String(value)}` : ""}: ` : "";
  return `${place}${message}${hint ? ` ${hint}` : ""}`;
}

const REST = 250; // milliseconds without a key before what was typed is sent
const APART = 150; // least milliseconds between two pictures of the text
const MOST = 4000; // lines that are numbered

export class TextEditor {
  readonly element = el("div", { class: "text" });
  readonly area: HTMLTextAreaElement;
  private readonly gutter = el("div", { class: "gutter", "aria-hidden": "true" });
  private readonly list = el("div", { class: "faults", id: "faults" });
  private readonly said = el("p", { class: "sentence" });
  private timer = 0;
  private late = 0; // timer of a picture that is due
  private shown = -APART; // when it was drawn last
  private typed = false; // and not yet sent
  private waiting = ""; // what was sent last
  private gesture: string | null = null;
  private lines = -1;
  private seen = false;

  constructor(private readonly session: Session) {
    this.area = el("textarea", { id: "text-area", spellcheck: "false", autocomplete: "off", autocapitalize: "off", wrap: "off", rows: 24, "aria-label": t("text.label"), "aria-describedby": "faults" });
    this.area.addEventListener("input", () => {
      this.typed = true;
      this.number();
      clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.flush(), REST);
    });
    // The browser itself takes a second for each few hundred lines that it pastes.
    this.area.addEventListener("paste", (event) => {
      const pasted = event.clipboardData?.getData("text/plain");
      if (!pasted) return;
      event.preventDefault();
      this.area.setRangeText(pasted, this.area.selectionStart, this.area.selectionEnd, "end");
      this.area.dispatchEvent(new Event("input"));
    });
    this.area.addEventListener("blur", () => {
      this.flush();
      this.gesture = null;
    });
    this.area.addEventListener("scroll", () => {
      this.gutter.scrollTop = this.area.scrollTop;
    });
    new IntersectionObserver((entries) => {
      this.seen = entries.at(-1)?.isIntersecting ?? false;
    }).observe(this.area);
    this.element.append(this.said, this.list, el("div", { class: "editor" }, this.gutter, this.area));
  }

  // Sends what was typed and not yet sent.
  flush(): void {
    clearTimeout(this.timer);
    if (!this.typed) return;
    this.typed = false;
    this.waiting = this.area.value;
    this.gesture ??= this.session.gesture();
    this.session.write(this.waiting, this.gesture);
  }

  // A new step to undo begins.
  rest(): void {
    this.flush();
    this.gesture = null;
  }

  // Follows the scene, though not with each frame of a drag, and not before its end if it is not seen.
  update(): void {
    if (this.session.held && !this.seen) return;
    const wait = this.shown + APART - performance.now();
    clearTimeout(this.late);
    if (wait > 0) this.late = window.setTimeout(() => this.follow(), wait);
    else this.follow();
  }

  private follow(): void {
    this.shown = performance.now();
    const { text } = this.session;
    const late = this.typed || (document.activeElement === this.area && this.waiting !== "" && text !== this.waiting && this.session.waits);
    if (!late && this.area.value !== text) {
      const { selectionStart, selectionEnd, scrollTop } = this.area;
      this.area.value = text;
      this.area.setSelectionRange(selectionStart, selectionEnd);
      this.area.scrollTop = scrollTop;
    }
    this.number();
    this.faults();
  }

  private faults(): void {
    const { faults, refused, known } = this.session;
    const sentence = [refused && t("text.refused", { message: refused }), faults.length ? t("text.faults", { n: faults.length }) : ""].filter(Boolean).join(" ");
    const judged = known && known.severity !== "waiting" && known.severity !== "unknown";
    say(this.said, sentence || (judged ? t("text.fault-none") : (known?.sentence ?? t("findings.waiting"))));
    this.said.classList.toggle("bad", sentence !== "");
    attribute(this.area, "aria-invalid", faults.length ? "true" : null);
    const told = JSON.stringify(faults);
    if (this.list.dataset["shown"] === told) return;
    this.list.dataset["shown"] = told;
    shown(this.list, faults.length > 0);
    const items = faults.map((fault) => {
      const line = fault.line;
      const where = line ? button(t("text.fault-at", { line }), () => this.go(line)) : null;
      return el("li", {}, where, el("span", {}, ` ${worded(fault)}`));
    });
    this.list.replaceChildren(el("ul", { class: "list" }, ...items));
    this.lines = -1;
    this.number();
  }

  private number(): void {
    const count = this.area.value.split("\n").length;
    if (count === this.lines) return;
    this.lines = count;
    const bad = new Set(this.session.faults.map((fault) => fault.line));
    const numbers = Array.from({ length: Math.min(count, MOST) }, (_, k) => el("div", bad.has(k + 1) ? { class: "bad" } : {}, bad.has(k + 1) ? `${t("text.mark")} ${k + 1}` : String(k + 1)));
    this.gutter.replaceChildren(...numbers);
    this.gutter.scrollTop = this.area.scrollTop;
  }

  private go(line: number): void {
    const before = this.area.value.split("\n").slice(0, line - 1).join("\n").length;
    const start = line > 1 ? before + 1 : 0;
    const end = this.area.value.indexOf("\n", start);
    this.area.focus();
    this.area.setSelectionRange(start, end < 0 ? this.area.value.length : end);
    const high = this.area.scrollHeight / Math.max(1, this.lines);
    this.area.scrollTop = Math.max(0, (line - 4) * high);
  }
}
