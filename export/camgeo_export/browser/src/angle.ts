// The cam angle that the mechanism and all diagrams of a page share.

// Told of the angle in degrees, from 0 to below 360, and whether it is to rest there.
export type Listener = (degrees: number, rests: boolean) => void;

export class CamAngle {
  degrees = 0;
  private readonly listeners = new Set<Listener>();

  set(degrees: number, rests = true): void {
    const rest = degrees % 360; // exact: an angle within a turn stays as it is
    const turned = rest < 0 ? rest + 360 : rest;
    this.degrees = turned < 360 ? turned : 0;
    for (const each of this.listeners) each(this.degrees, rests);
  }

  // Calls the listener now and at each change, until what it gives back is called.
  listen(listener: Listener): () => void {
    this.listeners.add(listener);
    listener(this.degrees, true);
    return () => this.listeners.delete(listener);
  }
}
