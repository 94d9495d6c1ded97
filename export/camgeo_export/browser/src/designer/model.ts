// What page and server tell each other, see docs/designer.md.

import type { Animation, Figure, Mark } from "../data";

export type Point = [number, number];

export type Value = number | string | boolean | null | Value[] | { [key: string]: Value };

export interface Fault {
  key: string;
  value?: Value;
  message: string;
  hint?: string;
  line?: number | null;
}

export interface Chosen {
  value: string;
  title?: string;
  description?: string;
}

export interface Field {
  key: string;
  title: string;
  description?: string;
  type: "number" | "choice" | "text" | "flag" | "file" | "list";
  unit?: string | null;
  value: Value;
  stated?: boolean;
  default?: Value;
  choices?: Value[] | null;
  low?: number | null;
  high?: number | null;
  slider?: [number, number, number] | null;
}

export interface Section {
  key: string;
  title: string;
  description?: string;
  stated?: boolean;
  kind?: string | null;
  kinds?: Chosen[] | null;
  fields: Field[];
}

export interface Segment {
  index: number;
  kind: string;
  from: number | null;
  to: number | null;
  start?: number | null;
  end?: number | null;
  law?: string | null;
  fields: Field[];
}

export interface HandleValue {
  key: string;
  label: string;
  unit?: string;
  value: number;
}

export interface Handle {
  name: string;
  kind: string;
  space: "plan" | "mechanism";
  panel?: number | null;
  at: Point;
  moves: "x" | "y" | "xy" | "radial";
  label: string;
  values: HandleValue[];
}

export interface Reading {
  name: string;
  low: number | string | null;
  low_at: number;
  high: number | string | null;
  high_at: number;
  limits: [string, number | string][];
}

export interface Chart {
  name: string;
  title: string;
  figure: Figure;
  sentence: string;
  readings: Reading[];
}

export interface Effect {
  name: string;
  title?: string;
  sentence: string;
}

// The result of a scene; after faults only they are there.
export interface Curves {
  faults: Fault[];
  name?: string;
  unit?: string;
  animation?: Animation | null;
  charts?: Chart[];
  handles?: Handle[];
  plan?: Segment[];
  form?: Section[];
  effects?: string[]; // names of those that are on
  text?: string;
  label?: string | null;
  refused?: string;
}

export interface Finding {
  about: string;
  name: string;
  severity: string;
  verdict: string;
  mark: string;
  sentence: string;
  value: number | null;
  limit: number | null;
  unit: string;
  at_degrees: number | null;
  key?: string | null;
  step?: string | null;
}

export interface Cure {
  sentence: string;
  works: boolean;
  index: number;
}

export interface Place {
  x: number;
  y: number;
  kind: string;
  label: string;
  severity?: string;
  points?: Point[]; // along which it is, if it is more than a point
}

// The one verdict on a text: how bad it is, a sentence, and what is wrong in the scene.
export interface Verdict {
  revision: number;
  severity: string;
  sentence: string;
  faults: Fault[];
}

export interface Found {
  findings?: Finding[];
  cures?: Cure[];
  places?: Place[];
  charts?: Chart[]; // of effects, which take longer than curves
}

export interface State {
  revision: number;
  file: string | null;
  folder_files?: string[];
  templates?: string[];
  formats?: string[]; // that can be made
  text?: string | null;
  saved: boolean;
  undo: string | null;
  redo: string | null;
  disk: "same" | "changed" | "gone";
  pinned?: boolean | null;
}

// One of several cams: its name, and its sizes by name.
export type Size = { name: string } & Record<string, number | string | null>;

export interface Sized {
  faults?: Fault[];
  sizes?: Size[];
  sentence?: string;
  edits?: { [key: string]: Value } | null;
}

export interface Law {
  name: string;
  title?: string;
  figure?: Figure | null;
  facts?: { name: string; value: string }[];
  edits?: { [key: string]: Value };
}

export interface BuiltFile {
  name: string;
  url: string;
  size: number;
  deviation?: number | null;
  tolerance?: number | null;
}

export type FromServer =
  | ({ kind: "state" } & State)
  | ({ kind: "verdict" } & Verdict)
  | ({ kind: "curves"; revision: number; answers?: number | null } & Curves)
  | ({ kind: "moved"; revision: number; answers?: number | null } & Curves) // what moves in a drag; the rest follows as curves
  | ({ kind: "findings"; revision: number } & Found)
  | { kind: "refused"; id?: number | null; message: string; force?: boolean; faults?: Fault[] }
  | { kind: "built"; revision?: number; files: BuiltFile[]; findings?: string[]; faults?: Fault[]; message?: string }
  | { kind: "solid"; revision?: number; solids?: { name: string; places: string }[]; faults?: Fault[] }
  | ({ kind: "sized"; revision?: number } & Sized)
  | { kind: "laws"; segment?: number; laws: Law[] }
  | { kind: "effects"; effects: Effect[] }
  | { kind: "pinned"; curves: Curves | null }
  | { kind: "busy"; what: string }
  | { kind: "told"; message: string };

export type ToServer = { kind: string; [key: string]: unknown };

// What a `change` says beside its kind, id and gesture.
export type Change =
  | { edits: { [key: string]: Value } }
  | { handle: string; to: Point; step?: number }
  | { segment: { action: string; at: number } }
  | { table: { key: string; kind: string } }
  | { effect: { name: string; on: boolean } }
  | { cure: number }
  | { sized: { [key: string]: Value } };

export type { Figure, Mark };
