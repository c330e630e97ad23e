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
  /** `views`: ids of views that go on. */
  opened(connection: Connection, views: readonly bigint[]): void;
  closed(): void;
  received(bytes: number): void;
}

const soon = 200; // ms: another server goes on

/** A connection that is reopened after it is lost, with exponential backoff. The server's session goes on. */
export class Link {
  private connection: Connection | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private attempt = 0;
  private session = '';
  private closed = false;

  private openUrl = '';

  /** `url`: of the server, at the time of connecting. */
  constructor(
    private readonly url: () => string,
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

  /** Connects anew if the URL is another one than when the connection was made. Its session ends. */
  renew(): void {
    const former = this.connection;
    if (!former || this.openUrl === this.url()) return;
    this.connection = undefined;
    this.session = '';
    former.close();
    this.events.closed();
    this.connect();
  }

  private connect(): void {
    clearTimeout(this.timer);
    this.events.changed({ kind: 'connecting' });
    this.openUrl = this.url();
    const connection: Connection = new Connection(this.openUrl, {
      opened: (hello: Hello) => {
        this.attempt = 0;
        this.events.changed({ kind: 'open', server: hello.program });
        void this.resume(connection);
      },
      closed: (refusal, leaving) => {
        if (connection === this.connection) this.lost(refusal, leaving);
      },
      received: (bytes) => this.events.received(bytes),
    });
    this.connection = connection;
  }

  /** Goes on with the session of the former connection. The first one has nothing to wait for. */
  private async resume(connection: Connection): Promise<void> {
    const first = this.session === '';
    if (first) this.events.opened(connection, []);
    let views: readonly bigint[] = [];
    try {
      const resumed = await connection.ask({ case: 'resume', value: { session: this.session } }, 'resumed');
      if (connection === this.connection) this.session = resumed.session;
      views = resumed.views;
    } catch {
      if (connection === this.connection) this.session = ''; // a server that keeps none
    }
    if (!first && connection === this.connection) this.events.opened(connection, views);
  }

  private lost(refusal: Refusal | undefined, leaving: boolean): void {
    this.connection = undefined;
    this.events.closed();
    if (this.closed) return;
    if (refusal && !refusal.again) {
      this.events.changed({ kind: 'refused', message: refusal.message });
      return;
    }
    const wait = leaving && this.attempt === 0 ? soon * Math.random() : backoff(this.attempt, Math.random());
    this.attempt += 1;
    this.timer = setTimeout(() => this.connect(), wait);
    const message = refusal?.message ?? 'The server cannot be reached.';
    this.events.changed({ kind: 'waiting', until: Date.now() + wait, message });
  }
}
