import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { expect, it } from 'vitest';
import { encodeLas, makeScene } from './support/las';
import * as look from './support/page';
import { Server, surfcastdRun } from './support/programs';
import { Session, use } from './support/session';

/** A server of a COPC file in place, and of a model of the same scan. */
class ScanInPlace extends Session {
  server!: Server;

  override async begin(): Promise<void> {
    await super.begin();
    const path = (name: string): string => join(this.folder, name);
    await writeFile(path('yard.las'), encodeLas(makeScene()));
    await surfcastdRun('build', path('yard.las'), '--output', path('built.surf'));
    await surfcastdRun('export', path('built.surf'), '--output', path('yard.copc.laz'));
    this.server = await Server.start(path('built.surf'), 0, path('yard.copc.laz'), '--in-place');
  }

  override async end(): Promise<void> {
    await this.server?.kill();
    await super.end();
  }
}

const session = use(new ScanInPlace());

it('says whether a model or the scan itself is drawn', async () => {
  const { page, server } = session;
  const origin = page.locator('dl.facts > div', { hasText: 'Drawn from' }).locator('dd');
  const explanation = page.getByText('No model was built of the scan');

  await page.goto(`${server.url}#/built`);
  await look.sharp(page);
  await page.getByRole('button', { name: 'Model', exact: true }).click();
  await origin.waitFor();
  expect(await origin.textContent()).toBe('a model');
  expect(await explanation.count()).toBe(0);

  await page.goto(`${server.url}#/yard.copc`);
  await explanation.waitFor();
  expect(await origin.textContent()).toBe('the scan, in place');
  await look.sharp(page);
});
