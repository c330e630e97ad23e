import { mkdtemp, readdir, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it } from 'vitest';
import { serverHello } from '../tests/support/fake_server';
import type { ViewFrame } from '../src/generated/surfcast_pb';
import * as decoding from './support/decoding';
import { encodeLas, makeScene, worldOf, type LasPoint } from './support/las';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import { Wire } from './support/wire';

let folder: string;
let model: string;
let scene: LasPoint[];
let server: Server;
let browser: Browser;
let page: Page;
let errors: string[];

beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'surfcast-viewer-'));
  scene = makeScene();
  await writeFile(join(folder, 'yard.las'), encodeLas(scene));
  model = join(folder, 'yard.surf');
  await surfcastdRun('build', join(folder, 'yard.las'), '--output', model);
  server = await Server.start(model);
  browser = await look.launch();
});

afterAll(async () => {
  await browser?.close();
  await server?.kill();
  if (folder) await rm(folder, { recursive: true });
});

beforeEach(async () => {
  ({ page, errors } = await look.open(browser, look.desktop));
});

afterEach(async () => {
  await page.context().close();
  expect(errors).toEqual([]);
});

async function openYard(): Promise<void> {
  await page.goto(`${server.url}#/yard`);
  await look.sharp(page);
}

/** Flags of `surfcastd render` for the view of the address. */
async function viewFromAddress(): Promise<string[]> {
  const place = await look.placeNow(page);
  const { width, height } = await look.pictureSize(page);
  const up = place.get('view_up');
  return [
    ...['--resolution', `${width},${height}`],
    ...['--camera-position', place.get('position')!, '--camera-focal-point', place.get('focal_point')!],
    ...(up ? ['--camera-view-up', up] : []),
  ];
}

/** The picture of the address, drawn without a server. */
async function renderedFromAddress(file = model): Promise<Buffer> {
  const output = join(folder, 'rendered.png');
  const view = await viewFromAddress();
  await surfcastdRun('render', file, '--output', output, ...view, '--background', '14,18,22', '--spacing', '1');
  return readFile(output);
}

/** Reads the point under a pixel with the inspect tool. */
async function inspect(dx: number, dy: number): Promise<{ at: number[]; rows: Map<string, string> }> {
  await page.keyboard.press('i');
  const pixel = await look.middle(page, dx, dy);
  await page.mouse.click(pixel.x, pixel.y);
  const card = page.locator('.inspect-card');
  await card.waitFor();
  const at = await card.locator('dd[data-axis]').allTextContents();
  const names = await card.locator('.facts dt').allTextContents();
  const values = await card.locator('.facts dd').allTextContents();
  await page.keyboard.press('Escape');
  await page.waitForTimeout(400); // so that this click is not the first of a double click
  return { at: at.map(Number), rows: new Map(names.map((name, i) => [name, values[i]!.trim()])) };
}

/** A file that an action saves. */
async function saved(action: () => Promise<void>): Promise<Buffer> {
  const download = page.waitForEvent('download', { timeout: 60_000 });
  await action();
  return readFile(await (await download).path());
}

/** Points of the scene in a band from a to b, by a search of them all. */
function pointsInBand(a: number[], b: number[], width: number): number {
  const [dx, dy] = [b[0]! - a[0]!, b[1]! - a[1]!];
  const length = Math.hypot(dx, dy);
  const places = new Set<string>();
  for (const p of scene) {
    const [x, y, z] = worldOf(p);
    const along = ((x - a[0]!) * dx + (y - a[1]!) * dy) / length;
    const across = ((y - a[1]!) * dx - (x - a[0]!) * dy) / length;
    // The model has one surfel for points that coincide.
    if (along >= 0 && along <= length && Math.abs(across) <= width / 2) places.add(`${x},${y},${z}`);
  }
  return places.size;
}

