import type { Camera } from '../camera/pose';
import { FileFormat, type DrawPicture, type ViewFrame } from '../generated/surfcast_pb';
import { cameraFrom } from '../protocol/pictures';
import { DepthMesher } from '../warp/depth_mesher';
import type { MeshedPlanes } from '../warp/meshed_plane';
import { PacketDecoder } from './packet_decoder';

const types: Readonly<Record<FileFormat, string>> = {
  [FileFormat.PNG]: 'image/png',
  [FileFormat.JPEG]: 'image/jpeg',
  [FileFormat.WEBP]: 'image/webp',
  [FileFormat.EXR]: 'image/x-exr',
};

export const mediaType = (format: FileFormat): string => types[format];

/**
 * A received frame and its time of arrival (performance.now()). With `frame.more`, sharper pictures of the same frame
 * follow, and its messages have been acknowledged.
 */
export interface ArrivedFrame {
  readonly frame: ViewFrame;
  readonly bytes: number;
  readonly arrived: number;
  /** The request that it shows, if it is known. */
  readonly asked?: DrawPicture | undefined;
}

export interface DecodedFrame extends ArrivedFrame {
  readonly camera: Camera;
  readonly bitmap: ImageBitmap;
  readonly depth: MeshedPlanes | undefined;
  readonly decoded: number; // performance.now()
}

/** A frame that has been shown. */
export interface PaintedFrame extends ArrivedFrame {
  readonly decoded: number;
  readonly painted: number; // performance.now()
}

export interface DecoderEvents {
  /** A frame is decoded: `newestFrame` should be called in the next animation frame. */
  ready(): void;
  /** A newer frame was ready before this one was taken. The frame must be acknowledged all the same. */
  skipped(frame: ArrivedFrame): void;
  broken(frame: ArrivedFrame): void;
}

/** Decodes pictures and depths off the main thread. Only the newest decoded frame is kept. */
export class FrameDecoder {
  private ready: DecodedFrame | undefined;
  private newest = 0n;
  private newestBytes = 0;
  private generation = 0;
  private readonly video = new PacketDecoder();
  private readonly mesher = new DepthMesher();

  /** `coarse`: frames in motion are warped with coarse depths now. */
  constructor(
    private readonly events: DecoderEvents,
    private readonly coarse: () => boolean,
  ) {}

  /** Drops the frames of a view that has ended. */
  reset(): void {
    this.generation += 1;
    this.newest = 0n;
    this.newestBytes = 0;
    this.video.reset();
    this.ready?.bitmap.close();
    this.ready = undefined;
  }

  async take(arrived: ArrivedFrame): Promise<void> {
    const { generation } = this;
    const { frame } = arrived;
    try {
      const camera = cameraFrom(frame.picture?.camera);
      if (!camera) throw new Error('a frame without a camera');
      const decoded = frame.video ? this.video.decode(frame) : bitmapOf(frame);
      const [bitmap, depth] = await Promise.all([decoded, this.depthOf(frame)]);
      if (generation === this.generation) this.queue({ ...arrived, camera, bitmap, depth, decoded: performance.now() });
      else bitmap.close();
    } catch {
      if (generation === this.generation) this.events.broken(arrived);
    }
  }

  /** Without a depth, or with a damaged one, the frame is shown as it is. */
  private async depthOf({ depth, picture, moving }: ViewFrame): Promise<MeshedPlanes | undefined> {
    if (!depth || !picture?.resolution) return undefined;
    const coarse = this.coarse(); // may change while a frame at rest is shown
    return this.mesher.mesh(depth, picture.resolution, { fine: !moving || !coarse, coarse: !moving || coarse });
  }

  private queue(decoded: DecodedFrame): void {
    const { frame, bytes } = decoded;
    if (frame.frame < this.newest || (frame.frame === this.newest && bytes < this.newestBytes)) {
      this.skip(decoded);
      return;
    }
    if (this.ready) this.skip(this.ready);
    this.newest = frame.frame;
    this.newestBytes = bytes;
    this.ready = decoded;
    this.events.ready();
  }

  private skip(decoded: DecodedFrame): void {
    decoded.bitmap.close();
    this.events.skipped(decoded);
  }

  /** The frame that is ready, if there is one. Whoever takes it closes the bitmap. */
  newestFrame(): DecodedFrame | undefined {
    const decoded = this.ready;
    this.ready = undefined;
    return decoded;
  }
}

/** Of a frame that is a file. */
async function bitmapOf({ picture }: ViewFrame): Promise<ImageBitmap> {
  if (!picture) throw new Error('a frame without a picture');
  const file = new Blob([picture.data as Uint8Array<ArrayBuffer>], { type: mediaType(picture.format) });
  return createImageBitmap(file, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
}
