import type { Page } from 'playwright-core';

/**
 * Lets a test decide in which order the page's pictures are decoded, and tells which of them were shown. Pictures are
 * numbered from 0 as they arrive, with those of frames that are not whole.
 */
interface Decoding {
  /** Every second picture is decoded only after a later one was painted. */
  unordered: boolean;
  arrived: number;
  /** Older pictures do not count. */
  first: number;
  /** Pictures, in the order in which they were shown, as they are or warped. */
  readonly painted: number[];
  /** Of each picture: whether it is a progressive JPEG file that lacks scans. */
  readonly early: boolean[];
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
    const decoding: Decoding = { unordered: false, arrived: 0, first: 0, painted: [], early: [], waiting: new Map() };
    window.decoding = decoding;
    const numbers = new WeakMap<object, number>();
    const decode = window.createImageBitmap.bind(window);
    const lacksScans = async (file: unknown): Promise<boolean> => {
      if (!(file instanceof Blob) || file.type !== 'image/jpeg') return false;
      const bytes = new Uint8Array(await file.arrayBuffer());
      const count = (marker: number): number =>
        bytes.reduce((sum, byte, i) => sum + (byte === 0xff && bytes[i + 1] === marker ? 1 : 0), 0);
      return count(0xc2) === 1 && count(0xda) < 10; // libjpeg-turbo writes ten
    };
    window.createImageBitmap = async (...args: unknown[]): Promise<ImageBitmap> => {
      const number = decoding.arrived++;
      decoding.early[number] = false;
      decoding.early[number] = await lacksScans(args[0]);
      const bitmap = await (decode as (...rest: unknown[]) => Promise<ImageBitmap>)(...args);
      numbers.set(bitmap, number);
      if (decoding.unordered && number % 2 === 0) {
        await new Promise<void>((resolve) => decoding.waiting.set(number, resolve));
      }
      return bitmap;
    };
    const shown = (bitmap: ImageBitmap): void => {
      const number = numbers.get(bitmap);
      if (number === undefined || number < decoding.first || decoding.painted.at(-1) === number) return;
      decoding.painted.push(number);
      for (const [waiting, release] of decoding.waiting) {
        if (waiting > number) continue;
        decoding.waiting.delete(waiting);
        release();
      }
    };
    type Method = (...args: unknown[]) => void;
    const watchCalls = (prototype: object, name: string): void => {
      const methods = prototype as Record<string, Method>;
      const method = methods[name]!;
      methods[name] = function (this: unknown, ...args: unknown[]) {
        method.apply(this, args);
        args.filter((arg) => arg instanceof ImageBitmap).forEach(shown);
      };
    };
    watchCalls(CanvasRenderingContext2D.prototype, 'drawImage');
    watchCalls(WebGL2RenderingContext.prototype, 'texImage2D'); // of a frame that is warped
  });

export const startUnordered = (page: Page): Promise<void> =>
  page.evaluate(() => {
    window.decoding.first = window.decoding.arrived;
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

/** The painted frames that are whole, by their number among those. */
export const painted = (page: Page): Promise<number[]> =>
  page.evaluate(() => {
    const { painted, early } = window.decoding;
    const whole = painted.filter((number) => !early[number]);
    return whole.map((number) => number - early.slice(0, number).filter(Boolean).length);
  });
