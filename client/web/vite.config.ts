import { readFileSync } from 'node:fs';
import { defineConfig, type Plugin } from 'vite';

/** The licence of the typeface must be distributed with its files. */
function fontLicence(): Plugin {
  return {
    name: 'font-licence',
    generateBundle() {
      const source = readFileSync('node_modules/@fontsource-variable/inter/LICENSE', 'utf8');
      this.emitFile({ type: 'asset', fileName: 'assets/inter-licence.txt', source });
    },
  };
}

export default defineConfig({
  plugins: [fontLicence()],
  base: './',
  build: { outDir: process.env['SURFCAST_VIEWER_OUT'] ?? 'dist', emptyOutDir: true, target: 'es2022' },
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  // `npm run dev` serves the page itself and forwards other requests to a surfcastd on the default port.
  server: { proxy: { '/ws': { target: 'ws://127.0.0.1:7600', ws: true }, '/api': 'http://127.0.0.1:7600' } },
});
