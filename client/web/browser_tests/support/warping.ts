import type { Page } from 'playwright-core';

/** What is on the screen above the overlay's canvas, frame by frame. */

declare global {
  interface Window {
    /** After each movement of the pointer, in the next animation frame: checksums of what is shown. */
    shown: { readonly warped: boolean; readonly picture: number; readonly overlay: number }[];
  }
}

/** Once the page is open. */
export const record = (page: Page): Promise<void> =>
  page.evaluate(() => {
    window.shown = [];
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true })!;
    const sum = (name: string): number => {
      const canvas = document.querySelector<HTMLCanvasElement>(`canvas.${name}`)!;
      if (canvas.hidden) return 0;
      copy.canvas.width = canvas.width;
      copy.canvas.height = canvas.height;
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      let value = 1;
      for (const pixel of new Uint32Array(data.buffer)) value = (Math.imul(value, 31) + pixel) | 0;
      return value;
    };
    // The page has heard of the event before, so that its own animation frame comes first.
    addEventListener('pointermove', () =>
      requestAnimationFrame(() => {
        const warped = !document.querySelector<HTMLCanvasElement>('canvas.warped')!.hidden;
        window.shown.push({ warped, picture: sum(warped ? 'warped' : 'picture'), overlay: sum('overlay') });
      }),
    );
  });

export const shown = (page: Page): Promise<Window['shown']> => page.evaluate(() => window.shown);

/** What is shown, or why it cannot be warped. */
export const state = (page: Page): Promise<'warped' | 'picture' | 'WebGL is lost' | 'no WebGL'> =>
  page.evaluate(() => {
    const canvas = document.querySelector<HTMLCanvasElement>('canvas.warped')!;
    if (!canvas.hidden) return 'warped';
    const gl = canvas.getContext('webgl2');
    if (!gl) return 'no WebGL';
    return gl.isContextLost() ? 'WebGL is lost' : 'picture';
  });

export const isWarped = async (page: Page): Promise<boolean> => (await state(page)) === 'warped';

/** What a user sees of the picture and its overlay. */
export const screen = (page: Page): Promise<Buffer> => page.locator('.canvases').screenshot();

/** Mean difference of two screenshots, in levels, over the pixels of which either is not of the background. */
export const distance = (page: Page, a: Buffer, b: Buffer): Promise<number> =>
  page.evaluate(
    async (files) => {
      const [one, other] = await Promise.all(
        files.map(async (file) => {
          const blob = new Blob([Uint8Array.from(atob(file), (c) => c.charCodeAt(0))], { type: 'image/png' });
          const bitmap = await createImageBitmap(blob);
          const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d')!;
          context.drawImage(bitmap, 0, 0);
          return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
        }),
      );
      let [sum, count] = [0, 0];
      for (let i = 0; i < one!.length; i += 4) {
        if (one![i]! + one![i + 1]! < 64 && other![i]! + other![i + 1]! < 64) continue;
        for (const k of [0, 1, 2]) sum += Math.abs(one![i + k]! - other![i + k]!);
        count += 3;
      }
      return sum / count;
    },
    [a.toString('base64'), b.toString('base64')],
  );
