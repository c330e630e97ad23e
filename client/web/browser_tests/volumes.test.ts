import { mkdtemp, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Locator } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server } from './support/programs';
import { Session, use } from './support/session';
import { ballNrrd, detachedBall } from './support/volume';
import { Wire } from './support/wire';

/** A server of a volume, given as its file. */
class Ball extends Session {
  server!: Server;
  cache!: string;

  override async begin(): Promise<void> {
    await super.begin();
    const file = join(this.folder, 'ball.nrrd');
    await writeFile(file, ballNrrd());
    this.cache = join(this.folder, 'cache');
    this.server = await Server.start(file, 0, '--cache', this.cache);
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }

  async open(query = ''): Promise<void> {
    await this.page.goto(`${this.server.url}#/ball${query}`);
    await look.sharp(this.page);
  }

  /** The parameter of the address, once it passes after all that has been done: not in the midst of a drag. */
  async parameter(name: string, passes: (value: string | null) => boolean): Promise<string> {
    let value: string | null = null;
    const read = async (): Promise<boolean> => passes((value = (await look.placeNow(this.page)).get(name)));
    await expect.poll(read).toBe(true);
    return value ?? '';
  }

  /** Waits for a picture that differs from the one of a checksum, and is whole. */
  async changedFrom(sum: number): Promise<number> {
    await expect.poll(() => look.pictureSum(this.page)).not.toBe(sum);
    await look.sharp(this.page);
    return look.pictureSum(this.page);
  }
}

const ball = use(new Ball());

const curve = (): Locator => ball.page.locator('.curve');
const pointCount = (): Promise<number> => curve().locator('circle').count();
const pointsIn = (text: string | null): number[][] => (text ?? '').split(';').map((part) => part.split(',').map(Number));

/** Drags from one place of the curve to another; places are shares of its width and height, upwards. */
async function dragCurve(from: readonly [number, number], to: readonly [number, number]): Promise<void> {
  const box = (await curve().boundingBox())!;
  const place = ([x, y]: readonly [number, number]): [number, number] => [
    box.x + x * box.width,
    box.y + (1 - y) * box.height,
  ];
  await ball.page.mouse.move(...place(from));
  await ball.page.mouse.down();
  await ball.page.mouse.move(...place(to), { steps: 5 });
  await ball.page.mouse.up();
}

const ramp = '0,0,0,0,0;500,255,0,0,0.25;1000,255,255,255,1';

describe('the transfer function', () => {
  it('is edited over the histogram: a point is dragged, added and removed', async () => {
    await ball.open(`?transfer=${ramp}`);
    await look.toggleOptions(ball.page);
    expect(await pointCount()).toBe(3);
    const before = await look.pictureSum(ball.page);
    await dragCurve([0.5, 0.5], [0.25, 0.9]); // heights are square roots of opacities
    const dragged = pointsIn(await ball.parameter('transfer', (text) => pointsIn(text)[1]![0]! < 300));
    expect(dragged).toHaveLength(3);
    expect(dragged[1]![0]).toBeCloseTo(250, -1);
    expect(dragged[1]![4]).toBeCloseTo(0.81, 1);
    expect(dragged[1]!.slice(1, 4)).toEqual([255, 0, 0]);
    const moved = await ball.changedFrom(before);

    await dragCurve([0.7, 0.2], [0.7, 0.2]);
    const added = pointsIn(await ball.parameter('transfer', (text) => pointsIn(text).length === 4));
    expect(added[2]![0]).toBeCloseTo(700, -1);
    expect(await pointCount()).toBe(4);
    await ball.changedFrom(moved);

    await ball.page.getByRole('button', { name: 'Remove', exact: true }).click();
    await ball.parameter('transfer', (text) => pointsIn(text).length === 3);
    expect(await ball.changedFrom(0)).toBe(moved); // the picture before the point was added
  });

  it('is edited with the keyboard', async () => {
    await ball.open(`?transfer=${ramp}`);
    await look.toggleOptions(ball.page);
    await curve().focus();
    await ball.page.keyboard.press('PageDown');
    await ball.page.keyboard.press('ArrowRight');
    const moved = pointsIn(await ball.parameter('transfer', (text) => pointsIn(text)[1]![0] !== 500));
    expect(moved[1]![0]).toBeCloseTo(510);
    await ball.page.keyboard.press('Delete');
    await ball.parameter('transfer', (text) => pointsIn(text).length === 2);
  });

  it('is a preset until it is edited, and its window is set in numbers', async () => {
    await ball.open();
    await look.toggleOptions(ball.page);
    const before = await look.pictureSum(ball.page);
    await ball.page.getByText('CT bone', { exact: true }).click();
    await ball.parameter('transfer', (text) => text === 'ct-bone');
    await ball.changedFrom(before);
    for (const [name, value] of [['Level', '400'], ['Window', '300']] as const) {
      const field = ball.page.getByRole('textbox', { name, exact: true });
      await field.fill(value);
      await field.press('Enter');
    }
    await ball.parameter('transfer', (text) => text === 'ct-bone,250,550');
    expect(await ball.page.getByRole('radio', { name: 'Own' }).isChecked()).toBe(false);
  });

  it('lies over a histogram with a logarithmic or a linear scale', async () => {
    await ball.open();
    await look.toggleOptions(ball.page);
    const bars = (): Promise<string | null> => curve().locator('.bars').getAttribute('d');
    const logarithmic = await bars();
    await ball.page.getByRole('button', { name: 'Linear histogram' }).click();
    await expect.poll(bars).not.toBe(logarithmic);
    await ball.page.getByRole('button', { name: 'Logarithmic histogram' }).click();
    await expect.poll(bars).toBe(logarithmic);
  });

  it('comes back with a link', async () => {
    await ball.open(`?transfer=${ramp}`);
    await look.toggleOptions(ball.page);
    await dragCurve([0.5, 0.5], [0.4, 0.7]);
    await ball.page.getByRole('switch', { name: 'Light by gradient' }).check();
    await ball.parameter('shaded', (text) => text === 'on');
    // The panel takes room from the picture.
    await ball.page.getByRole('button', { name: 'Close the panel' }).click();
    await ball.page.locator('.panel').waitFor({ state: 'detached' });
    await look.sharp(ball.page);
    const [url, sum] = [ball.page.url(), await look.pictureSum(ball.page)];
    await ball.page.goto('about:blank');
    await ball.page.goto(url);
    await look.sharp(ball.page);
    expect(await look.pictureSum(ball.page)).toBe(sum);
    expect(ball.page.url()).toBe(url);
  });
});