describe('the viewer', () => {
  it('opens the only model, and frames arrive until the picture is sharp', async () => {
    await page.goto(server.url);
    await look.sharp(page);
    expect(page.url()).toContain('#/yard');
    const sizes = await look.pictureSize(page);
    expect(sizes.width).toBeGreaterThan(600);
  });

  it('shows ever newer pictures while the hand drags, and the newest where it rests', async () => {
    const wire = await Wire.tap(page);
    await decoding.watch(page);
    await openYard();
    const from = await look.middle(page);
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await decoding.startUnordered(page);
    // Each step waits for a picture on its way, so that pictures follow each other on every machine.
    for (let i = 1; i <= 12; ++i) {
      const frames = wire.frames.length;
      await page.mouse.move(from.x + 12 * i, from.y + 3 * i);
      await expect.poll(() => wire.frames.length, { timeout: 30_000, interval: 5 }).toBeGreaterThan(frames);
    }
    await decoding.endUnordered(page);
    const shown = async (): Promise<ViewFrame | undefined> => wire.frames[(await decoding.painted(page)).at(-1) ?? -1];
    await expect.poll(async () => (await shown())?.update, { timeout: 30_000 }).toBe(wire.updates.at(-1)!.update);

    const painted = await decoding.painted(page);
    expect(painted).toEqual([...painted].sort((a, b) => a - b)); // decoded out of order, painted in order
    const updates = painted.map((number) => wire.frames[number]!.update);
    expect(updates).toEqual([...updates].sort((a, b) => Number(a - b)));
    expect(new Set(updates).size).toBeGreaterThan(2);
    // Each picture is of the camera that its update asked for.
    for (const number of painted) {
      const { update, picture } = wire.frames[number]!;
      const asked = wire.updates.find((sent) => sent.update === update);
      if (asked) expect(picture?.camera?.position).toEqual(asked.picture?.camera?.position);
    }
    await page.mouse.up();
  });

  it('shows at rest, pixel by pixel, what `surfcastd render` draws', async () => {
    await openYard();
    await look.drag(page, 140, -60);
    await look.sharp(page);
    expect(await look.differenceFrom(page, await renderedFromAddress())).toBe(0);
  });

  it('looks straight down and still agrees with `surfcastd render`', async () => {
    await openYard();
    await page.keyboard.press('5');
    await page.waitForTimeout(600);
    await look.sharp(page);
    expect(await look.differenceFrom(page, await renderedFromAddress())).toBe(0);
  });

  it('reads the source point with all its attributes', async () => {
    await openYard();
    const { at, rows } = await inspect(0, 0);
    const source = scene.filter((p) => worldOf(p).every((value, i) => value === at[i]));
    expect(source.length).toBeGreaterThan(0); // to the last bit
    const matching = source.find((p) => String(p.intensity) === rows.get('intensity'));
    expect(matching).toBeDefined();
    expect(rows.get('classification')).toContain(String(matching!.classification));
  });

  it('measures a distance to the precision of the scan', async () => {
    await openYard();
    const [a, b] = [(await inspect(-60, 20)).at, (await inspect(70, -10)).at];
    await page.keyboard.press('m');
    for (const [dx, dy] of [[-60, 20], [70, -10]] as const) {
      const pixel = await look.middle(page, dx, dy);
      await page.mouse.click(pixel.x, pixel.y);
      await page.waitForTimeout(600);
    }
    await page.keyboard.press('Enter');
    const shown = (await page.locator('.card[data-kind=distance] .main dd').textContent()) ?? '';
    const exact = Math.hypot(...a.map((value, i) => value - b[i]!));
    expect(Math.abs(Number(shown.replaceAll('\u202f', '')) - exact)).toBeLessThanOrEqual(0.0005);
  });

  it('shows the points along a profile, and saves them and the measurements', async () => {
    await openYard();
    const [a, b] = [(await inspect(-60, 20)).at, (await inspect(70, -10)).at];
    await page.keyboard.press('p');
    for (const [dx, dy] of [[-60, 20], [70, -10]] as const) {
      const pixel = await look.middle(page, dx, dy);
      await page.mouse.click(pixel.x, pixel.y);
      await page.waitForTimeout(600);
    }
    await page.keyboard.press('Enter');
    const card = page.locator('.card[data-kind=profile]');
    await card.getByText('in the band').waitFor({ timeout: 30_000 });
    const width = Number(await card.getByLabel('Width of the band').inputValue());
    const expected = pointsInBand(a, b, width);
    expect(expected).toBeGreaterThan(100);
    expect((await card.locator('.band p').textContent())?.replaceAll('\u202f', '')).toBe(`${expected} points in the band`);
    const painted = await card.locator('canvas').evaluate((canvas: HTMLCanvasElement) => {
      const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
      return data.reduce((count, byte, i) => count + (i % 4 === 3 && byte > 0 ? 1 : 0), 0);
    });
    expect(painted).toBeGreaterThan(100);

    const csv = (await saved(() => card.getByText('Points as CSV').click())).toString().trimEnd().split('\r\n');
    expect(csv[0]).toContain('x,y,z,along,across,red,green,blue');
    expect(csv).toHaveLength(1 + expected);
    const las = await saved(() => card.getByText('Points as LAS').click());
    expect(las.subarray(0, 4).toString()).toBe('LASF');
    expect(Number(las.readBigUInt64LE(247))).toBe(expected);

    const geoJson = JSON.parse((await saved(() => page.getByRole('button', { name: 'GeoJSON' }).click())).toString()) as {
      features: { properties: { kind: string }; geometry: { coordinates: number[][] } }[];
    };
    expect(geoJson.features.map((feature) => feature.properties.kind)).toEqual(['profile']);
    expect(geoJson.features[0]!.geometry.coordinates).toEqual([a, b]);
    const table = await saved(() => page.getByRole('button', { name: 'CSV', exact: true }).click());
    expect(table.toString()).toContain(`1,profile,1,${a.join(',')},`);
  });

  it('keeps the view over a reload', async () => {
    await openYard();
    await look.drag(page, -90, 30);
    await look.sharp(page);
    await look.placeNow(page);
    const [url, sum] = [page.url(), await look.pictureSum(page)];
    await page.reload();
    await look.sharp(page);
    expect(page.url()).toBe(url);
    expect(await look.pictureSum(page)).toBe(sum);
  });

  it('comes back with its view after the server was killed', async () => {
    const wire = await Wire.tap(page);
    await openYard();
    await look.drag(page, 60, 60);
    await look.sharp(page);
    await look.placeNow(page);
    const [url, sum, { port }] = [page.url(), await look.pictureSum(page), server];
    await server.kill();
    await page.locator('.banner').waitFor({ timeout: 20_000 });
    expect(await page.locator('.banner').textContent()).toContain('cannot be reached');
    wire.holdFrames();
    server = await Server.start(model, port);
    await expect.poll(() => wire.heldFrames, { timeout: 60_000 }).toBeGreaterThan(0);
    expect(await look.lamp(page)).toBe('working'); // the picture on the screen is the old server's
    wire.releaseFrames();
    await look.sharp(page);
    expect(await page.locator('.banner').count()).toBe(0);
    expect(page.url()).toBe(url);
    expect(await look.pictureSum(page)).toBe(sum);
  });

  it('says clearly that the server speaks another version', async () => {
    await page.routeWebSocket(/\/ws$/, (socket) => {
      socket.onMessage(() => socket.send(serverHello(9, 1, 'this server speaks version 9.0')));
    });
    await page.goto(`${server.url}#/yard`);
    const card = page.getByRole('alert');
    await card.waitFor();
    const text = await card.textContent();
    expect(text).toContain('This page speaks version 1 of the protocol');
    expect(text).toContain('version 9');
  });

  it('says that there is no such model, and shows those there are', async () => {
    await page.goto(`${server.url}#/nowhere`);
    const card = page.getByRole('alert');
    await card.waitFor();
    expect(await card.textContent()).toContain('No such model');
    await card.getByRole('button', { name: 'Show all models' }).click();
    await page.locator('.model-card', { hasText: 'yard' }).click();
    await look.sharp(page);
  });

  it('hides a class, colours by another attribute, and says so in its address', async () => {
    await openYard();
    const before = await look.pictureSum(page);
    await page.keyboard.press('o');
    await page.getByText('Elevation', { exact: true }).click();
    await page.locator('.classes label', { hasText: 'Building' }).click();
    await page.waitForTimeout(600);
    await look.sharp(page);
    expect(await look.pictureSum(page)).not.toBe(before);
    const place = await look.placeNow(page);
    expect(place.get('color_by')).toBe('elevation');
    expect(place.get('hide_classes')).toBe('6');
  });

  it('saves a picture of another size, drawn by the server', async () => {
    await openYard();
    await page.keyboard.press('x');
    await page.getByRole('button', { name: 'Full HD' }).click();
    const download = page.waitForEvent('download', { timeout: 60_000 });
    await page.getByRole('button', { name: 'Save picture' }).click();
    const file = await readFile(await (await download).path());
    expect(file.subarray(1, 4).toString()).toBe('PNG');
    expect([file.readUInt32BE(16), file.readUInt32BE(20)]).toEqual([1920, 1080]);
  });
});

