// The page of `camgeo report`: diagrams and the turning mechanism, with one cam angle for all.

import { CamAngle } from "./angle";
import { Chart } from "./chart";
import type { Animation, Body, Charted } from "./data";
import { Drawing } from "./figure";
import { liftAt, Mechanism } from "./mechanism";
import { Player } from "./player";
import { cut } from "./sheets";
import { WORDS } from "./words";

interface Data {
  animation: Animation | null;
  charts: Charted[];
  prices: Charted | null;
  solids: Body[];
}

function found<Kind extends HTMLElement>(identifier: string): Kind {
  return document.getElementById(identifier) as Kind;
}

function drawSolid(holder: HTMLElement, places: string): void {
  const canvas = holder.querySelector("canvas")!;
  const solid = camgeoSolid.Solid.on(canvas);
  if (!solid) {
    canvas.replaceWith(WORDS.noWebGL);
    return;
  }
  solid.show(camgeoSolid.singles(places));
  for (const button of holder.querySelectorAll("button")) {
    button.addEventListener("click", () => solid.go(button.value));
  }
}

const { animation, charts, prices, solids } = JSON.parse(found("data").textContent) as Data;
const angle = new CamAngle();
const controls = {
  play: found<HTMLButtonElement>("play"),
  speed: found<HTMLSelectElement>("speed"),
  slider: found<HTMLInputElement>("angle"),
  field: found<HTMLInputElement>("degrees"),
  state: found("state"),
};
const player = new Player(angle, controls, (degrees) => (animation ? liftAt(animation, degrees) : ""));

if (animation) {
  const mechanism = new Mechanism(angle, WORDS.mechanism);
  mechanism.update(animation);
  found("mechanism").prepend(mechanism.svg);
}
charts.forEach((each, k) => {
  const chart = new Chart(angle, () => player.stop());
  chart.update(each);
  found(`chart-${k}`).prepend(chart.svg);
  cut(chart.svg, chart.drawing.drawn);
});
if (prices) {
  const drawing = new Drawing();
  drawing.update(prices.figure, prices.sentence);
  found("prices").prepend(drawing.svg);
}
// Once the next script is there, which only pages with solids have.
document.addEventListener("DOMContentLoaded", () => solids.forEach(({ places }, k) => drawSolid(found(`solid-${k}`), places)));
document.documentElement.dataset.ready = "true";