describe('window and level', () => {
  it('are dragged on the picture, and moved by the arrow keys', async () => {
    await ball.open('?transfer=gray,0,1000');
    const before = await look.pictureSum(ball.page);
    await ball.page.keyboard.press('v');
    await ball.page.getByText('Level 500, window 1000').waitFor();
    const camera = await ball.parameter('position', (text) => text !== null);
    const from = await look.middle(ball.page);
    await ball.page.mouse.move(from.x, from.y);
    await ball.page.mouse.down();
    await ball.page.mouse.move(from.x - 80, from.y - 60, { steps: 5 });
    await ball.page.mouse.up();
    const text = await ball.parameter('transfer', (value) => value !== 'gray,0,1000');
    const [first, last] = text.split(',').slice(1).map(Number);
    expect(last! - first!).toBeLessThan(990); // to the left: narrower
    expect((first! + last!) / 2).toBeLessThan(490); // upwards: brighter
    expect(await ball.parameter('position', () => true)).toBe(camera);
    await ball.changedFrom(before);
    await ball.page.keyboard.press('ArrowRight');
    const [a, b] = (await ball.parameter('transfer', (value) => value !== text)).split(',').slice(1).map(Number);
    expect(b! - a!).toBeCloseTo(last! - first! + 10);
  });
});

describe('surfaces and slices', () => {
  it('are asked for, moved by sliders, and kept by the link', async () => {
    const wire = await Wire.tap(ball.page);
    await ball.open();
    const asked = () => wire.updates.at(-1)?.picture;
    await look.toggleOptions(ball.page);
    await ball.page.getByRole('button', { name: 'Add surface' }).click();
    await ball.parameter('iso', (text) => text === '500');
    await ball.page.getByRole('slider', { name: 'Value of surface' }).fill('300');
    await ball.parameter('iso', (text) => text === '300');
    await expect.poll(() => asked()?.isoSurfaces.map(({ value }) => value)).toEqual([300]);
    expect(asked()?.medium).toBeUndefined();
    await ball.page.getByRole('switch', { name: 'Across K' }).check();
    await ball.page.getByRole('slider', { name: 'Index along K' }).fill('20');
    await ball.parameter('slice', (text) => text === 'k,20');
    await expect.poll(() => asked()?.slices.map(({ axis, index }) => [axis, index])).toEqual([[3, 20]]);
    await ball.page.getByRole('switch', { name: 'Show the volume around' }).first().check();
    await ball.parameter('medium', (text) => text === 'on');
    await ball.page.getByRole('slider', { name: 'Opacity of all' }).fill('0.5');
    await ball.parameter('opacity', (text) => text === '0.5');
    await expect.poll(() => [asked()?.medium, asked()?.opacity]).toEqual([true, 0.5]);

    await ball.page.reload();
    await look.sharp(ball.page);
    await look.toggleOptions(ball.page);
    expect(await ball.page.getByRole('slider', { name: 'Value of surface' }).inputValue()).toBe('300');
    expect(await ball.page.getByRole('slider', { name: 'Index along K' }).inputValue()).toBe('20');
    await ball.page.getByRole('button', { name: 'Remove surface' }).click();
    await ball.page.getByRole('switch', { name: 'Across K' }).uncheck();
    await ball.parameter('iso', (text) => text === null);
    await ball.parameter('medium', (text) => text === null);
  });
});

