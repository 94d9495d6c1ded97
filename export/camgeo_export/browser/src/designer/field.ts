// One value of the scene: its label, a field for exact entry, a slider where there is a range.

import { attribute, button, el, fresh, type Kept, say, shown } from "../dom";
import type { Change, Chosen, Field, Value } from "./model";
import type { Session } from "./session";
import { number, t } from "./strings";

export interface Ways {
  nudges?: boolean; // buttons for a little less and more
  slider?: boolean;
  compact?: boolean; // without its description and faults
  change?: (key: string, value: Value) => Change | null; // that a value asks for, if not that of its key
  name?: string; // the whole of its name, where the label alone says too little
}

// A value as it stands in a text field.
export function written(value: Value): string {
  if (value === null) return "";
  if (Array.isArray(value)) return value.map((each) => (typeof each === "object" ? JSON.stringify(each) : String(each))).join(", ");
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

// What a list means that was written; null if it means none.
function list(text: string): Value | null {
  try {
    const bare = text.trim().replace(/^\[|\]$/g, "");
    return JSON.parse(`[${bare}]`) as Value;
  } catch {
    const parts = text.split(",").map((each) => each.trim());
    return parts.every(Boolean) ? parts : null;
  }
}

function choices(field: Field): Chosen[] {
  return (field.choices ?? []).map((each) => ({ value: String(each) }));
}

// Whether a number or one of some words is to be entered.
function mixed(field: Field): boolean {
  const limits = typeof field.low === "number" || typeof field.high === "number";
  return (field.type === "number" && choices(field).length > 0) || (field.type === "choice" && limits);
}

// A step for the arrow keys and buttons: a round hundredth of the value, or that of the slider.
export function stepOf(field: Field): number {
  if (field.slider) return field.slider[2];
  const size = Math.abs(Number(field.value ?? field.default ?? 1)) || 1;
  return 10 ** Math.floor(Math.log10(size / 10));
}

// The sum without the digits that binary fractions add.
export function stepped(value: number, by: number): number {
  return Number((value + by).toPrecision(12));
}

type Input = HTMLInputElement | HTMLSelectElement;

export class FieldView implements Kept<Field> {
  readonly element: HTMLElement;
  readonly input: Input;
  private readonly label: HTMLLabelElement;
  private readonly unit: HTMLElement;
  private readonly note: HTMLElement;
  private readonly hint: HTMLElement;
  private readonly slider: HTMLInputElement | null = null;
  private readonly reset: HTMLButtonElement | null = null;
  private field: Field;
  private words: HTMLDataListElement | null = null;
  private dirty = false;
  private dragging = false;
  private reverts = true; // what is in the field may not be what was shown last
  private whole = ""; // what was shown last
  private gesture: string | null = null;
  private rest = 0;

  constructor(
    private readonly session: Session,
    field: Field,
    private readonly ways: Ways = {},
  ) {
    this.field = field;
    const id = fresh();
    this.label = el("label", { for: id }, field.title);
    this.unit = el("span", { class: "unit" });
    this.note = el("p", { class: "note", id: `${id}-note`, hidden: true });
    this.hint = el("p", { id: `${id}-hint`, class: "hint", hidden: true }, field.description ?? "");
    this.input = this.made(id);
    attribute(this.input, "data-key", field.key);
    if (ways.name) attribute(this.input, "aria-label", ways.name);
    attribute(this.input, "aria-describedby", `${id}-note${field.description ? ` ${id}-hint` : ""}`);
    const row = el("div", { class: "entry" });
    if (ways.nudges) row.append(button("−", () => this.nudge(-1), { class: "nudge", "aria-label": t("handle.less", { label: field.title }) }));
    row.append(this.input, ...(this.words ? [this.words] : []), this.unit);
    if (ways.nudges) row.append(button("+", () => this.nudge(1), { class: "nudge", "aria-label": t("handle.more", { label: field.title }) }));
    if (!ways.compact) {
      this.reset = button(t("form.reset"), () => this.commit(null), { class: "reset", "aria-label": t("form.reset-label", { title: field.title }) });
      row.append(this.reset);
    }
    this.element = el("div", { class: `field ${field.type}${ways.compact ? " compact" : ""}` }, this.label, row);
    if (ways.slider !== false && field.type === "number" && field.slider) {
      this.slider = el("input", { type: "range", class: "slider", "aria-label": t("form.slider", { title: ways.name ?? field.title }), min: field.slider[0], max: field.slider[1], step: "any" });
      this.slide(this.slider);
      this.element.append(this.slider);
    }
    this.element.append(this.note, this.hint);
    this.element.addEventListener("focusin", () => {
      this.element.dispatchEvent(new CustomEvent("camgeo-hint", { bubbles: true, detail: `${this.field.title}: ${this.field.description ?? ""}` }));
    });
    this.update(field);
  }

  private made(id: string): Input {
    const { field } = this;
    if (field.type === "choice" && !mixed(field)) {
      const input = el("select", { id });
      input.addEventListener("change", () => this.commit(input.value === "" ? null : input.value));
      return input;
    }
    if (field.type === "flag") {
      const input = el("input", { id, type: "checkbox" });
      input.addEventListener("change", () => this.commit(input.checked));
      return input;
    }
    const numeric = field.type === "number" && !mixed(field);
    const words = mixed(field) ? el("datalist", { id: `${id}-words` }, ...choices(field).map((each) => el("option", { value: each.value }))) : null;
    const input = el("input", { id, type: numeric ? "number" : "text", ...(numeric ? { step: "any" } : {}), autocomplete: "off", spellcheck: "false" });
    if (words) {
      this.words = words;
      input.setAttribute("list", words.id);
    }
    input.addEventListener("input", () => {
      this.dirty = true;
    });
    input.addEventListener("change", () => this.enter(input));
    input.addEventListener("blur", () => {
      if (!this.dirty) return;
      this.dirty = false;
      this.reverts = true;
      this.update(this.field);
    });
    input.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.dirty) {
        this.dirty = false;
        this.reverts = true;
        this.update(this.field);
        event.stopPropagation();
      } else if (numeric && (event.key === "ArrowUp" || event.key === "ArrowDown")) {
        event.preventDefault();
        this.nudge((event.key === "ArrowUp" ? 1 : -1) * (event.shiftKey ? 10 : 1), event.timeStamp);
      }
    });
    return input;
  }

  private enter(input: HTMLInputElement): void {
    const { field } = this;
    const text = input.value.trim();
    let value: Value;
    if (mixed(field)) value = text === "" ? null : Number.isFinite(Number(text)) ? Number(text) : text;
    else if (field.type === "number") {
      if (input.validity.badInput || (text !== "" && !Number.isFinite(input.valueAsNumber))) return this.wrong(t("form.number"));
      value = text === "" ? null : input.valueAsNumber;
    } else if (field.type === "list") {
      value = text === "" ? null : list(text);
      if (text !== "" && value === null) return this.wrong(t("form.list"));
    } else value = text === "" ? null : text;
    this.dirty = false;
    if (written(value) !== written(field.value)) this.commit(value);
    else this.update(field);
  }

  private wrong(text: string): void {
    this.reverts = true;
    attribute(this.input, "aria-invalid", "true");
    say(this.note, text);
    shown(this.note, true);
  }

  private commit(value: Value, gesture: string | null = null, input?: number): void {
    this.reverts = true;
    const change = this.ways.change?.(this.field.key, value) ?? { edits: { [this.field.key]: value } };
    this.session.change(change, { gesture, ...(input === undefined ? {} : { input }) }, gesture && this.field.key);
  }

  // By steps; quick ones after each other are one step to undo.
  private nudge(steps: number, at?: number): void {
    const now = Number(this.dirty && this.input instanceof HTMLInputElement ? this.input.valueAsNumber : (this.field.value ?? this.field.default ?? 0));
    if (!Number.isFinite(now)) return;
    const value = stepped(now, steps * stepOf(this.field));
    this.gesture ??= this.session.gesture();
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => (this.gesture = null), 1000);
    this.dirty = false;
    this.field = { ...this.field, value };
    this.input.value = String(value);
    this.commit(value, this.gesture, at);
  }

  private slide(slider: HTMLInputElement): void {
    let gesture: string | null = null;
    slider.addEventListener("input", (event) => {
      gesture ??= this.session.gesture();
      const step = this.field.slider?.[2] ?? 0;
      const raw = slider.valueAsNumber;
      const value = step ? Number((Math.round(raw / step) * step).toPrecision(12)) : raw;
      this.field = { ...this.field, value };
      this.input.value = String(value);
      this.dragging = true;
      this.commit(value, gesture, event.timeStamp);
    });
    slider.addEventListener("change", () => {
      gesture = null;
      this.dragging = false;
    });
    slider.addEventListener("keydown", (event) => {
      const ways: Record<string, number> = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };
      const way = ways[event.key];
      if (way === undefined) return;
      event.preventDefault();
      this.nudge(way * (event.shiftKey ? 10 : 1), event.timeStamp);
    });
  }

  update(field: Field): void {
    this.field = field;
    const { input } = this;
    const faults = this.session.faultsAt(field.key).map((each) => each.message);
    const whole = JSON.stringify([field, faults]);
    if (whole === this.whole && !this.dirty && !this.reverts) return;
    this.whole = whole;
    this.reverts = false;
    say(this.label, field.title);
    say(this.unit, field.unit ?? "");
    say(this.hint, field.description ?? "");
    const low = this.low(field);
    if (input instanceof HTMLSelectElement) {
      const own = choices(field);
      if (field.value === null || field.value === undefined) own.unshift({ value: "", title: low || t("form.none") });
      else if (!own.some((each) => each.value === String(field.value))) own.unshift({ value: String(field.value) });
      const text = JSON.stringify(own);
      if (input.dataset["choices"] !== text) {
        input.dataset["choices"] = text;
        input.replaceChildren(...own.map((each) => el("option", { value: each.value, title: each.description }, each.title ?? each.value)));
      }
      const value = written(field.value);
      if (input.value !== value) input.value = value;
    } else if (field.type === "flag") input.checked = Boolean(field.value ?? field.default);
    else if (!this.dirty) {
      const value = written(field.value);
      if (input.value !== value) input.value = value;
      attribute(input, "placeholder", low || null);
    }
    if (this.reset) shown(this.reset, field.stated !== false && field.value !== null && field.default !== undefined && field.default !== null);
    if (this.slider && field.slider && !this.dragging) {
      const value = Number(field.value ?? field.default ?? field.slider[0]);
      attribute(this.slider, "min", String(Math.min(field.slider[0], value)));
      attribute(this.slider, "max", String(Math.max(field.slider[1], value)));
      this.slider.value = String(value);
    }
    if (this.slider) attribute(this.slider, "aria-valuetext", `${number(Number(field.value ?? field.default ?? 0))} ${field.unit ?? ""}`);
    if (!this.dirty) {
      attribute(input, "aria-invalid", faults.length ? "true" : null);
      say(this.note, faults.join(" "));
      shown(this.note, faults.length > 0 && !this.ways.compact);
    }
  }

  private low(field: Field): string {
    if (field.default === null || field.default === undefined) return "";
    return typeof field.default === "number" ? t("form.default", { value: number(field.default) }) : t("form.default", { value: written(field.default) });
  }
}
