import { readFile } from 'node:fs/promises';
import { describe, expect, it } from 'vitest';
import * as look from './support/page';
import { useYard } from './support/yard';

const yard = useYard();

describe('the display options', () => {
  it('hides a class, colours by another attribute, and says so in its address', async () => {
    await yard.open();
    await look.toggleOptions(yard.page);
    const before = await look.pictureSum(yard.page);
    await yard.page.getByText('Elevation', { exact: true }).click();
    await yard.page.locator('.classes label', { hasText: 'Building' }).click();
    await expect.poll(() => look.pictureSum(yard.page)).not.toBe(before);
    await look.sharp(yard.page);
    expect(await look.pictureSum(yard.page)).not.toBe(before);
    const place = await look.placeNow(yard.page);
    expect(place.get('color_by')).toBe('elevation');
    expect(place.get('hide_classes')).toBe('6');
  });

  it('lights a scan with colours, also when its address is opened again', async () => {
    await yard.open();
    await look.toggleOptions(yard.page);
    const unlit = await look.pictureSum(yard.page);
    const lighting = yard.page.getByRole('radiogroup', { name: 'Surface lighting' });
    await lighting.getByText('On', { exact: true }).click();
    await expect.poll(() => look.pictureSum(yard.page)).not.toBe(unlit);
    expect((await look.placeNow(yard.page)).get('shading')).toBe('lit');
    await look.sharp(yard.page);
    const lit = await look.pictureSum(yard.page);
    await yard.page.reload();
    await look.toggleOptions(yard.page);
    expect(await lighting.getByRole('radio', { name: 'On' }).isChecked()).toBe(true);
    await expect.poll(() => look.pictureSum(yard.page)).toBe(lit);
  });

  it('saves a picture of another size, drawn by the server', async () => {
    await yard.open();
    await yard.page.keyboard.press('x');
    await yard.page.getByRole('button', { name: 'Full HD' }).click();
    const download = yard.page.waitForEvent('download');
    await yard.page.getByRole('button', { name: 'Save picture' }).click();
    const file = await readFile(await (await download).path());
    expect(file.subarray(1, 4).toString()).toBe('PNG');
    expect([file.readUInt32BE(16), file.readUInt32BE(20)]).toEqual([1920, 1080]);
  });
});

describe('on a phone', () => {
  it('fits 360 pixels, and its panels are sheets over the picture', async () => {
    await yard.reopen(look.phone);
    await yard.open();
    expect(await yard.page.evaluate(() => document.documentElement.scrollWidth)).toBe(360);
    await yard.page.locator('.phone-bar').getByText('Display').tap();
    const sheet = await yard.page.locator('.panel').boundingBox();
    const bar = await yard.page.locator('.phone-bar').boundingBox();
    expect(sheet!.width).toBe(360);
    expect(sheet!.y).toBeGreaterThan(200);
    expect(sheet!.y + sheet!.height).toBeLessThanOrEqual(bar!.y + 1);
  });
});
