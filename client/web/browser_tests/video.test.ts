import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { LinkRelay } from './support/programs';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

declare global {
  interface Window {
    /** JPEG files whose pictures were painted, in this order: a character for each byte. */
    paintedFiles: string[];
  }
}

const yard = useYard();

/** Opens the yard over a thin link, and drags until the condition holds. */
async function dragOverThinLink(until: () => boolean): Promise<void> {
  const relay = await LinkRelay.start(yard.server, 1, 40);
  try {
    await yard.page.goto(`http://127.0.0.1:${relay.port}/#/yard`);
    await look.sharp(yard.page);
    const from = await look.middle(yard.page);
    await yard.page.mouse.move(from.x, from.y);
    await yard.page.mouse.down();
    for (let i = 1; i < 2000 && !until(); ++i) {
      await yard.page.mouse.move(from.x + 60 * Math.sin(i / 10), from.y + 20 * Math.cos(i / 14));
      await yard.page.waitForTimeout(16);
    }
    await yard.page.mouse.up();
    await look.sharp(yard.page);
  } finally {
    await relay.stop();
  }
}

describe('a view over a thin link', () => {
  it('shows the packets of a video in motion, and files at rest', async () => {
    const wire = await Wire.tap(yard.page);
    const packets = (): number => wire.frames.filter(({ video }) => video).length;
    await dragOverThinLink(() => packets() >= 20);
    expect(packets()).toBeGreaterThanOrEqual(20);
    expect(wire.frames.filter(({ moving, video }) => !moving && video)).toEqual([]);
    expect(wire.opened.map(({ video }) => video.length)).toEqual([1]); // it was not opened again without
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });

  it('shows a frame at rest from coarse to fine while it arrives', async () => {
    await yard.reopen({ viewport: { width: 1200, height: 640 } }); // larger frames arrive in more pieces
    await yard.page.addInitScript(() => {
      window.paintedFiles = [];
      const files = new WeakMap<object, Blob>();
      const decode = window.createImageBitmap.bind(window);
      window.createImageBitmap = async (...args: unknown[]): Promise<ImageBitmap> => {
        const bitmap = await (decode as (...rest: unknown[]) => Promise<ImageBitmap>)(...args);
        if (args[0] instanceof Blob && args[0].type === 'image/jpeg') files.set(bitmap, args[0]);
        return bitmap;
      };
      const draw = CanvasRenderingContext2D.prototype.drawImage;
      CanvasRenderingContext2D.prototype.drawImage = function (this: CanvasRenderingContext2D, ...args: unknown[]) {
        (draw as (...rest: unknown[]) => void).apply(this, args);
        const file = files.get(args[0] as object);
        const text = new TextDecoder('latin1'); // arrays of numbers would take seconds to leave the page
        if (file) void file.arrayBuffer().then((bytes) => window.paintedFiles.push(text.decode(bytes)));
      };
    });
    let moved = 0;
    await dragOverThinLink(() => ++moved > 60);
    const files = await yard.page.evaluate(() => window.paintedFiles);
    const begins = (early: string, whole: string): boolean =>
      whole.length > early.length && whole.startsWith(early.slice(0, -2));
    const begun = files.filter((early, i) => files.slice(i + 1).some((whole) => begins(early, whole)));
    expect(begun.length).toBeGreaterThanOrEqual(1);
  });

  it('goes on with files where a packet is damaged', async () => {
    const wire = await Wire.tap(yard.page);
    wire.damagePackets = true;
    await dragOverThinLink(() => wire.opened.length > 1);
    expect(wire.opened.map(({ video }) => video.length)).toEqual([1, 0]);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });
});
