import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ScanState, ScanStatusSchema, type ScanStatus } from '../src/generated/surfcast_pb';
import { awaited, progressText, renewed } from '../src/state/scans';

type Fields = Partial<Omit<ScanStatus, '$typeName' | '$unknown'>>;
const scan = (model: string, edition: bigint, more: Fields = {}): ScanStatus =>
  create(ScanStatusSchema, { model, edition, state: ScanState.BUILDING, done: 0.374, secondsLeft: 40.2, ...more });
const byName = (...scans: ScanStatus[]): Map<string, ScanStatus> => new Map(scans.map((each) => [each.model, each]));

describe('scans that are being built', () => {
  it('say how far they are', () => {
    expect(progressText(scan('a', 0n))).toBe('37 %, 41 s left');
    expect(progressText(scan('a', 0n, { secondsLeft: 200 }))).toBe('37 %, 4 min left');
    expect(progressText(scan('a', 0n, { secondsLeft: 0 }))).toBe('37 %');
    const broken = scan('a', 0n, { state: ScanState.FAILED, problem: 'a.laz: truncated' });
    expect(progressText(broken)).toBe('a.laz: truncated');
  });
  it('are awaited until there is a preview', () => {
    expect(awaited(scan('a', 0n))).toBe(true);
    expect(awaited(scan('a', 1n))).toBe(false);
    expect(awaited(scan('a', 0n, { state: ScanState.FAILED }))).toBe(false);
    expect(awaited(undefined)).toBe(false);
  });
  it('are described anew with each preview and when they are complete', () => {
    expect(renewed(byName(scan('a', 0n), scan('b', 1n)), byName(scan('a', 1n), scan('b', 1n)))).toEqual(['a']);
    expect(renewed(byName(scan('a', 1n), scan('b', 1n)), byName(scan('b', 1n)))).toEqual(['a']);
    expect(renewed(byName(scan('a', 0n)), byName(scan('a', 0n, { state: ScanState.FAILED })))).toEqual([]);
  });
});
