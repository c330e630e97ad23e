import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { Server } from './support/programs';
import { useYard } from './support/yard';

const yard = useYard();

interface Document {
  readonly views: readonly { readonly name: string }[];
  readonly annotations: readonly { readonly text: string; readonly position: readonly number[] }[];
}

describe('what is kept beside the model', () => {
  it('is written by one page, read by another, and drawn where it was written', async () => {
    const folder = await mkdtemp(join(tmpdir(), 'surfcast-annotations-'));
    const server = await Server.start(yard.model, 0, '--annotations', folder);
    const { page } = yard;
    const document = async (): Promise<Document> => JSON.parse(await readFile(join(folder, 'yard.json'), 'utf8')) as Document;
    try {
      await page.goto(`${server.url}#/yard`);
      await look.sharp(page);
      await page.keyboard.press('i');
      const pixel = await look.middle(page, -60, 20);
      await page.mouse.click(pixel.x, pixel.y);
      await page.getByLabel('Text of the annotation').waitFor();
      const at = (await page.locator('.inspect-card dd[data-axis]').allTextContents()).map(Number);
      await page.getByLabel('Text of the annotation').fill('A crack');
      await page.getByRole('button', { name: 'Annotate' }).click();
      await page.getByText('Annotation saved.').waitFor();
      expect((await document()).annotations).toMatchObject([{ text: 'A crack', position: at }]);

      await page.keyboard.press('s');
      await page.getByLabel('Name of the view').fill('Gate');
      await page.getByRole('button', { name: 'Save for all' }).click();
      await page.getByRole('link', { name: 'Gate' }).waitFor();
      expect((await document()).views).toMatchObject([{ name: 'Gate' }]);

      // Another page, without what the browser keeps. A click on the mark shows the text.
      await yard.reopen(look.desktop);
      await yard.page.goto(`${server.url}#/yard`);
      await look.sharp(yard.page);
      await yard.page.mouse.click(pixel.x, pixel.y);
      await yard.page.locator('.annotation-text', { hasText: 'A crack' }).waitFor();
      await yard.page.keyboard.press('s');
      await yard.page.getByRole('link', { name: 'Gate' }).waitFor();
      await yard.page.getByRole('button', { name: 'Remove A crack' }).click();
      await yard.page.getByText('Annotation removed.').waitFor();
      expect((await document()).annotations).toEqual([]);
      expect(await yard.page.locator('.annotation-text').count()).toBe(0);
    } finally {
      await server.kill();
      await rm(folder, { recursive: true });
    }
  });

  it('does not appear where the server keeps nothing, and cannot be written without the right to', async () => {
    await yard.open();
    await yard.page.keyboard.press('s');
    await yard.page.getByLabel('Name of the view').waitFor();
    expect(await yard.page.getByRole('button', { name: 'Save for all' }).count()).toBe(0);
    expect(await yard.page.getByText('Annotations', { exact: true }).count()).toBe(0);
  });
});
