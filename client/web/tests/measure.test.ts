import { describe, expect, it } from 'vitest';
import { scale, vector } from '../src/camera/vector';
import { chartOf, ticks } from '../src/measure/chart';
import { decimalsOf, formatExact, formatNumber, linesOf } from '../src/measure/format';
import { angleAt, arc, area, cornerBelow, levelArea, pathLength, perimeter, profileOf, rise } from '../src/measure/measurement';
import { expectNear } from './support/near';

const square = [vector(0, 0, 0), vector(4, 0, 0), vector(4, 3, 0), vector(0, 3, 0)];
const far = { x: 4_500_000, y: 300_000, z: 100 };
const shifted = square.map((p) => vector(p.x + far.x, p.y + far.y, p.z + far.z));

describe('measuring', () => {
  it('adds up the parts of a path', () => {
    expect(pathLength(square)).toBe(11);
    expect(perimeter(square)).toBe(14);
    expect(pathLength([])).toBe(0);
  });

  it('has the area of a polygon, also far from the origin', () => {
    expect(area(square)).toBe(12);
    expect(area(shifted)).toBe(12);
    expect(area(square.slice(0, 2))).toBe(0);
  });

  it('tells the area of a slope from that of its shadow', () => {
    const slope = square.map((p) => vector(p.x, p.y, p.y)); // 45 degrees
    expect(area(slope)).toBeCloseTo(12 * Math.SQRT2, 12);
    expect(levelArea(slope, 'z')).toBeCloseTo(12, 12);
  });

  it('has exact angles, also those near 0 and 180 degrees', () => {
    const o = vector(0, 0, 0);
    expect(angleAt(vector(1, 0, 0), o, vector(0, 2, 0))).toBe(Math.PI / 2);
    expect(angleAt(vector(1, 0, 0), o, vector(1, 1e-9, 0))).toBeCloseTo(1e-9, 18);
    expect(angleAt(vector(1, 0, 0), o, vector(-1, 1e-9, 0))).toBeCloseTo(Math.PI - 1e-9, 15);
    expect(angleAt(o, o, o)).toBe(0);
  });

  it('measures heights along the axis that is up', () => {
    const [a, b] = [vector(0, 1, 2), vector(5, 9, -4)];
    expect(rise(a, b, 'z')).toBe(-6);
    expect(rise(a, b, 'y')).toBe(8);
    expect(cornerBelow(a, b, 'z')).toEqual(vector(0, 1, -4));
  });

  it('lays a profile out along its level course', () => {
    const profile = profileOf([vector(0, 0, 1), vector(3, 4, 6), vector(3, 4, 2), vector(3, 10, 2)], 'z');
    expect(profile).toEqual([
      { along: 0, height: 1 },
      { along: 5, height: 6 },
      { along: 5, height: 2 },
      { along: 11, height: 2 },
    ]);
  });

  it('draws the arc of an angle from one side to the other', () => {
    const points = arc(vector(9, 0, 0), vector(0, 0, 0), vector(0, 4, 0), 2, 8);
    expectNear(points[0]!, vector(2, 0, 0));
    expectNear(points[8]!, vector(0, 2, 0));
    expectNear(points[4]!, scale(vector(1, 1, 0), Math.SQRT2));
  });
});

describe('figures on the screen', () => {
  it('group their digits and keep their sign', () => {
    expect(formatNumber(1234567.891, 2)).toBe('1\u202f234\u202f567.89');
    expect(formatNumber(-0.5, 1)).toBe('\u22120.5');
    expect(formatNumber(-0.001, 1)).toBe('0.0');
    expect(formatNumber(123, 0)).toBe('123');
  });

  it('have as many decimals as the scan is dense', () => {
    expect(decimalsOf(0.02)).toBe(4);
    expect(decimalsOf(5)).toBe(2);
    expect(decimalsOf(2000)).toBe(0);
    expect(decimalsOf(0)).toBe(3);
  });

  it('show coordinates with all their digits', () => {
    expect(formatExact(4500123.25)).toBe('4500123.25');
  });

  it('say the main thing first, and nothing too early', () => {
    expect(linesOf({ id: 1, kind: 'area', points: square }, 'z', 2)[0]).toEqual({ name: 'Area', value: '12.00' });
    expect(linesOf({ id: 1, kind: 'area', points: square.slice(2) }, 'z', 2)).toEqual([]);
    const corner = [square[1]!, square[0]!, square[3]!];
    expect(linesOf({ id: 1, kind: 'angle', points: corner }, 'z', 2)[0]?.value).toBe('90.00°');
  });
});

describe('a chart', () => {
  it('has round ticks within its range', () => {
    expect(ticks(0, 10, 4)).toEqual([0, 5, 10]);
    expect(ticks(-0.13, 0.42, 3)).toEqual([0, 0.2, 0.4]);
    expect(ticks(3, 3, 4)).toEqual([3]);
  });

  it('fits a profile into its frame, also a flat one', () => {
    const frame = { width: 100, height: 50, left: 10, right: 0, top: 0, bottom: 10 };
    const chart = chartOf([{ along: 0, height: 5 }, { along: 2, height: 5 }], frame);
    expect(chart.dots).toEqual([{ x: 10, y: 20 }, { x: 100, y: 20 }]);
    expect(chartOf([{ along: 0, height: 0 }, { along: 0, height: 0 }], frame).path).not.toContain('NaN');
  });
});
