import { backoff } from './backoff';
import { Connection } from './connection';
import type { Hello, Refusal } from './hello';

export type LinkState =
  | { readonly kind: 'connecting' }
  | { readonly kind: 'open'; readonly server: string }
  | { readonly kind: 'waiting'; readonly until: number; readonly message: string } // `until`: as Date.now()
  | { readonly kind: 'refused'; readonly message: string }; // no retry

export interface LinkEvents {
  changed(state: LinkState): void;
  opened(connection: Connection): void;
  closed(): void;
  received(bytes: number): void;
}

/** A connection that is reopened after it is lost, with exponential backoff. */
export class Link {
  private connection: Connection | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private attempt = 0;
  private closed = false;

  constructor(
    private readonly url: string,
    private readonly events: LinkEvents,
  ) {
    this.connect();
  }

  /** Closes the connection; no retries follow. */
  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.connection?.close();
  }

  /** Retries immediately instead of waiting. */
  retry(): void {
    if (this.connection) return;
    this.attempt = 0;
    this.connect();
  }

  private connect(): void {
    clearTimeout(this.timer);
    this.events.changed({ kind: 'connecting' });
    const connection: Connection = new Connection(this.url, {
      opened: (hello: Hello) => {
        this.attempt = 0;
        this.events.changed({ kind: 'open', server: hello.program });
        this.events.opened(connection);
      },
      closed: (refusal) => this.lost(refusal),
      received: (bytes) => this.events.received(bytes),
    });
    this.connection = connection;
  }

  private lost(refusal: Refusal | undefined): void {
    this.connection = undefined;
    this.events.closed();
    if (this.closed) return;
    if (refusal && !refusal.again) {
      this.events.changed({ kind: 'refused', message: refusal.message });
      return;
    }
    const wait = backoff(this.attempt++, Math.random());
    this.timer = setTimeout(() => this.connect(), wait);
    const message = refusal?.message ?? 'The server cannot be reached.';
    this.events.changed({ kind: 'waiting', until: Date.now() + wait, message });
  }
}