describe('a real scan', () => {
  it('is turned, shown pixel by pixel as `surfcastd render` draws it, and read point by point', async () => {
    const lion = join(folder, 'lion.surf');
    await surfcastdRun('build', '../../tests/data/lion.drc', '--output', lion);
    const lionServer = await Server.start(lion);
    try {
      await page.goto(`${lionServer.url}#/lion`);
      await look.sharp(page);
      await look.drag(page, 120, -30);
      await look.sharp(page);
      expect(await look.differenceFrom(page, await renderedFromAddress(lion))).toBe(0);
      const { width, height } = await look.pictureSize(page);
      const pixel = `${Math.floor(width / 2)},${Math.floor(height / 2)}`;
      const picked = await surfcastdRun('pick', lion, '--pixel', pixel, '--json', ...(await viewFromAddress()));
      const { at, rows } = await inspect(0, 0);
      const { position, color } = JSON.parse(picked) as { position: number[]; color: number[] };
      expect(at).toEqual(position);
      expect(rows.get('colour')).toBe(color.join(' '));
      await page.keyboard.press('5');
      await page.waitForFunction((former) => location.href !== former, page.url(), { timeout: 20_000 });
      await look.sharp(page);
      expect(await look.differenceFrom(page, await renderedFromAddress(lion))).toBe(0);
    } finally {
      await lionServer.kill();
    }
  });
});

