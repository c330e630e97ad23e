import { pointAt } from '../camera/projection';
import type { Pixel, Vector } from '../camera/vector';
import type { PickResult } from '../generated/surfcast_pb';
import { cameraFrom, pictureOf, vectorFrom } from '../protocol/pictures';
import * as store from '../state/store';
import type { ViewController } from './view_controller';

/** Asks what is under a pixel of the picture on the screen. */
export class Probe {
  constructor(private readonly controller: ViewController) {}

  /** Rejects with a RequestError; nothing while there is no picture. */
  async pick(pixel: Pixel): Promise<PickResult | undefined> {
    const frame = store.shownFrame.peek();
    const model = store.model.peek();
    const camera = cameraFrom(frame?.picture?.camera);
    if (!frame?.resolution || !camera || model === undefined) return undefined;
    const { width, height } = frame.resolution;
    const x = Math.min(width - 1, Math.max(0, Math.floor(pixel.x)));
    const y = Math.min(height - 1, Math.max(0, Math.floor(pixel.y)));
    return this.controller.pick(pictureOf(model, camera, store.display.peek(), { width, height }), x, y);
  }

  /** The point under a pixel as well as it is known: the scan's own once the server has answered. */
  anchor(pixel: Pixel): Anchor {
    const anchor = new Anchor(pixel);
    this.pick(pixel).then(
      (result) => {
        if (result?.hit && result.position) anchor.hit = vectorFrom(result.position);
      },
      () => undefined, // without an answer the plane of interest will do
    );
    return anchor;
  }
}

export class Anchor {
  hit: Vector | undefined;

  constructor(readonly pixel: Pixel) {}

  /** On the scan, or else as far away as what the eye is interested in. */
  get point(): Vector {
    const view = store.shownProjection.peek();
    const pose = store.pose.peek();
    if (this.hit || !view || !pose) return this.hit ?? { x: 0, y: 0, z: 0 };
    return pointAt(view, this.pixel, pose.distance);
  }
}
