import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, expect } from 'vitest';
import * as look from './page';

/** A browser, a folder for the files of the tests, and for each test a page whose errors fail it. */
export class Session {
  folder!: string;
  browser!: Browser;
  page!: Page;
  private errors: string[] = [];

  /** Another page in place of the present one. */
  async reopen(options: BrowserContextOptions): Promise<void> {
    await this.page.context().close();
    await this.openPage(options);
  }

  async openPage(options: BrowserContextOptions): Promise<void> {
    ({ page: this.page, errors: this.errors } = await look.open(this.browser, options));
  }

  async closePage(): Promise<void> {
    await this.page.context().close();
    expect(this.errors).toEqual([]);
  }

  async begin(): Promise<void> {
    this.folder = await mkdtemp(join(tmpdir(), 'surfcast-viewer-'));
    this.browser = await look.sharedBrowser();
  }

  async end(): Promise<void> {
    if (this.folder) await rm(this.folder, { recursive: true });
  }
}

/** Call it once at the top of a file of tests. */
export function use<Kind extends Session>(session: Kind): Kind {
  beforeAll(() => session.begin());
  afterAll(() => session.end());
  beforeEach(() => session.openPage(look.desktop));
  afterEach(() => session.closePage());
  return session;
}
