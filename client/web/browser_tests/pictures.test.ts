import { join } from 'node:path';
import { isDeepStrictEqual } from 'node:util';
import { describe, expect, it } from 'vitest';
import type { ViewFrame } from '../src/generated/surfcast_pb';
import * as decoding from './support/decoding';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import * as warping from './support/warping';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

const yard = useYard();

describe('the picture', () => {
  it('opens the only model, and frames arrive until the picture is sharp', async () => {
    await yard.page.goto(yard.server.url);
    await look.sharp(yard.page);
    expect(yard.page.url()).toContain('#/yard');
    const sizes = await look.pictureSize(yard.page);
    expect(sizes.width).toBeGreaterThan(600);
  });

  it('shows ever newer pictures while the hand drags, and the newest where it rests', async () => {
    const wire = await Wire.tap(yard.page);
    await decoding.watch(yard.page);
    await yard.open();
    const from = await look.middle(yard.page);
    await yard.page.mouse.move(from.x, from.y);
    await yard.page.mouse.down();
    await decoding.startUnordered(yard.page);
    // Each step waits for a picture on its way, so that pictures follow each other on every machine.
    for (let i = 1; i <= 12; ++i) {
      const frames = wire.frames.length;
      await yard.page.mouse.move(from.x + 12 * i, from.y + 3 * i);
      await expect.poll(() => wire.frames.length, { interval: 5 }).toBeGreaterThan(frames);
    }
    await decoding.endUnordered(yard.page);
    const shown = async (): Promise<ViewFrame | undefined> =>
      wire.frames[(await decoding.painted(yard.page)).at(-1) ?? -1];
    await expect.poll(async () => (await shown())?.update).toBe(wire.updates.at(-1)!.update);

    const painted = await decoding.painted(yard.page);
    expect(painted).toEqual([...painted].sort((a, b) => a - b)); // decoded out of order, painted in order
    const updates = painted.map((number) => wire.frames[number]!.update);
    expect(updates).toEqual([...updates].sort((a, b) => Number(a - b)));
    expect(new Set(updates).size).toBeGreaterThan(2);
    // Pictures in motion are drawn ahead of the hand. The screen shows the present camera all the same.
    const isOwn = (frame: ViewFrame | undefined): boolean => {
      const asked = wire.updates.find((sent) => sent.update === frame?.update)?.picture?.camera;
      return asked !== undefined && isDeepStrictEqual(frame?.picture?.camera?.position, asked.position);
    };
    for (const number of painted) expect(wire.frames[number]!.moving || isOwn(wire.frames[number])).toBe(true);
    await expect.poll(async () => isOwn(await shown()) !== (await warping.isWarped(yard.page))).toBe(true);
    await yard.page.mouse.up();
    await look.sharp(yard.page);
    expect(isOwn(await shown())).toBe(true);
    expect(await warping.isWarped(yard.page)).toBe(false);
  });

  it('shows at rest, pixel by pixel, what `surfcastd render` draws', async () => {
    await yard.open();
    await look.drag(yard.page, 140, -60);
    await look.sharp(yard.page);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });

  it('looks straight down and still agrees with `surfcastd render`', async () => {
    await yard.open();
    await look.placeNow(yard.page);
    await look.turned(yard.page, () => yard.page.keyboard.press('5'));
    await look.sharp(yard.page);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });
});

describe('a real scan', () => {
  it('is turned, shown pixel by pixel as `surfcastd render` draws it, and read point by point', async () => {
    const lion = join(yard.folder, 'lion.surf');
    await surfcastdRun('build', '../../tests/data/lion.drc', '--output', lion);
    const lionServer = await Server.start(lion);
    try {
      await yard.page.goto(`${lionServer.url}#/lion`);
      await look.sharp(yard.page);
      await look.drag(yard.page, 120, -30);
      await look.sharp(yard.page);
      expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress(lion))).toBe(0);
      const { width, height } = await look.pictureSize(yard.page);
      const pixel = `${Math.floor(width / 2)},${Math.floor(height / 2)}`;
      const picked = await surfcastdRun('pick', lion, '--pixel', pixel, '--json', ...(await yard.viewFromAddress()));
      const { at, rows } = await yard.inspect(0, 0);
      const { position, color } = JSON.parse(picked) as { position: number[]; color: number[] };
      expect(at).toEqual(position);
      expect(rows.get('colour')).toBe(color.join(' '));
      await look.turned(yard.page, () => yard.page.keyboard.press('5'));
      await look.sharp(yard.page);
      expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress(lion))).toBe(0);
    } finally {
      await lionServer.kill();
    }
  });
});
