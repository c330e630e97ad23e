import { describe, expect, it } from 'vitest';
import { defaultTransfer, type TransferPoint } from '../src/volume/transfer';
import { draggedWindow, windowNow, withWindow } from '../src/volume/window';

const black = { red: 0, green: 0, blue: 0 };
const points: TransferPoint[] = [
  { value: 0, color: black, opacity: 0 },
  { value: 25, color: black, opacity: 0.5 },
  { value: 100, color: black, opacity: 1 },
];
const preset = { transfer: defaultTransfer, points, span: 1000 };
const own = { transfer: { ...defaultTransfer, points }, points, span: 1000 };

describe('the window of a transfer function', () => {
  it('is the range of its points', () => {
    expect(windowNow(own)).toEqual({ level: 50, width: 100 });
  });

  it('of a preset becomes its stated ends', () => {
    expect(withWindow(preset, { level: 40, width: 400 })).toEqual({ preset: 'auto', range: [-160, 240], points: [] });
  });

  it('of points moves and stretches them', () => {
    expect(withWindow(own, { level: 100, width: 200 }).points.map(({ value }) => value)).toEqual([0, 50, 200]);
  });

  it('is rounded to what can be told apart', () => {
    expect(withWindow(preset, { level: 1 / 3, width: 1 }).range).toEqual([-0.17, 0.83]);
    expect(withWindow({ ...preset, span: 0.001 }, { level: 1 / 3e4, width: 1e-5 }).range).toEqual([
      0.00002833, 0.00003833,
    ]);
  });

  it('never closes', () => {
    const { range } = withWindow(preset, { level: 5, width: -7 });
    expect(range![0]).toBeLessThan(range![1]);
    const step = { ...own, points: points.slice(0, 1) };
    expect(withWindow(step, { level: 5, width: 1 })).toBe(step.transfer);
  });

  it('is dragged wider to the right, and brighter upwards', () => {
    expect(draggedWindow({ level: 50, width: 100 }, 1000, 0.1, 0)).toEqual({ level: 50, width: 200 });
    expect(draggedWindow({ level: 50, width: 100 }, 1000, 0, 0.1)).toEqual({ level: -50, width: 100 });
    expect(draggedWindow({ level: 50, width: 100 }, 1000, -3, 0).width).toBe(0);
  });
});
