// Handles on a picture: buttons over it, which are dragged, or chosen and moved by the arrow keys or
// by the exact fields below the picture. Where they stand and what they move comes from the server.

import { announce } from "./announce";
import { attribute, el, fresh, type Kept, keyed, say } from "../dom";
import { FieldView, stepped } from "./field";
import type { Change, Field, Handle, HandleValue, Point, Value } from "./model";
import type { Session } from "./session";
import { number, t } from "./strings";

// How the values of a handle's space stand in the picture.
export interface View {
  part(at: Point): Point; // from values to fractions of the picture, from its upper left
  values(client: Point): Point | null; // from a place on the screen
  pixel(): Point; // values per pixel on the screen
  shift?: Point; // pixels to the right and down, from where it belongs to where there is room for it
}

const FAR = 3; // pixels that a pointer moves before it drags
const QUIET = 1000; // milliseconds after which the arrow keys begin a new step to undo
const KEYS: Record<string, Point> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// The round step that is about as long as these values.
function round(size: number): number {
  const power = 10 ** Math.floor(Math.log10(size));
  return ([5, 2, 1].find((each) => each * power <= size * (1 + 1e-9)) ?? 1) * power;
}

// To whose multiples values are rounded: about a pixel.
function stepOf(view: View): number {
  return round(Math.min(...view.pixel().map(Math.abs)));
}

function fieldOf(value: HandleValue): Field {
  return { key: value.key, title: value.label, type: "number", unit: value.unit ?? "", value: value.value, stated: true };
}

// What a handle's exact fields hold. A joint moves the spans of both its neighbours, so that its
// place is entered, not a span; the keys of its fields are the coordinates.
function valuesOf(handle: Handle): HandleValue[] {
  if (handle.space !== "plan") return handle.values;
  const position = handle.values.find((each) => each.key.endsWith(".to"));
  const found: HandleValue[] = [];
  if (handle.moves.includes("x")) found.push({ key: "0", label: t("handle.angle"), unit: "°", value: handle.at[0] });
  if (handle.moves.includes("y")) found.push({ key: "1", label: position?.label ?? t("handle.position"), unit: position?.unit ?? "", value: handle.at[1] });
  return found;
}

const words = (handle: Handle): string => valuesOf(handle).map((each) => `${each.label} ${number(each.value)} ${each.unit ?? ""}`.trim()).join(", ");

export class Handles {
  readonly layer = el("div", { class: "handles" });
  readonly exact = el("div", { class: "exact", role: "group" });
  private handles: Handle[] = [];
  private view: ((handle: Handle) => View | null) | null = null;
  private views = new Map<string, View>(); // at the last drawing
  private readonly places = new WeakMap<HTMLElement, string>();
  private chosen: string | null = null;
  private dragged: { name: string; view: View; step: number; gesture: string; at: Point; started: boolean; from: Point; offset: Point } | null = null;
  private keyed: { name: string; at: Point; gesture: string; until: number } | null = null;
  private readonly help = el("p", { class: "help", id: fresh() });
  private readonly title = el("p", { class: "chosen" });
  private readonly fields = el("div", { class: "fields" });
  private readonly show: (items: readonly Handle[]) => void;
  private readonly list: (items: readonly HandleValue[]) => void;

