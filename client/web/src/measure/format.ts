import { isWhole, angleAt, area, levelArea, levelLength, pathLength, perimeter, rise, type Measurement } from './measurement';
import type { UpAxis } from '../camera/pose';
import { subtract, type Vector } from '../camera/vector';

const thin = '\u202f'; // between groups of three digits

/** Number of decimals of a length: down to a hundredth of the point spacing of the model. */
export function decimalsOf(spacing: number): number {
  if (!(spacing > 0)) return 3;
  return Math.min(8, Math.max(0, 2 - Math.floor(Math.log10(spacing))));
}

export function formatNumber(value: number, decimals: number): string {
  const [whole = '', fraction] = Math.abs(value).toFixed(decimals).split('.');
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, thin);
  const digits = fraction === undefined ? grouped : `${grouped}.${fraction}`;
  const zero = !/[1-9]/.test(digits);
  return value < 0 && !zero ? `\u2212${digits}` : digits;
}

/** A coordinate with all digits of the source file and no others. */
export const formatExact = (value: number): string => String(value);

const degrees = (radians: number): string => `${((radians * 180) / Math.PI).toFixed(2)}°`;

export interface Line {
  readonly name: string;
  readonly value: string;
}

/** The results of a measurement, the main result first. */
export function linesOf(m: Measurement, up: UpAxis, decimals: number): Line[] {
  if (!isWhole(m)) return [];
  const number = (value: number): string => formatNumber(value, decimals);
  const [a, b, c] = m.points as [Vector, Vector, Vector];
  const last = m.points[m.points.length - 1]!;
  switch (m.kind) {
    case 'distance':
      return distanceLines(m.points, up, number);
    case 'height':
      return [
        { name: 'Height', value: number(Math.abs(rise(a, b, up))) },
        { name: 'Level distance', value: number(levelLength(subtract(b, a), up)) },
      ];
    case 'angle':
      return [{ name: 'Angle', value: degrees(angleAt(a, b, c)) }];
    case 'area':
      return [
        { name: 'Area', value: number(area(m.points)) },
        { name: 'Seen from above', value: number(levelArea(m.points, up)) },
        { name: 'Perimeter', value: number(perimeter(m.points)) },
      ];
    case 'profile':
      return [
        { name: 'Length along', value: number(pathLength(m.points)) },
        { name: 'Rise', value: number(rise(a, last, up)) },
      ];
  }
}

function distanceLines(points: readonly Vector[], up: UpAxis, number: (value: number) => string): Line[] {
  const [first, last] = [points[0]!, points[points.length - 1]!];
  const lines = [{ name: points.length > 2 ? 'Length of path' : 'Distance', value: number(pathLength(points)) }];
  return [
    ...lines,
    { name: 'Level', value: number(levelLength(subtract(last, first), up)) },
    { name: 'Rise', value: number(rise(first, last, up)) },
  ];
}
