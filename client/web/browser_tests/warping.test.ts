import { cp } from 'node:fs/promises';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server } from './support/programs';
import * as warping from './support/warping';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

const yard = useYard();

/** Opens the yard, through a wire. */
async function openYard(): Promise<Wire> {
  const wire = await Wire.tap(yard.page);
  await yard.open();
  return wire;
}

/** Presses in the middle. */
async function press(page: Page): Promise<{ x: number; y: number }> {
  const from = await look.middle(page);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  return from;
}

describe('a drag', () => {
  it('moves the picture with the next animation frame, however late the frames of the server are', async () => {
    const wire = await openYard();
    wire.delay = 150;
    await warping.record(yard.page);
    const from = await press(yard.page);
    for (let i = 1; i <= 12; ++i) await yard.page.mouse.move(from.x + 6 * i, from.y + 2 * i);
    await expect.poll(async () => (await warping.shown(yard.page)).length).toBeGreaterThanOrEqual(12);
    const shown = (await warping.shown(yard.page)).slice(1); // the first is the way to the middle, or a jitter
    expect(shown.every(({ warped }) => warped)).toBe(true);
    expect(new Set(shown.map(({ picture }) => picture)).size).toBe(shown.length);
    expect(yard.page.workers().length).toBe(1); // makes the triangles
    await yard.page.mouse.up();
    await look.sharp(yard.page);
    expect(await warping.isWarped(yard.page)).toBe(false);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
  });

  it('moves the picture and what lies over it to where they will be', async () => {
    const wire = await openYard();
    await yard.page.keyboard.press('i');
    const at = await look.middle(yard.page, 110, 60); // the point in the middle does not move
    await yard.page.mouse.click(at.x, at.y); // a ring around the point
    await yard.page.locator('.inspect-card').waitFor();
    await yard.page.waitForTimeout(400); // so that the drag does not begin with a double click
    const before = await warping.screen(yard.page);
    const overlay = (): Promise<string> =>
      yard.page.evaluate(() => document.querySelector<HTMLCanvasElement>('canvas.overlay')!.toDataURL());
    const still = await overlay();
    wire.holdFrames();
    await look.drag(yard.page, 40, -12);
    await expect.poll(() => warping.state(yard.page)).toBe('warped');
    const [moved, warped] = [await overlay(), await warping.screen(yard.page)];
    expect(moved).not.toBe(still);
    wire.releaseFrames();
    await look.sharp(yard.page);
    expect(await overlay()).toBe(moved);
    const after = await warping.screen(yard.page);
    const stale = await warping.distance(yard.page, before, after);
    const late = await warping.distance(yard.page, warped, after);
    expect(late).toBeLessThan(stale / 3);
  });

  it('sends picks with the camera that is shown', async () => {
    const wire = await openYard();
    wire.holdFrames();
    await look.drag(yard.page, 60, 0);
    const sent = wire.updates.at(-1)!.picture!.camera;
    await press(yard.page);
    await expect.poll(() => wire.picked?.camera).toEqual(sent);
    await yard.page.mouse.up();
    wire.releaseFrames();
  });

  it('changes nothing until the next frame where frames have no depth', async () => {
    const wire = await Wire.tap(yard.page);
    wire.flat = true;
    await yard.open();
    const sum = await look.pictureSum(yard.page);
    wire.holdFrames();
    await look.drag(yard.page, 60, 0);
    expect(await warping.isWarped(yard.page)).toBe(false);
    expect(await look.pictureSum(yard.page)).toBe(sum);
    wire.releaseFrames();
    await look.sharp(yard.page);
    expect(await look.pictureSum(yard.page)).not.toBe(sum);
  });
});

