import { VideoCodec, type ViewFrame } from '../generated/surfcast_pb';

const config: VideoDecoderConfig = {
  codec: 'vp09.00.40.08', // profile 0, 8 bits
  colorSpace: { primaries: 'bt709', transfer: 'iec61966-2-1', matrix: 'bt709', fullRange: false },
  optimizeForLatency: true,
};

/** Whether this browser decodes the videos of views. Without a secure context it has no decoders. */
export async function decodesVideo(): Promise<boolean> {
  if (typeof VideoDecoder === 'undefined') return false;
  return VideoDecoder.isConfigSupported(config).then(
    ({ supported }) => supported === true,
    () => false,
  );
}

interface Waiting {
  resolve(bitmap: ImageBitmap): void;
  reject(error: Error): void;
}

/**
 * Decodes the packets of a view's video. The pictures are copies, so that one which is shown for long does not keep a
 * place of the decoder.
 */
export class PacketDecoder {
  private decoder: VideoDecoder | undefined;
  private readonly waiting = new Map<number, Waiting>(); // by the number of the frame
  private last = 0n; // the frame that was decoded last; 0: none

  /** Rejects what is not the packet after the last one, or cannot be decoded. Call it once for each, in order. */
  decode({ frame, video, picture }: ViewFrame): Promise<ImageBitmap> {
    const follows = video?.key === true || (this.last !== 0n && video?.refersTo === this.last);
    if (!picture || video?.codec !== VideoCodec.VP9 || !follows) return Promise.reject(new Error('no next packet'));
    this.decoder ??= this.begin();
    this.last = frame;
    const timestamp = Number(frame);
    const type = video.key ? 'key' : 'delta';
    return new Promise((resolve, reject) => {
      this.waiting.set(timestamp, { resolve, reject });
      this.decoder?.decode(new EncodedVideoChunk({ type, timestamp, data: picture.data as Uint8Array<ArrayBuffer> }));
    });
  }

  /** The next packet begins another video. */
  reset(): void {
    const { decoder } = this;
    this.decoder = undefined;
    this.last = 0n;
    if (decoder && decoder.state !== 'closed') decoder.close();
    for (const one of this.waiting.values()) one.reject(new Error('the video has ended'));
    this.waiting.clear();
  }

  private begin(): VideoDecoder {
    const decoder = new VideoDecoder({
      output: (picture) => void this.take(picture),
      error: () => this.reset(),
    });
    decoder.configure(config);
    return decoder;
  }

  private async take(picture: VideoFrame): Promise<void> {
    const waiting = this.waiting.get(picture.timestamp);
    this.waiting.delete(picture.timestamp);
    try {
      const bitmap = await createImageBitmap(picture, { premultiplyAlpha: 'none' });
      if (waiting) waiting.resolve(bitmap);
      else bitmap.close();
    } catch {
      waiting?.reject(new Error('a picture of the video cannot be shown'));
    } finally {
      picture.close();
    }
  }
}
