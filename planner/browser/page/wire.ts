// SPDX-License-Identifier: AGPL-3.0-or-later
// The one WebSocket of this window: requests as promises, events, binary pictures, and a new connection after
// a loss.
import {FrameHeader, Json} from "./protocol";

/// A request that failed. `code` is the server's: input, geometry, cancelled, resource, internal or changed;
/// or "lost" if the connection broke.
export class Refusal extends Error {
  constructor(message: string, readonly code: string) {
    super(message);
  }
}

export interface WireEvents {
  opened(): void;
  lost(why: string): void;  // empty if the server stated no reason
  event(word: string, message: {[key: string]: Json}): void;
  picture(header: FrameHeader, parts: Uint8Array[]): void;
}

interface Waiting {
  resolve(value: unknown): void;
  reject(error: Refusal): void;
}

const first_retry_ms = 400;
const last_retry_ms = 5000;
/// The code with which the server closes a connection that it has no room for.
const try_again_later = 1013;

/// Time between two tests of the connection, and the time without any message after which it counts as
/// broken. A network that drops packets reports no error.
const ask_alive_ms = 2000;
const longest_silence_ms = 8000;

export class Wire {
  private socket: WebSocket|null = null;
  private next_id = 1;
  private retry_ms = first_retry_ms;
  private heard_at = 0;
  private asked_at = 0;
  private readonly waiting = new Map<number, Waiting>();

  constructor(private readonly url: string, private readonly events: WireEvents) {}

  open(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard_at = this.asked_at = performance.now();
    socket.onopen = () => {
      this.retry_ms = first_retry_ms;
      this.heard_at = performance.now();
      this.events.opened();
    };
    socket.onmessage = (message: MessageEvent<string|ArrayBuffer>) => {
      this.heard_at = performance.now();
      if (typeof message.data === "string")
        this.hear(message.data);
      else
        this.see(message.data);
    };
    socket.onclose = (event) => {
      if (event.code === try_again_later) this.retry_ms = last_retry_ms;
      this.closed(event.reason);
    };
    const alive = window.setInterval(() => {
      if (this.socket === socket)
        this.ask_alive(socket);
      else
        window.clearInterval(alive);
    }, ask_alive_ms);
  }

  get is_open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  private ask_alive(socket: WebSocket): void {
    const now = performance.now();
    // A browser may suspend a tab. Its silence does not count; the next test shows whether the connection
    // still works.
    if (now - this.asked_at > 2 * ask_alive_ms) this.heard_at = now;
    this.asked_at = now;
    if (now - this.heard_at > longest_silence_ms) {
      // close() alone would call onclose only after the server's answer, which may never arrive.
      socket.onopen = socket.onmessage = socket.onclose = null;
      socket.close();
      this.closed("");
    } else if (socket.readyState === WebSocket.OPEN) {
      socket.send(JSON.stringify({id: this.next_id++, do: "alive"}));
    }
  }

  /// Sends a request. Rejects with a Refusal if the server refuses the request or the connection breaks.
  /// Calls `on_id` with the request's id before sending.
  ask<Answer>(word: string, fields: object = {}, on_id?: (id: number) => void): Promise<Answer> {
    const id = this.next_id++;
    on_id?.(id);
    return new Promise<Answer>((resolve, reject) => {
      if (!this.is_open) {
        reject(new Refusal("The connection to the planner's program is lost.", "lost"));
        return;
      }
      this.waiting.set(id, {resolve: (value) => resolve(value as Answer), reject});
      this.socket!.send(JSON.stringify({id, do: word, ...fields}));
    });
  }

  /// Sends a message that has no answer.
  say(word: string, fields: object): void {
    if (this.is_open) this.socket!.send(JSON.stringify({do: word, ...fields}));
  }

  private hear(text: string): void {
    const message = JSON.parse(text) as {[key: string]: Json};
    if (typeof message.event === "string") {
      this.events.event(message.event, message);
      return;
    }
    const asked = this.waiting.get(message.id as number);
    if (!asked) return;
    this.waiting.delete(message.id as number);
    const error = message.error as {
      message: string;
      code: string
    }
    |undefined;
    if (error)
      asked.reject(new Refusal(error.message, error.code));
    else
      asked.resolve(message.ok);
  }

  private see(data: ArrayBuffer): void {
    const header_bytes = new DataView(data).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, header_bytes))) as FrameHeader;
    const parts: Uint8Array[] = [];
    let at = 4 + header_bytes;
    for (const part of header.parts) {
      parts.push(new Uint8Array(data, at, part.bytes));
      at += part.bytes;
    }
    // A picture answers its request without a further text message.
    this.waiting.get(header.id)?.resolve(header);
    this.waiting.delete(header.id);
    this.events.picture(header, parts);
  }

  private closed(why: string): void {
    this.socket = null;
    for (const asked of this.waiting.values()) asked.reject(new Refusal("The connection was lost.", "lost"));
    this.waiting.clear();
    this.events.lost(why);
    window.setTimeout(() => this.open(), this.retry_ms);
    this.retry_ms = Math.min(last_retry_ms, this.retry_ms * 2);
  }
}
