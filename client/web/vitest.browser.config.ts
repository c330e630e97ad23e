import { defineConfig } from 'vitest/config';

// One browser and one server at a time: the server draws in software on the machine that also runs the browser.
export default defineConfig({
  test: {
    include: ['browser_tests/**/*.test.ts'],
    fileParallelism: false,
    testTimeout: 120_000,
    hookTimeout: 120_000,
  },
});
