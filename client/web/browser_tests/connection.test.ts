import { describe, expect, it } from 'vitest';
import { serverHello } from '../tests/support/fake_server';
import * as look from './support/page';
import { Server } from './support/programs';
import { Wire } from './support/wire';
import { useYard } from './support/yard';

const yard = useYard();

describe('the connection', () => {
  it('keeps the view over a reload', async () => {
    await yard.open();
    await look.drag(yard.page, -90, 30);
    await look.sharp(yard.page);
    await look.placeNow(yard.page);
    const [url, sum] = [yard.page.url(), await look.pictureSum(yard.page)];
    await yard.page.reload();
    await look.sharp(yard.page);
    expect(yard.page.url()).toBe(url);
    expect(await look.pictureSum(yard.page)).toBe(sum);
  });

  it('comes back with its view after the server was killed', async () => {
    const wire = await Wire.tap(yard.page);
    await yard.open();
    await look.drag(yard.page, 60, 60);
    await look.sharp(yard.page);
    await look.placeNow(yard.page);
    const [url, sum, { port }] = [yard.page.url(), await look.pictureSum(yard.page), yard.server];
    await yard.server.kill();
    await yard.page.locator('.banner').waitFor();
    expect(await yard.page.locator('.banner').textContent()).toContain('cannot be reached');
    wire.holdFrames();
    yard.server = await Server.start(yard.model, port);
    await expect.poll(() => wire.heldFrames).toBeGreaterThan(0);
    expect(await look.lamp(yard.page)).toBe('working'); // the picture on the screen is the old server's
    wire.releaseFrames();
    await look.sharp(yard.page);
    expect(await yard.page.locator('.banner').count()).toBe(0);
    expect(yard.page.url()).toBe(url);
    expect(await look.pictureSum(yard.page)).toBe(sum);
  });

  it('says clearly that the server speaks another version', async () => {
    await yard.page.routeWebSocket(/\/ws(\?|$)/, (socket) => {
      socket.onMessage(() => socket.send(serverHello(9, 1, 'this yard.server speaks version 9.0')));
    });
    await yard.page.goto(`${yard.server.url}#/yard`);
    const card = yard.page.getByRole('alert');
    await card.waitFor();
    const text = await card.textContent();
    expect(text).toContain('This page speaks version 1 of the protocol');
    expect(text).toContain('version 9');
  });

  it('says that there is no such model, and shows those there are', async () => {
    await yard.page.goto(`${yard.server.url}#/nowhere`);
    const card = yard.page.getByRole('alert');
    await card.waitFor();
    expect(await card.textContent()).toContain('No such model');
    await card.getByRole('button', { name: 'Show all models' }).click();
    await yard.page.locator('.model-card', { hasText: 'yard' }).click();
    await look.sharp(yard.page);
  });
});
