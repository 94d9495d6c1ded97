// The page of `camgeo report`: diagrams, the turning mechanism, and a cam angle for both.

const data = JSON.parse(document.getElementById("data").textContent);
const listeners = [];
let angle = 0;

function show(degrees, said = true) {
  angle = ((degrees % 360) + 360) % 360;
  for (const each of listeners) each(angle, said);
}

// The value of a curve at a cam angle, between its points.
function valueAt(points, at) {
  let [low, high] = [0, points.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= at) low = middle;
    else high = middle;
  }
  const [[x0, y0], [x1, y1]] = [points[low], points[high]];
  if (y0 === null || y1 === null) return null;
  return x1 > x0 ? y0 + ((y1 - y0) * (at - x0)) / (x1 - x0) : y1;
}

function chart(holder, found) {
  const { svg, turns } = drawFigure(found.figure, found.sentence);
  holder.prepend(svg);
  for (const { panel, box, place, curves } of turns) {
    const line = make("line", { y1: box.top, y2: box.bottom, class: "cursor" }, svg);
    const text = make("text", { x: box.left + 4, y: panel.legend ? box.bottom - 4 : box.top + 9, class: "value", "font-size": 7.5 }, svg);
    listeners.push((at) => {
      const x = fixed(place.x(at));
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
      const values = curves.map((mark) => valueAt(mark.points, at)).filter((each) => each !== null);
      text.textContent = values.length ? `${at.toFixed(1)}°: ${values.map((each) => numeral(Number(each.toPrecision(4)))).join("; ")}` : "";
    });
    const move = (event) => {
      const matrix = svg.getScreenCTM();
      if (!matrix) return;
      const x = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse()).x;
      show(Math.min(Math.max((360 * (x - box.left)) / (box.right - box.left), 0), 359.999));
    };
    const sheet = make("rect", { x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top, class: "sheet" }, svg);
    sheet.addEventListener("pointerdown", (event) => {
      stop();
      sheet.setPointerCapture(event.pointerId);
      move(event);
    });
    sheet.addEventListener("pointermove", (event) => {
      if (event.buttons) move(event);
    });
  }
}

const BODY = { fill: "white", stroke: "black", "stroke-width": 1.2 };
const LINK = { stroke: "black", "stroke-width": 1.8, "stroke-linecap": "round", fill: "none" };
const THIN = { stroke: "black", "stroke-width": 1 };
const WIDTH = 640;

