// The findings, each with its place and next step, and the cures, which are applied at a click.

import { attribute, button, el, say, shown } from "../dom";
import type { Finding } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

// A figure and a note are no verdict, and have signs of their own.
const SIGNS: Record<string, string> = { ok: "✓", warning: "!", broken: "✗", "no-disc": "✗", invalid: "✗", unknown: "✗", waiting: "…", figure: "=", note: "–" };

// Where the verdict leads to.
const FINDINGS = "#findings";
const FAULTS = "#text";

export class Findings {
  readonly element = el("div", { class: "findings" });
  readonly verdict = el("a", { href: FINDINGS, class: "verdict" });
  private readonly sentence = el("p", { class: "sentence" });
  private readonly bad = el("ul", { class: "list" });
  private readonly kept = el("ul", { class: "list" });
  private readonly summary = el("summary");
  private readonly more = el("details", { hidden: true }, this.summary, this.kept);
  private readonly cures = el("div", { class: "cures", hidden: true });

  constructor(
    private readonly session: Session,
    private readonly reveal: (key: string) => boolean,
  ) {
    this.element.append(this.sentence, this.bad, this.cures, this.more);
    say(this.sentence, t("findings.waiting"));
  }

  update(): void {
    const { findings: found, known, revision, held } = this.session;
    const old = !found || found.revision < revision;
    const faulty = known !== null && known.faults.length > 0;
    const sentence = known?.sentence ?? t("findings.waiting");
    const severity = known?.severity ?? "waiting";
    this.element.classList.toggle("old", old && !faulty);
    say(this.verdict, `${SIGNS[severity] ?? "✗"} ${sentence}`);
    attribute(this.verdict, "class", `verdict ${severity}`);
    attribute(this.verdict, "href", faulty ? FAULTS : FINDINGS);
    // Not while something is dragged: what grows above a picture would move it.
    if (held) return;
    say(this.sentence, faulty && (old || !found.findings) ? t("findings.faulty") : sentence);
    if (old && !faulty) return;
    const all = (!old && found.findings) || [];
    const bad = all.filter((each) => each.severity !== "ok");
    this.list(this.bad, bad);
    const kept = all.filter((each) => each.severity === "ok");
    shown(this.more, kept.length > 0);
    say(this.summary, t("findings.all", { n: kept.length }));
    this.list(this.kept, kept);
    const cures = (!old && found.cures) || [];
    shown(this.cures, cures.length > 0);
    this.cures.replaceChildren(
      el("p", {}, t("findings.cures")),
      el(
        "ul",
        { class: "list" },
        ...cures.map((cure) =>
          cure.works
            ? el("li", {}, el("span", {}, cure.sentence), button(t("findings.cure"), () => this.session.change({ cure: cure.index }), { "aria-label": t("findings.cure-label", { sentence: cure.sentence }), "data-cure": cure.index }))
            : el("li", {}, t("findings.no-cure", { sentence: cure.sentence })),
        ),
      ),
    );
  }

  // Drawn anew only if it says something else, so that no button goes from under a pointer.
  private list(parent: HTMLElement, findings: Finding[]): void {
    const text = JSON.stringify(findings);
    if (parent.dataset["shown"] === text) return;
    parent.dataset["shown"] = text;
    parent.replaceChildren(...findings.map((each) => this.item(each)));
  }

  private item(finding: Finding): HTMLElement {
    const { at_degrees: at, key } = finding;
    const angle = at === null ? "" : String(Number(at.toFixed(1)));
    return el(
      "li",
      { class: "finding" },
      el("p", {}, el("strong", { class: `severity ${finding.verdict}` }, `${SIGNS[finding.verdict] ?? "!"} ${finding.mark}`), ` ${finding.about}: `, finding.sentence),
      finding.step ? el("p", { class: "step" }, `${t("findings.step")}: ${finding.step}`) : null,
      el(
        "div",
        { class: "actions" },
        at === null ? null : button(t("findings.show", { angle }), () => this.session.angle.set(at), { "data-at": angle }),
        key ? button(t("findings.edit", { key }), () => this.reveal(key)) : null,
      ),
    );
  }
}
