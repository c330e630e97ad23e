import type { Rgb } from '../state/rgb';

export const presets = ['auto', 'gray', 'ct-bone', 'ct-soft', 'mr'] as const;
export type PresetName = (typeof presets)[number];

/** A point of a transfer function. */
export interface TransferPoint {
  readonly value: number; // of a sample
  readonly color: Rgb;
  readonly opacity: number; // of one spacing of the grid, 0 to 1
}

/** The colours and opacities of volumes: a preset with the values at its ends, or points in ascending order. */
export interface Transfer {
  readonly preset: PresetName;
  readonly range: readonly [number, number] | undefined; // undefined: the preset's own
  readonly points: readonly TransferPoint[]; // none: the preset
}

export const defaultTransfer: Transfer = { preset: 'auto', range: undefined, points: [] };

export const maxPoints = 256;

const toLinear = (code: number): number => {
  const x = code / 255;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
};

const toCode = (linear: number): number => {
  const x = linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
  return Math.round(Math.min(1, Math.max(0, x)) * 255);
};

const mixed = (a: number, b: number, t: number): number => a + (b - a) * t;

const mixedColor = (a: Rgb, b: Rgb, t: number): Rgb => {
  const part = (from: number, to: number): number => toCode(mixed(toLinear(from), toLinear(to), t));
  return { red: part(a.red, b.red), green: part(a.green, b.green), blue: part(a.blue, b.blue) };
};

/** Colour and opacity at a value: linear between points, colours in linear light. Of a step, those after it. */
export function lookUp(points: readonly TransferPoint[], value: number): Omit<TransferPoint, 'value'> {
  const next = points.findIndex((point) => point.value > value);
  const after = points[next === -1 ? points.length - 1 : next];
  const before = points[next === -1 ? points.length - 1 : Math.max(0, next - 1)];
  if (!after || !before) return { color: { red: 255, green: 255, blue: 255 }, opacity: 0 };
  const span = after.value - before.value;
  const t = span > 0 ? Math.min(1, Math.max(0, (value - before.value) / span)) : 0;
  return { color: mixedColor(before.color, after.color, t), opacity: mixed(before.opacity, after.opacity, t) };
}

const clamp = (value: number, low: number, high: number): number => Math.min(high, Math.max(low, value));

/** A point moved, between its neighbours. */
export function movePoint(
  points: readonly TransferPoint[],
  index: number,
  value: number,
  opacity: number,
): TransferPoint[] {
  const low = points[index - 1]?.value ?? -Infinity;
  const high = points[index + 1]?.value ?? Infinity;
  return points.map((point, i) =>
    i === index ? { ...point, value: clamp(value, low, high), opacity: clamp(opacity, 0, 1) } : point,
  );
}

/** A new point with the colour that is there already, and its index. */
export function addPoint(
  points: readonly TransferPoint[],
  value: number,
  opacity: number,
): { readonly points: TransferPoint[]; readonly index: number } {
  const next = points.findIndex((point) => point.value > value);
  const index = next === -1 ? points.length : next;
  const point = { value, color: lookUp(points, value).color, opacity: clamp(opacity, 0, 1) };
  return { points: [...points.slice(0, index), point, ...points.slice(index)], index };
}

/** The last two points stay. */
export const removePoint = (points: readonly TransferPoint[], index: number): readonly TransferPoint[] =>
  points.length > 2 ? points.filter((_, i) => i !== index) : points;

export const recolorPoint = (points: readonly TransferPoint[], index: number, color: Rgb): TransferPoint[] =>
  points.map((point, i) => (i === index ? { ...point, color } : point));

/** Maps the values of all points from one range to another: the window and level of an image. */
export function fitTo(
  points: readonly TransferPoint[],
  from: readonly [number, number],
  to: readonly [number, number],
): TransferPoint[] {
  const scale = (to[1] - to[0]) / (from[1] - from[0]);
  return points.map((point) => ({ ...point, value: to[0] + (point.value - from[0]) * scale }));
}

/** The values of the first and the last point. */
export const rangeOf = (points: readonly TransferPoint[]): readonly [number, number] => [
  points[0]?.value ?? 0,
  points[points.length - 1]?.value ?? 1,
];

/** A window of given centre and width, at least `smallest` wide. */
export const windowOf = (level: number, width: number, smallest: number): readonly [number, number] => {
  const half = Math.max(width, smallest) / 2;
  return [level - half, level + half];
};

/** The text of the parameter `transfer`; undefined for the default. */
export function formatTransfer({ preset, range, points }: Transfer): string | undefined {
  if (points.length > 0) {
    return points
      .map(({ value, color, opacity }) => [value, color.red, color.green, color.blue, opacity].join(','))
      .join(';');
  }
  if (range) return `${preset},${range.join(',')}`;
  return preset === defaultTransfer.preset ? undefined : preset;
}

const numbersIn = (parts: readonly string[]): number[] | undefined => {
  const numbers = parts.map((part) => (part.trim() === '' ? Number.NaN : Number(part)));
  return numbers.every(Number.isFinite) ? numbers : undefined;
};

function parsePoint(text: string): TransferPoint | undefined {
  const [value, red, green, blue, opacity, ...rest] = numbersIn(text.split(',')) ?? [];
  if (value === undefined || opacity === undefined || rest.length > 0) return undefined;
  const isPart = (part: number | undefined): part is number =>
    part !== undefined && Number.isInteger(part) && part >= 0 && part <= 255;
  if (!isPart(red) || !isPart(green) || !isPart(blue) || opacity < 0 || opacity > 1) return undefined;
  return { value, color: { red, green, blue }, opacity };
}

function parsePreset(text: string): Transfer | undefined {
  const [name, ...ends] = text.split(',');
  const preset = presets.find((each) => each === name);
  if (!preset) return undefined;
  const [first, last, ...rest] = numbersIn(ends) ?? [];
  if (ends.length === 0) return { preset, range: undefined, points: [] };
  if (first === undefined || last === undefined || rest.length > 0 || !(first < last)) return undefined;
  return { preset, range: [first, last], points: [] };
}

/** The inverse of `formatTransfer`. A text that is no transfer function gives the default. */
export function parseTransfer(text: string | null): Transfer {
  if (text === null) return defaultTransfer;
  const preset = parsePreset(text);
  if (preset) return preset;
  const points = text.split(';').map(parsePoint);
  const ascending = points.every((point, i) => point && (points[i - 1]?.value ?? -Infinity) <= point.value);
  if (!ascending || points.length > maxPoints) return defaultTransfer;
  return { ...defaultTransfer, points: points.filter((point) => point !== undefined) };
}

/** The heights of a histogram's bars, 0 to 1, through a window of values. `counts` reach from `low` to `high`. */
export function barHeights(
  counts: readonly number[],
  low: number,
  high: number,
  window: readonly [number, number],
  bars: number,
  logarithmic: boolean,
): number[] {
  const sums = new Array<number>(bars).fill(0);
  const width = (high - low) / Math.max(1, counts.length) || 1;
  counts.forEach((count, i) => {
    const value = low + (i + 0.5) * width;
    const bar = Math.floor(((value - window[0]) / (window[1] - window[0])) * bars);
    if (bar >= 0 && bar < bars) sums[bar]! += count;
  });
  const scaled = sums.map((sum) => (logarithmic ? Math.log1p(sum) : sum));
  const tallest = Math.max(...scaled);
  return scaled.map((height) => (tallest > 0 ? height / tallest : 0));
}
