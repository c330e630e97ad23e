import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { LinkRelay } from './support/programs';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

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

  it('goes on with files where a packet is damaged', async () => {
    const wire = await Wire.tap(yard.page);
    wire.damagePackets = true;
    await dragOverThinLink(() => wire.opened.length > 1);
    expect(wire.opened.map(({ video }) => video.length)).toEqual([1, 0]);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });
});
