// The sizes: a group for each part of the scene, with its kinds and a field for each value.

import { el, fresh, type Kept, keyed, say, shown } from "../dom";
import { FieldView } from "./field";
import type { Field, Section } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

export class Form {
  readonly element = el("div", { class: "form" });
  private readonly help = el("p", { class: "helpline" }, t("form.help"));
  private readonly sections = el("div");
  private readonly others = el("div");
  private readonly rest = el("details", { class: "rest", hidden: true }, el("summary", {}, t("form.rest")), this.others);
  private readonly show: (items: readonly Section[]) => void;
  private readonly open = new Set(["", "cam", "follower", "linkage"]);

  constructor(private readonly session: Session) {
    this.element.append(this.sections, this.rest, this.help);
    const show = [this.sections, this.others].map((holder) => keyed<Section>(holder, (section) => section.key, (section) => this.section(section)));
    this.show = (sections) => {
      // Effects that are off are switched on where all of them stand.
      const off = sections.filter((section) => section.stated === false && !section.key.startsWith("effects"));
      show[0]?.(sections.filter((section) => section.stated !== false));
      show[1]?.(off);
      shown(this.rest, off.length > 0);
    };
    this.element.addEventListener("camgeo-hint", (event) => say(this.help, (event as CustomEvent<string>).detail));
  }

  update(sections: Section[]): void {
    this.show(sections);
  }

  private tell(title: string, text: string): void {
    say(this.help, text ? `${title}: ${text}` : title);
  }

  // Shows the field of a key, and puts the focus in it.
  reveal(key: string): boolean {
    const found = [...document.querySelectorAll<HTMLElement>("[data-key]")].find((each) => each.dataset["key"] === key);
    if (!found) return false;
    for (let at = found.closest("details"); at; at = at.parentElement?.closest("details") ?? null) at.open = true;
    found.scrollIntoView({ block: "center" });
    found.focus();
    return true;
  }

  private section(section: Section): Kept<Section> {
    const fields = el("div", { class: "fields" });
    const list = keyed<Field>(fields, (field) => `${field.key} ${field.type} ${Boolean(field.slider)}`, (field) => {
      return new FieldView(this.session, field, { name: t("form.field", { section: section.title, title: field.title }) });
    });
    const id = fresh();
    const kinds = el("select", { id, "data-kinds": section.key, "aria-label": t("form.field", { section: section.title, title: t("form.kind") }) });
    kinds.addEventListener("change", () => this.session.change({ table: { key: section.key, kind: kinds.value } }));
    const about = el("p", { id: fresh(), hidden: true });
    kinds.setAttribute("aria-describedby", about.id);
    kinds.addEventListener("focus", () => this.tell(kinds.selectedOptions[0]?.textContent ?? "", about.textContent));
    const kind = el("div", { class: "field choice" }, el("label", { for: id }, t("form.kind")), el("div", { class: "entry" }, kinds), about);
    const title = el("summary", {}, section.title);
    const note = el("p", { class: "note", hidden: true });
    const meant = el("p", { id: fresh(), hidden: true });
    title.setAttribute("aria-describedby", meant.id);
    title.addEventListener("focus", () => this.tell(title.textContent, meant.textContent));
    const element = el("details", { open: this.open.has(section.key) && section.stated !== false, "data-section": section.key }, title, meant, note, kind, fields);
    return {
      element,
      update: (next) => {
        say(title, next.title);
        say(meant, next.description ?? "");
        const own = this.session.faults.filter((each) => each.key === next.key && each.key !== "").map((each) => each.message);
        say(note, own.join(" "));
        shown(note, own.length > 0);
        const all = next.kinds ?? [];
        shown(kind, all.length > 0);
        const text = JSON.stringify(all);
        if (kinds.dataset["choices"] !== text) {
          kinds.dataset["choices"] = text;
          const none = next.kind ? [] : [el("option", { value: "" }, t("form.none"))];
          kinds.replaceChildren(...none, ...all.map((each) => el("option", { value: each.value }, each.title ?? each.value)));
        }
        kinds.value = next.kind ?? "";
        say(about, all.find((each) => each.value === next.kind)?.description ?? "");
        list(next.fields);
      },
    };
  }
}
