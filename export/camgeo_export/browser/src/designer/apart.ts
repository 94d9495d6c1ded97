// Places of targets for a pointer, moved apart where one would cover another.

import type { Point } from "./model";

const TURNS = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6].map((k) => (k * Math.PI) / 6); // ways to move, the best first

const distance = (one: Point, other: Point): number => Math.hypot(one[0] - other[0], one[1] - other[1]);

// The places at least so far from each other, as far as there is room. Those that come first stay;
// a later one goes straight away from the nearest of them, or beside that if it is not free there.
export function apart(places: readonly Point[], least: number): Point[] {
  const taken: Point[] = [];
  const free = (at: Point): boolean => taken.every((each) => distance(at, each) > least - 1e-6);
  for (const at of places) {
    const [near] = [...taken].sort((one, other) => distance(at, one) - distance(at, other));
    if (!near || free(at)) {
      taken.push(at);
      continue;
    }
    const away = Math.atan2(at[1] - near[1], at[0] - near[0]);
    const tries = TURNS.map((turn): Point => [near[0] + least * Math.cos(away + turn), near[1] + least * Math.sin(away + turn)]);
    taken.push(tries.find(free) ?? at);
  }
  return taken;
}
