import type { Vector } from '../camera/vector';
import type { Rgb } from '../state/rgb';

/** Iso-surfaces and slices of volumes, and their texts: those of the parameters `iso` and `slice`. */

export interface IsoSurface {
  readonly value: number;
  readonly color: Rgb | undefined; // undefined: light grey
  readonly opacity: number; // 0 to 1
}

export const gridAxes = ['i', 'j', 'k'] as const;
export type GridAxis = (typeof gridAxes)[number];

/** A plane of the grid at an index along an axis, which may lie between samples, or one through a point of the world. */
export type Slice =
  | { readonly axis: GridAxis; readonly index: number }
  | { readonly axis: undefined; readonly point: Vector; readonly normal: Vector };

/** Of each in a picture. */
export const maxSurfaces = 8;

export const isoGray: Rgb = { red: 231, green: 231, blue: 231 };

const numbersIn = (text: string): number[] => text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));

const isByte = (part: number): boolean => Number.isInteger(part) && part >= 0 && part <= 255;

function parseSurface(text: string): IsoSurface | undefined {
  const numbers = numbersIn(text);
  const [value = NaN, red = 0, green = 0, blue = 0, opacity = 1] = numbers;
  const known = [1, 4, 5].includes(numbers.length) && numbers.every(Number.isFinite);
  if (!known || ![red, green, blue].every(isByte) || opacity < 0 || opacity > 1) return undefined;
  return { value, color: numbers.length > 1 ? { red, green, blue } : undefined, opacity };
}

function formatSurface({ value, color, opacity }: IsoSurface): string {
  if (!color && opacity === 1) return String(value);
  const { red, green, blue } = color ?? isoGray;
  return [value, red, green, blue, ...(opacity === 1 ? [] : [opacity])].join(',');
}

function parseSlice(text: string): Slice | undefined {
  const axis = gridAxes.find((name) => text.startsWith(`${name},`));
  const numbers = numbersIn(axis ? text.slice(2) : text);
  if (!numbers.every(Number.isFinite)) return undefined;
  const [x = 0, y = 0, z = 0, u = 0, v = 0, w = 0] = numbers;
  if (axis) return numbers.length === 1 ? { axis, index: x } : undefined;
  if (numbers.length !== 6 || Math.hypot(u, v, w) === 0) return undefined;
  return { axis: undefined, point: { x, y, z }, normal: { x: u, y: v, z: w } };
}

const formatSlice = (slice: Slice): string =>
  slice.axis
    ? `${slice.axis},${slice.index}`
    : [slice.point, slice.normal].map(({ x, y, z }) => `${x},${y},${z}`).join(',');

/** All parts of a list, or none if one is wrong. */
function parseList<Item>(text: string | null, parse: (part: string) => Item | undefined): readonly Item[] {
  if (!text) return [];
  const items = text.split(';').map(parse);
  const found = items.filter((item) => item !== undefined);
  return found.length === items.length && found.length <= maxSurfaces ? found : [];
}

const formatList = <Item>(items: readonly Item[], format: (item: Item) => string): string | undefined =>
  items.length > 0 ? items.map(format).join(';') : undefined;

export const parseSurfaces = (text: string | null): readonly IsoSurface[] => parseList(text, parseSurface);
export const formatSurfaces = (surfaces: readonly IsoSurface[]): string | undefined =>
  formatList(surfaces, formatSurface);
export const parseSlices = (text: string | null): readonly Slice[] => parseList(text, parseSlice);
export const formatSlices = (slices: readonly Slice[]): string | undefined => formatList(slices, formatSlice);

/** Where the slice across an axis is. */
export function indexAcross(slices: readonly Slice[], axis: GridAxis): number | undefined {
  for (const slice of slices) if (slice.axis === axis) return slice.index;
  return undefined;
}

/** The slices with the one across an axis at an index, or without it. Others across that axis go. */
export function withSlice(slices: readonly Slice[], axis: GridAxis, index: number | undefined): readonly Slice[] {
  const others = slices.filter((slice) => slice.axis !== axis);
  return index === undefined ? others : [...others, { axis, index }];
}

export const withSurface = (
  surfaces: readonly IsoSurface[],
  at: number,
  change: Partial<IsoSurface>,
): readonly IsoSurface[] => surfaces.map((surface, i) => (i === at ? { ...surface, ...change } : surface));
