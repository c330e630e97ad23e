import { VideoCodec, type DrawPicture } from '../generated/surfcast_pb';
import { errorOf, type AnswerKind, type Connection, type RequestError } from '../protocol/connection';
import { FrameAssembler } from './assembler';
import type { ArrivedFrame } from './frame_decoder';

export interface ViewEvents {
  frame(frame: ArrivedFrame): void;
  /** The view has ended; nothing follows. */
  failed(error: RequestError): void;
}

/** What a view asks for beside its picture, as far as the browser can use it. */
export interface ViewWishes {
  readonly depth: boolean;
  readonly video: boolean;
}

/** One view of a model over one connection: sends updates and receives frames. */
export class ViewSession {
  readonly id: bigint;
  private assembler = new FrameAssembler();
  private lastUpdate = 0n;
  /** What was asked for, by the number of the update. Frames show one of these; older ones are forgotten. */
  private readonly asked = new Map<bigint, DrawPicture>();
  private ended = false;

  constructor(
    private connection: Connection,
    picture: DrawPicture,
    private readonly events: ViewEvents,
    { depth, video }: ViewWishes = { depth: false, video: false },
  ) {
    this.asked.set(this.lastUpdate, picture);
    const value = { picture, depth, video: video ? [VideoCodec.VP9] : [] };
    this.id = connection.listen({ case: 'openView', value }, (answer, bytes) => this.take(answer, bytes));
  }

  /** Goes on over another connection, whose server has the view open again. Its frames are counted anew. */
  goOn(connection: Connection): void {
    this.connection = connection;
    this.assembler = new FrameAssembler();
    this.ended = false;
    connection.listenAs(this.id, (answer, bytes) => this.take(answer, bytes));
  }

  /** Sends an update. Returns its number, which frames that show it repeat. */
  update(picture: DrawPicture, moving: boolean): bigint {
    const update = ++this.lastUpdate;
    this.asked.set(update, picture);
    if (!this.ended) this.connection.send(this.id, { case: 'updateView', value: { update, picture, moving } });
    return update;
  }

  /** Must be called once for every message of a frame; otherwise the server stops sending. */
  acknowledge(frame: bigint, clientMs: number): void {
    if (!this.ended) this.connection.send(this.id, { case: 'framePainted', value: { frame, clientMs } });
  }

  close(): void {
    if (this.ended) return;
    this.ended = true;
    this.connection.unlisten(this.id);
    void this.connection.ask({ case: 'closeView', value: { view: this.id } }, 'viewClosed').catch(() => undefined);
  }

  private take(answer: AnswerKind, bytes: number): void {
    if (answer.case === 'viewFrame') {
      const piece = answer.value;
      const frame = this.assembler.take(piece, bytes, performance.now());
      if (piece.more) this.acknowledge(piece.frame, 0);
      if (frame) this.events.frame({ ...frame, asked: this.askedFor(frame.frame.update) });
      return;
    }
    this.ended = true;
    this.connection.unlisten(this.id);
    if (answer.case !== 'viewClosed') this.events.failed(errorOf(answer));
  }

  private askedFor(update: bigint): DrawPicture | undefined {
    for (const older of this.asked.keys()) if (older < update) this.asked.delete(older);
    return this.asked.get(update);
  }
}
