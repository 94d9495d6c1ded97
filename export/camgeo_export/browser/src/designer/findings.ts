// The findings, each with its place and next step, and the cures, which are applied at a click.

import { attribute, button, el, say, shown } from "../dom";
import type { Finding } from "./model";
import type { Session } from "./session";
import { t } from "./strings";

const SIGNS: Record<string, string> = { ok: "✓", warning: "!", broken: "✗", "no-disc": "✗", invalid: "✗" };

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
    const { findings: found, faults } = this.session;
    const old = !found || found.revision < this.session.revision;
    this.element.classList.toggle("old", old);
    if (faults.length > 0) return this.faulty(faults.length);
    if (this.verdict.hash === FAULTS) this.tell("waiting", FINDINGS, t("findings.waiting"), t("findings.waiting"));
    // Not while something is dragged: what grows above a picture would move it.
    if (!found || old || this.session.held) return;
    const all = found.findings ?? [];
    const bad = all.filter((each) => each.severity !== "ok");
    const verdict = found.verdict || t(all.length ? "findings.kept" : "findings.none");
    const worst = bad.length ? this.worst(bad) : "ok";
    this.tell(worst, FINDINGS, `${SIGNS[worst] ?? "!"} ${verdict}`, verdict);
    this.list(this.bad, bad);
    const kept = all.filter((each) => each.severity === "ok");
    shown(this.more, kept.length > 0);
    say(this.summary, t("findings.all", { n: kept.length }));
    this.list(this.kept, kept);
    const cures = found.cures ?? [];
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

  private worst(bad: Finding[]): string {
    return ["invalid", "no-disc", "broken", "warning"].find((each) => bad.some((one) => one.severity === each)) ?? "warning";
  }

  // A scene with faults has no findings; the faults are listed beside its text.
  private faulty(count: number): void {
    this.tell("invalid", FAULTS, `${SIGNS["invalid"]} ${t("findings.faults", { n: count })}`, t("findings.faulty"));
    this.list(this.bad, []);
    shown(this.more, false);
    shown(this.cures, false);
  }

  private tell(severity: string, place: string, verdict: string, sentence: string): void {
    say(this.sentence, sentence);
    say(this.verdict, verdict);
    attribute(this.verdict, "class", `verdict ${severity}`);
    attribute(this.verdict, "href", place);
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
      el("p", {}, el("strong", { class: `severity ${finding.severity}` }, `${SIGNS[finding.severity] ?? "!"} ${finding.mark}`), ` ${finding.about}: `, finding.sentence),
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
