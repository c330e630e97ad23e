const first = 500; // ms
const longest = 15_000; // ms

/**
 * How long to wait before trying again for the nth time (from 0), ms: twice as long each time, and by `chance` (0 to 1)
 * up to half of it less, so that a thousand pages do not return to a restarted server in the same moment.
 */
export function backoff(attempt: number, chance: number): number {
  const whole = Math.min(longest, first * 2 ** Math.min(attempt, 16));
  return whole * (1 - chance / 2);
}
