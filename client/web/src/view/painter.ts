import { FileFormat, type DrawPicture, type ViewFrame } from '../generated/surfcast_pb';
import { DepthMesher } from '../warp/depth_mesher';
import type { MeshedPlane } from '../warp/meshed_plane';
import { PacketDecoder } from './packet_decoder';

const types: Readonly<Record<FileFormat, string>> = {
  [FileFormat.PNG]: 'image/png',
  [FileFormat.JPEG]: 'image/jpeg',
  [FileFormat.WEBP]: 'image/webp',
  [FileFormat.EXR]: 'image/x-exr',
};

export const mediaType = (format: FileFormat): string => types[format];

/** A received frame and its time of arrival (performance.now()). */
export interface ArrivedFrame {
  readonly frame: ViewFrame;
  readonly bytes: number;
  readonly arrived: number;
  /** False: sharper pictures of the same frame follow. Its messages have been acknowledged. */
  readonly whole: boolean;
  /** The request that it shows, if it is known. */
  readonly asked?: DrawPicture | undefined;
}

export interface PaintedFrame extends ArrivedFrame {
  readonly decoded: number;
  readonly painted: number;
}

export interface DecodedFrame extends ArrivedFrame {
  readonly bitmap: ImageBitmap;
  readonly depth: MeshedPlane | undefined;
  readonly decoded: number;
}

export interface PainterEvents {
  /** A frame is decoded: `paint` should be called in the next animation frame. */
  ready(): void;
  /** Whoever takes this closes the bitmap. */
  painted(frame: PaintedFrame & DecodedFrame): void;
  /** A newer frame was ready before this one could be painted. The frame must be acknowledged all the same. */
  skipped(frame: ArrivedFrame): void;
  broken(frame: ArrivedFrame): void;
}

/**
 * Paints frames on a canvas. Pictures are decoded off the main thread. Only the newest decoded picture is painted.
 */
export class Painter {
  private readonly context: CanvasRenderingContext2D;
  private ready: DecodedFrame | undefined;
  private newest = 0n;
  private newestBytes = 0;
  private generation = 0;
  private readonly video = new PacketDecoder();
  private readonly mesher = new DepthMesher();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly events: PainterEvents,
  ) {
    const context = canvas.getContext('2d', { alpha: false });
    if (!context) throw new Error('This browser does not support 2D canvases.');
    this.context = context;
    canvas.hidden = true; // until the first picture
  }

  /** Drops the frames of a view that has ended. The picture stays until the next one. */
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
      const decoded = frame.video ? this.video.decode(frame) : bitmapOf(frame);
      const [bitmap, depth] = await Promise.all([decoded, this.depthOf(frame)]);
      if (generation === this.generation) this.queue({ ...arrived, bitmap, depth, decoded: performance.now() });
      else bitmap.close();
    } catch {
      if (generation === this.generation) this.events.broken(arrived);
    }
  }

  /** Without a depth, or with a damaged one, the frame is shown as it is. */
  private async depthOf({ depth, picture }: ViewFrame): Promise<MeshedPlane | undefined> {
    return depth && picture?.resolution ? this.mesher.mesh(depth, picture.resolution) : undefined;
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

  /** Paints the frame that is ready, if there is one. */
  paint(): void {
    const decoded = this.ready;
    if (!decoded) return;
    this.ready = undefined;
    const { bitmap, frame } = decoded;
    // The canvas has the size of the view. A smaller picture is scaled to it; one of the same size is copied exactly.
    const { width, height } = frame.resolution ?? bitmap;
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    this.canvas.hidden = false;
    this.context.imageSmoothingQuality = 'medium';
    this.context.drawImage(bitmap, 0, 0, width, height);
    this.events.painted({ ...decoded, painted: performance.now() });
  }
}

/** Of a frame that is a file. */
async function bitmapOf({ picture }: ViewFrame): Promise<ImageBitmap> {
  if (!picture) throw new Error('a frame without a picture');
  const file = new Blob([picture.data as Uint8Array<ArrayBuffer>], { type: mediaType(picture.format) });
  return createImageBitmap(file, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
}
