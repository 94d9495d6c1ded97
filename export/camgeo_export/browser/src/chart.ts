// A diagram with a cursor at the cam angle, and the values there; a press or a drag in it sets it.

import type { CamAngle } from "./angle";
import { numeral } from "./axes";
import type { Charted, Gap } from "./data";
import { attribute, say } from "./dom";
import { type Drawn, Drawing } from "./figure";
import { element, fixed, Node } from "./svg";

const LAST = 359.999; // the end of a turn, which is not its beginning

// The value of a curve at a cam angle, between its points.
export function curveAt(points: readonly Gap[], at: number): number | null {
  if (!points.length) return null;
  let [low, high] = [0, points.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (points[middle]![0]! <= at) low = middle;
    else high = middle;
  }
  const [x0, y0] = points[low]!;
  const [x1, y1] = points[high]!;
  if (x0 === null || x1 === null || y0 === null || y1 === null) return null;
  return x1 > x0 ? y0 + ((y1 - y0) * (at - x0)) / (x1 - x0) : y1;
}

interface Cursor {
  drawn: Drawn;
  line: Node;
  text: Node;
}

export class Chart {
  readonly drawing: Drawing;
  private readonly over: Node;
  private cursors: Cursor[] = [];
  private readonly forget: () => void;

  // `taken` is called when a press in a diagram sets the cam angle, to stop what turns it.
  constructor(
    private readonly angle: CamAngle,
    private readonly taken: () => void = () => {},
  ) {
    this.drawing = new Drawing();
    const group = element("g");
    this.drawing.overlay.before(group); // below what others lay over the figure
    this.over = new Node("g", group);
    this.forget = angle.listen((degrees) => this.point(degrees));
    group.addEventListener("pointerdown", (event) => {
      const drawn = this.under(event);
      if (!drawn) return;
      this.taken();
      (event.target as Element).setPointerCapture(event.pointerId);
      this.move(event, drawn);
    });
    group.addEventListener("pointermove", (event) => {
      const drawn = this.under(event);
      if (drawn && event.buttons) this.move(event, drawn);
    });
  }

  get svg(): SVGSVGElement {
    return this.drawing.svg;
  }

  update({ figure, sentence }: Charted, held = false): void {
    this.drawing.update(figure, sentence, held);
    const turns = this.drawing.panels.filter((each) => each.turn);
    this.over.redraw((into) => {
      this.cursors = turns.map((drawn) => {
        const { left, right, top, bottom } = drawn.plane.box;
        const line = into.add("line", { y1: top, y2: bottom, class: "cursor" });
        const y = drawn.legend.startsWith("upper") ? bottom - 4 : top + 9;
        const text = into.add("text", { x: left + 4, y, class: "value", "font-size": 7.5 });
        const sheet = { x: left, y: top, width: right - left, height: bottom - top, class: "sheet" };
        into.add("rect", { ...sheet, "data-panel": drawn.index });
        return { drawn, line, text };
      });
    });
    this.point(this.angle.degrees);
  }

  dispose(): void {
    this.forget();
    this.svg.remove();
  }

  private point(degrees: number): void {
    for (const { drawn, line, text } of this.cursors) {
      const x = fixed(drawn.plane.x(degrees));
      for (const name of ["x1", "x2"]) attribute(line.element, name, String(x));
      const values = drawn.curves.map((mark) => curveAt(mark.points, degrees)).filter((each) => each !== null);
      const numbers = values.map((each) => numeral(Number(each.toPrecision(4)))).join("; ");
      say(text.element, numbers && `${degrees.toFixed(1)}°: ${numbers}`);
    }
  }

  private under(event: PointerEvent): Drawn | undefined {
    const index = (event.target as Element).getAttribute("data-panel");
    return this.cursors.find(({ drawn }) => String(drawn.index) === index)?.drawn;
  }

  private move(event: PointerEvent, drawn: Drawn): void {
    const there = this.drawing.at(drawn, event.clientX, event.clientY);
    if (there) this.angle.set(Math.min(Math.max(there.values[0], 0), LAST));
  }
}
