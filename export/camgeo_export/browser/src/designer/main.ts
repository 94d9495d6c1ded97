// The page of `camgeo design`: its parts, where they stand, and the keys that work everywhere.

import { announcer } from "./announce";
import { Build } from "./build";
import { Charts } from "./charts";
import { Comparison } from "./compare";
import { attribute, button, el, type Panel, panel, say, shown } from "../dom";
import { Effects } from "./effects";
import { Files } from "./files";
import { Findings } from "./findings";
import { Form } from "./form";
import { MechanismView } from "./mechanism_view";
import { MotionView } from "./motion";
import { Session } from "./session";
import { SizeView } from "./size";
import { SolidView } from "./solid_view";
import { LANGUAGE, t, told } from "./strings";
import { TextEditor } from "./text";
import { timings } from "./timings";

const NAME = 120; // letters of a scene's name that are shown in the title

// Undo and redo are those of the scene, also in fields and in its text.
function keys(files: Files): void {
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || document.querySelector("dialog[open]")) return;
    const key = event.key.toLowerCase();
    const act = key === "z" ? () => files.back(event.shiftKey ? "redo" : "undo") : key === "y" && !event.shiftKey ? () => files.back("redo") : key === "s" && !event.shiftKey ? () => files.save() : null;
    if (!act) return;
    event.preventDefault();
    act();
  });
}

function pinning(session: Session): HTMLElement {
  const pin = button(t("pin.pin"), () => session.send({ kind: session.pinned ? "unpin" : "pin" }), { id: "pin", "aria-pressed": "false" });
  session.on(["pinned", "state"], () => {
    const is = session.pinned !== null;
    say(pin, t(is ? "pin.unpin" : "pin.pin"));
    attribute(pin, "aria-pressed", String(is));
    attribute(pin, "title", t(is ? "pin.unpin-label" : "pin.pin-label"));
  });
  return pin;
}

function start(root: HTMLElement): void {
  document.documentElement.lang = LANGUAGE;
  document.title = t("page.name");
  const session = new Session();
  const mechanism = new MechanismView(session);
  const motion = new MotionView(session, () => mechanism.player.stop());
  const charts = new Charts(session, () => mechanism.player.stop());
  const form = new Form(session);
  const text = new TextEditor(session);
  const findings = new Findings(session, (key) => form.reveal(key));
  const files = new Files(session, () => {
    // What was typed into a field and not yet taken is taken first.
    const field = document.activeElement;
    if (field instanceof HTMLInputElement && field.dataset["key"] && ["number", "text"].includes(field.type)) field.dispatchEvent(new Event("change"));
    text.rest();
  });
  const comparison = new Comparison(session);
  const effects = new Effects(session);

  const title = el("h1", {}, t("page.name"));
  const lost = el("p", { class: "banner", role: "alert", hidden: true });
  const busy = el("p", { class: "busy", role: "status", hidden: true });
  const message = el("p", { class: "told", hidden: true });
  const parts: Panel[] = [];
  const part = (name: string, heading: Parameters<typeof t>[0], ...content: HTMLElement[]): HTMLElement => {
    const made = panel(name, t(heading));
    made.body.append(...content);
    parts.push(made);
    return made.section;
  };
  const header = el(
    "header",
    {},
    el("a", { href: "#mechanism", class: "skip" }, t("page.skip")),
    el("div", { class: "bar" }, title, findings.verdict, files.element, pinning(session)),
    lost,
    files.banner,
    // Over the page and not above it: what comes and goes must not move a picture in which is dragged.
    el("div", { class: "over" }, message, busy),
  );
  // Columns, side by side as far as there is room; their order is that of reading.
  const column = (...sections: HTMLElement[]): HTMLElement => el("div", { class: "column" }, ...sections);
  const main = el(
    "main",
    {},
    column(
      part("mechanism", "mechanism.title", mechanism.element),
      part("findings", "findings.title", findings.element),
      part("compare", "compare.title", comparison.element),
    ),
    column(part("motion", "motion.title", motion.element), part("segments", "plan.title", motion.plan.element)),
    el("div", { class: "side" }, column(part("sizes", "form.title", form.element)), column(part("text", "text.title", text.element))),
    column(
      part("effects", "effects.title", effects.element),
      part("size", "size.title", new SizeView(session).element),
      part("build", "build.title", new Build(session).element),
      part("solid", "solid.title", new SolidView(session).element),
    ),
    part("diagrams", "charts.title", charts.element),
  );
  root.replaceChildren(header, main, announcer(), files.dialogs);

  const compare = parts.find((each) => each.section.id === "compare")?.section;
  session.on(["curves", "faults"], () => {
    const name = session.curves?.name?.slice(0, NAME) || session.state?.file || t("page.new-scene");
    say(title, name);
    document.title = `${session.state?.saved === false ? "• " : ""}${t("page.title", { name })}`;
    form.update(session.curves?.form ?? []);
    comparison.update();
    if (compare) shown(compare, session.pinned !== null);
    findings.update();
    text.update();
  });
  session.on("pinned", () => {
    comparison.update();
    if (compare) shown(compare, session.pinned !== null);
  });
  session.on(["findings", "moved"], () => findings.update());
  session.on("state", () => {
    files.update();
    findings.update(); // a verdict on an earlier text is none on this one
    text.update();
  });
  session.on("connection", () => {
    shown(lost, !session.connected);
    say(lost, session.connected ? "" : t(session.ended ? "connection.ended" : "connection.lost"));
    document.documentElement.dataset["connected"] = String(session.connected);
  });
  session.on("busy", () => {
    shown(busy, session.busy !== "");
    say(busy, session.busy && t("connection.wait", { what: told(`busy.${session.busy}`, session.busy) }));
  });
  session.on(["told", "faults"], () => {
    const refused = session.refused && t("text.refused", { message: session.refused });
    const text = [refused, session.message].filter(Boolean).join(" ");
    say(message, text);
    shown(message, text !== "");
    message.classList.toggle("bad", refused !== "");
  });
  session.on(["curves", "faults"], () => {
    document.documentElement.dataset["ready"] = "true";
  });
  keys(files);
  session.open();
  session.send({ kind: "effects" });
  Object.assign(window, { camgeo: { timings, session } });
}

const root = document.getElementById("page");
if (root) start(root);
