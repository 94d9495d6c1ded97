// The controls of a player, for pages that have none in their HTML.

import type { Controls } from "./player";
import { WORDS, type Words } from "./words";

const SPEEDS = [30, 15, 8, 4, 2]; // seconds of a turn
const SPEED = 8; // at first

export function make<Name extends keyof HTMLElementTagNameMap>(
  name: Name,
  properties: Partial<HTMLElementTagNameMap[Name]> = {},
  ...content: (Node | string)[]
): HTMLElementTagNameMap[Name] {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...content);
  return made;
}

// A group of them, and what a player wants of it.
export function makeControls(words: Words = WORDS): [HTMLElement, Controls] {
  const play = make("button", { type: "button" }, words.play);
  play.setAttribute("aria-pressed", "false");
  const choices = SPEEDS.map((each) => new Option(words.turnIn(each), String(each), each === SPEED, each === SPEED));
  const speed = make("select", {}, ...choices);
  const slider = make("input", { type: "range", min: "0", max: "360", step: "0.5", value: "0" });
  const field = make("input", { type: "number", min: "0", max: "360", step: "any", value: "0", ariaLabel: words.inDegrees });
  const state = make("p", { className: "state", ariaLive: "polite" });
  const group = make(
    "div",
    { className: "controls", role: "group", ariaLabel: words.angle },
    play,
    make("label", {}, `${words.speed} `, speed),
    make("label", { className: "scrub" }, `${words.angle} `, slider),
    make("label", {}, field, " °"),
    state,
  );
  return [group, { play, speed, slider, field, state }];
}