describe('a warped picture', () => {
  it('has fewer pixels where warps are slow, and all of them once it stands still', async () => {
    const wire = await openYard();
    await yard.page.evaluate(() => {
      const read = WebGL2RenderingContext.prototype.readPixels;
      WebGL2RenderingContext.prototype.readPixels = function (this: WebGL2RenderingContext, ...args: unknown[]) {
        const until = performance.now() + 50;
        while (performance.now() < until);
        (read as (...rest: unknown[]) => void).apply(this, args);
      } as typeof read;
    });
    const width = (name: string): Promise<number> =>
      yard.page.evaluate((name) => document.querySelector<HTMLCanvasElement>(`canvas.${name}`)!.width, name);
    wire.holdFrames();
    const whole = await width('picture');
    const least = Math.round(0.375 * whole);
    const from = await press(yard.page);
    let smaller = false;
    for (let i = 1; i <= 300 && !smaller; ++i) {
      await yard.page.mouse.move(from.x + 30 * Math.sin(i / 10), from.y + i / 10);
      smaller = (await warping.isWarped(yard.page)) && (await width('warped')) === least;
    }
    expect(smaller).toBe(true);
    await expect.poll(() => width('warped')).toBe(whole);
    expect(await warping.isWarped(yard.page)).toBe(true);
    await yard.page.mouse.up();
    wire.releaseFrames();
    await look.sharp(yard.page);
  });

  it('acknowledges each message of a frame once', async () => {
    const wire = await openYard();
    const from = await press(yard.page);
    for (let i = 1; i <= 20; ++i) await yard.page.mouse.move(from.x + 4 * i, from.y);
    await yard.page.mouse.up();
    await look.sharp(yard.page);
    const sorted = (frames: readonly bigint[]): bigint[] => [...frames].sort((a, b) => Number(a - b));
    await expect.poll(() => sorted(wire.acknowledged)).toEqual(sorted(wire.pieces));
  });

  it('is given up while the browser has lost its graphics, and comes back with them', async () => {
    const wire = await openYard();
    wire.holdFrames();
    await look.drag(yard.page, 40, 0);
    await expect.poll(() => warping.state(yard.page)).toBe('warped');
    await yard.page.evaluate(() => {
      const gl = document.querySelector<HTMLCanvasElement>('canvas.warped')!.getContext('webgl2')!;
      const extension = gl.getExtension('WEBGL_lose_context')!;
      extension.loseContext();
      Object.assign(window, { restore: () => extension.restoreContext() });
    });
    await expect.poll(() => warping.isWarped(yard.page)).toBe(false);
    await yard.page.evaluate(() => (window as unknown as { restore: () => void }).restore());
    await expect.poll(() => warping.state(yard.page)).toBe('warped');
    wire.releaseFrames();
    await look.sharp(yard.page);
    expect(await warping.isWarped(yard.page)).toBe(false);
  });

  it('of another model stays as it was until the first frame of the new one', async () => {
    const other = join(yard.folder, 'other.surf');
    await cp(yard.model, other);
    const server = await Server.start(yard.model, 0, other);
    try {
      const wire = await Wire.tap(yard.page);
      await yard.page.goto(`${server.url}#/yard`);
      await look.sharp(yard.page);
      // Overlay and controls will be those of no picture.
      await yard.page.addStyleTag({ content: 'body :not(.warped, :has(.warped)) { opacity: 0 !important; }' });
      wire.holdFrames();
      await look.drag(yard.page, 40, 0);
      const warped = await warping.screen(yard.page);
      const view = 'position=452010,5410950,240&focal_point=452012,5411012,200';
      await yard.page.evaluate((hash) => (location.hash = hash), `#/other?${view}`);
      await expect.poll(() => wire.asked.filter((kind) => kind === 'openView').length).toBe(2);
      await yard.page.mouse.wheel(0, 300);
      await yard.page.waitForTimeout(300);
      await expect.poll(() => warping.state(yard.page)).toBe('warped');
      // What is left of the former one has not moved.
      expect(await warping.distance(yard.page, await warping.screen(yard.page), warped)).toBeLessThan(0.1);
      wire.releaseFrames();
      await look.sharp(yard.page);
      expect(await warping.isWarped(yard.page)).toBe(false);
    } finally {
      await server.kill();
    }
  });

  it('goes on moving while the server is away', async () => {
    const wire = await openYard();
    const { port } = yard.server;
    await yard.server.kill();
    await yard.page.locator('.banner').waitFor();
    const before = await warping.screen(yard.page);
    await look.drag(yard.page, 40, 0);
    await expect.poll(() => warping.state(yard.page)).toBe('warped');
    expect(await warping.distance(yard.page, before, await warping.screen(yard.page))).toBeGreaterThan(1);
    yard.server = await Server.start(yard.model, port);
    await look.sharp(yard.page);
    expect(await warping.isWarped(yard.page)).toBe(false);
    expect(await look.differenceFrom(yard.page, await yard.renderedFromAddress())).toBe(0);
    expect(wire.frames.length).toBeGreaterThan(0);
  });
});
