// The path of a curve through many points, of which those that nobody could see are left out.

import type { Gap } from "./data";
import { fixed } from "./svg";

const SEEN = 0.03; // points: a line that is nearer to another looks the same

export type Scale = (value: number) => number;

// Through all places, to SEEN: from the last place written, those that follow are left out as long
// as one straight line passes all of them. It lies between `left` and `right`, the directions that
// just miss a place by SEEN.
export function course(points: readonly Gap[], x: Scale, y: Scale): string {
  let path = "";
  let open = false;
  let [fromX, fromY] = [0, 0]; // written
  let [lastX, lastY] = [0, 0]; // seen, not yet written
  let waiting = false;
  let far = 0;
  let [leftX, leftY, rightX, rightY] = [0, 0, 0, 0];
  const write = () => {
    path += `${fixed(lastX)} ${fixed(lastY)} `;
    fromX = lastX;
    fromY = lastY;
    far = 0;
    waiting = false;
  };
  for (const point of points) {
    const a = point[0];
    const b = point[1];
    if (a === null || b === null) {
      if (waiting) write();
      open = false;
      continue;
    }
    const [u, v] = [x(a), y(b)];
    if (!open) {
      path += `M${fixed(u)} ${fixed(v)}L`;
      [fromX, fromY, lastX, lastY, far, waiting, open] = [u, v, u, v, 0, true, true];
      continue;
    }
    let [dx, dy] = [u - fromX, v - fromY];
    let long = Math.hypot(dx, dy);
    const missed = far > 0 && (long < far || dx * leftY - dy * leftX < 0 || dx * rightY - dy * rightX > 0);
    if (missed) {
      write();
      [dx, dy] = [u - fromX, v - fromY];
      long = Math.hypot(dx, dy);
    }
    if (long > SEEN) {
      const off = SEEN / long;
      const [lx, ly] = [dx - dy * off, dy + dx * off];
      const [rx, ry] = [dx + dy * off, dy - dx * off];
      if (far === 0 || lx * leftY - ly * leftX > 0) [leftX, leftY] = [lx, ly];
      if (far === 0 || rx * rightY - ry * rightX < 0) [rightX, rightY] = [rx, ry];
      far = long;
    }
    [lastX, lastY, waiting] = [u, v, true];
  }
  if (waiting) write();
  return path.trimEnd();
}
