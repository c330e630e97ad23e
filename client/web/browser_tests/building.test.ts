import { mkdtemp, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import { encodeLas, type LasPoint } from './support/las';
import * as look from './support/page';
import { Server } from './support/programs';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

const yard = useYard();

/** Timeout of a build, ms. A server builds at the least priority, so other programs of a busy machine go first. */
const buildTime = 270_000;

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

describe('a scan that is being built', () => {
  it('is shown as a preview, which the model replaces without a reload', async () => {
    const scan = join(yard.folder, 'hills.las');
    await writeHills(scan, 500);
    const wire = await Wire.tap(yard.page);
    const cache = join(yard.folder, 'cache');
    const hills = await Server.start(scan, 0, '--cache', cache, '--preview-points', '5000', '--preview-from', '1K');
    try {
      await yard.page.goto(hills.url);
      await yard.page.locator('.status', { hasText: 'Preview' }).waitFor();
      await yard.page.evaluate(() => (window.name = 'not reloaded'));
      await look.drag(yard.page, 90, -30); // moves while the yard.model is built
      await look.sharp(yard.page, buildTime);
      expect(await yard.page.evaluate(() => window.name)).toBe('not reloaded');
      expect(yard.page.url()).toContain('#/hills');
      const kinds = wire.frames.map((frame) => frame.picture?.preview ?? false);
      const first = kinds.indexOf(false);
      expect(first).toBeGreaterThan(0);
      expect(kinds.slice(0, first).every((preview) => preview)).toBe(true); // all previews come before
      expect(kinds.slice(first).some((preview) => preview)).toBe(false);
      const { blocksDrawn, blocksSelected } = wire.frames[first]!.picture!;
      expect(blocksDrawn).toBe(blocksSelected); // the yard.model comes once nothing of it is missing
      await expect.poll(() => yard.page.locator('.status').textContent()).toContain('Sharp');
    } finally {
      await hills.kill();
    }
  });

  it('is dropped on the page, sent, listed and shown', async () => {
    const uploads = await mkdtemp(join(tmpdir(), 'surfcast-uploads-'));
    const taking = await Server.start(yard.model, 0, '--cache', join(yard.folder, 'cache'), '--uploads', uploads);
    try {
      await yard.page.goto(`${taking.url}#/yard`);
      await look.sharp(yard.page);
      expect(await yard.page.locator('.uploads').count()).toBe(0);
      const dropped = await yard.page.evaluateHandle(
        ([las]) => {
          const bytes = Uint8Array.from(atob(las!), (c) => c.charCodeAt(0));
          const transfer = new DataTransfer();
          transfer.items.add(new File([bytes], 'shed.las'));
          transfer.items.add(new File(['words'], 'notes.docx'));
          transfer.items.add(new File(['no scan'], 'bad.ply'));
          return transfer;
        },
        [Buffer.from(encodeLas(yard.scene)).toString('base64')],
      );
      await yard.page.dispatchEvent('body', 'drop', { dataTransfer: dropped });
      const row = (name: string) => yard.page.locator('.uploads li', { hasText: name });
      await row('notes.docx').getByText('Not a scan by its name').waitFor();
      await row('bad.ply').getByText('bad.ply: ').waitFor();
      await row('shed.las').getByRole('button', { name: 'Open' }).click();
      await look.sharp(yard.page, buildTime);
      expect(yard.page.url()).toContain('#/shed');
      expect((await readdir(uploads)).sort()).toEqual(['shed.las']);
      await yard.page.goto(`${taking.url}#/`);
      const torn = Buffer.from('1 2 3\n4 5\n');
      await yard.page.locator('.send-scans input').setInputFiles({ name: 'torn.xyz', mimeType: '', buffer: torn });
      await row('torn.xyz').getByRole('button', { name: 'Open' }).click();
      await yard.page.getByText('torn cannot be built').waitFor({ timeout: buildTime });
    } finally {
      await taking.kill();
      await rm(uploads, { recursive: true });
    }
  });

  it('is given up by its sender, and nothing of it stays', async () => {
    const uploads = await mkdtemp(join(tmpdir(), 'surfcast-uploads-'));
    const taking = await Server.start(yard.model, 0, '--cache', join(yard.folder, 'cache'), '--uploads', uploads);
    try {
      await yard.page.goto(`${taking.url}#/yard`);
      await look.sharp(yard.page);
      const slow = await yard.page.context().newCDPSession(yard.page);
      await slow.send('Network.enable');
      const rate = { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 200_000 };
      await slow.send('Network.emulateNetworkConditions', rate);
      const dropped = await yard.page.evaluateHandle(() => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([new Uint8Array(8_000_000)], 'long.laz'));
        return transfer;
      });
      await yard.page.dispatchEvent('body', 'drop', { dataTransfer: dropped });
      const cancel = yard.page.getByRole('button', { name: 'Cancel long.laz' });
      await cancel.waitFor();
      await expect.poll(async () => (await readdir(uploads)).length).toBe(1);
      await cancel.click();
      await expect.poll(async () => (await readdir(uploads)).length).toBe(0);
      expect(await yard.page.locator('.uploads').count()).toBe(0);
    } finally {
      await taking.kill();
      await rm(uploads, { recursive: true });
    }
  });
});
