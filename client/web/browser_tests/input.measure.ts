import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { it } from 'vitest';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import { Wire } from './support/wire';

/**
 * Measures the time from the movement of a pointer that drags to the display of a picture that shows it, on the lion,
 * with the round trips of `roundTrips` added: one line for each, with frames that have a depth and frames that have
 * none. No test: `npm run measure`, with SURFCASTD as for the tests.
 */

const roundTrips = [0, 150, 300]; // ms
const moves = 100;
const pause = 40; // ms between them

const quantile = (values: readonly number[], part: number): number =>
  [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(part * values.length))] ?? NaN;

const described = (values: readonly number[]): string =>
  `median ${quantile(values, 0.5).toFixed(0)} ms, p95 ${quantile(values, 0.95).toFixed(0)} ms of ${values.length}`;

/** Times from an event to the end of the drawing in the next animation frame, ms. */
const watchWarps = (page: Page): Promise<void> =>
  page.evaluate(() => {
    const times: number[] = [];
    Object.assign(window, { times });
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true })!;
    addEventListener('pointermove', (event) =>
      requestAnimationFrame(() => {
        const canvas = document.querySelector<HTMLCanvasElement>('canvas.warped')!;
        if (canvas.hidden) return;
        copy.drawImage(canvas, 0, 0, 1, 1);
        copy.getImageData(0, 0, 1, 1); // waits for the drawing
        times.push(performance.now() - event.timeStamp);
      }),
    );
  });

async function drag(page: Page, moved: () => void): Promise<void> {
  const from = await look.middle(page);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= moves; ++i) {
    moved();
    await page.mouse.move(from.x + 3 * (i % 50 < 25 ? i % 25 : 25 - (i % 25)), from.y + (i % 7));
    await page.waitForTimeout(pause);
  }
  await page.mouse.up();
}

/** Without a warp a movement is displayed with the first frame that shows an update sent after it. */
async function measure(page: Page, url: string, roundTrip: number, flat: boolean): Promise<readonly number[]> {
  const wire = await Wire.tap(page);
  wire.flat = flat;
  await page.goto(`${url}#/lion`);
  await look.sharp(page);
  wire.delay = roundTrip / 2;
  await watchWarps(page);
  const begun: { readonly at: number; readonly update: bigint }[] = [];
  await drag(page, () => begun.push({ at: performance.now(), update: (wire.updates.at(-1)?.update ?? 0n) + 1n }));
  await look.sharp(page);
  if (!flat) return page.evaluate(() => (window as unknown as { times: number[] }).times);
  return begun.flatMap(({ at, update }) => {
    const shown = wire.painted.find((painted) => painted.update >= update);
    return shown ? [shown.at - at] : [];
  });
}

it('takes from the input to the display', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'surfcast-input-'));
  const model = join(folder, 'lion.surf');
  await surfcastdRun('build', '../../tests/data/lion.drc', '--output', model);
  const server = await Server.start(model);
  const browser = await look.launch();
  for (const roundTrip of roundTrips) {
    for (const flat of [false, true]) {
      const { page } = await look.open(browser, look.desktop);
      const times = await measure(page, server.url, roundTrip, flat);
      console.log(`round trip ${roundTrip} ms, ${flat ? 'without' : 'with'} depth: ${described(times)}`);
      await page.context().close();
    }
  }
  await browser.close();
  await server.kill();
  await rm(folder, { recursive: true });
});
