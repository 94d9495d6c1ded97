// How long it took from an input to the frame that shows what it changed. Tests read
// `window.camgeo.timings`; times are those of `performance.now()`.

export interface Timing {
  id: number;
  gesture: string | null;
  input: number;
  sent: number;
  answered: number;
  painted: number;
}

const MOST = 2000;

export const timings = {
  changes: [] as Timing[],
  findings: [] as number[],
  clear(): void {
    timings.changes.length = 0;
    timings.findings.length = 0;
  },
};

// Calls once the next frame is on the screen: after its drawing, not before it.
export function painted(call: (at: number) => void): void {
  requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => call(performance.now());
    channel.port2.postMessage(null);
  });
}

export function took(found: Timing): void {
  timings.changes.push(found);
  if (timings.changes.length > MOST) timings.changes.splice(0, MOST / 2);
  performance.measure("camgeo:input-to-frame", { start: found.input, end: found.painted });
  if (performance.getEntriesByName("camgeo:input-to-frame").length > MOST) performance.clearMeasures("camgeo:input-to-frame");
}
