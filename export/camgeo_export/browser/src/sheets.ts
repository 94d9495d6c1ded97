// Cuts a picture that is too high for a sheet of paper into several, for printing, where it cuts
// through neither a panel nor a text.

import { element } from "./svg";

const HIGH = 640; // points that fit on a sheet of A4 with its caption
const WHOLE = 740; // what is no higher is printed somewhat smaller
const APART = 2; // points, between what is above and below a cut

let names = 0;

// Heights at which a picture can be cut, from its top.
function gaps(svg: SVGSVGElement): number[] {
  const { top, width } = svg.getBoundingClientRect();
  const k = svg.viewBox.baseVal.width / width;
  const boxes = [...svg.querySelectorAll("text, clipPath + g, path, line")].map((each) => each.getBoundingClientRect());
  const spans = boxes.filter((box) => box.height > 0).map((box) => [(box.top - top) * k, (box.bottom - top) * k] as const);
  spans.sort((a, b) => a[0] - b[0]);
  const found: number[] = [];
  let end = -Infinity;
  for (const [low, high] of spans) {
    if (low > end + APART && end > 0) found.push(low - APART / 2);
    end = Math.max(end, high);
  }
  return found;
}

// Adds the parts after the picture, which only paper shows.
export function cut(svg: SVGSVGElement, picture: SVGElement): void {
  const { width, height } = svg.viewBox.baseVal;
  if (height <= WHOLE || !svg.clientWidth) return;
  const places = gaps(svg);
  const cuts = [0];
  while (height - cuts.at(-1)! > HIGH) {
    const from = cuts.at(-1)!;
    const next = places.findLast((each) => each > from && each <= from + HIGH);
    if (next === undefined) return;
    cuts.push(next);
  }
  picture.id = `picture-${++names}`;
  const parts = cuts.map((from, k) => {
    const part = element("svg", {
      viewBox: `0 ${from} ${width} ${(cuts[k + 1] ?? height) - from}`,
      class: "drawn part", role: "img", "aria-label": svg.getAttribute("aria-label") ?? "",
    });
    part.append(element("use", { href: `#${picture.id}` }));
    return part;
  });
  svg.classList.add("whole");
  svg.after(...parts);
}
