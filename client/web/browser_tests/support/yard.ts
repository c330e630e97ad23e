import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { encodeLas, makeScene, type LasPoint } from './las';
import * as look from './page';
import { Server, surfcastdRun } from './programs';
import { Session, use } from './session';

/** A server of a small scan, "yard". */
export class Yard extends Session {
  readonly scene: LasPoint[] = makeScene();
  model!: string;
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    await writeFile(join(this.folder, 'yard.las'), encodeLas(this.scene));
    this.model = join(this.folder, 'yard.surf');
    await surfcastdRun('build', join(this.folder, 'yard.las'), '--output', this.model);
    this.server = await Server.start(this.model);
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }

  async open(): Promise<void> {
    await this.page.goto(`${this.server.url}#/yard`);
    await look.sharp(this.page);
  }

  /** Flags of `surfcastd render` for the view of the address. */
  async viewFromAddress(): Promise<string[]> {
    const place = await look.placeNow(this.page);
    const { width, height } = await look.pictureSize(this.page);
    const up = place.get('view_up');
    return [
      ...['--resolution', `${width},${height}`],
      ...['--camera-position', place.get('position')!, '--camera-focal-point', place.get('focal_point')!],
      ...(up ? ['--camera-view-up', up] : []),
    ];
  }

  /** The picture of the address, drawn without a server. */
  async renderedFromAddress(file = this.model): Promise<Buffer> {
    const output = join(this.folder, 'rendered.png');
    const view = await this.viewFromAddress();
    await surfcastdRun('render', file, '--output', output, ...view, '--background', '14,18,22', '--spacing', '1');
    return readFile(output);
  }

  /** Reads the point under a pixel with the inspect tool. */
  async inspect(dx: number, dy: number): Promise<{ at: number[]; rows: Map<string, string> }> {
    const { page } = this;
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
}

export const useYard = (): Yard => use(new Yard());
