// Every word that the page itself shows, by key. What the server sends (findings, titles, sentences)
// comes worded. A text with {name} in it takes values; one with "one" and "many" counts {n}.

import type { Words } from "../words";

export const LANGUAGE = "en";

export const STRINGS = {
  "page.title": "{name}: camgeo designer",
  "page.name": "camgeo designer",
  "page.skip": "Skip to the mechanism",
  "page.new-scene": "new scene",

  "connection.lost": "The connection to camgeo is lost. Your changes are kept; trying again …",
  "connection.ended": "camgeo has ended this session. Start it again in the terminal and open the address that it prints.",
  "connection.back": "Connected again.",
  "busy.build": "making the files",
  "busy.size": "looking for sizes",
  "busy.solid": "making the solid",
  "connection.wait": "Working: {what} …",

  "file.saved": "saved",
  "file.unsaved": "not saved",
  "file.none": "not in a file yet",
  "file.undo": "Undo",
  "file.redo": "Redo",
  "file.undo-of": "Undo: {label}",
  "file.redo-of": "Redo: {label}",
  "file.save": "Save",
  "file.save-as": "Save as …",
  "file.open": "Open …",
  "file.new": "New …",
  "file.title-save-as": "Save as",
  "file.title-force": "Not saved",
  "file.title-open": "Open a scene",
  "file.title-new": "New scene",
  "file.name": "File name, in the folder that camgeo was started in",
  "file.exists": "A file of this name exists; saving overwrites it.",
  "file.choose": "Scenes in the folder",
  "file.no-scenes": "There is no scene in the folder.",
  "file.template": "Start from",
  "file.keeps": "Unsaved changes are kept, and come back when this scene is opened again.",
  "file.changed": "The file was changed on disk by another program.",
  "file.gone": "The file is no longer on disk.",
  "file.take": "Load the file from disk",
  "file.overwrite": "Overwrite it with this scene",
  "file.write-again": "Write it again",

  "dialog.cancel": "Cancel",
  "dialog.close": "Close",

  "mechanism.title": "Mechanism",
  "mechanism.label": "The mechanism at the cam angle stated below",
  "mechanism.waiting": "The mechanism is being computed.",
  "mechanism.empty": "There is no scene yet: choose New … or Open … above.",
  "mechanism.none": "There is no mechanism to show.",
  "mechanism.old": "There is no picture of the present text; this is the last one.",
  "mechanism.play": "Play",
  "mechanism.pause": "Pause",
  "mechanism.speed": "Speed",
  "mechanism.turn": "a turn in {n} s",
  "mechanism.angle": "Cam angle",
  "mechanism.degrees": "Cam angle in degrees",
  "mechanism.degrees-said": "{angle} degrees",
  "mechanism.state": "Cam angle {angle}°",
  "mechanism.state-lift": "Cam angle {angle}°, follower at {lift}",
  "mechanism.help": "Drag a handle, or choose one and use the fields below or the arrow keys (with Shift, ten times the step). Handles are shown where the parts are at cam angle 0.",
  "mechanism.places": "Places on the disc",

  "handle.name": "{label}: {values}",
  "handle.none": "No handle is chosen.",
  "handle.chosen": "Chosen: {label}",
  "handle.angle": "cam angle",
  "handle.position": "position",
  "handle.less": "{label}: less",
  "handle.more": "{label}: more",

  "motion.title": "Motion",
  "motion.picture": "Motion plan and diagrams",
  "motion.none": "There is no motion to show.",
  "motion.help": "Drag a joint, or choose one and use the fields below or the arrow keys. The table has every value.",

  "plan.title": "Motion plan, segment by segment",
  "plan.number": "No.",
  "plan.kind": "kind",
  "plan.from": "from",
  "plan.to": "to",
  "plan.values": "values and changes",
  "plan.kind-dwell": "dwell",
  "plan.kind-move": "move",
  "plan.kind-points": "points",
  "plan.kind-table": "table",
  "plan.insert": "Insert",
  "plan.insert-label": "Insert a segment after {n}",
  "plan.split": "Split",
  "plan.split-label": "Split segment {n}",
  "plan.remove": "Remove",
  "plan.remove-label": "Remove segment {n}",
  "plan.up": "Up",
  "plan.up-label": "Up: segment {n}",
  "plan.down": "Down",
  "plan.down-label": "Down: segment {n}",
  "plan.to-dwell": "To dwell",
  "plan.to-dwell-label": "To dwell: segment {n}",
  "plan.to-move": "To move",
  "plan.to-move-label": "To move: segment {n}",
  "plan.laws": "Laws …",
  "plan.laws-label": "Laws … for segment {n}, as pictures",
  "plan.segment": "segment {n}",
  "plan.more": "More",
  "plan.more-label": "More: values of segment {n}",

  "laws.title": "Laws for segment {n}",
  "laws.picture": "Position, velocity and acceleration of {title}",
  "laws.now": "in use",

  "form.title": "Sizes",
  "form.kind": "kind",
  "form.default": "default {value}",
  "form.reset": "Default",
  "form.reset-label": "{title}: back to the default",
  "form.slider": "{title}, slider",
  "form.none": "not stated",
  "form.number": "Enter a number.",
  "form.list": "Enter numbers with commas between them.",
  "form.field": "{section}, {title}",
  "form.rest": "Tables that are not in the scene",
  "form.help": "Choose a field to see what its value means.",

  "effects.title": "Effects",
  "effects.none": "There are no effects.",

  "findings.title": "Findings",
  "findings.step": "next step",
  "findings.show": "Show at {angle}°",
  "findings.waiting": "Findings are being computed.",
  "findings.faulty": "A scene with faults has no findings. The faults are listed with its text.",
  "findings.all": { one: "Show the finding that is kept", many: "Show the {n} findings that are kept" },
  "findings.edit": "Go to {key}",
  "findings.cures": "Each of these remedies removes the fault that it names:",
  "findings.cure": "Apply",
  "findings.cure-label": "Apply: {sentence}",
  "findings.no-cure": "no remedy: {sentence}",

  "size.title": "Smallest cam",
  "size.ask": "Find sizes",
  "size.take": "Use these sizes",
  "size.none": "No sizes were found.",
  "size.intro": "The smallest cam that keeps its limits, as camgeo size finds it.",
  "size.size": "size",
  "size.base_radius": "base radius [{unit}]",
  "size.arm_side": "arm side",
  "size.transmission_angle": "transmission angle [°]",
  "size.radius_ratio": "radius ratio",
  "size.old": "The scene has changed since then: find sizes again.",

  "charts.title": "Diagrams",
  "charts.one": "Diagram",
  "charts.table": "Extremes as a table",
  "charts.table-of": "Extremes, {title}",
  "charts.curve": "curve",
  "charts.low": "smallest",
  "charts.high": "largest",
  "charts.at": "at",
  "charts.limits": "limits drawn",
  "charts.pinned-low": "smallest, pinned",
  "charts.pinned-high": "largest, pinned",
  "charts.none": "There are no diagrams.",

  "text.title": "Text of the scene",
  "text.label": "Text of the scene, TOML",
  "text.fault-at": "Line {line}",
  "text.fault-none": "The scene has no faults.",
  "text.faults": { one: "One fault:", many: "{n} faults:" },
  "text.mark": "!",
  "text.refused": "The change was not made: {message}",

  "compare.title": "Comparison with the pinned variant",
  "compare.what": "value",
  "compare.now": "now",
  "compare.pinned": "pinned",
  "compare.same": "There are no differences.",

  "pin.pin": "Pin",
  "pin.pin-label": "Pin this variant, to compare with it",
  "pin.unpin": "Unpin",
  "pin.unpin-label": "Remove the pinned variant",
  "pin.note": "Grey: the pinned variant.",

  "build.title": "Build",
  "build.build": "Build",
  "build.formats": "Formats",
  "build.intro": "Makes the files as camgeo build does, for download.",
  "build.file": "file",
  "build.size": "size",
  "build.deviation": "deviation [{unit}]",
  "build.tolerance": "tolerance [{unit}]",
  "build.bytes": "{n} bytes",
  "build.done": { one: "One file was made.", many: "{n} files were made." },
  "build.none": "No files were made.",
  "build.old": "The scene has changed since then: build again.",

  "solid.title": "Solid",
  "solid.show": "Show the solid",
  "solid.again": "Make it again",
  "solid.old": "The scene has changed since it was made.",
  "solid.none": "The part has no solid: it has no thickness, or there is no disc.",
  "solid.not-loaded": "The script that draws solids could not be loaded. Try again.",
  "solid.label": "The solid of {name}",

  "solid.no-webgl": "This browser has no WebGL, so the solid is not drawn.",

  "view.left": "Left",
  "view.right": "Right",
  "view.up": "Up",
  "view.down": "Down",
  "view.closer": "Closer",
  "view.farther": "Farther",
  "view.back": "Back",
  "view.of": "View of {name}",

  "announce.changed": "{label}.",
  "announce.value": "{label}: {values}",
} as const;

