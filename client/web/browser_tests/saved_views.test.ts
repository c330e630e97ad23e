import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { useYard } from './support/yard';

const yard = useYard();

/** The parameters of the address, once they are those wanted. */
async function addressIs(wanted: URLSearchParams): Promise<void> {
  const end = `?${decodeURIComponent(wanted.toString())}`;
  await yard.page.waitForFunction((text) => decodeURIComponent(location.hash).endsWith(text), end);
}

describe('saved views', () => {
  it('keep camera, display options and clip boxes, over a reload, and go by file', async () => {
    const { page } = yard;
    const clip = '452002,5411002,190,452020,5411020,230';
    await page.goto(`${yard.server.url}#/yard?color_by=elevation&clip_box=${clip}`);
    await look.sharp(page);
    await look.drag(page, 120, -40);
    await look.sharp(page);
    const gate = await look.placeNow(page);
    expect(gate.get('clip_box')).toBe(clip);
    await page.keyboard.press('s');
    await page.getByLabel('Name of the view').fill('Gate');
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    const link = page.getByRole('link', { name: 'Gate' });
    await link.waitFor();

    // Another view, and back.
    await page.goto(`${yard.server.url}#/yard`);
    await page.keyboard.press('5');
    await page.waitForFunction(() => !location.hash.includes('clip_box') && location.hash.includes('view_up'));
    await look.sharp(page);
    await link.click();
    await addressIs(gate);
    await look.sharp(page);

    // Another page of the same browser.
    await page.reload();
    await look.sharp(page);
    await page.keyboard.press('s');
    await link.waitFor();
    const address = new URL((await link.getAttribute('href'))!, page.url());
    expect(Object.fromEntries(new URLSearchParams(address.hash.split('?')[1]))).toEqual(Object.fromEntries(gate));

    // Out, away and in again.
    const { name, bytes } = await look.saved(page, () => page.getByRole('button', { name: 'Export' }).click());
    expect(name).toBe('yard-views.json');
    const file = JSON.parse(bytes.toString()) as { model: string; views: { name: string; parameters: object }[] };
    expect(file.model).toBe('yard');
    expect(file.views).toEqual([{ name: 'Gate', parameters: Object.fromEntries(gate) }]);
    await page.getByRole('button', { name: 'Remove Gate' }).click();
    await link.waitFor({ state: 'detached' });
    const path = join(yard.folder, 'views.json');
    await writeFile(path, bytes);
    await page.getByLabel('File of views').setInputFiles(path);
    await page.getByText('1 view was added.').waitFor();
    await link.waitFor();
    await writeFile(path, '{"format": "something else"}');
    await page.getByLabel('File of views').setInputFiles(path);
    await page.getByText('The file has no views of Surfcast.').waitFor();
    expect(await page.locator('.view-row').count()).toBe(1);

    // Two views are a flight.
    const copy = page.getByRole('button', { name: 'Copy the command' });
    expect(await copy.count()).toBe(0);
    await page.getByLabel('Name of the view').fill('Apse');
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await copy.waitFor();
    expect(await copy.getAttribute('title')).toContain("/yard' --path 'yard-views.json' --output 'yard.mp4'");
  });
});
