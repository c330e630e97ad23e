import { readFile } from 'node:fs/promises';
import { chromium, type Browser, type BrowserContextOptions, type Page } from 'playwright-core';
import { expect } from 'vitest';
import { patience } from './patience';

/** Actions and observations of a user, as short functions. */

const flags = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--disable-site-isolation-trials', // one process less for each page
];

export const launch = (): Promise<Browser> =>
  chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: flags });

let shared: Browser | undefined;

/** One browser for all files: its start takes as long as a test. Each page has a context of its own. */
export async function sharedBrowser(): Promise<Browser> {
  if (!shared?.isConnected()) shared = await launch();
  return shared;
}

/** Small: server and browser draw in software. */
export const desktop: BrowserContextOptions = { viewport: { width: 960, height: 540 } };
export const phone: BrowserContextOptions = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true };

/** A page whose errors fail the test that uses it. */
export async function open(browser: Browser, options: BrowserContextOptions): Promise<{ page: Page; errors: string[] }> {
  const page = await (await browser.newContext(options)).newPage();
  page.setDefaultTimeout(patience);
  const errors: string[] = [];
  page.on('pageerror', (error) => errors.push(error.message));
  return { page, errors };
}

/** Waits until the page has taken note of what was done last: its layout is observed once a frame. */
const noted = (page: Page): Promise<unknown> =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Waits until the picture on the screen is the converged one of the newest view. `timeout`: in ms, if not the usual. */
export async function sharp(page: Page, timeout?: number): Promise<void> {
  await noted(page);
  await page.locator('.status .lamp.sharp').waitFor({ state: 'attached', timeout });
}

/** Opens or closes the panel of options, and waits for the picture of the size that it leaves. */
export async function toggleOptions(page: Page): Promise<void> {
  await page.keyboard.press('o');
  await sharp(page);
}

/** The state of the lamp in the status line: sharp, working or offline. */
export async function lamp(page: Page): Promise<string> {
  const names = (await page.locator('.status .lamp').getAttribute('class')) ?? '';
  return names.replace('lamp ', '');
}

/** A file that an action saves. */
export async function saved(page: Page, action: () => Promise<void>): Promise<{ name: string; bytes: Buffer }> {
  const download = page.waitForEvent('download');
  await action();
  const file = await download;
  return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}

/** A checksum of the picture's pixels. */
export const pictureSum = (page: Page): Promise<number> =>
  page.evaluate(() => {
    const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
    const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    for (const byte of data) sum = (Math.imul(sum, 31) + byte) | 0;
    return sum;
  });

/** Number of bytes in which the picture on the screen differs from a PNG file. */
export const differenceFrom = (page: Page, png: Buffer): Promise<number> =>
  page.evaluate(async (base64) => {
    const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
    const file = new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: 'image/png' });
    const bitmap = await createImageBitmap(file, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
    if (bitmap.width !== canvas.width || bitmap.height !== canvas.height) return Infinity;
    const other = document.createElement('canvas');
    other.width = bitmap.width;
    other.height = bitmap.height;
    const context = other.getContext('2d', { alpha: false })!;
    context.drawImage(bitmap, 0, 0);
    const bytes = (of: CanvasRenderingContext2D): Uint8ClampedArray =>
      of.getImageData(0, 0, canvas.width, canvas.height).data;
    const [a, b] = [bytes(canvas.getContext('2d')!), bytes(context)];
    return a.reduce((count, byte, i) => count + (byte === b[i] ? 0 : 1), 0);
  }, png.toString('base64'));

export const pictureSize = (page: Page): Promise<{ width: number; height: number }> =>
  page.evaluate(() => {
    const { width, height } = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
    return { width, height };
  });

/** The centre of the picture plus an offset, in page coordinates, pixels. */
export async function middle(page: Page, dx = 0, dy = 0): Promise<{ x: number; y: number }> {
  const box = await page.locator('.canvases').boundingBox();
  expect(box).not.toBeNull();
  return { x: box!.x + Math.floor(box!.width / 2) + dx, y: box!.y + Math.floor(box!.height / 2) + dy };
}

export async function drag(page: Page, dx: number, dy: number): Promise<void> {
  const from = await middle(page);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 6; ++i) await page.mouse.move(from.x + (dx * i) / 6, from.y + (dy * i) / 6);
  await page.waitForTimeout(100); // a pause before the release, so that nothing coasts
  await page.mouse.up();
}

/** Does what changes the view, and waits until the address tells of it. */
export async function turned(page: Page, action: () => Promise<void>): Promise<void> {
  const former = page.url();
  await action();
  await page.waitForFunction((url) => location.href !== url, former);
}

/** The parameters of the address once it has been updated to the view. */
export async function placeNow(page: Page): Promise<URLSearchParams> {
  await noted(page);
  await page.waitForFunction(() => location.hash.includes('position='));
  // Timers of a page end in their order: this one after that of the address, which is shorter and began before.
  await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
  return new URLSearchParams(new URL(page.url()).hash.split('?')[1]);
}
