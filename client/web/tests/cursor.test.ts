import { create } from '@bufbuild/protobuf';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { PickResultSchema, ViewFrameSchema, type PickResult } from '../src/generated/surfcast_pb';
import type { Pixel } from '../src/camera/vector';
import * as store from '../src/state/store';
import { CursorProbe, waitBeforeAsking, type CursorState } from '../src/view/cursor_probe';

const resting: CursorState = {
  pointer: { pixel: { x: 1, y: 2 }, since: 1000 },
  settled: true,
  asking: false,
  answered: false,
  askedAt: -Infinity,
};

describe('when the point under the pointer is asked for', () => {
  it('waits until the pointer rests, and a while after the last time', () => {
    expect(waitBeforeAsking(resting, 1000)).toBe(80);
    expect(waitBeforeAsking(resting, 1030)).toBe(50);
    expect(waitBeforeAsking(resting, 2000)).toBe(0);
    expect(waitBeforeAsking({ ...resting, askedAt: 1990 }, 2000)).toBe(140);
  });

  const reasons = [{ pointer: undefined }, { settled: false }, { asking: true }, { answered: true }];
  it.each(reasons)('is not while %o', (change) => {
    expect(waitBeforeAsking({ ...resting, ...change }, 5000)).toBeUndefined();
  });
});

describe('the cursor', () => {
  const asked: { pixel: Pixel; answer: (result: PickResult | undefined) => void; fail: () => void }[] = [];
  let probe: CursorProbe;

  const hit = (x: number, source?: number): PickResult =>
    create(PickResultSchema, {
      hit: true,
      position: { x, y: 0, z: 0 },
      ...(source === undefined ? {} : { sourcePosition: { x: source, y: 0, z: 0 } }),
    });
  const settle = (converged: boolean): void => {
    store.shownFrame.value = create(ViewFrameSchema, { picture: { converged } });
  };
  const answerLast = async (result: PickResult | undefined): Promise<void> => {
    asked[asked.length - 1]!.answer(result);
    await vi.advanceTimersByTimeAsync(0);
  };

  beforeEach(() => {
    vi.useFakeTimers();
    asked.length = 0;
    store.frameIsCurrent.value = true;
    store.cursor.value = undefined;
    settle(true);
    probe = new CursorProbe(
      (pixel) => new Promise((answer, reject) => asked.push({ pixel, answer, fail: () => reject(new Error('busy')) })),
    );
  });
  afterEach(() => {
    probe.left();
    store.shownFrame.value = undefined;
    vi.useRealTimers();
  });

  it('is asked for once the pointer rests, not on its way', async () => {
    for (let x = 0; x < 20; ++x) {
      probe.moved({ x, y: 0 });
      await vi.advanceTimersByTimeAsync(20);
    }
    expect(asked).toHaveLength(0);
    await vi.advanceTimersByTimeAsync(100);
    expect(asked.map(({ pixel }) => pixel)).toEqual([{ x: 19, y: 0 }]);
    await answerLast(hit(7));
    expect(store.cursor.value).toEqual({ at: { x: 7, y: 0, z: 0 }, ofSource: false, stale: false });
    await vi.advanceTimersByTimeAsync(10_000);
    expect(asked).toHaveLength(1);
  });

  it('is in the coordinates of the source where these are others', async () => {
    probe.moved({ x: 0, y: 0 });
    await vi.advanceTimersByTimeAsync(100);
    await answerLast(hit(7, 9.5));
    expect(store.cursor.value).toMatchObject({ at: { x: 9.5 }, ofSource: true });
  });

  it('is asked for one at a time, the newest next', async () => {
    probe.moved({ x: 0, y: 0 });
    await vi.advanceTimersByTimeAsync(100);
    probe.moved({ x: 1, y: 0 });
    probe.moved({ x: 2, y: 0 });
    await vi.advanceTimersByTimeAsync(1000);
    expect(asked).toHaveLength(1);
    await answerLast(hit(7)); // of a pixel that the pointer has left
    expect(store.cursor.value).toBeUndefined();
    await vi.advanceTimersByTimeAsync(200);
    expect(asked.map(({ pixel }) => pixel.x)).toEqual([0, 2]);
  });

  it('is not asked for while the picture changes, and again when it has', async () => {
    settle(false);
    probe.moved({ x: 0, y: 0 });
    await vi.advanceTimersByTimeAsync(1000);
    expect(asked).toHaveLength(0);
    settle(true);
    await vi.advanceTimersByTimeAsync(1000);
    expect(asked).toHaveLength(1);
    settle(false);
    settle(true);
    await answerLast(hit(7)); // of the picture before
    expect(store.cursor.value).toBeUndefined();
    await vi.advanceTimersByTimeAsync(1000);
    await answerLast(hit(8));
    expect(store.cursor.value).toMatchObject({ at: { x: 8 }, stale: false });
    store.moving.value = true;
    expect(store.cursor.value).toMatchObject({ at: { x: 8 }, stale: true });
    store.moving.value = false;
  });

  it('is nowhere over the background, after an error, outside, and under a pressed button', async () => {
    probe.moved({ x: 0, y: 0 });
    await vi.advanceTimersByTimeAsync(100);
    await answerLast(hit(7));
    probe.moved({ x: 1, y: 0 });
    expect(store.cursor.value).toMatchObject({ stale: true });
    await vi.advanceTimersByTimeAsync(200);
    await answerLast(create(PickResultSchema, { hit: false }));
    expect(store.cursor.value).toBeUndefined();
    probe.moved({ x: 2, y: 0 });
    await vi.advanceTimersByTimeAsync(200);
    asked[2]!.fail();
    await vi.advanceTimersByTimeAsync(5000);
    expect(asked).toHaveLength(3); // an error is no reason to ask again
    probe.moved({ x: 3, y: 0 });
    probe.left();
    await vi.advanceTimersByTimeAsync(5000);
    expect(asked).toHaveLength(3);
    expect(store.cursor.value).toBeUndefined();
  });
});
