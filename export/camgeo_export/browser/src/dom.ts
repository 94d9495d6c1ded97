// Elements, made and kept. Texts become text nodes: none of them is ever read as markup.

type Content = Node | string | null | false;

interface Given {
  class?: string;
  [attribute: string]: string | number | boolean | ((event: never) => void) | undefined;
}

// An element; attributes that are functions listen, true and false set or leave out an attribute.
export function el<K extends keyof HTMLElementTagNameMap>(name: K, given: Given = {}, ...content: Content[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(given)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(key, value as EventListener);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  for (const each of content) if (each !== null && each !== false) element.append(each);
  return element;
}

// Sets a text only where it differs, so that nothing is announced or laid out anew for nothing.
export function say(element: Node, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function shown(element: HTMLElement, is: boolean): void {
  if (element.hidden === is) element.hidden = !is;
}

export function attribute(element: Element, name: string, value: string | null): void {
  if (value === null) element.removeAttribute(name);
  else if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

export interface Kept<T> {
  element: HTMLElement;
  update(item: T): void;
}

// Children of a parent for a list of items, each kept as long as its key is there, in their order.
export function keyed<T>(parent: HTMLElement, key: (item: T) => string, make: (item: T) => Kept<T>): (items: readonly T[]) => void {
  let kept = new Map<string, Kept<T>>();
  return (items) => {
    const next = new Map<string, Kept<T>>();
    for (const item of items) {
      const own = key(item);
      const found = kept.get(own) ?? make(item);
      found.update(item);
      next.set(own, found);
    }
    for (const [own, each] of kept) if (!next.has(own)) each.element.remove();
    kept = next;
    let place = parent.firstElementChild;
    for (const each of next.values()) {
      if (each.element === place) place = place.nextElementSibling;
      else parent.insertBefore(each.element, place);
    }
  };
}

let numbers = 0;

// An identifier that no other element has.
export function fresh(): string {
  numbers += 1;
  return `e${numbers}`;
}

export function button(text: string, press: () => void, given: Given = {}): HTMLButtonElement {
  return el("button", { type: "button", ...given, click: press }, text);
}

export interface Panel {
  section: HTMLElement;
  heading: HTMLElement;
  body: HTMLElement;
}

// A part of the page with its heading.
export function panel(name: string, title: string): Panel {
  const id = `${name}-title`;
  const heading = el("h2", { id }, title);
  const body = el("div", { class: "body" });
  const section = el("section", { id: name, class: "panel", "aria-labelledby": id }, heading, body);
  return { section, heading, body };
}

// A table that scrolls sideways within its own box; its head, and its rows as texts or nodes.
export function table(label: string, heads: string[], rows: Content[][], numeric: number[] = []): HTMLElement {
  const look = (k: number): Given => (numeric.includes(k) ? { class: "number" } : {});
  return el(
    "div",
    { class: "wide", role: "group", tabindex: 0, "aria-label": label },
    el(
      "table",
      {},
      el("thead", {}, el("tr", {}, ...heads.map((each, k) => el("th", { scope: "col", ...look(k) }, each)))),
      el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((each, k) => el("td", look(k), each))))),
    ),
  );
}
