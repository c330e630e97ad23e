import { ScanState, type ScanStatus } from '../generated/surfcast_pb';

/** What the page says about scans whose models are not complete. */

const seconds = (value: number): string =>
  value < 90 ? `${Math.max(1, Math.ceil(value))} s` : `${Math.ceil(value / 60)} min`;

/** "37 %, 40 s left". */
export function progressText(scan: ScanStatus): string {
  if (scan.state === ScanState.FAILED) return scan.problem;
  if (scan.state === ScanState.WAITING) return 'waits for other scans';
  const percent = `${Math.floor(scan.done * 100)} %`;
  return scan.secondsLeft > 0 ? `${percent}, ${seconds(scan.secondsLeft)} left` : percent;
}

export const failed = (scan: ScanStatus): boolean => scan.state === ScanState.FAILED;

/** There is nothing to draw yet, and will be. */
export const awaited = (scan: ScanStatus | undefined): boolean =>
  scan !== undefined && !failed(scan) && scan.edition === 0n;

/** Names of models of which there is another edition in `after` than in `before`. */
export function renewed(
  before: ReadonlyMap<string, ScanStatus>,
  after: ReadonlyMap<string, ScanStatus>,
): readonly string[] {
  const names = new Set([...before.keys(), ...after.keys()]);
  return [...names].filter((name) => {
    const [old, now] = [before.get(name), after.get(name)];
    if (now && failed(now)) return false;
    return now ? now.edition > (old?.edition ?? 0n) : true; // one that is gone is complete
  });
}
