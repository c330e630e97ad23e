import type { Page } from 'playwright-core';
import { createServer, type ViteDevServer } from 'vite';

declare global {
  interface Window {
    load: (path: string) => Promise<unknown>;
  }
}

// Tests are compiled for Node, where `import` is another one.
const blank = '<!doctype html><script>window.load = (path) => import(path)</script>';

/** A server of single modules of the viewer, for tests that call them in a page. */
export class Sources {
  private constructor(private readonly server: ViteDevServer) {}

  static async start(): Promise<Sources> {
    const server = await createServer({
      server: { port: 0, host: '127.0.0.1', hmr: false, watch: null },
      appType: 'custom',
      logLevel: 'error',
      optimizeDeps: { noDiscovery: true, include: ['@bufbuild/protobuf', '@bufbuild/protobuf/codegenv2'] },
    });
    server.middlewares.use('/blank', (_, response) => response.end(blank));
    return new Sources(await server.listen());
  }

  /** An empty page that can load `/src/...`. */
  async open(page: Page): Promise<void> {
    await page.goto(new URL('/blank', this.server.resolvedUrls!.local[0]).href);
  }

  stop(): Promise<void> {
    return this.server.close();
  }
}