describe('a volume', () => {
  it('is named as one in the gallery and in the panel', async () => {
    await ball.open();
    await ball.page.getByTitle('All models').click();
    const card = ball.page.locator('.model-card', { hasText: 'ball' });
    await card.getByText('Volume', { exact: true }).waitFor();
    await card.getByText('volume of 33 × 33 × 33').waitFor();
    await card.click();
    await ball.page.getByRole('button', { name: 'Model', exact: true }).click();
    await ball.page.locator('.facts').getByText('Volume', { exact: true }).waitFor();
  });

  it('is dropped on the page with its samples in another file', async () => {
    const uploads = await mkdtemp(join(tmpdir(), 'surfcast-uploads-'));
    const taking = await Server.start(join(ball.folder, 'ball.nrrd'), 0, '--cache', ball.cache, '--uploads', uploads);
    try {
      await ball.page.goto(`${taking.url}#/ball`);
      await look.sharp(ball.page);
      const { header, samples } = detachedBall('ct.raw');
      const dropped = await ball.page.evaluateHandle(
        ([first, second]) => {
          const bytes = (text: string): Uint8Array => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
          const transfer = new DataTransfer();
          transfer.items.add(new File([bytes(first!)], 'head.nhdr'));
          transfer.items.add(new File([bytes(second!)], 'ct.raw'));
          return transfer;
        },
        [header.toString('base64'), samples.toString('base64')],
      );
      await ball.page.dispatchEvent('body', 'drop', { dataTransfer: dropped });
      const row = (name: string): Locator => ball.page.locator('.uploads li', { hasText: name });
      await row('ct.raw').getByText('waits for its header').waitFor();
      await row('head.nhdr').getByRole('button', { name: 'Open' }).click();
      await look.sharp(ball.page);
      expect(ball.page.url()).toContain('#/head');
      expect((await readdir(uploads)).sort()).toEqual(['ct.raw', 'head.nhdr']);
    } finally {
      await taking.kill();
      await rm(uploads, { recursive: true });
    }
  });
});

describe('on a phone', () => {
  it('the window is dragged with a finger, and the controls fit 360 pixels', async () => {
    await ball.reopen(look.phone);
    await ball.open('?transfer=gray,0,1000');
    await ball.page.locator('.phone-bar').getByText('Window').tap();
    await ball.page.getByText('Level 500, window 1000').waitFor();
    const from = await look.middle(ball.page);
    const finger = await ball.page.context().newCDPSession(ball.page);
    const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', x: number, y: number): Promise<unknown> =>
      finger.send('Input.dispatchTouchEvent', { type, touchPoints: type === 'touchEnd' ? [] : [{ x, y }] });
    await touch('touchStart', from.x, from.y);
    for (let i = 1; i <= 5; ++i) await touch('touchMove', from.x + 12 * i, from.y);
    await touch('touchEnd', 0, 0);
    const [first, last] = (await ball.parameter('transfer', (text) => text !== 'gray,0,1000'))
      .split(',').slice(1).map(Number);
    expect(last! - first!).toBeGreaterThan(1050);
    // Chromium may drop a tap that follows a drag by raw touch events.
    const display = ball.page.locator('.phone-bar button', { hasText: 'Display' });
    const pressed = async (): Promise<boolean> => (await display.getAttribute('aria-pressed')) === 'true';
    const tapped = async (): Promise<boolean> => {
      if (!(await pressed())) await display.tap();
      return pressed();
    };
    await expect.poll(tapped, { interval: 1000 }).toBe(true);
    await ball.page.getByRole('button', { name: 'Add surface' }).tap();
    await ball.page.getByRole('switch', { name: 'Across I' }).check();
    expect(await ball.page.evaluate(() => document.documentElement.scrollWidth)).toBe(360);
    const wide = await ball.page.locator('.panel-content').evaluate((panel) => panel.scrollWidth - panel.clientWidth);
    expect(wide).toBe(0);
  });
});
