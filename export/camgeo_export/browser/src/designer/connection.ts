// The socket to the server, and the changes on their way: one unanswered at a time, and of those that
// wait only the newest of each gesture.

import type { Change, FromServer, ToServer } from "./model";

export interface Ask {
  change: Change | { text: string };
  gesture?: string | null;
  input?: number; // time of the event that asked for it
}

interface Waiting extends Ask {
  id: number;
  slot: string | null;
  input: number;
  sent: number;
}

export interface Ears {
  message(found: FromServer): void;
  answered(id: number, asked: { input: number; sent: number; gesture: string | null } | null): void;
  connected(is: boolean, ended: boolean): void;
}

const FIRST_WAIT = 300; // milliseconds before trying again, doubled each time
const LONGEST_WAIT = 5000;
const ENDED = 1008; // close code: the server does not know this page
const PATIENT = 5; // failures after which the server has probably ended
const PATIENCE = 30000; // an answer that takes longer is not waited for

export class Connection {
  private socket: WebSocket | null = null;
  private wait = FIRST_WAIT;
  private ids = 0;
  private unanswered: Waiting | null = null;
  private asked = 0; // timer of the unanswered
  private queue: Waiting[] = [];
  private commands: ToServer[] = [];
  private greeted = false;
  private failures = 0; // to connect, one after the other

  constructor(private readonly ears: Ears) {}

  get busy(): boolean {
    return this.unanswered !== null || this.queue.length > 0;
  }

  open(revision?: number): void {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/ws`);
    this.socket = socket;
    this.greeted = false;
    socket.addEventListener("open", () => {
      this.wait = FIRST_WAIT;
      this.failures = 0;
      socket.send(JSON.stringify({ kind: "hello", ...(revision === undefined ? {} : { revision }) }));
      this.greeted = true;
      this.ears.connected(true, false);
      // What was unanswered is asked again: it states where things are to be, not by how much they move.
      if (this.unanswered) this.queue.unshift(this.unanswered);
      this.unanswered = null;
      this.next();
    });
    socket.addEventListener("message", (event) => this.heard(JSON.parse(String(event.data)) as FromServer));
    socket.addEventListener("close", (event) => {
      if (this.socket !== socket) return;
      this.failures += 1;
      this.ears.connected(false, event.code === ENDED || this.failures > PATIENT);
      if (event.code === ENDED) return;
      window.setTimeout(() => this.open(revision), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    });
  }

  // A change; of one gesture and slot only the newest that waits is kept.
  change(ask: Ask, slot: string | null = null): number {
    this.ids += 1;
    const own: Waiting = { ...ask, id: this.ids, slot, input: ask.input ?? performance.now(), sent: 0 };
    const last = this.queue.at(-1);
    if (last && slot !== null && last.slot === slot && last.gesture === own.gesture) this.queue[this.queue.length - 1] = own;
    else this.queue.push(own);
    this.next();
    return own.id;
  }

  // Anything else, after the changes that were made before it.
  send(message: ToServer): void {
    this.commands.push(message);
    this.next();
  }

  private next(): void {
    if (!this.greeted || this.socket?.readyState !== WebSocket.OPEN || this.unanswered) return;
    const own = this.queue.shift();
    if (own) {
      this.unanswered = own;
      own.sent = performance.now();
      clearTimeout(this.asked);
      this.asked = window.setTimeout(() => this.answer(own.id), PATIENCE);
      const gesture = own.gesture ? { gesture: own.gesture } : {};
      const body = "text" in own.change ? { kind: "text", text: own.change.text } : { kind: "change", ...own.change };
      this.socket.send(JSON.stringify({ ...body, id: own.id, ...gesture }));
      return;
    }
    for (const message of this.commands.splice(0)) this.socket.send(JSON.stringify(message));
  }

  private heard(message: FromServer): void {
    const painted = message.kind === "curves" || message.kind === "moved";
    const id = painted ? message.answers : message.kind === "refused" ? message.id : null;
    const own = this.unanswered;
    this.ears.message(message);
    if (typeof id === "number") {
      if (own?.id === id && painted) this.ears.answered(id, { input: own.input, sent: own.sent, gesture: own.gesture ?? null });
      this.answer(id);
    }
  }

  private answer(id: number): void {
    if (this.unanswered?.id !== id) return;
    clearTimeout(this.asked);
    this.unanswered = null;
    this.next();
  }
}
