import { fromBinary, toBinary } from '@bufbuild/protobuf';
import type { Page, WebSocketRoute } from 'playwright-core';
import { AnswerSchema, RequestSchema, type DrawPicture, type OpenView, type ViewFrame } from '../../src/generated/surfcast_pb';

/** What goes between the page and the server, seen and, where a test wants that, held up. */
export class Wire {
  /** Updates of all views, by the order in which the page sent them. */
  readonly updates: { readonly update: bigint; readonly picture: DrawPicture | undefined }[] = [];
  /** Kinds of all requests, in the order in which the page sent them. */
  readonly asked: string[] = [];
  /** The picture of the last pick. */
  picked: DrawPicture | undefined;
  /** The frame of each message that the page gets, and of each acknowledgement that it sends. */
  readonly pieces: bigint[] = [];
  readonly acknowledged: bigint[] = [];
  /** The update of each frame that the page has painted, and when (performance.now()). */
  readonly painted: { readonly update: bigint; readonly at: number }[] = [];
  /** Whole frames, in the order in which the page gets them, each as its first piece says it. */
  readonly frames: ViewFrame[] = [];
  /** What views were opened with, in this order. */
  readonly opened: OpenView[] = [];
  private begun: ViewFrame | undefined;
  heldFrames = 0;
  /** Milliseconds that each message takes, either way. */
  delay = 0;
  /** Frames lose their depth on the way, as if the server knew none. */
  flat = false;
  /** Packets of videos lose their end on the way. */
  damagePackets = false;
  private holding = false;
  private readonly held: (() => void)[] = [];

  /** Before the page opens its connection. */
  static async tap(page: Page): Promise<Wire> {
    const wire = new Wire();
    await page.routeWebSocket(/\/ws(\?|$)/, (socket) => wire.connect(socket));
    return wire;
  }

  /** From now on no frame reaches the page; all else does. */
  holdFrames(): void {
    this.holding = true;
  }

  releaseFrames(): void {
    this.holding = false;
    for (const pass of this.held.splice(0)) pass();
  }

  private connect(socket: WebSocketRoute): void {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      if (typeof message !== 'string') this.noteRequest(message);
      this.later(() => server.send(message));
    });
    server.onMessage((message) => {
      const frame = typeof message === 'string' ? undefined : frameOf(message);
      const pass = (): void =>
        this.later(() => {
          if (frame) this.noteFrame(frame);
          socket.send(frame ? this.changed(message as Buffer) : message);
        });
      if (!frame || !this.holding) return pass();
      this.heldFrames += 1;
      this.held.push(pass);
    });
  }

  private changed(message: Buffer): Buffer {
    if (this.flat) return flattened(message);
    return this.damagePackets ? damaged(message) : message;
  }

  private later(pass: () => void): void {
    if (this.delay === 0) pass();
    else setTimeout(pass, this.delay);
  }

  /** What goes on in further pieces is whole with the last of them. */
  private noteFrame(piece: ViewFrame): void {
    this.pieces.push(piece.frame);
    if (this.begun?.frame !== piece.frame) this.begun = piece;
    if (!piece.more) this.frames.push(this.begun!);
  }

  private noteAcknowledgement(frame: bigint): void {
    this.acknowledged.push(frame);
    const whole = [...this.frames].reverse().find((one) => one.frame === frame);
    if (whole) this.painted.push({ update: whole.update, at: performance.now() });
  }

  private noteRequest(message: Buffer): void {
    const { kind } = isHello(message) ? { kind: undefined } : fromBinary(RequestSchema, message);
    if (kind?.case) this.asked.push(kind.case);
    if (kind?.case === 'openView') this.opened.push(kind.value);
    if (kind?.case === 'pickSurfel') this.picked = kind.value.picture;
    if (kind?.case === 'framePainted') this.noteAcknowledgement(kind.value.frame);
    if (kind?.case === 'updateView') this.updates.push({ update: kind.value.update, picture: kind.value.picture });
  }
}

const isHello = (message: Buffer): boolean => message[0] === 0xf5; // no message begins so

function frameOf(message: Buffer): ViewFrame | undefined {
  if (isHello(message)) return undefined;
  const { kind } = fromBinary(AnswerSchema, message);
  return kind.case === 'viewFrame' ? kind.value : undefined;
}

function flattened(message: Buffer): Buffer {
  const answer = fromBinary(AnswerSchema, message);
  if (answer.kind.case === 'viewFrame') delete answer.kind.value.depth;
  return Buffer.from(toBinary(AnswerSchema, answer));
}

function damaged(message: Buffer): Buffer {
  const answer = fromBinary(AnswerSchema, message);
  if (answer.kind.case !== 'viewFrame' || !answer.kind.value.video || !answer.kind.value.picture) return message;
  answer.kind.value.picture.data = answer.kind.value.picture.data.subarray(0, 3);
  return Buffer.from(toBinary(AnswerSchema, answer));
}
