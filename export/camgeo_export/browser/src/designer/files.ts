// The scene's file: what it is called, whether it is saved, undo and redo, and the dialogs about files.

import { attribute, button, el, fresh, say, shown } from "../dom";
import type { Session } from "./session";
import { t } from "./strings";

export class Files {
  readonly element = el("div", { class: "files", role: "group" });
  readonly banner = el("div", { class: "banner", hidden: true });
  readonly dialogs = el("div");
  private readonly name = el("span", { class: "file" });
  private readonly saved = el("span", { class: "saved" });
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private readonly keep: HTMLButtonElement;

  private asked = ""; // the name under which the scene was to be saved last

  constructor(
    private readonly session: Session,
    private readonly settle: () => void,
  ) {
    session.on("refused", () => session.overwrites && this.force());
    this.undo = button(t("file.undo"), () => this.back("undo"), { id: "undo", "aria-keyshortcuts": "Control+Z" });
    this.redo = button(t("file.redo"), () => this.back("redo"), { id: "redo", "aria-keyshortcuts": "Control+Shift+Z" });
    this.keep = button(t("file.save"), () => this.save(), { id: "save", "aria-keyshortcuts": "Control+S" });
    attribute(this.element, "aria-label", t("file.name"));
    this.element.append(
      el("span", { class: "status" }, this.name, " ", this.saved),
      this.undo,
      this.redo,
      this.keep,
      button(t("file.save-as"), () => this.saveAs(), { id: "save-as" }),
      button(t("file.open"), () => this.choose(), { id: "open" }),
      button(t("file.new"), () => this.begin(), { id: "new" }),
    );
  }

  back(kind: "undo" | "redo"): void {
    this.settle();
    this.session.send({ kind });
  }

  save(): void {
    this.settle();
    this.asked = "";
    if (this.session.state?.file) this.session.send({ kind: "save" });
    else this.saveAs();
  }

  update(): void {
    const { state } = this.session;
    if (!state) return;
    const file = state.file ?? "";
    say(this.name, file.split("/").at(-1) || t("file.none"));
    attribute(this.name, "title", file);
    say(this.saved, t(state.saved ? "file.saved" : "file.unsaved"));
    this.saved.classList.toggle("unsaved", !state.saved);
    for (const [element, label, key, of] of [[this.undo, state.undo, "file.undo", "file.undo-of"], [this.redo, state.redo, "file.redo", "file.redo-of"]] as const) {
      // Said to be off, but not switched off: a button that has the focus would lose it.
      attribute(element, "aria-disabled", label === null ? "true" : null);
      attribute(element, "title", label ? t(of, { label }) : t(key));
    }
    this.disk();
  }

  private disk(): void {
    const disk = this.session.state?.disk ?? "same";
    if (this.banner.dataset["disk"] === disk) return;
    this.banner.dataset["disk"] = disk;
    shown(this.banner, disk !== "same");
    if (disk === "same") return this.banner.replaceChildren();
    const changed = disk === "changed";
    this.banner.replaceChildren(
      el("p", { role: "alert" }, `! ${t(changed ? "file.changed" : "file.gone")}`),
      changed ? button(t("file.take"), () => this.session.send({ kind: "reload" })) : "",
      button(t(changed ? "file.overwrite" : "file.write-again"), () => {
        this.settle();
        this.session.send({ kind: "save", force: true });
      }),
    );
  }

  private dialog(title: string, confirm: string, done: () => void, ...content: Node[]): void {
    const id = fresh();
    const from = document.activeElement;
    const form = el(
      "form",
      { method: "dialog" },
      el("h2", { id }, title),
      ...content,
      el("div", { class: "actions" }, el("button", { type: "submit", class: "main" }, confirm), button(t("dialog.cancel"), () => dialog.close())),
    );
    const dialog = el("dialog", { "aria-labelledby": id }, form);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      dialog.close();
      done();
    });
    dialog.addEventListener("close", () => {
      dialog.remove();
      if (from instanceof HTMLElement) from.focus();
    });
    this.dialogs.append(dialog);
    dialog.showModal();
  }

  // What is there was not read here: it is overwritten only if that is said.
  private force(): void {
    const message = el("p", {}, this.session.refused);
    const path = this.asked ? { path: this.asked } : {};
    this.dialog(t("file.title-force"), t("file.overwrite"), () => this.session.send({ kind: "save", ...path, force: true }), message);
  }

  private saveAs(): void {
    this.settle();
    const id = fresh();
    const name = el("input", { id, type: "text", required: true, autocomplete: "off", spellcheck: "false", value: this.session.state?.file ?? "scene.toml" });
    const there = new Set(this.session.state?.folder_files ?? []);
    const note = el("p", { class: "note", id: `${id}-note`, hidden: true }, t("file.exists"));
    attribute(name, "aria-describedby", note.id);
    const warn = (): void => shown(note, there.has(name.value.trim()) && name.value.trim() !== this.session.state?.file);
    name.addEventListener("input", warn);
    warn();
    this.dialog(
      t("file.title-save-as"),
      t("file.save"),
      () => {
        this.asked = name.value.trim();
        this.session.send({ kind: "save", path: this.asked, ...(note.hidden ? {} : { force: true }) });
      },
      el("label", { for: id }, t("file.name")),
      name,
      note,
    );
  }

  private choose(): void {
    this.settle();
    const files = this.session.state?.folder_files ?? [];
    if (!files.length) return this.dialog(t("file.title-open"), t("dialog.close"), () => undefined, el("p", {}, t("file.no-scenes")));
    const id = fresh();
    const list = el("select", { id, size: Math.min(12, Math.max(4, files.length)) }, ...files.map((each) => el("option", { value: each }, each)));
    list.value = this.session.state?.file ?? files[0] ?? "";
    if (list.selectedIndex < 0) list.selectedIndex = 0;
    this.dialog(t("file.title-open"), t("file.open").replace(/ …$/, ""), () => this.session.send({ kind: "open", path: list.value }), this.keeps(), el("label", { for: id }, t("file.choose")), list);
  }

  private begin(): void {
    this.settle();
    const id = fresh();
    const list = el("select", { id, size: 8 });
    const own = this.session.state?.templates ?? [];
    list.replaceChildren(...own.map((each) => el("option", { value: each }, each.replaceAll("-", " "))));
    list.selectedIndex = 0;
    this.dialog(
      t("file.title-new"),
      t("file.new").replace(/ …$/, ""),
      () => list.value && this.session.send({ kind: "new", template: list.value }),
      this.keeps(),
      el("label", { for: id }, t("file.template")),
      list,
    );
  }

  private keeps(): HTMLElement {
    return el("p", { hidden: this.session.state?.saved !== false }, t("file.keeps"));
  }
}
