import type { Locator } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { offset, worldOf } from './support/las';
import * as look from './support/page';
import { Server } from './support/programs';
import { useYard } from './support/yard';

const yard = useYard();

const dialog = (): Locator => yard.page.getByRole('dialog', { name: 'Save points' });
const saveButton = (): Locator => dialog().getByRole('button', { name: /^Save as/ });

/** Opens a view of the yard, with parameters, and the dialog. */
async function openDialog(parameters = '', server = yard.server): Promise<void> {
  await yard.page.goto(`${server.url}#/yard${parameters}`);
  await look.sharp(yard.page);
  await yard.page.keyboard.press('e');
  await dialog().waitFor();
}

async function shownCount(): Promise<number> {
  const text = (await dialog().locator('.count b').textContent()) ?? '';
  return Number(text.replace(/\D/g, ''));
}

/** Points of the scene, of which a model has one for each place. */
function countWhere(holds: (local: number[], classification: number) => boolean): number {
  const places = new Set<string>();
  for (const point of yard.scene) {
    const [x, y, z] = worldOf(point);
    if (holds([x - offset.x, y - offset.y, z - offset.z], point.classification)) places.add(`${x},${y},${z}`);
  }
  return places.size;
}

const inBox = (local: number[], low: number[], high: number[]): boolean =>
  local.every((value, i) => value >= low[i]! && value <= high[i]!);

/** A box of local coordinates, in those of the world. */
const boxText = (low: number[], high: number[]): string =>
  [low, high].map(([x, y, z]) => `${x! + offset.x},${y! + offset.y},${z! + offset.z}`).join(',');

async function endpoint(query: string, server = yard.server): Promise<Buffer> {
  const answer = await fetch(`${server.url}api/models/yard/points?${query}`);
  expect(answer.status).toBe(200);
  return Buffer.from(await answer.arrayBuffer());
}

describe('saving points', () => {
  it('saves the whole model in each format, as the server has it', async () => {
    await openDialog();
    expect(await shownCount()).toBe(countWhere(() => true));
    for (const format of ['LAS', 'LAZ', 'PLY', 'CSV']) {
      if (!(await dialog().isVisible())) await yard.page.getByRole('button', { name: 'Save points' }).click();
      await dialog().getByText(format, { exact: true }).click();
      const { name, bytes } = await look.saved(yard.page, () => saveButton().click());
      const extension = format.toLowerCase();
      expect(name).toBe(`yard-points.${extension}`);
      expect(bytes.equals(await endpoint(`format=${extension}`)), format).toBe(true);
      await dialog().waitFor({ state: 'detached' });
    }
  });

  it('saves what clip boxes and classes show', async () => {
    const [low, high] = [[3, 4, -5], [16, 20, 30]];
    const [holeLow, holeHigh] = [[10, 10.5, -5], [13, 12, 30]];
    const boxes = `clip_box=${boxText(low, high)}&clip_out=${boxText(holeLow, holeHigh)}`;
    await openDialog(`?${boxes}&hide_classes=2`);
    const expected = countWhere(
      (local, code) => code === 6 && inBox(local, low, high) && !inBox(local, holeLow, holeHigh),
    );
    expect(expected).toBeGreaterThan(1000);
    expect(await shownCount()).toBe(expected);
    expect(await dialog().textContent()).toContain('inside 1 clip box, outside 1 clip box, of Building');
    await dialog().getByText('CSV', { exact: true }).click();
    await dialog().getByLabel('Normals of the model').check();
    const { bytes } = await look.saved(yard.page, () => saveButton().click());
    const rows = bytes.toString().trimEnd().split('\n');
    expect(rows).toHaveLength(1 + expected);
    // Every row is one of the server's without the hole, and none lies in the hole.
    const box = await endpoint(`format=csv&normals=1&classes=6&box=${boxText(low, high)}`);
    const whole = new Set(box.toString().split('\n'));
    expect(rows.filter((row) => !whole.has(row))).toEqual([]);
    const names = rows[0]!.split(',');
    expect(names).toContain('nx');
    const inHole = rows.slice(1).filter((row) => {
      const [x, y, z] = row.split(',').map(Number);
      return inBox([x! - offset.x, y! - offset.y, z! - offset.z], holeLow, holeHigh);
    });
    expect(inHole).toEqual([]);
  });

  it('explains the limit of the server, and takes fewer points', async () => {
    const server = await Server.start(yard.model, 0, '--max-region-points', '20000');
    try {
      await openDialog('', server);
      const all = await shownCount();
      expect(all).toBeGreaterThan(40_000);
      const explained = await dialog().locator('.too-many').textContent();
      expect(explained?.replaceAll('\u202f', '')).toContain('at most 20000 points');
      expect(await saveButton().isDisabled()).toBe(true);
      const every = Math.ceil(all / 20_000);
      await dialog().getByRole('button', { name: `Take every ${every}` }).click();
      await dialog().locator('.too-many').waitFor({ state: 'detached' });
      const fewer = await shownCount();
      expect(fewer).toBeLessThanOrEqual(20_000);
      const { bytes } = await look.saved(yard.page, () => saveButton().click());
      expect(bytes.equals(await endpoint(`format=laz&every=${every}`, server))).toBe(true);
    } finally {
      await server.kill();
    }
  });

  it('says where there is nothing to save, and where the server is gone', async () => {
    await openDialog('?hide_classes=2,6');
    expect(await dialog().textContent()).toContain('All classes are hidden.');
    expect(await saveButton().isDisabled()).toBe(true);
    const server = await Server.start(yard.model);
    await yard.page.goto(`${server.url}#/yard`);
    await look.sharp(yard.page);
    await server.kill();
    await yard.page.getByRole('button', { name: 'Save points' }).click();
    await dialog().getByText('The server does not answer.').waitFor();
    expect(await saveButton().isDisabled()).toBe(true);
  });
});
