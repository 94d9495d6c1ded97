// What the page knows, and who wants to be told of it. Views ask for changes here, and draw what comes.

import { CamAngle } from "../angle";
import { withLists } from "../packing";
import { announce } from "./announce";
import { type Ask, Connection } from "./connection";
import type { BuiltFile, Change, Curves, Effect, Fault, Found, FromServer, Law, Sized, State, ToServer, Verdict } from "./model";
import { moved } from "./moved";
import { t } from "./strings";
import { painted, timings, took } from "./timings";

export type Topic = "state" | "curves" | "moved" | "faults" | "refused" | "findings" | "pinned" | "connection" | "built" | "solid" | "sized" | "laws" | "effects" | "busy" | "told" | "hold";

const NEVER: Fault[] = [];
const ANSWERS = ["built", "solid", "sized", "refused"]; // of what the page is told to wait for

export class Session {
  state: State | null = null;
  text = "";
  curves: Curves | null = null; // the last without faults
  stale = false; // they are not of the present text
  verdict: Verdict | null = null; // the last, see `known`
  faults: Fault[] = NEVER;
  refused = "";
  overwrites = false; // whether what was refused can be forced
  findings: (Found & { revision: number }) | null = null;
  pinned: Curves | null = null;
  built: { files: BuiltFile[]; findings: string[]; faults: Fault[]; revision: number; message: string } | null = null;
  solid: { solids: { name: string; places: string }[]; revision: number } | null = null;
  sized: (Sized & { revision: number }) | null = null;
  laws: { segment: number; laws: Law[] } | null = null;
  effects: Effect[] = [];
  busy = "";
  message = "";
  connected = false;
  ended = false;
  readonly angle = new CamAngle();
  held = ""; // the picture that must not change its scale, because something is dragged in it
  revision = -1;

  private readonly calls = new Map<Topic, (() => void)[]>();
  private readonly due = new Set<Topic>();
  private readonly connection: Connection;
  private gestures = 0;

  constructor() {
    this.connection = new Connection({
      message: (found) => this.heard(found),
      answered: (id, asked) => {
        if (!asked) return;
        const answered = performance.now();
        painted((at) => took({ id, gesture: asked.gesture, input: asked.input, sent: asked.sent, answered, painted: at }));
      },
      connected: (is, ended) => {
        if (is && this.state) announce(t("connection.back"));
        [this.connected, this.ended] = [is, ended];
        if (is) this.revision = -1; // what comes first is what there is
        this.tell("connection");
      },
    });
  }

  // Whether a change is on its way.
  get waits(): boolean {
    return this.connection.busy;
  }

  // The verdict on the present text; null as long as there is none.
  get known(): Verdict | null {
    return this.verdict && this.verdict.revision >= this.revision ? this.verdict : null;
  }

  // What is wrong at a key, or within its value.
  faultsAt(key: string): Fault[] {
    return this.faults.filter((each) => each.key === key || [".", "["].some((mark) => each.key.startsWith(`${key}${mark}`)));
  }

  open(): void {
    this.connection.open();
  }

  on(topics: Topic | Topic[], call: () => void): void {
    for (const topic of [topics].flat()) this.calls.set(topic, [...(this.calls.get(topic) ?? []), call]);
  }

  // Tells those who listen, once for each message or event however often it is asked for, and before
  // the next frame, which has only to be painted then.
  tell(...topics: Topic[]): void {
    if (!this.due.size) {
      queueMicrotask(() => {
        const calls = new Set([...this.due].flatMap((topic) => this.calls.get(topic) ?? []));
        this.due.clear();
        for (const call of calls) call();
      });
    }
    for (const topic of topics) this.due.add(topic);
  }

  // A name under which several changes are one step to undo.
  gesture(): string {
    this.gestures += 1;
    return `${Math.floor(performance.timeOrigin)}-${this.gestures}`;
  }

  change(change: Change, ask: Omit<Ask, "change"> = {}, slot: string | null = null): number {
    return this.connection.change({ ...ask, change }, slot);
  }

  write(text: string, gesture: string): number {
    return this.connection.change({ change: { text }, gesture }, "text");
  }

  send(message: ToServer): void {
    this.connection.send(message);
  }