  constructor(
    private readonly session: Session,
    private readonly space: string,
    help: string,
    private readonly begun: () => void = () => undefined,
  ) {
    this.help.textContent = help;
    this.exact.append(this.help, this.title, this.fields);
    this.show = keyed(this.layer, (handle) => handle.name, (handle) => this.made(handle));
    this.list = keyed(this.fields, (value) => `${this.chosen ?? ""} ${value.key}`, (value) => this.field(value));
    this.fields.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || event.defaultPrevented) return;
      [...this.layer.querySelectorAll("button")].find((each) => each.dataset["name"] === this.chosen)?.focus();
    });
    this.choose(null);
  }

  update(handles: Handle[], view: (handle: Handle) => View | null): void {
    this.handles = handles;
    this.view = view;
    // First all places are read, then written: a reading that follows a writing lays the page out.
    this.views = new Map();
    for (const each of handles) {
      const found = view(each);
      if (found) this.views.set(each.name, found);
    }
    this.show(handles.filter((each) => this.views.has(each.name)));
    this.choose(this.chosen);
  }

  private field(value: HandleValue): Kept<HandleValue> {
    const change = (key: string, to: Value): Change | null => {
      const handle = this.handles.find((each) => each.name === this.chosen);
      if (!handle || handle.space !== "plan" || typeof to !== "number") return null;
      return { handle: handle.name, to: key === "0" ? [to, handle.at[1]] : [handle.at[0], to] };
    };
    const view = new FieldView(this.session, fieldOf(value), { nudges: true, slider: false, compact: true, change });
    return { element: view.element, update: (next) => view.update(fieldOf(next)) };
  }

  private choose(name: string | null): void {
    const handle = this.handles.find((each) => each.name === name);
    this.chosen = handle ? handle.name : null;
    say(this.title, handle ? t("handle.chosen", { label: handle.label }) : t("handle.none"));
    attribute(this.exact, "aria-label", handle ? t("handle.chosen", { label: handle.label }) : t("handle.none"));
    this.list(handle ? valuesOf(handle) : []);
    for (const each of this.layer.querySelectorAll("button")) attribute(each, "aria-pressed", String(each.dataset["name"] === this.chosen));
  }

  private made(handle: Handle): Kept<Handle> {
    let now = handle;
    const element = el("button", { type: "button", class: `handle ${handle.kind}`, "data-name": handle.name, "data-space": handle.space, "aria-pressed": "false", "aria-describedby": this.help.id });
    element.addEventListener("pointerdown", (event) => this.down(element, now, event));
    element.addEventListener("pointermove", (event) => this.move(element, event));
    for (const each of ["pointerup", "pointercancel", "lostpointercapture"] as const) element.addEventListener(each, () => this.up());
    element.addEventListener("keydown", (event) => this.key(now, event));
    element.addEventListener("click", (event) => {
      this.choose(now.name);
      // Pressed by the keyboard: on to the fields. By a pointer the handle keeps the arrow keys.
      if (event.detail === 0) this.fields.querySelector("input")?.focus();
    });
    return {
      element,
      update: (next) => {
        now = next;
        const name = t("handle.name", { label: next.label, values: words(next) });
        attribute(element, "aria-label", name);
        attribute(element, "title", name);
        if (this.dragged?.name !== next.name || !this.dragged.started) this.put(element, next, next.at);
      },
    };
  }

  private put(element: HTMLElement, handle: Handle, at: Point): void {
    const view = this.dragged?.name === handle.name ? this.dragged.view : this.views.get(handle.name);
    if (!view) return;
    const [x, y] = view.part(at);
    const [right, down] = view.shift ?? [0, 0];
    // By a transform, after which nothing is laid out anew; in parts of the layer.
    const place = `translate(calc(${(100 * x).toFixed(3)}cqw + ${right.toFixed(1)}px), calc(${(100 * y).toFixed(3)}cqh + ${down.toFixed(1)}px))`;
    if (this.places.get(element) === place) return;
    this.places.set(element, place);
    element.style.transform = place;
    element.classList.toggle("outside", x < -0.02 || x > 1.02 || y < -0.02 || y > 1.02);
  }

  private ask(handle: Handle, to: Point, step: number, gesture: string, input: number): void {
    this.session.change({ handle: handle.name, to: [Number(to[0].toPrecision(9)), Number(to[1].toPrecision(9))], step }, { gesture, input }, handle.name);
  }

  private down(element: HTMLElement, handle: Handle, event: PointerEvent): void {
    if (event.button !== 0) return;
    this.begun();
    this.choose(handle.name); // first: what it shows may move the picture
    const view = this.view?.(handle);
    const at = view?.values([event.clientX, event.clientY]);
    if (!view || !at) return;
    element.setPointerCapture(event.pointerId);
    const offset: Point = [handle.at[0] - at[0], handle.at[1] - at[1]];
    // The step is that of the picture as it is now: its scale stays, and to measure it lays the page out.
    this.dragged = { name: handle.name, view, step: stepOf(view), gesture: this.session.gesture(), at: handle.at, started: false, from: [event.clientX, event.clientY], offset };
  }

  private move(element: HTMLElement, event: PointerEvent): void {
    const own = this.dragged;
    if (!own) return;
    const handle = this.handles.find((each) => each.name === own.name);
    const at = own.view.values([event.clientX, event.clientY]);
    if (!handle || !at) return;
    if (!own.started) {
      if (Math.hypot(event.clientX - own.from[0], event.clientY - own.from[1]) < FAR) return;
      own.started = true;
      element.classList.add("dragged");
      this.session.hold(this.space);
    }
    let to: Point = [at[0] + own.offset[0], at[1] + own.offset[1]];
    if (handle.moves === "x") to = [to[0], own.at[1]];
    if (handle.moves === "y") to = [own.at[0], to[1]];
    this.put(element, handle, to);
    this.ask(handle, to, own.step, own.gesture, event.timeStamp);
  }

  private up(): void {
    const own = this.dragged;
    if (!own) return;
    this.dragged = null;
    if (!own.started) return;
    for (const each of this.layer.querySelectorAll(".dragged")) each.classList.remove("dragged");
    this.session.hold("");
    const handle = this.handles.find((each) => each.name === own.name);
    if (handle) announce(this.told(handle));
  }

  private told(handle: Handle): string {
    return t("announce.value", { label: handle.label, values: words(handle) });
  }

  private key(handle: Handle, event: KeyboardEvent): void {
    const way = KEYS[event.key];
    const view = this.view?.(handle);
    if (!way || !view || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.begun();
    this.choose(handle.name);
    const now = performance.now();
    const own = this.keyed?.name === handle.name && now < this.keyed.until ? this.keyed : { name: handle.name, at: handle.at, gesture: this.session.gesture(), until: 0 };
    own.until = now + QUIET;
    this.keyed = own;
    const steps = event.shiftKey ? 10 : 1;
    const [wide, high] = view.pixel().map((each) => steps * round(Math.abs(each))) as Point;
    own.at = [stepped(own.at[0], handle.moves === "y" ? 0 : way[0] * wide), stepped(own.at[1], handle.moves === "x" ? 0 : way[1] * high)];
    this.ask(handle, own.at, stepOf(view), own.gesture, event.timeStamp);
  }
}
