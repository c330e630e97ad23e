import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server } from './support/programs';
import { Session, use } from './support/session';

/** A field of 5 x 5 x 5 tensors along x; in each plane i the largest eigenvalue is 2 + i. */
function fieldNrrd(): Buffer {
  const header = `NRRD0004
type: float
dimension: 4
sizes: 6 5 5 5
kinds: 3D-symmetric-matrix space space space
space dimension: 3
space directions: none (1,0,0) (0,1,0) (0,0,1)
space origin: (-2,-2,-2)
endian: little
encoding: raw

`;
  const samples = Buffer.alloc(125 * 6 * 4);
  for (let at = 0; at < 125; ++at) {
    [2 + (at % 5), 0, 0, 1, 0, 1].forEach((part, c) => samples.writeFloatLE(part, 4 * (6 * at + c)));
  }
  return Buffer.concat([Buffer.from(header), samples]);
}

/** A server of the field. */
class Field extends Session {
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    const file = join(this.folder, 'field.nrrd');
    await writeFile(file, fieldNrrd());
    this.server = await Server.start(file, 0, '--cache', join(this.folder, 'cache'));
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }

  async open(query = ''): Promise<void> {
    await this.page.goto(`${this.server.url}#/field${query}`);
    await look.sharp(this.page);
    await look.toggleOptions(this.page);
  }

  /** Waits until a parameter of the address has a value. */
  async says(name: string, value: string | null): Promise<void> {
    const read = (): string | null => new URLSearchParams(new URL(this.page.url()).hash.split('?')[1]).get(name);
    await expect.poll(read).toBe(value);
  }

  /** Waits for a picture that differs from the one of a checksum, and is whole. */
  async changedFrom(sum: number): Promise<number> {
    await expect.poll(() => look.pictureSum(this.page)).not.toBe(sum);
    await look.sharp(this.page);
    return look.pictureSum(this.page);
  }
}

const field = use(new Field());

describe('a tensor field', () => {
  it('is drawn by other glyphs, sizes, colours and lights, which its link keeps', async () => {
    await field.open();
    const { page } = field;
    let sum = await look.pictureSum(page);
    await page.getByText('Superquadric', { exact: true }).click();
    await field.says('glyph', 'superquadric');
    sum = await field.changedFrom(sum);
    await page.getByText('Root', { exact: true }).click();
    await field.says('glyph_radius', 'root');
    sum = await field.changedFrom(sum);
    const size = page.getByRole('textbox', { name: 'Semi-axis of 1' });
    await size.fill('0.1');
    await size.press('Enter');
    await field.says('glyph_scale', '0.1');
    sum = await field.changedFrom(sum);
    await page.getByText('Attribute', { exact: true }).click();
    await page.getByRole('combobox', { name: 'Attribute', exact: true }).selectOption('md');
    await field.says('color_by', 'md');
    sum = await field.changedFrom(sum);
    expect(await page.locator('.legend figcaption').textContent()).toBe('md');
    await page.getByRole('button', { name: 'Add light' }).click();
    await field.says('lights', '0.1,0.25,32;0.5,0.7,-0.6,0.9');
    await field.changedFrom(sum);
    await look.placeNow(page);
    sum = await look.pictureSum(page);

    await page.reload();
    await look.sharp(page);
    await look.toggleOptions(page);
    await expect.poll(() => look.pictureSum(page)).toBe(sum);
    expect(await page.getByRole('radio', { name: 'Superquadric' }).isChecked()).toBe(true);
    expect(await page.getByRole('slider', { name: 'Power of light' }).inputValue()).toBe('0.9');
  });

  it('is cropped by thresholds and layers', async () => {
    await field.open();
    const { page } = field;
    let sum = await look.pictureSum(page);
    await page.getByRole('button', { name: 'Add threshold' }).click();
    await page.getByRole('combobox', { name: 'Attribute of threshold' }).selectOption('md');
    const least = page.getByRole('textbox', { name: 'From' });
    await least.fill('2.5');
    await least.press('Enter');
    await field.says('threshold', 'md,2.5');
    sum = await field.changedFrom(sum);
    await page.getByRole('button', { name: 'Remove threshold' }).click();
    await field.says('threshold', null);
    sum = await field.changedFrom(sum);
    await page.getByText('Across K').click();
    await field.says('slice', 'k,2');
    await field.changedFrom(sum);
  });

  it('keeps a threshold that is typed before the next frame', async () => {
    await field.open();
    const { page } = field;
    await page.getByRole('button', { name: 'Add threshold' }).click();
    await page.getByRole('textbox', { name: 'From' }).waitFor();
    await page.evaluate(async () => {
      const rendered = (): Promise<void> => new Promise((done) => setTimeout(done)); // sooner than a frame
      const select = document.querySelector<HTMLSelectElement>('.surfaces select')!;
      select.value = 'md';
      select.dispatchEvent(new Event('change', { bubbles: true }));
      await rendered();
      const least = document.querySelector<HTMLInputElement>('.surfaces .range-fields input')!;
      least.value = '2.5';
      least.dispatchEvent(new InputEvent('input', { bubbles: true }));
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      await rendered(); // effects run after a frame
      least.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true }));
    });
    await field.says('threshold', 'md,2.5');
  });

  it('tells of the tensor under a click, with its ellipsoid enlarged', async () => {
    await field.open('?position=0,-20,0&focal_point=0,0,0&view_up=0,0,1&slice=j,2');
    const { page } = field;
    await look.toggleOptions(page);
    await page.keyboard.press('i');
    const { x, y } = await look.middle(page);
    await page.mouse.click(x, y);
    const card = page.locator('.inspect-card');
    await card.waitFor();
    expect(await card.locator('dd[data-axis=x]').textContent()).toBe('0');
    const facts = (await card.locator('.facts').textContent()) ?? '';
    expect(facts).toContain('eigenvalue4 1 1');
    expect(facts).toContain('sample2 2 2');
    const painted = await card.locator('canvas.glyph').evaluate((canvas: HTMLCanvasElement) => {
      const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
      return data.reduce((count, byte, i) => count + (i % 4 === 3 && byte > 0 ? 1 : 0), 0);
    });
    expect(painted).toBeGreaterThan(1000);
  });
});
