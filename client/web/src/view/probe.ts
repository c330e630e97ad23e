import { pointAt } from '../camera/projection';
import type { Pixel, Vector } from '../camera/vector';
import type { PickResult } from '../generated/surfcast_pb';
import { pictureOf, vectorFrom } from '../protocol/pictures';
import { hiddenAt } from '../state/joined';
import * as store from '../state/store';
import type { ViewController } from './view_controller';

/** Requests the surfel at a pixel of the picture on the screen. */
export class Probe {
  constructor(private readonly controller: ViewController) {}

  /** Undefined while there is no picture. Rejects with a RequestError. */
  async pick(pixel: Pixel): Promise<PickResult | undefined> {
    const frame = store.shownFrame.peek();
    const model = store.model.peek();
    const camera = store.shownCamera.peek();
    if (!frame?.resolution || !camera || model === undefined) return undefined;
    const { width, height } = frame.resolution;
    const x = Math.min(width - 1, Math.max(0, Math.floor(pixel.x)));
    const y = Math.min(height - 1, Math.max(0, Math.floor(pixel.y)));
    const display = store.display.peek();
    const side = x < store.swipeAt.peek() * width ? 'left' : 'right';
    const hiddenModels = hiddenAt(side, display.hiddenModels, store.swipe.peek());
    const picture = pictureOf(model, camera, { ...display, hiddenModels }, { width, height });
    const result = await this.controller.pick(picture, x, y);
    const { hit, position } = result;
    if (hit && position && model === store.model.peek()) store.lastPick.value = vectorFrom(position);
    return result;
  }

  /** The point under a pixel: an estimate at first, the surfel's position once the server has answered. */
  anchor(pixel: Pixel): Anchor {
    const anchor = new Anchor(pixel);
    this.pick(pixel).then(
      (result) => {
        if (result?.hit && result.position) anchor.hit = vectorFrom(result.position);
      },
      () => undefined, // without an answer the estimate stays
    );
    return anchor;
  }
}

export class Anchor {
  hit: Vector | undefined;

  constructor(readonly pixel: Pixel) {}

  /** The picked point; without one, the point of the pixel at the depth of the focal point. */
  get point(): Vector {
    const view = store.shownProjection.peek();
    const pose = store.pose.peek();
    if (this.hit || !view || !pose) return this.hit ?? { x: 0, y: 0, z: 0 };
    return pointAt(view, this.pixel, pose.distance);
  }
}