type Text = string | { one: string; many: string };

export type Key = keyof typeof STRINGS;

export type Values = Record<string, string | number>;

function filled(text: string, values: Values): string {
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

// The text of a key.
export function t(key: Key, values: Values = {}): string {
  const text: Text = STRINGS[key];
  if (typeof text === "string") return filled(text, values);
  return filled(Number(values["n"]) === 1 ? text.one : text.many, values);
}

// The text of a key that is made at run time, or what stands for it.
export function told(key: string, otherwise: string): string {
  return key in STRINGS ? t(key as Key) : otherwise;
}

// Those of the parts that all pages share.
export const PLAYER: Words = {
  play: t("mechanism.play"),
  pause: t("mechanism.pause"),
  speed: t("mechanism.speed"),
  turnIn: (n) => t("mechanism.turn", { n }),
  angle: t("mechanism.angle"),
  inDegrees: t("mechanism.degrees"),
  degrees: (angle) => t("mechanism.degrees-said", { angle }),
  state: (angle, lift) => t(lift ? "mechanism.state-lift" : "mechanism.state", { angle, lift }),
  mechanism: t("mechanism.label"),
  diagram: t("charts.one"),
  extremes: t("charts.table"),
  extremesOf: [t("charts.curve"), t("charts.low"), t("charts.at"), t("charts.high"), t("charts.at")],
  noWebGL: t("solid.no-webgl"),
};

// A number as the page writes it: with a minus that is one, at most so many digits.
export function number(value: number, digits = 6): string {
  const text = Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}
