// The turning mechanism: the discs, and the bodies between two of the positions of an animation.

import type { CamAngle } from "./angle";
import { numeral } from "./axes";
import type { Animation, Place } from "./data";
import { attribute } from "./dom";
import { drawMarks, type Plane } from "./marks";
import { type Attributes, element, fixed, Node } from "./svg";

const BODY: Attributes = { fill: "white", stroke: "black", "stroke-width": 1.2 };
const LINK: Attributes = { stroke: "black", "stroke-width": 1.8, "stroke-linecap": "round", fill: "none" };
const THIN: Attributes = { fill: "none", stroke: "black", "stroke-width": 1 };
const FACE: Attributes = { ...THIN, "stroke-width": 3 };
const HAND: Attributes = { stroke: "#4d4d4d", "stroke-width": 1 }; // from the axis, shows the turning
const [WIDTH, HEIGHT] = [640, 520]; // of the picture at most, in points
const JOINT = 0.012; // radius of a joint, in square roots of the picture's area

// What is shown, and how large.
interface View {
  low: Place;
  high: Place;
  k: number; // points to a millimetre
  joint: number;
}

function viewOf({ low, high }: Animation): View {
  const k = Math.min(WIDTH / (high[0] - low[0]), HEIGHT / (high[1] - low[1]));
  return { low, high, k, joint: JOINT * k * Math.sqrt((high[0] - low[0]) * (high[1] - low[1])) };
}

// The two positions of an animation around a cam angle, and how far it is from one to the other.
function between(count: number, degrees: number): [number, number, number] {
  const share = (degrees / 360) * count;
  const first = Math.floor(share);
  return [first % count, (first + 1) % count, share - first];
}

// The follower's lift at a cam angle, with its unit: by the cubic through four positions.
export function liftAt({ lifts, lift_unit }: Animation, degrees: number): string {
  const count = lifts.length;
  const [first, second, t] = between(count, degrees);
  const [a, b, c, d] = [first - 1 + count, first, second, second + 1].map((k) => lifts[k % count]!) as [number, number, number, number];
  const lift = b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  return `${numeral(Number(lift.toFixed(3)))}${lift_unit === "°" ? "" : " "}${lift_unit}`;
}

export class Mechanism {
  readonly svg = element("svg", { class: "drawn" });
  readonly overlay = element("g"); // over the mechanism; stays when it is drawn anew
  animation: Animation | null = null;
  private view: View | null = null;
  private readonly picture: Node;
  private disc: Node | null = null;
  private movers: ((take: () => Place) => void)[] = [];
  private readonly forget: () => void;

  constructor(private readonly angle: CamAngle, label: string) {
    this.svg.setAttribute("role", "img");
    this.svg.setAttribute("aria-label", label);
    const group = element("g");
    this.picture = new Node("g", group);
    this.svg.append(group, this.overlay);
    this.forget = angle.listen((degrees) => this.turn(degrees));
  }

  // `held`: what is shown, and its scale, stay as they are, as they should during a drag.
  update(animation: Animation, held = false): void {
    this.animation = animation;
    if (!held || !this.view) {
      this.view = viewOf(animation);
      const { low, high, k } = this.view;
      attribute(this.svg, "viewBox", `0 0 ${fixed((high[0] - low[0]) * k)} ${fixed((high[1] - low[1]) * k)}`);
    }
    const view = this.view;
    this.picture.redraw((into) => this.draw(into, animation, view));
    this.turn(this.angle.degrees);
  }

  dispose(): void {
    this.forget();
    this.svg.remove();
  }

  // A place of the fixed frame [mm] in points of the picture.
  toPicture([x, y]: Place): Place {
    if (!this.view) return [0, 0];
    const { low, high, k } = this.view;
    return [(x - low[0]) * k, (high[1] - y) * k];
  }

  // The place of the fixed frame [mm] at a place on the screen.
  at(clientX: number, clientY: number): Place | null {
    const matrix = this.svg.getScreenCTM();
    if (!matrix || !this.view) return null;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
    const { low, high, k } = this.view;
    return [low[0] + x / k, high[1] - y / k];
  }

  // Points of the picture to a millimetre.
  get scale(): number {
    return this.view?.k ?? 1;
  }

