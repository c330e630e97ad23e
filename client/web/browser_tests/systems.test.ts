import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import { Session, use } from './support/session';

const west = 9.1;
const south = 48.7;
const step = 1e-5; // degrees

/** A level square of points, in degrees. */
function squareInDegrees(): string {
  const row = (i: number) => `${west + (i % 30) * step},${south + Math.floor(i / 30) * step},250`;
  const rows = Array.from({ length: 900 }, (_, i) => row(i));
  return ['x,y,z', ...rows, ''].join('\n');
}

/** A server of the square, which is drawn in metres. */
class Square extends Session {
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    const scan = join(this.folder, 'square.csv');
    const model = join(this.folder, 'square.surf');
    await writeFile(scan, squareInDegrees());
    await surfcastdRun('build', scan, '--crs', 'EPSG:4326', '--output', model);
    this.server = await Server.start(model);
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }

  async open(): Promise<void> {
    await this.page.goto(`${this.server.url}#/square`);
    await look.sharp(this.page);
  }
}

const square = use(new Square());

describe('a scan in degrees', () => {
  it('tells where a point is in the system of the picture and in its own', async () => {
    await square.open();
    const { page } = square;
    await page.keyboard.press('i');
    const { x, y } = await look.middle(page);
    await page.mouse.click(x, y);
    const card = page.locator('.inspect-card');
    await card.waitFor();
    const systems = ['WGS 84 / UTM zone 32N (EPSG:32632)', 'WGS 84 (EPSG:4326)'];
    expect(await card.locator('.system').allTextContents()).toEqual(systems);
    const metres = (await card.locator('dd[data-axis]').allTextContents()).map(Number);
    expect(metres[0]).toBeGreaterThan(400_000);
    const degrees = (await card.locator('dd[data-source-axis]').allTextContents()).map(Number);
    const [column, row] = [(degrees[0]! - west) / step, (degrees[1]! - south) / step];
    expect(Math.abs(column - Math.round(column))).toBeLessThan(0.002); // a millimetre is 0.0014
    expect(Math.abs(row - Math.round(row))).toBeLessThan(0.002);
    expect(column).toBeGreaterThan(-0.5);
    expect(column).toBeLessThan(29.5);
  });

  it('tells where the cursor is in its own system', async () => {
    await square.open();
    const { page } = square;
    const { x, y } = await look.middle(page);
    await page.mouse.move(x, y);
    await page.locator('.cursor:not(.stale)').waitFor();
    const text = (await page.locator('.cursor').textContent()) ?? '';
    expect(text).toMatch(/^X 9\.100\d+°Y 48\.700\d+°Z 250\.\d+WGS 84 \(EPSG:4326\)$/);
    // The picture is in metres.
    expect(await page.locator('.scale-bar figcaption').textContent()).toMatch(/^\d+ c?m$/);
    expect(await page.locator('.compass').count()).toBe(1);
  });

  it('is saved in either system', async () => {
    await square.open();
    const { page } = square;
    const firstRow = async (choice: string): Promise<number[]> => {
      await page.keyboard.press('e');
      const dialog = page.getByRole('dialog');
      await dialog.getByText('CSV', { exact: true }).click();
      await dialog.getByText(choice, { exact: true }).click();
      const { bytes } = await look.saved(page, () => dialog.getByRole('button', { name: 'Save as CSV' }).click());
      return bytes.toString().split('\n')[1]!.split(',').map(Number);
    };
    expect((await firstRow('Of the scan'))[0]).toBeCloseTo(west, 2);
    expect((await firstRow('Of the model'))[0]).toBeGreaterThan(400_000);
  });

  it('has the names of both systems among its facts', async () => {
    await square.open();
    await square.page.getByRole('button', { name: 'Model', exact: true }).click();
    const facts = await square.page.locator('.facts').first().textContent();
    expect(facts).toContain('CoordinatesWGS 84 / UTM zone 32N (EPSG:32632)');
    expect(facts).toContain('Of the scanWGS 84 (EPSG:4326)');
  });
});
