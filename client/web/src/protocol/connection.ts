import { create, fromBinary, toBinary, type MessageInitShape } from '@bufbuild/protobuf';
import { AnswerSchema, ErrorCode, ErrorSchema, RequestSchema, type Answer } from '../generated/surfcast_pb';
import { decodeHello, encodeHello, refusalIn, type Hello, type Refusal } from './hello';

export type AnswerKind = Answer['kind'];
export type RequestKind = NonNullable<MessageInitShape<typeof RequestSchema>['kind']>;
type AnswerValues = { [Kind in AnswerKind as NonNullable<Kind['case']>]: Kind['value'] };

/** A request that the server answered with an error. */
export class RequestError extends Error {
  constructor(
    readonly code: ErrorCode,
    message: string,
  ) {
    super(message);
  }
}

export interface ConnectionEvents {
  /** The hellos are exchanged; requests may be sent from now on. */
  opened(hello: Hello): void;
  /**
   * Called once, also if the connection never opened. Without a refusal the connection was lost, or the server leaves
   * and another one may go on.
   */
  closed(refusal: Refusal | undefined, leaving: boolean): void;
  received(bytes: number): void;
}

/** Receives the answers to one request. */
type Listener = (kind: AnswerKind, bytes: number) => void;

const program = 'surfcast viewer';
const helloTimeout = 10_000; // ms
const goingAway = 1001; // RFC 6455, 7.4.1

let lastId = 0n; // of all connections: a view keeps its id when it goes on over another one

/** One WebSocket connection: hellos, then requests and answers, matched by id. */
export class Connection {
  private readonly socket: WebSocket;
  private readonly listeners = new Map<bigint, Listener>();
  private readonly helloTimer: ReturnType<typeof setTimeout>;
  private welcomed = false;
  private ended = false;

  constructor(
    url: string,
    private readonly events: ConnectionEvents,
  ) {
    this.socket = new WebSocket(url, 'surfcast.v1');
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.socket.send(encodeHello(program));
    this.socket.onmessage = (event: MessageEvent<unknown>) => this.take(event.data);
    this.socket.onclose = ({ code }: CloseEvent) => this.end(undefined, code === goingAway);
    this.helloTimer = setTimeout(() => {
      if (!this.welcomed) this.end({ message: 'The server does not answer.', again: true });
    }, helloTimeout);
  }

  close(): void {
    this.end(undefined);
  }

  /** Sends a request that has one answer. Rejects on an error answer and when the connection ends. */
  ask<Case extends keyof AnswerValues>(
    kind: RequestKind,
    expected: Case,
    started?: (id: bigint) => void,
  ): Promise<AnswerValues[Case]> {
    return new Promise((resolve, reject) => {
      const id = this.listen(kind, (answer) => {
        this.listeners.delete(id);
        if (answer.case === expected) resolve(answer.value as AnswerValues[Case]);
        else reject(errorOf(answer));
      });
      started?.(id);
    });
  }

  /** Sends a request that has any number of answers, until `unlisten`. Returns the id for later messages. */
  listen(kind: RequestKind, listener: Listener): bigint {
    const id = ++lastId;
    this.listenAs(id, listener);
    this.send(id, kind);
    return id;
  }

  /** Receives the answers with an id of an earlier connection. */
  listenAs(id: bigint, listener: Listener): void {
    this.listeners.set(id, listener);
  }

  unlisten(id: bigint): void {
    this.listeners.delete(id);
  }

  send(id: bigint, kind: RequestKind): void {
    if (this.ended || !this.welcomed) return;
    this.socket.send(toBinary(RequestSchema, create(RequestSchema, { id, kind })));
  }

  private take(data: unknown): void {
    if (this.ended || !(data instanceof ArrayBuffer)) return;
    const bytes = new Uint8Array(data);
    this.events.received(bytes.length);
    if (this.welcomed) this.deliver(bytes);
    else this.greet(decodeHello(bytes));
  }

  private greet(hello: Hello | undefined): void {
    clearTimeout(this.helloTimer);
    const refusal = refusalIn(hello);
    if (refusal || !hello) {
      this.end(refusal);
      return;
    }
    this.welcomed = true;
    this.events.opened(hello);
  }

  private deliver(bytes: Uint8Array): void {
    let answer: Answer;
    try {
      answer = fromBinary(AnswerSchema, bytes);
    } catch {
      this.end({ message: 'The server sent an invalid message.', again: true });
      return;
    }
    if (answer.kind.case === 'error' && answer.kind.value.code === ErrorCode.DENIED) {
      this.end({ message: `${answer.kind.value.message}. Reload the page to log in.`, again: false });
      return;
    }
    this.listeners.get(answer.id)?.(answer.kind, bytes.length);
  }

  private end(refusal: Refusal | undefined, leaving = false): void {
    if (this.ended) return;
    this.ended = true;
    clearTimeout(this.helloTimer);
    this.socket.close();
    const waiting = [...this.listeners.values()];
    this.listeners.clear();
    const broken = create(ErrorSchema, { code: ErrorCode.UNAVAILABLE, message: 'The connection ended.' });
    for (const listener of waiting) listener({ case: 'error', value: broken }, 0);
    this.events.closed(refusal, leaving);
  }
}

export function errorOf(answer: AnswerKind): RequestError {
  if (answer.case === 'error') return new RequestError(answer.value.code, answer.value.message);
  return new RequestError(ErrorCode.INTERNAL, `The server answered with ${answer.case ?? 'nothing'}.`);
}