  hold(name: string): void {
    this.held = name;
    this.tell("hold", "curves", "findings");
  }

  private heard(found: FromServer): void {
    if (this.busy && ANSWERS.includes(found.kind)) {
      this.busy = "";
      this.tell("busy");
    }
    switch (found.kind) {
      case "state": {
        const { kind: _, text, ...rest } = found;
        this.state = rest;
        this.revision = Math.max(this.revision, found.revision);
        if (typeof text === "string") {
          this.text = text;
          this.message = ""; // it was said of what was there before
        }
        this.tell("state", "told");
        break;
      }
      case "verdict": {
        const { kind: _, ...rest } = found;
        if (rest.revision < this.revision) return;
        const late = rest.revision === this.revision; // what comes before its curves is said with them
        [this.verdict, this.faults] = [rest, rest.faults];
        this.tell("faults");
        if (late && rest.faults.length) announce(`${rest.sentence} ${rest.faults[0]?.message ?? ""}`);
        break;
      }
      case "curves": {
        const { kind: _, revision, answers: __, ...rest } = found;
        if (revision < this.revision) return;
        withLists(rest);
        this.revision = revision;
        if (typeof rest.text === "string") this.text = rest.text;
        this.refused = rest.refused ?? "";
        if (typeof found.answers === "number") this.message = ""; // it was said before this
        this.stale = !rest.charts;
        // With faults the last pictures stay; what can be entered is that of the text all the same.
        if (rest.charts) this.curves = rest;
        else if (rest.form?.length) this.curves = { ...this.curves, faults: rest.faults, form: rest.form, plan: rest.plan ?? [], effects: rest.effects ?? [] };
        this.tell("curves", "faults", "told");
        if (this.refused) announce(t("text.refused", { message: this.refused }));
        else if (this.faults.length) announce(`${t("text.faults", { n: this.faults.length })} ${this.faults[0]?.message ?? ""}`);
        else if (rest.label) announce(t("announce.changed", { label: rest.label }));
        break;
      }
      case "moved": {
        const { kind: _, revision, answers: __, ...rest } = found;
        if (revision < this.revision) return;
        this.revision = revision;
        if (typeof rest.text === "string") this.text = rest.text;
        if (this.refused || this.faults.length || this.message || this.stale) this.tell("faults", "told");
        [this.refused, this.message, this.faults, this.stale] = ["", "", NEVER, false];
        this.curves = moved(this.curves, withLists(rest));
        this.tell("moved");
        if (rest.label) announce(t("announce.changed", { label: rest.label }));
        break;
      }
      case "findings": {
        const { kind: _, ...rest } = found;
        if (found.revision < this.revision) return;
        this.findings = withLists(rest);
        this.tell("findings");
        painted((at) => timings.findings.push(at));
        break;
      }
      case "refused":
        this.refused = found.message;
        this.overwrites = found.force === true;
        this.tell("faults", "refused");
        announce(t("text.refused", { message: found.message }));
        break;
      case "built":
        this.built = { files: found.files, findings: found.findings ?? [], faults: found.faults ?? [], revision: found.revision ?? this.revision, message: found.message ?? "" };
        this.tell("built");
        announce(t(found.files.length ? "build.done" : "build.none", { n: found.files.length }));
        break;
      case "solid":
        this.solid = { solids: found.solids ?? [], revision: found.revision ?? this.revision };
        this.tell("solid");
        break;
      case "sized": {
        const { kind: _, ...rest } = found;
        this.sized = { ...rest, revision: found.revision ?? this.revision };
        this.tell("sized");
        announce(found.sentence ?? t("size.none"));
        break;
      }
      case "laws":
        this.laws = { segment: found.segment ?? -1, laws: found.laws };
        this.tell("laws");
        break;
      case "effects":
        this.effects = found.effects;
        this.tell("effects");
        break;
      case "pinned":
        this.pinned = found.curves && withLists(found.curves);
        this.tell("pinned", "curves");
        break;
      case "busy":
        this.busy = found.what;
        this.tell("busy");
        break;
      case "told":
        this.message = found.message;
        this.tell("told");
        announce(found.message);
        break;
    }
  }
}