  private draw(into: Node, found: Animation, { low, high, k, joint }: View): void {
    const box = { left: 0, top: 0, right: (high[0] - low[0]) * k, bottom: (high[1] - low[1]) * k };
    const plane: Plane = { x: (x) => (x - low[0]) * k, y: (y) => (high[1] - y) * k, k, box, clip: "" };
    const [ox, oy] = [fixed(plane.x(0)), fixed(plane.y(0))];
    const r = fixed(joint);
    const disc = into.add("g").add("g", { class: "turning" });
    drawMarks(found.turning, disc, plane);
    const radii = found.turning.flatMap((mark) => (mark.kind === "circle" ? mark.radius : []));
    const hand = 0.4 * Math.max(0, ...radii) * k;
    disc.add("line", { x1: ox, y1: oy, x2: fixed(ox + hand), y2: oy, ...HAND });
    this.disc = disc;
    const fixtures = into.add("g");
    for (const guide of found.guides) {
      const ends = [guide.start, guide.end].map((at) => this.toPicture(at)) as [Place, Place];
      fixtures.add("path", { d: hatched(...ends, joint, guide.block), ...THIN });
    }
    for (const shaft of found.shafts) {
      const [x, y] = this.toPicture(shaft).map(fixed) as Place;
      const foot = `l${fixed(-1.6 * joint)} ${fixed(2.6 * joint)}h${fixed(3.2 * joint)}Z`;
      fixtures.add("path", { d: `M${x} ${y}${foot}`, ...THIN });
    }
    const bodies = into.add("g");
    this.movers = [
      ...found.links.map((count) => link(bodies, count)),
      ...Array.from({ length: found.faces }, () => face(bodies)),
      ...found.rollers.map((radius) => roller(bodies, radius * k, joint)),
      ...Array.from({ length: found.joints }, () => moved(bodies.add("g"), [["circle", { r, ...BODY }]])),
      ...found.guides.filter((guide) => guide.block).map(({ start, end }) => {
        const turned = (Math.atan2(start[1] - end[1], end[0] - start[0]) * 180) / Math.PI;
        const [x, y, width, height] = [-1.6 * joint, -joint, 3.2 * joint, 2 * joint].map(fixed) as [number, number, number, number];
        const block = { x, y, width, height, transform: `rotate(${fixed(turned)})`, ...BODY };
        return moved(bodies.add("g"), [["rect", block], ["circle", { r, ...BODY }]]);
      }),
    ];
    const axes = into.add("g");
    for (const at of [...found.shafts, [0, 0] as Place]) {
      const [cx, cy] = this.toPicture(at).map(fixed) as Place;
      axes.add("circle", { cx, cy, r, ...BODY });
    }
  }

  private turn(degrees: number): void {
    const found = this.animation;
    if (!found || !this.disc) return;
    const [ox, oy] = this.toPicture([0, 0]).map(fixed) as Place;
    attribute(this.disc.element, "transform", `rotate(${fixed(-found.rotation * degrees)} ${ox} ${oy})`);
    const [first, second, rest] = between(found.places.length, degrees);
    const [from, to] = [found.places[first] ?? [], found.places[second] ?? []];
    let next = 0;
    const take = (): Place => {
      const [[x, y], [u, v]] = [from[next]!, to[next]!];
      next++;
      return this.toPicture([x + rest * (u - x), y + rest * (v - y)]).map(fixed) as Place;
    };
    for (const move of this.movers) move(take);
  }
}

type Mover = (take: () => Place) => void;

function link(parent: Node, count: number): Mover {
  const { element: line } = parent.add("polyline", LINK);
  return (take) => attribute(line, "points", Array.from({ length: count }, take).join(" "));
}

function face(parent: Node): Mover {
  const { element: line } = parent.add("path", FACE);
  return (take) => attribute(line, "d", `M${take().join(" ")}L${take().join(" ")}`);
}

function roller(parent: Node, radius: number, joint: number): Mover {
  const hub = Math.min(joint, 0.4 * radius);
  return moved(parent.add("g"), [["circle", { r: fixed(radius), ...BODY }], ["circle", { r: fixed(hub), ...BODY }]]);
}

// Parts that are drawn about the origin and moved together.
function moved(group: Node, parts: [keyof SVGElementTagNameMap, Attributes][]): Mover {
  for (const [name, attributes] of parts) group.add(name, attributes);
  return (take) => attribute(group.element, "transform", `translate(${take().join(" ")})`);
}

// A guide: two hatched lines, as far apart as a slider is high or a rod is thick.
function hatched(start: Place, end: Place, joint: number, block: boolean): string {
  const [dx, dy] = [end[0] - start[0], end[1] - start[1]];
  const long = Math.hypot(dx, dy) || 1;
  const along: Place = [(dx / long) * joint, (dy / long) * joint];
  const across: Place = [-along[1], along[0]];
  const count = Math.max(5, Math.round(long / (1.6 * joint)));
  let path = "";
  for (const side of [1, -1]) {
    const off = side * (block ? 1.15 : 0.58);
    const beside = (share: number): Place => [
      start[0] + share * dx + off * across[0],
      start[1] + share * dy + off * across[1],
    ];
    path += `M${beside(0).map(fixed).join(" ")}L${beside(1).map(fixed).join(" ")}`;
    for (let n = 0; n < count; n++) {
      const [x, y] = beside((n + 0.5) / count);
      path += `M${fixed(x)} ${fixed(y)}l${fixed(side * across[0] - 0.8 * along[0])} ${fixed(side * across[1] - 0.8 * along[1])}`;
    }
  }
  return path;
}