function mechanism(holder, found) {
  const [[left, low], [right, high]] = [found.low, found.high];
  const k = Math.min(WIDTH / (right - left), 520 / (high - low));
  const place = { x: (x) => (x - left) * k, y: (y) => (high - y) * k, k };
  const [wide, tall] = [(right - left) * k, (high - low) * k];
  const svg = make("svg", { viewBox: `0 0 ${fixed(wide)} ${fixed(tall)}`, role: "img", "aria-label": "The mechanism at the cam angle stated below" });
  const joint = 0.012 * Math.sqrt(wide * tall);
  const disc = make("g", {}, svg);
  drawMarks(found.turning, disc, place);
  const radius = 0.4 * Math.max(...found.turning.flatMap((mark) => mark.radius ?? [])) * k;
  const [ox, oy] = [place.x(0), place.y(0)];
  make("line", { x1: ox, y1: oy, x2: ox + radius, y2: oy, stroke: "#4d4d4d", "stroke-width": 1 }, disc); // shows the turning
  for (const way of found.guides) {
    const [a, b] = [way.start, way.end].map(([x, y]) => [place.x(x), place.y(y)]);
    const long = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const across = [(-(b[1] - a[1]) / long) * joint, ((b[0] - a[0]) / long) * joint];
    for (const side of [1, -1]) {
      const off = side * (way.block ? 1.15 : 0.58);
      const path = [`M${fixed(a[0] + off * across[0])} ${fixed(a[1] + off * across[1])}L${fixed(b[0] + off * across[0])} ${fixed(b[1] + off * across[1])}`];
      const count = Math.max(5, Math.round(long / (1.6 * joint)));
      for (let n = 0; n < count; n++) {
        const share = (n + 0.5) / count;
        const foot = [0, 1].map((c) => a[c] + share * (b[c] - a[c]) + off * across[c]);
        const end = [0, 1].map((c) => foot[c] + side * across[c] - (0.8 * joint * (b[c] - a[c])) / long);
        path.push(`M${fixed(foot[0])} ${fixed(foot[1])}L${fixed(end[0])} ${fixed(end[1])}`);
      }
      make("path", { d: path.join(""), fill: "none", ...THIN }, svg);
    }
  }
  for (const shaft of found.shafts) {
    const [x, y] = [place.x(shaft[0]), place.y(shaft[1])];
    make("path", { d: `M${fixed(x)} ${fixed(y)}l${fixed(-1.6 * joint)} ${fixed(2.6 * joint)}h${fixed(3.2 * joint)}Z`, fill: "none", ...THIN }, svg);
  }
  const movers = [];
  const links = found.links.map(() => make("polyline", LINK, svg));
  const faces = Array.from({ length: found.faces }, () => make("line", { ...THIN, "stroke-width": 3 }, svg));
  const rollers = found.rollers.map((r) => [make("circle", { r: fixed(r * k), ...BODY }, svg), make("circle", { r: fixed(Math.min(joint, 0.4 * r * k)), ...BODY }, svg)]);
  const joints = Array.from({ length: found.joints }, () => make("circle", { r: fixed(joint), ...BODY }, svg));
  const blocks = found.guides.filter((way) => way.block).map((way) => {
    const turn = (Math.atan2(-(way.end[1] - way.start[1]), way.end[0] - way.start[0]) * 180) / Math.PI;
    const block = make("g", {}, svg);
    make("rect", { x: fixed(-1.6 * joint), y: fixed(-joint), width: fixed(3.2 * joint), height: fixed(2 * joint), transform: `rotate(${fixed(turn)})`, ...BODY }, block);
    make("circle", { r: fixed(joint), ...BODY }, block);
    return block;
  });
  for (const shaft of found.shafts) make("circle", { cx: fixed(place.x(shaft[0])), cy: fixed(place.y(shaft[1])), r: fixed(joint), ...BODY }, svg);
  make("circle", { cx: ox, cy: oy, r: fixed(joint), ...BODY }, svg);
  const count = found.places.length;
  movers.push((at) => {
    disc.setAttribute("transform", `rotate(${fixed(-found.rotation * at)} ${fixed(ox)} ${fixed(oy)})`);
    const share = (at / 360) * count;
    const [first, second] = [Math.floor(share) % count, (Math.floor(share) + 1) % count];
    const rest = share - Math.floor(share);
    const points = found.places[first].map(([x, y], n) => {
      const [u, v] = found.places[second][n];
      return [fixed(place.x(x + rest * (u - x))), fixed(place.y(y + rest * (v - y)))];
    });
    const next = points[Symbol.iterator]();
    const take = () => next.next().value;
    links.forEach((link, n) => link.setAttribute("points", Array.from({ length: found.links[n] }, take).map((p) => p.join(",")).join(" ")));
    for (const face of faces) {
      const [[x1, y1], [x2, y2]] = [take(), take()];
      for (const [key, value] of Object.entries({ x1, y1, x2, y2 })) face.setAttribute(key, value);
    }
    const put = (circle, [x, y]) => {
      circle.setAttribute("cx", x);
      circle.setAttribute("cy", y);
    };
    for (const [rim, hub] of rollers) {
      const at = take();
      put(rim, at);
      put(hub, at);
    }
    for (const each of joints) put(each, take());
    for (const block of blocks) block.setAttribute("transform", `translate(${take().join(" ")})`);
  });
  holder.prepend(svg);
  listeners.push(...movers);
  return (at) => {
    const share = (at / 360) * count;
    const [first, rest] = [Math.floor(share) % count, share - Math.floor(share)];
    const lift = found.lifts[first] + rest * (found.lifts[(first + 1) % count] - found.lifts[first]);
    return `${numeral(Number(lift.toFixed(3)))} ${found.lift_unit}`;
  };
}

const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
const STEP = 15; // degrees at once, where motion is not wanted
const play = document.getElementById("play");
let playing = false;
let before = 0;

function stop() {
  playing = false;
  play.textContent = "Play";
  play.setAttribute("aria-pressed", "false");
}

function turn(now) {
  if (!playing) return;
  const seconds = Number(document.getElementById("speed").value);
  const passed = Math.min((now - before) / 1000, 0.25);
  if (!calm.matches) {
    before = now;
    show(angle + (360 * passed) / seconds, false);
  } else if (now - before > (1000 * seconds * STEP) / 360) {
    before = now;
    show(angle + STEP, false);
  }
  requestAnimationFrame(turn);
}

play.addEventListener("click", () => {
  if (playing) {
    stop();
    show(angle);
    return;
  }
  playing = true;
  play.textContent = "Pause";
  play.setAttribute("aria-pressed", "true");
  before = performance.now();
  requestAnimationFrame(turn);
});

const slider = document.getElementById("angle");
const field = document.getElementById("degrees");
for (const input of [slider, field]) {
  input.addEventListener("input", () => {
    const value = input.valueAsNumber;
    if (!Number.isFinite(value)) return;
    stop();
    show(Math.min(Math.max(value, 0), 359.999));
  });
}

let lift = () => "";
const holder = document.getElementById("mechanism");
if (data.animation) lift = mechanism(holder, data.animation);
data.charts.forEach((found, k) => chart(document.getElementById(`chart-${k}`), found));
if (data.prices) {
  const { svg } = drawFigure(data.prices.figure, data.prices.sentence);
  document.getElementById("prices").prepend(svg);
}

data.solids.forEach((found, k) => solid(document.getElementById(`solid-${k}`), found));

const state = document.getElementById("state");
let told = 0;
listeners.push((at, said) => {
  if (document.activeElement !== slider || !said) slider.value = at.toFixed(1);
  if (document.activeElement !== field) field.value = at.toFixed(1);
  slider.setAttribute("aria-valuetext", `${at.toFixed(1)} degrees`);
  clearTimeout(told);
  const tell = () => {
    state.textContent = `Cam angle ${at.toFixed(1)}°${data.animation ? `, follower at ${lift(at)}` : ""}`;
  };
  // Said once the angle rests: not sixty times a second.
  if (said) told = setTimeout(tell, 300);
});
show(0);
document.documentElement.dataset.ready = "true";
