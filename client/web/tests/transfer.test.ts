import { describe, expect, it } from 'vitest';
import {
  addPoint,
  barHeights,
  defaultTransfer,
  fitTo,
  formatTransfer,
  lookUp,
  movePoint,
  parseTransfer,
  removePoint,
  windowOf,
  type TransferPoint,
} from '../src/volume/transfer';

const black = { red: 0, green: 0, blue: 0 };
const white = { red: 255, green: 255, blue: 255 };
const red = { red: 255, green: 0, blue: 0 };
const ramp: TransferPoint[] = [
  { value: -100, color: black, opacity: 0 },
  { value: 0, color: red, opacity: 0.5 },
  { value: 300, color: white, opacity: 1 },
];

describe('a transfer function', () => {
  it('is linear between its points, colours in linear light', () => {
    expect(lookUp(ramp, -50).opacity).toBeCloseTo(0.25);
    expect(lookUp(ramp, -50).color).toEqual({ red: 188, green: 0, blue: 0 }); // half of the light
    expect(lookUp(ramp, 0).color).toEqual(red);
  });

  it('stays as it ends beyond the first and the last point', () => {
    expect(lookUp(ramp, -1000)).toEqual({ color: black, opacity: 0 });
    expect(lookUp(ramp, 1000)).toEqual({ color: white, opacity: 1 });
  });

  it('without points is clear', () => {
    expect(lookUp([], 3).opacity).toBe(0);
  });

  it('may have a step', () => {
    const step = [
      { value: 1, color: black, opacity: 0 },
      { value: 1, color: white, opacity: 1 },
    ];
    expect(lookUp(step, 0.9).opacity).toBe(0);
    expect(lookUp(step, 1.1).opacity).toBe(1);
  });

  it('keeps the order of its points when one is dragged', () => {
    expect(movePoint(ramp, 1, 1000, 2)[1]).toEqual({ value: 300, color: red, opacity: 1 });
    expect(movePoint(ramp, 1, -1000, -1)[1]).toEqual({ value: -100, color: red, opacity: 0 });
    expect(movePoint(ramp, 2, 5000, 0.5)[2]?.value).toBe(5000);
  });

  it('takes a new point in the colour that was there', () => {
    const { points, index } = addPoint(ramp, -50, 0.9);
    expect(index).toBe(1);
    expect(points[1]).toEqual({ value: -50, color: { red: 188, green: 0, blue: 0 }, opacity: 0.9 });
    expect(points.map((point) => point.value)).toEqual([-100, -50, 0, 300]);
    expect(addPoint(ramp, 999, 0).index).toBe(3);
  });

  it('keeps two points', () => {
    expect(removePoint(ramp, 1)).toHaveLength(2);
    expect(removePoint(ramp.slice(0, 2), 0)).toHaveLength(2);
  });

  it('is moved and stretched to another range', () => {
    expect(fitTo(ramp, [-100, 300], [0, 1]).map((point) => point.value)).toEqual([0, 0.25, 1]);
    expect(windowOf(50, 100, 1)).toEqual([0, 100]);
    expect(windowOf(50, -3, 2)).toEqual([49, 51]);
  });
});

describe('the text of a transfer function', () => {
  it('is read back as it was written', () => {
    for (const transfer of [
      { ...defaultTransfer, points: ramp },
      { preset: 'ct-bone', range: undefined, points: [] } as const,
      { preset: 'gray', range: [-5.5, 1e-3], points: [] } as const,
    ]) {
      expect(parseTransfer(formatTransfer(transfer) ?? null)).toEqual(transfer);
    }
    expect(formatTransfer(defaultTransfer)).toBeUndefined();
  });

  it.each([
    ...['', 'bone', 'gray,1', 'gray,2,1', '0,0,0,256,0', '0,0,0,0,2'],
    ...['1,0,0,0,0;0,0,0,0,0', '0,0,0,0,0;', '0,0,0,0,0,0'],
  ])('with nonsense is the default: %s', (text) => {
    expect(parseTransfer(text)).toEqual(defaultTransfer);
  });
});

describe('a histogram', () => {
  it('is seen through a window of values', () => {
    expect(barHeights([1, 4, 2, 0], 0, 4, [0, 4], 4, false)).toEqual([0.25, 1, 0.5, 0]);
    expect(barHeights([1, 4, 2, 0], 0, 4, [1, 3], 2, false)).toEqual([1, 0.5]);
    expect(barHeights([1, 4, 2, 0], 0, 4, [-4, 4], 2, false)).toEqual([0, 1]);
  });

  it('shows rare values on a logarithmic scale', () => {
    const [rare = 0] = barHeights([9, 99999], 0, 2, [0, 2], 2, true);
    expect(rare).toBeCloseTo(0.2);
  });

  it('of a constant or of nothing has no bars that are not numbers', () => {
    expect(barHeights([5], 3, 3, [2, 4], 2, true).every(Number.isFinite)).toBe(true);
    expect(barHeights([], 0, 0, [0, 1], 2, false)).toEqual([0, 0]);
  });
});
