import { batch } from '@preact/signals';
import type { Size } from '../protocol/pictures';
import * as store from '../state/store';

const maxPixels = 2560 * 1600; // larger pictures take too long for the gain in sharpness
const settle = 120; // ms without a change; otherwise every step of resizing would request a new picture

/** Size of an element in device pixels, limited on screens of very high resolution. */
export function pixelsOf(width: number, height: number, ratio: number): Size {
  const used = Math.min(ratio, 2, Math.sqrt(maxPixels / Math.max(1, width * height)));
  return { width: Math.round(width * used), height: Math.round(height * used) };
}

/** Keeps the store's picture size equal to the size of the element. */
export function followSize(element: HTMLElement, changed: (before: Size, after: Size) => void): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const adopt = (): void => {
    const { clientWidth, clientHeight } = element;
    if (clientWidth === 0 || clientHeight === 0) return;
    const size = pixelsOf(clientWidth, clientHeight, devicePixelRatio);
    const now = store.stageSize.peek();
    if (size.width === now.width && size.height === now.height) return;
    if (now.width > 0) changed(now, size);
    store.stageSize.value = size;
  };
  const take = (): void =>
    batch(() => {
      adopt();
      store.resizing.value = false;
    });
  new ResizeObserver(() => {
    clearTimeout(timer);
    if (store.stageSize.peek().width === 0) return take();
    store.resizing.value = true;
    timer = setTimeout(take, settle);
  }).observe(element);
}
