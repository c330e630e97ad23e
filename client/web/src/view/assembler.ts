import { create } from '@bufbuild/protobuf';
import { FileFormat, ViewFrameSchema, type ViewFrame } from '../generated/surfcast_pb';
import { endedAt, showableBytes } from './jpeg_scans';
import type { ArrivedFrame } from './frame_decoder';

/**
 * Assembles frames from their pieces. Each piece states whether more pieces follow. A piece of another frame means that
 * the server dropped the rest of the previous one.
 */
export class FrameAssembler {
  private pieces: ViewFrame[] = [];
  private bytes = 0;
  private shown = 0; // bytes of the picture that early frames had

  /** Adds a piece; returns the frame when the piece is its last, or, with `more`, when more of it can be shown. */
  take(piece: ViewFrame, bytes: number, arrived: number): ArrivedFrame | undefined {
    if (this.pieces[0] && this.pieces[0].frame !== piece.frame) this.drop();
    this.pieces.push(piece);
    this.bytes += bytes;
    if (piece.more) return this.early(arrived);
    const frame = { frame: joined(this.pieces), bytes: this.bytes, arrived };
    this.drop();
    return frame;
  }

  private early(arrived: number): ArrivedFrame | undefined {
    if (this.pieces[0]?.picture?.format !== FileFormat.JPEG) return undefined; // a large file is not joined at each piece
    const frame = joined(this.pieces);
    const picture = frame.picture!;
    const showable = showableBytes(picture.data);
    if (showable <= this.shown) return undefined;
    this.shown = showable;
    const data = endedAt(picture.data, showable);
    return { frame: { ...frame, more: true, picture: { ...picture, data } }, bytes: this.bytes, arrived };
  }

  private drop(): void {
    this.pieces = [];
    this.bytes = 0;
    this.shown = 0;
  }
}

/** The first piece has all fields; the others have only data. */
function joined(pieces: readonly ViewFrame[]): ViewFrame {
  const [first] = pieces;
  if (!first?.picture || pieces.length === 1) return first ?? create(ViewFrameSchema);
  const parts = pieces.map((piece) => piece.picture?.data ?? new Uint8Array());
  const data = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    data.set(part, at);
    at += part.length;
  }
  return { ...first, more: false, picture: { ...first.picture, data } };
}
