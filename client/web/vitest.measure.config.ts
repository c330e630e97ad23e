import { defineConfig } from 'vitest/config';

// Measurements, which state figures and check nothing.
export default defineConfig({
  test: { include: ['browser_tests/**/*.measure.ts'], fileParallelism: false, testTimeout: 900_000 },
});
