// The mechanism: turning, with handles on its sizes, and with the places where something is wrong.

import { makeControls } from "../controls";
import type { Animation, Mark } from "../data";
import { liftAt, Mechanism } from "../mechanism";
import { Player } from "../player";
import { element, fixed } from "../svg";
import { apart } from "./apart";
import { GREY } from "./compare";
import { attribute, el, say, shown } from "../dom";
import { Handles, type View } from "./handles";
import type { Handle, Place, Point } from "./model";
import type { Session } from "./session";
import { PLAYER, t } from "./strings";

const SPACE = "mechanism";
const MOST = 40; // places that are drawn, and said in words
const TARGET = 24; // pixels across a handle, as in the style sheet
const SIGN = "M0-7L7 5H-7Z"; // around a place

// The disc of a pinned variant, in grey over the present one.
function ghosts(found: Animation): Mark[] {
  const style = { kind: "fill" as const, face: "", edge: GREY, width: 1.2, dashes: [3, 2], hatched: false, opacity: 1 };
  return found.turning.flatMap((mark): Mark[] => {
    if (mark.kind === "area") return [{ ...mark, style, layer: 3 }];
    if (mark.kind === "circle") return [{ ...mark, style, layer: 3 }];
    return [];
  });
}

export class MechanismView {
  readonly element = el("div", { class: "mechanism" });
  readonly player: Player;
  private readonly mechanism: Mechanism;
  private readonly handles: Handles;
  private readonly picture: HTMLElement;
  private readonly none = el("p", { hidden: true });
  private readonly old = el("p", { class: "stale", hidden: true }, t("mechanism.old"));
  private readonly places = element("g");
  private readonly listed = el("ul", { class: "list places" });
  private shifts = new Map<string, Point>(); // of handles that are drawn beside where they belong
  private width = 0; // pixels of the picture
  private readonly details = el("details", { hidden: true }, el("summary", {}, t("mechanism.places")), this.listed);

  constructor(private readonly session: Session) {
    const [controls, parts] = makeControls(PLAYER);
    const lift = (degrees: number): string => (session.curves?.animation ? liftAt(session.curves.animation, degrees) : "");
    this.player = new Player(session.angle, parts, lift, PLAYER);
    this.mechanism = new Mechanism(session.angle, PLAYER.mechanism);
    this.mechanism.overlay.append(this.places);
    this.handles = new Handles(session, SPACE, t("mechanism.help"), () => {
      // Handles are where the parts are at cam angle 0.
      this.player.stop();
      if (session.angle.degrees) session.angle.set(0);
    });
    this.picture = el("div", { class: "picture" }, this.mechanism.svg, this.handles.layer);
    this.element.append(
      this.none,
      this.handles.exact,
      this.picture,
      this.old,
      controls,
      this.details,
    );
    session.on(["curves", "moved", "faults"], () => this.update());
    session.on(["findings", "curves", "moved"], () => this.mark());
    session.angle.listen((degrees) => this.turn(degrees));
    new ResizeObserver(([entry]) => {
      this.width = entry?.contentRect.width ?? 0;
      this.place();
    }).observe(this.picture);
  }

  private update(): void {
    const { curves, pinned, stale, held } = this.session;
    const found = curves?.animation ?? null;
    shown(this.none, !found);
    shown(this.picture, Boolean(found));
    shown(this.old, stale && Boolean(found));
    this.picture.classList.toggle("old", stale);
    say(this.none, !curves ? t("mechanism.waiting") : this.session.text.trim() ? t("mechanism.none") : t("mechanism.empty"));
    if (!found) return this.handles.update([], () => null);
    const other = pinned?.animation;
    const low = other ? ([0, 1].map((k) => Math.min(found.low[k]!, other.low[k]!)) as [number, number]) : found.low;
    const high = other ? ([0, 1].map((k) => Math.max(found.high[k]!, other.high[k]!)) as [number, number]) : found.high;
    const both = other ? { ...found, low, high, turning: [...found.turning, ...ghosts(other)] } : found;
    this.mechanism.update(both, held !== "");
    if (!this.player.playing) this.player.tell();
    const { width, height } = this.mechanism.svg.viewBox.baseVal;
    const aspect = (width / height).toFixed(4);
    if (this.picture.style.getPropertyValue("--aspect") !== aspect) this.picture.style.setProperty("--aspect", aspect);
    this.place();
  }

