import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { it } from 'vitest';
import * as look from './support/page';
import { LinkRelay, Server, surfcastdRun } from './support/programs';

/**
 * Films what the viewer shows of a drag over a link of 200 ms: as it shows frames where the browser has no WebGL 2, on
 * the left, and warped, on the right. The dot is the pointer. Writes numbered pictures to the folder FILM; without it
 * there is nothing to do. One animation of them: PIL.Image.save(..., save_all=True, duration=1000 / 12).
 */

const film = process.env['FILM'];
const roundTrip = 200; // ms
const megabits = 20;
const perSecond = 12;
const moving = 5; // seconds
const resting = 1.5;
const size = { width: 320, height: 180 };

declare global {
  interface Window {
    pointer: { x: number; y: number };
    shots: { at: number; url: string }[];
  }
}

/** Before the page is opened: its warps stay readable, or it has no WebGL. */
const prepare = (page: Page, warps: boolean): Promise<void> =>
  page.addInitScript((warps) => {
    const get = HTMLCanvasElement.prototype.getContext as (...args: unknown[]) => unknown;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, options?: object) {
      if (kind !== 'webgl2') return get.call(this, kind, options);
      return warps ? get.call(this, kind, { ...options, preserveDrawingBuffer: true }) : null;
    } as typeof HTMLCanvasElement.prototype.getContext;
  }, warps);

/** From now on, until there are shots of so many seconds. */
const shoot = (page: Page, seconds: number): Promise<void> =>
  page.evaluate(
    ({ seconds, size, every }) => {
      window.pointer = { x: 0, y: 0 };
      window.shots = [];
      addEventListener('pointermove', ({ clientX: x, clientY: y }) => (window.pointer = { x, y }), { capture: true });
      const copy = document.createElement('canvas');
      Object.assign(copy, size);
      const context = copy.getContext('2d')!;
      const begun = performance.now();
      const take = (): void => {
        const at = (performance.now() - begun) / 1000;
        if (at > seconds) return;
        if (at >= every * window.shots.length) {
          const warped = document.querySelector<HTMLCanvasElement>('canvas.warped')!;
          const shown = warped.hidden ? document.querySelector<HTMLCanvasElement>('canvas.picture')! : warped;
          const { left, top, width, height } = shown.getBoundingClientRect();
          context.drawImage(shown, 0, 0, size.width, size.height);
          context.fillStyle = '#ffb347';
          context.beginPath();
          const x = ((window.pointer.x - left) / width) * size.width;
          context.arc(x, ((window.pointer.y - top) / height) * size.height, 4, 0, 7);
          context.fill();
          window.shots.push({ at, url: copy.toDataURL() });
        }
        requestAnimationFrame(take);
      };
      requestAnimationFrame(take);
    },
    { seconds, size, every: 1 / perSecond },
  );

async function record(browser: Browser, url: string, warps: boolean): Promise<readonly string[]> {
  const { page } = await look.open(browser, { viewport: { width: 960, height: 600 } });
  await prepare(page, warps);
  await page.goto(`${url}#/lion`);
  await look.sharp(page);
  const from = await look.middle(page);
  await page.mouse.move(from.x, from.y);
  await shoot(page, moving + resting);
  await page.mouse.down();
  const begun = performance.now();
  for (let now = 0; now < moving; now = (performance.now() - begun) / 1000) {
    await page.mouse.move(from.x + 40 * Math.sin(1.3 * now), from.y + 12 * Math.sin(0.6 * now));
    await page.waitForTimeout(12);
  }
  await page.mouse.up();
  await page.waitForTimeout(1000 * resting + 500);
  const shots = await page.evaluate(() => window.shots);
  await page.context().close();
  const frames = Math.floor((moving + resting) * perSecond);
  return Array.from({ length: frames }, (_, i) => shots.filter(({ at }) => at <= (i + 0.5) / perSecond).at(-1)!.url);
}

/** Two pictures beside each other, as a PNG file. */
const joined = (page: Page, urls: readonly string[]): Promise<string> =>
  page.evaluate(
    async ({ urls, size }) => {
      const canvas = document.createElement('canvas');
      Object.assign(canvas, { width: 2 * size.width + 4, height: size.height });
      const context = canvas.getContext('2d')!;
      for (const [i, url] of urls.entries()) {
        const image = new Image();
        image.src = url;
        await image.decode();
        context.drawImage(image, i * (size.width + 4), 0);
        context.fillStyle = '#d8dee4';
        context.font = '12px sans-serif';
        context.fillText(['frames as they arrive', 'warped'][i]!, i * (size.width + 4) + 8, size.height - 8);
      }
      return canvas.toDataURL().split(',')[1]!;
    },
    { urls: [...urls], size },
  );

it.runIf(film)('films a drag over a long link', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'surfcast-film-'));
  const model = join(folder, 'lion.surf');
  await surfcastdRun('build', '../../tests/data/lion.drc', '--output', model);
  const server = await Server.start(model);
  const relay = await LinkRelay.start(server, megabits, roundTrip);
  const browser = await look.launch();
  const url = `http://127.0.0.1:${relay.port}/`;
  const [before, after] = [await record(browser, url, false), await record(browser, url, true)];
  const { page } = await look.open(browser, look.desktop);
  await mkdir(film!, { recursive: true });
  for (const [i, picture] of before.entries()) {
    const file = join(film!, `${i}`.padStart(3, '0') + '.png');
    await writeFile(file, Buffer.from(await joined(page, [picture, after[i]!]), 'base64'));
  }
  await browser.close();
  await relay.stop();
  await server.kill();
  await rm(folder, { recursive: true });
});
