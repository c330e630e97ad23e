import { defineConfig } from 'vitest/config';

// One browser and one server at a time: the server draws in software on the machine that also runs the browser.
export default defineConfig({
  test: {
    include: ['browser_tests/**/*.test.ts'],
    fileParallelism: false,
    isolate: false, // all files in one process, which has the browser
    testTimeout: 300_000,
    hookTimeout: 120_000,
    expect: { poll: { timeout: 90_000 } }, // as the pages of the tests
  },
});