  private place(): void {
    const handles = (this.session.curves?.handles ?? []).filter((each) => each.space === SPACE);
    const { width } = this.mechanism.svg.viewBox.baseVal;
    const pixels = width ? this.width / width : 0;
    // Centres and joints stay where they are, and a rim's handle goes on outward.
    const ordered = [...handles].sort((one, other) => Number(one.moves === "radial") - Number(other.moves === "radial"));
    const places = ordered.map(({ at }) => this.mechanism.toPicture(at).map((each) => each * pixels) as Point);
    const free = pixels ? apart(places, TARGET) : places;
    this.shifts = new Map(ordered.map(({ name }, k) => [name, [free[k]![0] - places[k]![0], free[k]![1] - places[k]![1]]]));
    this.handles.update(handles, (handle) => this.view(handle));
  }

  private view({ name }: Handle): View | null {
    const { svg } = this.mechanism;
    const { width, height } = svg.viewBox.baseVal;
    if (!width || !height) return null;
    const shift = this.shifts.get(name) ?? ([0, 0] as Point);
    return {
      shift,
      part: (at) => {
        const [x, y] = this.mechanism.toPicture(at);
        return [x / width, y / height];
      },
      values: ([x, y]) => this.mechanism.at(x, y),
      pixel: () => {
        const pixel = width / (this.mechanism.scale * this.width || 1);
        return [pixel, pixel];
      },
    };
  }

  // Where something is wrong: signs on the disc, which turn with it, and the same in words.
  private mark(): void {
    const found = this.session.findings;
    const places = found && found.revision >= this.session.revision ? (found.places ?? []) : [];
    this.places.replaceChildren(...places.slice(0, MOST).flatMap((place) => [...this.range(place), this.sign(place)]));
    shown(this.details, places.length > 0);
    const words = places.slice(0, MOST).map((place) => place.label);
    if (this.listed.dataset["shown"] !== JSON.stringify(words)) {
      this.listed.dataset["shown"] = JSON.stringify(words);
      this.listed.replaceChildren(...words.map((text) => el("li", {}, `! ${text}`)));
    }
    this.turn(this.session.angle.degrees);
  }

  // The part of a flank along which it is.
  private range(place: Place): SVGElement[] {
    if (!place.points) return [];
    const points = place.points.map((at) => this.mechanism.toPicture(at).map(fixed).join(",")).join(" ");
    return [element("polyline", { class: "range", points })];
  }

  private sign(place: Place): SVGElement {
    const [x, y] = this.mechanism.toPicture([place.x, place.y]);
    const sign = element("g", { class: `place ${/^[\w-]*$/.test(place.kind) ? place.kind : ""}`, transform: `translate(${fixed(x)} ${fixed(y)})`, "data-kind": place.kind });
    const title = element("title");
    title.textContent = place.label;
    const text = element("text", { y: 4, "text-anchor": "middle", "font-size": 8 });
    text.textContent = "!";
    sign.append(title, element("circle", { r: 11 }), element("path", { d: SIGN }), text);
    return sign;
  }

  private turn(degrees: number): void {
    attribute(this.picture, "data-turned", degrees ? "true" : null);
    const found = this.mechanism.animation;
    if (!found) return;
    const [x, y] = this.mechanism.toPicture([0, 0]).map(fixed);
    this.places.setAttribute("transform", `rotate(${fixed(-found.rotation * degrees)} ${x} ${y})`);
  }
}
