import { defineConfig } from 'vitest/config';
import { patience } from './browser_tests/support/patience';

// One browser and one server at a time: the server draws in software on the machine that also runs the browser.
export default defineConfig({
  test: {
    include: ['browser_tests/**/*.test.ts'],
    fileParallelism: false,
    isolate: false, // all files in one process, which has the browser
    testTimeout: 600_000,
    hookTimeout: patience,
    expect: { poll: { timeout: patience } },
  },
});
