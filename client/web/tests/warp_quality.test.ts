import { describe, expect, it } from 'vitest';
import { costOf, WarpQualityControl } from '../src/view/warp_quality';

/** After so many warps on a device that takes these milliseconds for a warp with all pixels and both layers. */
function settled(
  milliseconds: (warp: number) => number,
  warps = 60,
  control = new WarpQualityControl(),
  hasBoth = true,
): WarpQualityControl {
  for (let i = 0; i < warps; ++i) {
    const drawn = { ...control.quality, layered: control.quality.layered && hasBoth };
    if (control.measuresNext()) control.record(milliseconds(i) * costOf(drawn), drawn.layered);
  }
  return control;
}

const best = { scale: 1, coarse: false, layered: true };
const threeQuarters = { scale: 0.75, coarse: false, layered: true };
const half = { scale: 0.5, coarse: false, layered: true };
const coarseHalf = { scale: 0.5, coarse: true, layered: true };
const threeEighths = { scale: 0.375, coarse: true, layered: true };
const worst = { scale: 0.375, coarse: true, layered: false };

/** How many of the next eight warps are measured. */
const measured = (control: WarpQualityControl): number =>
  Array.from({ length: 8 }, () => control.measuresNext()).filter(Boolean).length;

describe('the quality of warps', () => {
  it('is the best where they are drawn in time', () => {
    expect(settled(() => 3).quality).toEqual(best);
    expect(settled(() => 11.9).quality).toEqual(best);
  });

  it('is the best that is drawn in time', () => {
    expect(settled(() => 17).quality).toEqual(threeQuarters);
    expect(settled(() => 25).quality).toEqual(half);
    expect(settled(() => 33).quality).toEqual(coarseHalf);
    expect(settled(() => 50).quality).toEqual(threeEighths);
    expect(settled(() => 500).quality).toEqual(worst);
  });

  it('is the same where only one layer is there to be drawn', () => {
    for (const milliseconds of [3, 17, 25, 33, 50, 500]) {
      const alone = settled(() => milliseconds, 60, new WarpQualityControl(), false);
      expect(alone.quality).toEqual(settled(() => milliseconds).quality);
    }
  });

  it('falls at once after two warps that take far too long', () => {
    const control = settled(() => 28, 1);
    expect(control.quality).toEqual(best);
    expect(settled(() => 28, 1, control).quality).toEqual(half);
    expect(settled((i) => [60, 28][i % 2]!, 2).quality).toEqual(half); // as the faster of them demands
    expect(settled((i) => [60, 17, 10][i % 3]!, 60).quality).toEqual(threeQuarters); // the middle of three
  });

  it('does not follow single warps that take long', () => {
    expect(settled((i) => (i % 12 === 0 ? 200 : 3)).quality).toEqual(best);
  });

  it('rises again where there is much time left, and only then', () => {
    const slow = settled(() => 28);
    expect(settled(() => 11, 200, slow).quality).toEqual(half); // 7.2 ms with three quarters
    expect(settled(() => 10, 200, slow).quality).toEqual(threeQuarters);
    expect(settled(() => 6.5, 200, slow).quality).toEqual(best);
  });

  it('keeps still between two of them', () => {
    const control = settled(() => 14);
    const seen = new Set<number>();
    for (let i = 0; i < 300; ++i) {
      settled(() => 14, 1, control);
      seen.add(control.quality.scale);
    }
    expect([...seen]).toEqual([0.75]);
  });

  it('is measured for the first warps of each, and then for one of four', () => {
    const control = new WarpQualityControl();
    expect(control.isUncertain).toBe(true);
    settled(() => 1, 3, control);
    expect(control.isUncertain).toBe(false);
    expect(measured(control)).toBe(2);
    const slow = settled(() => 28, 3);
    expect(slow.quality).toEqual(half);
    expect(slow.isUncertain).toBe(true);
    expect(slow.measuresNext()).toBe(true);
    settled(() => 500, 20, slow); // the worst takes too long as well
    expect(measured(slow)).toBe(2);
  });
});
