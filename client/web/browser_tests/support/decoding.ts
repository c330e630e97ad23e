import type { Page } from 'playwright-core';

/**
 * Lets a test decide in which order the page's pictures are decoded, and tells which of them were painted. Pictures are
 * numbered from 0 as they arrive.
 */
interface Decoding {
  /** Every second picture is decoded only after a later one was painted. */
  unordered: boolean;
  readonly painted: number[];
  /** Pictures whose decoding is held up. */
  readonly waiting: Map<number, () => void>;
}

declare global {
  interface Window {
    decoding: Decoding;
  }
}

/** Before the page is opened. */
export const watch = (page: Page): Promise<void> =>
  page.addInitScript(() => {
    const decoding: Decoding = { unordered: false, painted: [], waiting: new Map() };
    window.decoding = decoding;
    const numbers = new WeakMap<object, number>();
    let arrived = 0;
    const decode = window.createImageBitmap.bind(window);
    window.createImageBitmap = async (...args: unknown[]): Promise<ImageBitmap> => {
      const number = arrived++;
      const bitmap = await (decode as (...rest: unknown[]) => Promise<ImageBitmap>)(...args);
      numbers.set(bitmap, number);
      if (decoding.unordered && number % 2 === 0) {
        await new Promise<void>((resolve) => decoding.waiting.set(number, resolve));
      }
      return bitmap;
    };
    const draw = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function (this: CanvasRenderingContext2D, ...args: unknown[]) {
      (draw as (...rest: unknown[]) => void).apply(this, args);
      const number = numbers.get(args[0] as object);
      if (number === undefined) return;
      decoding.painted.push(number);
      for (const [waiting, release] of decoding.waiting) {
        if (waiting > number) continue;
        decoding.waiting.delete(waiting);
        release();
      }
    } as typeof draw;
  });

export const startUnordered = (page: Page): Promise<void> =>
  page.evaluate(() => {
    window.decoding.painted.length = 0;
    window.decoding.unordered = true;
  });

/** What still waits is decoded now, and what follows in order. */
export const endUnordered = (page: Page): Promise<void> =>
  page.evaluate(() => {
    window.decoding.unordered = false;
    for (const release of window.decoding.waiting.values()) release();
    window.decoding.waiting.clear();
  });

export const painted = (page: Page): Promise<number[]> => page.evaluate(() => [...window.decoding.painted]);
