// The controls of a player, for pages that have none in their HTML.

import { el } from "./dom";
import type { Controls } from "./player";
import { WORDS, type Words } from "./words";

const SPEEDS = [30, 15, 8, 4, 2]; // seconds of a turn
const SPEED = 8; // at first

// A group of them, and what a player wants of it.
export function makeControls(words: Words = WORDS): [HTMLElement, Controls] {
  const play = el("button", { type: "button", "aria-pressed": "false" }, words.play);
  const speed = el("select", {}, ...SPEEDS.map((each) => el("option", { value: each, selected: each === SPEED }, words.turnIn(each))));
  const slider = el("input", { type: "range", min: 0, max: 360, step: 0.5, value: 0 });
  const field = el("input", { type: "number", min: 0, max: 360, step: "any", value: 0, "aria-label": words.inDegrees });
  const state = el("p", { class: "state", role: "status", "aria-live": "polite" });
  const group = el(
    "div",
    { class: "controls", role: "group", "aria-label": words.angle },
    play,
    el("label", {}, `${words.speed} `, speed),
    el("label", { class: "scrub" }, `${words.angle} `, slider),
    el("label", {}, field, " °"),
    state,
  );
  return [group, { play, speed, slider, field, state }];
}
