import type { Chart, Curves } from "./model";

// The curves with those parts that are newer; diagrams that are not among them stay.
export function moved(curves: Curves | null, parts: Curves): Curves {
  const newer = parts.charts ?? [];
  const same = (one: Chart, other: Chart): boolean => one.name === other.name && one.title === other.title;
  const charts = (curves?.charts ?? []).map((chart) => newer.find((each) => same(each, chart)) ?? chart);
  const more = newer.filter((each) => !charts.includes(each));
  return { ...curves, ...parts, charts: [...charts, ...more] };
}
