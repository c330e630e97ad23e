import { defineConfig } from 'vitest/config';

export default defineConfig({
  test: {
    include: ['tests/**/*.test.ts'],
    pool: 'threads',
    maxWorkers: 2,
    minWorkers: 1,
    isolate: false, // modules are read once for all files, half of the time
    testTimeout: 60_000,
  },
});
