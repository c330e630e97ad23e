const first = 500; // ms
const longest = 15_000; // ms

/**
 * Delay before retry number `attempt` (from 0), ms: exponential backoff with jitter. The delay doubles with each
 * attempt up to a maximum. `chance` (0 to 1) shortens it by up to half, so that many pages do not reconnect to a
 * restarted server at the same moment.
 */
export function backoff(attempt: number, chance: number): number {
  const whole = Math.min(longest, first * 2 ** Math.min(attempt, 16));
  return whole * (1 - chance / 2);
}
