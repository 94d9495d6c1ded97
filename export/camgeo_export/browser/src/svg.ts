// Elements of an SVG picture that are kept from one drawing to the next: the same code draws and
// redraws, and only what differs is handed to the browser. All texts become text nodes: none of
// them is ever read as markup.

const SVG = "http://www.w3.org/2000/svg";

export type Attributes = Record<string, string | number>;

export function element<Name extends keyof SVGElementTagNameMap>(
  name: Name,
  attributes: Attributes = {},
): SVGElementTagNameMap[Name] {
  const made = document.createElementNS(SVG, name);
  for (const key in attributes) made.setAttribute(key, String(attributes[key]));
  return made;
}

export class Node {
  private readonly children: Node[] = [];
  private attributes: Attributes = {};
  private text: string | undefined;
  private used = 0;

  constructor(
    readonly name: keyof SVGElementTagNameMap,
    readonly element: SVGElement = document.createElementNS(SVG, name),
  ) {}

  // The next element in this one: that of the last drawing, if it has the same name.
  add(name: keyof SVGElementTagNameMap, attributes: Attributes = {}, text?: string): Node {
    let child = this.children[this.used];
    if (child?.name !== name) {
      const made = new Node(name);
      if (child) child.element.replaceWith(made.element);
      else this.element.append(made.element);
      this.children[this.used] = child = made;
    }
    this.used++;
    child.used = 0;
    child.set(attributes);
    if (text !== child.text) {
      child.element.textContent = text ?? "";
      child.children.length = 0;
      child.text = text;
    }
    return child;
  }

  // Has these attributes and no others.
  set(attributes: Attributes): void {
    const old = this.attributes;
    for (const key in attributes) {
      const value = attributes[key]!;
      if (old[key] !== value) this.element.setAttribute(key, String(value));
    }
    for (const key in old) if (!(key in attributes)) this.element.removeAttribute(key);
    this.attributes = attributes;
  }

  // Draws what this element holds, anew; what is left over of the last drawing goes.
  redraw(draw: (into: Node) => void): void {
    this.used = 0;
    draw(this);
    this.trim();
  }

  private trim(): void {
    for (const gone of this.children.splice(this.used)) gone.element.remove();
    for (const child of this.children) child.trim();
  }
}

// To hundredths, which is finer than any screen or printer.
export function fixed(value: number): number {
  return Math.round(value * 100) / 100;
}
