import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import { encodeLas, makeScene, lattice } from './support/las';
import * as look from './support/page';
import { surfcastdRun, Server } from './support/programs';
import { Session, use } from './support/session';

const metres = 1 / lattice;

/** A server of two scans side by side, "yard" and "street". */
class TwoScans extends Session {
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    await this.build('yard', 0);
    await this.build('street', 24 * metres);
    this.server = await Server.start(join(this.folder, 'yard.surf'), 0, join(this.folder, 'street.surf'));
  }

  private async build(name: string, east: number): Promise<void> {
    const scan = makeScene().map((point) => ({ ...point, x: point.x + east }));
    await writeFile(join(this.folder, `${name}.las`), encodeLas(scan));
    await surfcastdRun('build', join(this.folder, `${name}.las`), '--output', join(this.folder, `${name}.surf`));
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }
}

const scans = use(new TwoScans());

const addressIs = (path: string): Promise<unknown> =>
  scans.page.waitForFunction((start) => location.hash.split('?')[0] === start, path);

describe('several models', () => {
  it('are added from the gallery, hidden, and taken out, under the same camera', async () => {
    const { page } = scans;
    await page.goto(`${scans.server.url}#/yard`);
    await look.sharp(page);
    await look.drag(page, 60, -20);
    await look.sharp(page);
    const alone = await look.pictureSum(page);
    const before = await look.placeNow(page);
    await page.getByRole('button', { name: 'Model', exact: true }).click();
    await look.sharp(page);
    const narrow = await look.pictureSum(page); // beside the panel

    await page.getByRole('button', { name: 'Add a model' }).click();
    expect(await page.getByRole('button', { name: 'Add to the view' }).count()).toBe(1);
    await page.getByRole('button', { name: 'Add to the view' }).click();
    await addressIs('#/yard+street');
    await look.sharp(page);
    expect(await look.pictureSum(page)).not.toBe(narrow);
    const place = await look.placeNow(page);
    expect(place.get('position')).toBe(before.get('position'));

    await page.getByRole('button', { name: 'Hide street' }).click();
    await expect.poll(() => look.pictureSum(page)).toBe(narrow);
    expect((await look.placeNow(page)).get('hide_models')).toBe('street');
    await page.reload();
    await look.sharp(page);
    expect(await look.pictureSum(page)).toBe(alone); // the panel is closed

    await page.getByRole('button', { name: 'Model', exact: true }).click();
    await page.getByRole('button', { name: 'Show street' }).click();
    await page.getByRole('button', { name: 'Take yard out of the view' }).click();
    await addressIs('#/street');
    await look.sharp(page);
    await page.goBack();
    await addressIs('#/yard+street');
    await look.sharp(page);
  });
});
