// The widget of notebooks, as anywidget wants it: the turning mechanism, and a diagram with the same
// cam angle. It lives in a shadow root, so that its styles and those of the notebook stay apart.

import { CamAngle } from "./angle";
import { Chart } from "./chart";
import { make, makeControls } from "./controls";
import type { Animation, Charted } from "./data";
import drawingStyle from "./drawing.css";
import { liftAt, Mechanism } from "./mechanism";
import { Player } from "./player";
import viewerStyle from "./viewer.css";
import { WORDS } from "./words";

interface Data {
  animation: Animation | null;
  charts: (Charted & { title?: string })[];
}

interface Model {
  get(name: "data"): Data | null | undefined;
  on(event: "change:data", listener: () => void): void;
  off(event: "change:data", listener: () => void): void;
}

function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const host = make("div");
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
  const note = make("figcaption");
  const sentence = make("figcaption");
  const choice = make("select", { ariaLabel: WORDS.diagram });
  const left = make("figure", {}, mechanism.svg, note);
  const right = make("figure", {}, choice, chart.svg, sentence);
  const pictures = make("div", { className: "pictures" }, left, right);
  root.append(make("div", { className: "viewer" }, controls, pictures));
  for (const kind of ["keydown", "keyup", "keypress"]) host.addEventListener(kind, (event) => event.stopPropagation());

  const choose = () => {
    const chosen = data.charts[Math.max(0, choice.selectedIndex)];
    if (!chosen) return;
    chart.update(chosen);
    sentence.textContent = chosen.sentence;
  };
  const update = () => {
    data = model.get("data") ?? { animation: null, charts: [] };
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
  el.append(host);
  return () => {
    model.off("change:data", update);
    player.dispose();
    mechanism.dispose();
    chart.dispose();
    host.remove();
  };
}

export default { render };
