// Pictures as they come from Python, their long lists of numbers packed: camgeo.app.designing.painting.

import type { Animation, Figure } from "./data";

interface Packed {
  packed: "f4" | "f8";
  shape: number[];
  numbers: string; // in base 64, the lowest byte first
}

const isPacked = (value: object): value is Packed => "packed" in value;

type Numbers = (number | null | Numbers)[];

function listed({ packed, shape, numbers }: Packed): Numbers {
  const text = atob(numbers);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const all = packed === "f4" ? new Float32Array(bytes.buffer) : new Float64Array(bytes.buffer);
  let next = 0;
  const part = (depth: number): Numbers => {
    const list: Numbers = new Array(shape[depth] ?? 0); // filled by a loop, four times as fast as Array.from
    for (let k = 0; k < list.length; k++) {
      const value = depth < shape.length - 1 ? part(depth + 1) : (all[next++] ?? NaN);
      list[k] = Number.isNaN(value) ? null : value;
    }
    return list;
  };
  return part(0);
}

// The same with all lists; the others stay where they are.
function unpacked(value: unknown): unknown {
  if (typeof value !== "object" || value === null) return value;
  if (Array.isArray(value)) {
    for (let k = 0; k < value.length; k++) if (typeof value[k] === "object") value[k] = unpacked(value[k]);
    return value;
  }
  if (isPacked(value)) return listed(value);
  const table = value as Record<string, unknown>;
  for (const key in table) if (typeof table[key] === "object") table[key] = unpacked(table[key]);
  return value;
}

// Charts, and all that has some, with lists in place of what is packed.
export function withLists<T extends { charts?: { figure: Figure }[]; animation?: Animation | null }>(found: T): T {
  for (const chart of found.charts ?? []) chart.figure = unpacked(chart.figure) as Figure;
  if (found.animation) found.animation = unpacked(found.animation) as Animation;
  return found;
}
