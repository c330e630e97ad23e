import { expect } from 'vitest';
import type { Pixel, Vector } from '../../src/camera/vector';

export function expectNear(actual: Vector, expected: Vector, error = 1e-9): void {
  expect(Math.hypot(actual.x - expected.x, actual.y - expected.y, actual.z - expected.z)).toBeLessThan(error);
}

export function expectPixel(actual: Pixel | undefined, expected: Pixel, error = 1e-6): void {
  expect(actual).toBeDefined();
  expect(Math.hypot(actual!.x - expected.x, actual!.y - expected.y)).toBeLessThan(error);
}
