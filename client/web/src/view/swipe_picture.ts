import { effect } from '@preact/signals';
import type { DrawPicture } from '../generated/surfcast_pb';
import { pictureOf } from '../protocol/pictures';
import { hiddenAt } from '../state/joined';
import * as store from '../state/store';
import type { ViewController } from './view_controller';

/** What the picture at rest shows on the right of the line; undefined while the view moves, or is not divided. */
function wantedPicture(): DrawPicture | undefined {
  const swipe = store.swipe.value;
  if (!swipe || !store.pictureSettled.value) return undefined;
  const [model, camera, frame] = [store.model.peek(), store.shownCamera.peek(), store.shownFrame.peek()];
  if (model === undefined || !camera || !frame?.resolution) return undefined;
  const display = store.display.value;
  const hiddenModels = hiddenAt('right', display.hiddenModels, swipe);
  return pictureOf(model, camera, { ...display, hiddenModels }, frame.resolution);
}

/** Shows the models on the right of the line on a canvas over the picture. In motion the left ones fill the view. */
export function startSwipe(canvas: HTMLCanvasElement, controller: ViewController): void {
  const context = canvas.getContext('2d', { alpha: false });
  let newest = 0;
  let cancel: (() => void) | undefined;

  const show = async (picture: DrawPicture, number: number): Promise<void> => {
    const { data } = await controller.draw(picture, (started) => (cancel = started));
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(data)]));
    if (number === newest) {
      [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
      context?.drawImage(bitmap, 0, 0);
      canvas.hidden = false;
    }
    bitmap.close();
  };

  effect(() => {
    const number = ++newest;
    cancel?.();
    cancel = undefined;
    canvas.hidden = true;
    const picture = wantedPicture();
    if (picture) show(picture, number).catch(() => undefined); // the left models stay
  });
  effect(() => {
    canvas.style.clipPath = `inset(0 0 0 ${100 * store.swipeAt.value}%)`;
  });
}
