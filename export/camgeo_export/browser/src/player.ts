// Turns the cam: play and pause, speed, a slider and a field for the cam angle, and a line of text
// that says it.

import type { CamAngle } from "./angle";
import { WORDS, type Words } from "./words";

export interface Controls {
  play: HTMLButtonElement;
  speed: HTMLSelectElement; // its values are seconds of a turn
  slider: HTMLInputElement;
  field: HTMLInputElement;
  state: HTMLElement;
}

const STEP = 15; // degrees at once, where motion is not wanted
const LAST = 359.999; // the end of a turn, which is not its beginning
const LONGEST = 0.25; // seconds between two pictures: after a longer pause the cam does not jump
const RESTED = 300; // milliseconds after which the angle is said: not sixty times a second

export class Player {
  playing = false;
  private before = 0;
  private told: ReturnType<typeof setTimeout> | undefined;
  private readonly calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  private readonly forget: () => void;

  // `lift` says where the follower is at a cam angle; empty if there is none.
  constructor(
    private readonly angle: CamAngle,
    private readonly controls: Controls,
    private readonly lift: (degrees: number) => string,
    private readonly words: Words = WORDS,
  ) {
    const { play, slider, field } = controls;
    play.addEventListener("click", () => (this.playing ? this.rest() : this.start()));
    for (const input of [slider, field]) {
      input.addEventListener("input", () => {
        const value = input.valueAsNumber;
        if (!Number.isFinite(value)) return;
        this.stop();
        angle.set(Math.min(Math.max(value, 0), LAST));
      });
    }
    this.forget = angle.listen((degrees, rests) => this.show(degrees, rests));
  }

  start(): void {
    this.playing = true;
    this.controls.play.textContent = this.words.pause;
    this.controls.play.setAttribute("aria-pressed", "true");
    this.before = performance.now();
    requestAnimationFrame((now) => this.turn(now));
  }

  stop(): void {
    this.playing = false;
    this.controls.play.textContent = this.words.play;
    this.controls.play.setAttribute("aria-pressed", "false");
  }

  // Says the cam angle and where the follower is, once nothing has changed for a while.
  tell(): void {
    clearTimeout(this.told);
    this.told = setTimeout(() => {
      const { degrees } = this.angle;
      const said = this.words.state(degrees.toFixed(1), this.lift(degrees));
      if (this.controls.state.textContent !== said) this.controls.state.textContent = said;
    }, RESTED);
  }

  dispose(): void {
    this.stop();
    clearTimeout(this.told);
    this.forget();
  }

  private rest(): void {
    this.stop();
    this.angle.set(this.angle.degrees);
  }

  private turn(now: number): void {
    if (!this.playing || !this.controls.play.isConnected) return;
    const seconds = Number(this.controls.speed.value);
    const passed = Math.max(0, now - this.before) / 1000;
    if (!this.calm.matches) {
      this.before = now;
      this.angle.set(this.angle.degrees + (360 * Math.min(passed, LONGEST)) / seconds, false);
    } else if (passed > (seconds * STEP) / 360) {
      this.before = now;
      this.angle.set(this.angle.degrees + STEP, false);
    }
    requestAnimationFrame((next) => this.turn(next));
  }

  private show(degrees: number, rests: boolean): void {
    const { slider, field } = this.controls;
    const shown = degrees.toFixed(1);
    const active = (slider.getRootNode() as Document | ShadowRoot).activeElement;
    if (active !== slider || !rests) slider.value = shown;
    if (active !== field) field.value = shown;
    slider.setAttribute("aria-valuetext", this.words.degrees(shown));
    clearTimeout(this.told);
    if (rests) this.tell();
  }
}
