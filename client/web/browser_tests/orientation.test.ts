import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import { Session, use } from './support/session';
import { Wire } from './support/wire';

const [west, south] = [500_000, 5_400_000];
const step = 0.25; // metres
const side = 120; // points

/** A level square of points in UTM, and the same scan without a system. */
class Field extends Session {
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    const row = (i: number): string =>
      `${west + (i % side) * step},${south + Math.floor(i / side) * step},${250 + (i % 2) * 0.001}`;
    const models = join(this.folder, 'models');
    await mkdir(models);
    const scan = join(this.folder, 'field.csv');
    await writeFile(scan, ['x,y,z', ...Array.from({ length: side * side }, (_, i) => row(i)), ''].join('\n'));
    await surfcastdRun('build', scan, '--crs', 'EPSG:25832', '--output', join(models, 'field.surf'));
    await surfcastdRun('build', scan, '--output', join(models, 'plain.surf'));
    this.server = await Server.start(models);
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }

  async open(model = 'field'): Promise<void> {
    await this.page.goto(`${this.server.url}#/${model}`);
    await look.sharp(this.page);
  }

  /** Rests the pointer on a pixel of the picture; the exact coordinates that the page shows. */
  async hover(dx: number, dy: number): Promise<number[]> {
    const { x, y } = await look.middle(this.page, dx, dy);
    await this.page.mouse.move(x, y);
    await this.page.locator('.cursor:not(.stale)').waitFor();
    const parts = await this.page.locator('[data-cursor-axis]').all();
    return (await Promise.all(parts.map((part) => part.getAttribute('title')))).map(Number);
  }

  /** Where the letter of the compass is, from its middle. */
  async letter(): Promise<{ x: number; y: number }> {
    const text = this.page.locator('.compass text');
    return { x: Number(await text.getAttribute('x')), y: Number(await text.getAttribute('y')) };
  }

  /** Does what changes the view, and waits for its picture. */
  async turn(action: () => Promise<void>): Promise<void> {
    await look.placeNow(this.page);
    await look.turned(this.page, action);
    await look.sharp(this.page);
  }

  view(key: string): Promise<void> {
    return this.turn(() => this.page.keyboard.press(key));
  }
}

const field = use(new Field());

describe('the cursor', () => {
  it('tells the coordinates of a pick, with system and unit', async () => {
    await field.open();
    const at = await field.hover(-40, 30);
    const place = await look.placeNow(field.page);
    const { width, height } = await look.pictureSize(field.page);
    const pixel = `${Math.floor(width / 2) - 40},${Math.floor(height / 2) + 30}`;
    const query = new URLSearchParams({ pixel, resolution: `${width},${height}` });
    for (const name of ['position', 'focal_point']) query.set(name, place.get(name)!);
    const answer = await fetch(`${field.server.url}api/models/field/pick?${query.toString()}`);
    expect(((await answer.json()) as { position: number[] }).position).toEqual(at);
    const shown = (await field.page.locator('.cursor').textContent())?.replaceAll('\u202f', '') ?? '';
    expect(shown).toContain('ETRS89 / UTM zone 32N (EPSG:25832)');
    expect(shown).toContain(`X ${at[0]!.toFixed(3)} m`);
  });

  it('has no system where the model has none, and is gone outside of the picture', async () => {
    await field.open('plain');
    await field.hover(0, 0);
    expect(await field.page.locator('.cursor .system').count()).toBe(0);
    expect(await field.page.locator('.compass, .scale-bar').count()).toBe(0);
    await field.page.mouse.move(300, 20); // the top bar
    await field.page.locator('.cursor').waitFor({ state: 'detached' });
  });

  it('asks nothing while the view moves, nor before its picture is final', async () => {
    const wire = await Wire.tap(field.page);
    const picks = (): number => wire.asked.filter((kind) => kind === 'pickSurfel').length;
    await field.open();
    await field.hover(0, 0);
    expect(picks()).toBe(1);
    const { x, y } = await look.middle(field.page);
    await field.page.mouse.down(); // which asks for the point to turn around
    await expect.poll(picks).toBe(2);
    for (let i = 1; i <= 8; ++i) {
      await field.page.mouse.move(x + 4 * i, y);
      await field.page.waitForTimeout(120); // for a question that must not be asked
    }
    expect(picks()).toBe(2);
    expect(await field.page.locator('.cursor').count()).toBe(0);
    wire.holdFrames();
    await field.page.mouse.up();
    await field.page.mouse.move(x + 5, y);
    await field.page.waitForTimeout(800); // likewise
    expect(picks()).toBe(2);
    wire.releaseFrames();
  });
});

describe('the scale bar', () => {
  it('is as long as it says, at the depth of the point under the cursor', async () => {
    await field.open();
    await field.view('5'); // from above: all points are equally far
    const [a, b] = [await field.hover(-150, 0), await field.hover(150, 0)];
    const perPixel = (b[0]! - a[0]!) / 300;
    const bar = field.page.locator('.scale-bar');
    const [length = '', unit] = ((await bar.locator('figcaption').textContent()) ?? '').split(' ');
    expect(unit).toBe('m');
    const pixels = await bar.locator('span').evaluate((span) => span.getBoundingClientRect().width);
    // The pick finds points of the scan, which are a step apart.
    expect(Math.abs(pixels * perPixel - Number(length))).toBeLessThan((2 * step * pixels) / 300);
    expect(await bar.getAttribute('title')).toContain('last picked point');
  });
});

describe('the north arrow', () => {
  it('points up from above, to the right in a view to the west, and turns the view to the north', async () => {
    await field.open();
    await field.view('5');
    const above = await field.letter();
    expect(Math.abs(above.x)).toBeLessThan(0.01);
    expect(above.y).toBeLessThan(-20);
    await field.view('2');
    const fromEast = await field.letter();
    expect(fromEast.x).toBeGreaterThan(20);
    expect(Math.abs(fromEast.y)).toBeLessThan(0.01);
    await field.view('7');
    await field.turn(() => field.page.getByRole('button', { name: 'Turn to the north' }).click());
    const place = await look.placeNow(field.page);
    const [eye, focal] = ['position', 'focal_point'].map((name) => place.get(name)!.split(',').map(Number));
    expect(Math.abs(eye![0]! - focal![0]!)).toBeLessThan(0.001);
    expect(eye![1]!).toBeLessThan(focal![1]!);
  });
});
