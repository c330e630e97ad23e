import { describe, expect, it } from 'vitest';
import type { Picture } from '../src/generated/surfcast_pb';
import * as look from './support/page';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

const yard = useYard();

/** Blocks, as a picture tells of them. */
const blocksOf = (picture: Picture | undefined): Record<string, number> => ({
  waitedFor: picture?.blocksWaitedFor ?? -1,
  resident: picture?.blocksResident ?? -1,
  bytes: Number(picture?.bytesResident ?? -1),
});

/** Waits for the final picture of the newest update. */
async function settled(wire: Wire): Promise<void> {
  const isFinal = (): boolean => {
    const last = wire.frames.at(-1);
    return last?.picture?.converged === true && last.update === (wire.updates.at(-1)?.update ?? 0n);
  };
  await expect.poll(isFinal).toBe(true);
}

/** Drags the thumb of a slider to shares of its length. Each step waits for a picture on its way. */
async function slide(wire: Wire, name: string, shares: readonly number[]): Promise<void> {
  const slider = yard.page.getByRole('slider', { name, exact: true });
  await slider.scrollIntoViewIfNeeded();
  const box = (await slider.boundingBox())!;
  const to = (share: number): Promise<void> =>
    yard.page.mouse.move(box.x + share * box.width, box.y + box.height / 2);
  await to(shares[0]!);
  await yard.page.mouse.down();
  for (const share of shares) {
    const frames = wire.frames.length;
    await to(share);
    await expect.poll(() => wire.frames.length, { interval: 5 }).toBeGreaterThan(frames);
  }
  await yard.page.mouse.up();
  await settled(wire);
}

/** Does something that changes the picture, and loads and asks for nothing anew. */
async function loadsNothing(wire: Wire, act: () => Promise<void>): Promise<void> {
  const before = blocksOf(wire.frames.at(-1)?.picture);
  const sum = await look.pictureSum(yard.page);
  const frames = wire.frames.length;
  const asked = wire.asked.length;
  await act();
  await expect.poll(() => wire.asked.slice(asked)).toContain('updateView');
  await expect.poll(() => look.pictureSum(yard.page)).not.toBe(sum);
  expect(before['resident']).toBeGreaterThan(1);
  for (const { picture } of wire.frames.slice(frames)) expect(blocksOf(picture)).toEqual({ ...before, waitedFor: 0 });
  expect(new Set(wire.asked.slice(asked))).toEqual(new Set(['updateView', 'framePainted']));
}

describe('what is seen through', () => {
  it('follows its sliders and loads nothing anew', async () => {
    const wire = await Wire.tap(yard.page);
    await yard.page.goto(`${yard.server.url}#/yard?opacity_by_class=6=0.5`); // classes are in a buffer of their own
    await look.sharp(yard.page);
    await look.toggleOptions(yard.page);
    await slide(wire, 'Opacity of all', [0.9, 0.8]); // the first picture of moderate quality
    await loadsNothing(wire, () => slide(wire, 'Opacity of all', [0.6, 0.4, 0.3]));
    await loadsNothing(wire, () => slide(wire, 'Opacity of Building', [0.4, 0.25, 0.7]));
    for (const xray of ['Walls', 'Density']) {
      await loadsNothing(wire, async () => {
        await yard.page.getByText(xray, { exact: true }).click();
        await settled(wire);
      });
    }
    const place = await look.placeNow(yard.page);
    expect(place.get('xray')).toBe('density');
    expect(Number(place.get('opacity'))).toBeCloseTo(0.3, 1);
  });

  it('includes the ghost of what a clip box hides', async () => {
    const wire = await Wire.tap(yard.page);
    const box = '452000,5411000,190,452024,5411024,202';
    await yard.page.goto(`${yard.server.url}#/yard?clip_box=${box}&ghost=0.2`);
    await look.sharp(yard.page);
    await yard.page.keyboard.press('c');
    await slide(wire, 'Opacity of what is hidden', [0.25, 0.3]);
    await loadsNothing(wire, () => slide(wire, 'Opacity of what is hidden', [0.5, 0.8, 0.6]));
    const place = await look.placeNow(yard.page);
    expect(Number(place.get('ghost'))).toBeCloseTo(0.6, 1);
  });
});
