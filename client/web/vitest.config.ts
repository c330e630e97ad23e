import { defineConfig } from 'vitest/config';

export default defineConfig({
  test: {
    include: ['tests/**/*.test.ts'],
    pool: 'threads',
    maxWorkers: 2,
    minWorkers: 1,
    isolate: false, // loads modules once for all files, which halves the time
    testTimeout: 60_000,
  },
});
