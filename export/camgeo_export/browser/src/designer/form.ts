// The sizes: a group for each part of the scene, with its kinds and a field for each value.

import { el, fresh, type Kept, keyed, say, shown } from "./dom";
import { FieldView } from "./field";
import type { Field, Section } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

// Of several tables of one kind, the how manieth it is.
function named(section: Section): string {
  const number = /\[(\d+)\]$/.exec(section.key)?.[1];
  return number ? `${section.title} ${number}` : section.title;
}

export class Form {
  readonly element = el("div", { class: "form" });
  private readonly help = el("p", { class: "helpline" }, t("form.help"));
  private readonly sections = el("div");
  private readonly show: (items: readonly Section[]) => void;
  private readonly open = new Set(["", "cam", "follower", "linkage"]);

  constructor(private readonly session: Session) {
    this.element.append(this.sections, this.help);
    this.show = keyed(this.sections, (section) => section.key, (section) => this.section(section));
    this.element.addEventListener("camgeo-hint", (event) => say(this.help, (event as CustomEvent<string>).detail));
  }

  update(sections: Section[]): void {
    // Effects that are off are switched on where all of them stand.
    this.show(sections.filter((section) => section.stated !== false || !section.key.startsWith("effects.")));
  }

  // Shows the field of a key, and puts the focus in it.
  reveal(key: string): boolean {
    const found = [...document.querySelectorAll<HTMLElement>("[data-key]")].find((each) => each.dataset["key"] === key);
    if (!found) return false;
    found.closest("details")?.setAttribute("open", "");
    found.scrollIntoView({ block: "center" });
    found.focus();
    return true;
  }

  private section(section: Section): Kept<Section> {
    const fields = el("div", { class: "fields" });
    const list = keyed<Field>(fields, (field) => `${field.key} ${field.type} ${Boolean(field.slider)}`, (field) => {
      return new FieldView(this.session, field, { name: t("form.field", { section: named(section), title: field.title }) });
    });
    const id = fresh();
    const kinds = el("select", { id, "data-kinds": section.key, "aria-label": t("form.field", { section: named(section), title: t("form.kind") }) });
    kinds.addEventListener("change", () => this.session.change({ table: { key: section.key, kind: kinds.value } }));
    const about = el("p", { class: "about" });
    const kind = el("div", { class: "field choice" }, el("label", { for: id }, t("form.kind")), el("div", { class: "entry" }, kinds), about);
    const title = el("summary", {}, section.title);
    const meant = el("p", { class: "about" });
    const element = el("details", { open: this.open.has(section.key) && section.stated !== false, "data-section": section.key }, title, meant, kind, fields);
    return {
      element,
      update: (next) => {
        const name = named(next);
        say(title, next.stated === false ? t("form.unstated", { title: name }) : name);
        say(meant, next.description ?? "");
        shown(meant, Boolean(next.description));
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
