import { describe, expect, it } from 'vitest';
import { WarpResolution } from '../src/view/warp_resolution';

/** After so many warps on a device that takes these milliseconds for a warp with all pixels. */
function settled(milliseconds: (warp: number) => number, warps = 60, resolution = new WarpResolution()): WarpResolution {
  for (let i = 0; i < warps; ++i) {
    if (resolution.measuresNext()) resolution.record(milliseconds(i) * resolution.scale ** 2);
  }
  return resolution;
}

describe('the resolution of warps', () => {
  it('is whole where they are drawn in time', () => {
    expect(settled(() => 3).scale).toBe(1);
    expect(settled(() => 11.9).scale).toBe(1);
  });

  it('is the largest that is drawn in time', () => {
    expect(settled(() => 20).scale).toBe(0.75);
    expect(settled(() => 40).scale).toBe(0.5);
  });

  it('does not fall below a half', () => {
    expect(settled(() => 500).scale).toBe(0.5);
  });

  it('does not follow single warps that take long', () => {
    expect(settled((i) => (i % 12 === 0 ? 200 : 3)).scale).toBe(1);
  });

  it('rises again where there is much time left, and only then', () => {
    const slow = settled(() => 40);
    expect(settled(() => 13, 200, slow).scale).toBe(0.5); // 7.3 ms with three quarters
    expect(settled(() => 11, 200, slow).scale).toBe(0.75);
    expect(settled(() => 6.5, 200, slow).scale).toBe(1);
  });

  it('keeps still between two scales', () => {
    const resolution = settled(() => 14);
    const seen = new Set<number>();
    for (let i = 0; i < 300; ++i) {
      settled(() => 14, 1, resolution);
      seen.add(resolution.scale);
    }
    expect([...seen]).toEqual([0.75]);
  });

  it('is measured for one warp of four', () => {
    const resolution = new WarpResolution();
    expect(Array.from({ length: 8 }, () => resolution.measuresNext()).filter(Boolean).length).toBe(2);
  });
});
