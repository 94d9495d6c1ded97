// The widget of notebooks, as anywidget wants it: the turning mechanism, and a diagram with the same
// cam angle. It lives in a shadow root, so that its styles and those of the notebook stay apart.

import { CamAngle } from "./angle";
import { Chart } from "./chart";
import { makeControls } from "./controls";
import type { Animation, Charted } from "./data";
import { el, table } from "./dom";
import drawingStyle from "./drawing.css";
import { liftAt, Mechanism } from "./mechanism";
import { withLists } from "./packing";
import { Player } from "./player";
import viewerStyle from "./viewer.css";
import { WORDS } from "./words";

// The extremes of a curve, as they are read, at cam angles in degrees.
interface Reading {
  name: string;
  low: string;
  low_at: number;
  high: string;
  high_at: number;
}

interface Data {
  animation: Animation | null;
  charts: (Charted & { title?: string; readings?: Reading[] })[];
}

type Change = "change:data" | "change:angle";

interface Model {
  get(name: "data"): Data | null | undefined;
  get(name: "angle"): number | null | undefined;
  set(name: "angle", degrees: number): void;
  save_changes(): void;
  on(event: Change, listener: () => void): void;
  off(event: Change, listener: () => void): void;
}

const APART = 100; // milliseconds between two messages to Python while the cam turns

function tableOf(readings: Reading[]): HTMLElement {
  const rows = readings.map((each) => [each.name, each.low, `${each.low_at}°`, each.high, `${each.high_at}°`]);
  return table(WORDS.extremes, WORDS.extremesOf, rows);
}

function render({ model, el: place }: { model: Model; el: HTMLElement }): () => void {
  const host = el("div");
  host.dataset.lmSuppressShortcuts = "true"; // keys pressed here are not commands of JupyterLab
  const root = host.attachShadow({ mode: "open" });
  const style = new CSSStyleSheet();
  style.replaceSync(drawingStyle + viewerStyle);
  root.adoptedStyleSheets = [style];

  let data: Data = { animation: null, charts: [] };
  const angle = new CamAngle();
  const [controls, parts] = makeControls();
  const player = new Player(angle, parts, (degrees) => (data.animation ? liftAt(data.animation, degrees) : ""));
  const mechanism = new Mechanism(angle, WORDS.mechanism);
  const chart = new Chart(angle, () => player.stop());
  const note = el("figcaption");
  const sentence = el("figcaption");
  const choice = el("select", { "aria-label": WORDS.diagram });
  const left = el("figure", { class: "mechanism" }, mechanism.svg, note);
  const extremes = el("details");
  const right = el("figure", {}, choice, chart.svg, sentence, extremes);
  const pictures = el("div", { class: "pictures" }, left, right);
  root.append(el("div", { class: "viewer" }, controls, pictures));
  for (const kind of ["keydown", "keyup", "keypress"]) host.addEventListener(kind, (event) => event.stopPropagation());

  const choose = () => {
    const chosen = data.charts[Math.max(0, choice.selectedIndex)];
    if (!chosen) return;
    chart.update(chosen);
    sentence.textContent = chosen.sentence;
    extremes.hidden = !chosen.readings?.length;
    extremes.replaceChildren(el("summary", {}, WORDS.extremes), tableOf(chosen.readings ?? []));
  };
  const update = () => {
    data = withLists(model.get("data") ?? { animation: null, charts: [] });
    const { animation, charts } = data;
    if (animation) mechanism.update(animation);
    note.textContent = animation?.note ?? "";
    left.hidden = !animation;
    const before = choice.value;
    choice.replaceChildren(...charts.map(({ title, sentence: said }) => new Option(title ?? said)));
    choice.selectedIndex = Math.max(0, [...choice.options].findIndex((each) => each.value === before));
    choice.hidden = charts.length < 2;
    right.hidden = !charts.length;
    pictures.classList.toggle("both", !left.hidden && !right.hidden);
    choose();
    angle.set(angle.degrees);
  };
  choice.addEventListener("change", choose);
  model.on("change:data", update);
  update();

  // The angle of the model is Python's: it is told when the cam rests, and now and then in between.
  let told = 0;
  const take = () => {
    const degrees = model.get("angle");
    if (typeof degrees !== "number" || degrees === angle.degrees) return;
    player.stop();
    angle.set(degrees);
  };
  const tell = (degrees: number, rests: boolean) => {
    const now = performance.now();
    if (degrees === model.get("angle") || (!rests && now - told < APART)) return;
    told = now;
    model.off("change:angle", take); // what follows is no news
    model.set("angle", degrees);
    model.on("change:angle", take);
    model.save_changes();
  };
  take();
  model.on("change:angle", take);
  const forget = angle.listen(tell);
  place.append(host);
  return () => {
    model.off("change:data", update);
    model.off("change:angle", take);
    forget();
    player.dispose();
    mechanism.dispose();
    chart.dispose();
    host.remove();
  };
}

export default { render };
