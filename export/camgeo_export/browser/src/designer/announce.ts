// What is said to those who listen to the page instead of looking: the last word once it has rested.

import { el } from "../dom";

const REST = 700; // milliseconds without a newer word
const APART = 1500; // least between two

let region: HTMLElement | null = null;
let timer = 0;
let last = -APART;

export function announcer(): HTMLElement {
  region = el("p", { class: "unseen", role: "status", "aria-live": "polite", id: "said" });
  return region;
}

export function announce(text: string): void {
  clearTimeout(timer);
  const wait = Math.max(REST, last + APART - performance.now());
  timer = window.setTimeout(() => {
    last = performance.now();
    if (region) region.textContent = text;
  }, wait);
}
