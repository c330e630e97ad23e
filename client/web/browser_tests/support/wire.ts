import { fromBinary } from '@bufbuild/protobuf';
import type { Page, WebSocketRoute } from 'playwright-core';
import { AnswerSchema, RequestSchema, type DrawPicture, type ViewFrame } from '../../src/generated/surfcast_pb';

/** What goes between the page and the server, seen and, where a test wants that, held up. */
export class Wire {
  /** Updates of all views, by the order in which the page sent them. */
  readonly updates: { readonly update: bigint; readonly picture: DrawPicture | undefined }[] = [];
  /** Kinds of all requests, in the order in which the page sent them. */
  readonly asked: string[] = [];
  /** Whole frames, in the order in which the page gets them, each as its first piece says it. */
  readonly frames: ViewFrame[] = [];
  private begun: ViewFrame | undefined;
  heldFrames = 0;
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
      server.send(message);
    });
    server.onMessage((message) => {
      const frame = typeof message === 'string' ? undefined : frameOf(message);
      const pass = (): void => {
        if (frame) this.noteFrame(frame);
        socket.send(message);
      };
      if (!frame || !this.holding) return pass();
      this.heldFrames += 1;
      this.held.push(pass);
    });
  }

  /** What goes on in further pieces is whole with the last of them. */
  private noteFrame(piece: ViewFrame): void {
    if (this.begun?.frame !== piece.frame) this.begun = piece;
    if (!piece.more) this.frames.push(this.begun!);
  }

  private noteRequest(message: Buffer): void {
    const { kind } = isHello(message) ? { kind: undefined } : fromBinary(RequestSchema, message);
    if (kind?.case) this.asked.push(kind.case);
    if (kind?.case === 'updateView') this.updates.push({ update: kind.value.update, picture: kind.value.picture });
  }
}

const isHello = (message: Buffer): boolean => message[0] === 0xf5; // no message begins so

function frameOf(message: Buffer): ViewFrame | undefined {
  if (isHello(message)) return undefined;
  const { kind } = fromBinary(AnswerSchema, message);
  return kind.case === 'viewFrame' ? kind.value : undefined;
}