describe('a scan that is being built', () => {
  /** A hilly square; larger than what is built before a test could look. */
  async function writeHills(file: string, side: number): Promise<void> {
    const points: LasPoint[] = [];
    for (let y = 0; y < side; ++y) {
      for (let x = 0; x < side; ++x) {
        const z = Math.round(900 * Math.sin(x / 60) * Math.cos(y / 45));
        const color = [(x * 90) % 65536, (y * 90) % 65536, 25_000] as const;
        points.push({ x: 40 * x, y: 40 * y, z, intensity: (x * 7) % 256, classification: 2, color });
      }
    }
    await writeFile(file, encodeLas(points));
  }

  it('is shown as a preview, which the model replaces without a reload', async () => {
    const scan = join(folder, 'hills.las');
    await writeHills(scan, 500);
    const wire = await Wire.tap(page);
    const cache = join(folder, 'cache');
    const hills = await Server.start(scan, 0, '--cache', cache, '--preview-points', '5000', '--preview-from', '1K');
    try {
      await page.goto(hills.url);
      await page.locator('.status', { hasText: 'Preview' }).waitFor({ timeout: 60_000 });
      await page.evaluate(() => (window.name = 'not reloaded'));
      await look.drag(page, 90, -30); // moves while the model is built
      await look.sharp(page);
      expect(await page.evaluate(() => window.name)).toBe('not reloaded');
      expect(page.url()).toContain('#/hills');
      const kinds = wire.frames.map((frame) => frame.picture?.preview ?? false);
      const first = kinds.indexOf(false);
      expect(first).toBeGreaterThan(0);
      expect(kinds.slice(0, first).every((preview) => preview)).toBe(true); // all previews come before
      expect(kinds.slice(first).some((preview) => preview)).toBe(false);
      const { blocksDrawn, blocksSelected } = wire.frames[first]!.picture!;
      expect(blocksDrawn).toBe(blocksSelected); // the model comes once nothing of it is missing
      await expect.poll(() => page.locator('.status').textContent(), { timeout: 20_000 }).toContain('Sharp');
    } finally {
      await hills.kill();
    }
  });

  it('is dropped on the page, sent, listed and shown', async () => {
    const uploads = await mkdtemp(join(tmpdir(), 'surfcast-uploads-'));
    const taking = await Server.start(model, 0, '--cache', join(folder, 'cache'), '--uploads', uploads);
    try {
      await page.goto(`${taking.url}#/yard`);
      await look.sharp(page);
      expect(await page.locator('.uploads').count()).toBe(0);
      const dropped = await page.evaluateHandle(
        ([las]) => {
          const bytes = Uint8Array.from(atob(las!), (c) => c.charCodeAt(0));
          const transfer = new DataTransfer();
          transfer.items.add(new File([bytes], 'shed.las'));
          transfer.items.add(new File(['words'], 'notes.docx'));
          transfer.items.add(new File(['no scan'], 'bad.ply'));
          return transfer;
        },
        [Buffer.from(encodeLas(scene)).toString('base64')],
      );
      await page.dispatchEvent('body', 'drop', { dataTransfer: dropped });
      const row = (name: string) => page.locator('.uploads li', { hasText: name });
      await row('notes.docx').getByText('Not a scan by its name').waitFor();
      await row('bad.ply').getByText('bad.ply: ').waitFor({ timeout: 30_000 });
      await row('shed.las').getByRole('button', { name: 'Open' }).click({ timeout: 30_000 });
      await look.sharp(page);
      expect(page.url()).toContain('#/shed');
      expect((await readdir(uploads)).sort()).toEqual(['shed.las']);
      await page.goto(`${taking.url}#/`);
      const torn = Buffer.from('1 2 3\n4 5\n');
      await page.locator('.send-scans input').setInputFiles({ name: 'torn.xyz', mimeType: '', buffer: torn });
      await row('torn.xyz').getByRole('button', { name: 'Open' }).click({ timeout: 30_000 });
      await page.getByText('torn cannot be built').waitFor({ timeout: 30_000 });
    } finally {
      await taking.kill();
      await rm(uploads, { recursive: true });
    }
  });

  it('is given up by its sender, and nothing of it stays', async () => {
    const uploads = await mkdtemp(join(tmpdir(), 'surfcast-uploads-'));
    const taking = await Server.start(model, 0, '--cache', join(folder, 'cache'), '--uploads', uploads);
    try {
      await page.goto(`${taking.url}#/yard`);
      await look.sharp(page);
      const slow = await page.context().newCDPSession(page);
      await slow.send('Network.enable');
      const rate = { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 200_000 };
      await slow.send('Network.emulateNetworkConditions', rate);
      const dropped = await page.evaluateHandle(() => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([new Uint8Array(8_000_000)], 'long.laz'));
        return transfer;
      });
      await page.dispatchEvent('body', 'drop', { dataTransfer: dropped });
      const cancel = page.getByRole('button', { name: 'Cancel long.laz' });
      await cancel.waitFor();
      await expect.poll(async () => (await readdir(uploads)).length).toBe(1);
      await cancel.click();
      await expect.poll(async () => (await readdir(uploads)).length).toBe(0);
      expect(await page.locator('.uploads').count()).toBe(0);
    } finally {
      await taking.kill();
      await rm(uploads, { recursive: true });
    }
  });
});

describe('on a phone', () => {
  it('fits 360 pixels, and its panels are sheets over the picture', async () => {
    await page.context().close();
    ({ page, errors } = await look.open(browser, look.phone));
    await openYard();
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(360);
    await page.locator('.phone-bar').getByText('Display').tap();
    const sheet = await page.locator('.panel').boundingBox();
    const bar = await page.locator('.phone-bar').boundingBox();
    expect(sheet!.width).toBe(360);
    expect(sheet!.y).toBeGreaterThan(200);
    expect(sheet!.y + sheet!.height).toBeLessThanOrEqual(bar!.y + 1);
  });
});
