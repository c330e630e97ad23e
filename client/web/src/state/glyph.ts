import { dot, vector, type Vector } from '../camera/vector';
import type { Axes } from '../camera/pose';

/** An attribute of a picked item. */
export interface Value {
  readonly attribute: string;
  readonly value: number;
}

/** A picked ellipsoid: semi-axes in proportion, descending, and their unit directions in the world. */
export interface Glyph {
  readonly semiAxes: readonly number[];
  readonly axes: readonly Vector[];
  readonly tensor: boolean;
}

const indices = [1, 2, 3] as const;

/** The ellipsoid among the attributes of a pick; none of other items. */
export function glyphOf(values: readonly Value[]): Glyph | undefined {
  const named = new Map(values.map(({ attribute, value }) => [attribute, value]));
  const tensor = named.has('eigenvalue_1');
  const [size, axis] = tensor ? ['eigenvalue', 'eigenvector'] : ['semi_axis', 'axis'];
  const semiAxes = indices.map((i) => named.get(`${size}_${i}`));
  const axes = indices.map((i) => ['x', 'y', 'z'].map((part) => named.get(`${axis}_${i}_${part}`)));
  if ([...semiAxes, ...axes.flat()].some((value) => value === undefined)) return undefined;
  return { semiAxes: semiAxes as number[], axes: axes.map(([x, y, z]) => vector(x!, y!, z!)), tensor };
}

const grouped = /^(eigenvector_\d|axis_\d|tensor)_[xyz]+$|^(eigenvalue|semi_axis)_\d$|^([ijk])$/;

/** The attributes of an ellipsoid as lines: those of an axis, and of the tensor, in one. */
export function linesOf(values: readonly Value[], format: (value: Value) => string): [string, string][] {
  const lines = new Map<string, string[]>();
  for (const value of values) {
    const group = grouped.exec(value.attribute);
    const name = group?.[1] ?? group?.[2] ?? (group?.[3] ? 'sample' : value.attribute);
    const text = group && !group[3] ? Number(value.value.toPrecision(5)).toString() : format(value);
    lines.set(name, [...(lines.get(name) ?? []), text]);
  }
  return [...lines].map(([name, parts]) => [name.replaceAll('_', ' '), parts.join(' ')]);
}

const leastAxis = 1e-3; // of the longest: flat discs have a rim

/**
 * An ellipsoid that fills a square picture, seen from far along a view, lit from the eye: RGBA, rows from the top.
 * Without `color` it has the colour of its direction.
 */
export function glyphPixels(
  glyph: Glyph,
  view: Axes,
  color: readonly number[] | undefined,
  size: number,
): Uint8ClampedArray<ArrayBuffer> {
  const longest = glyph.semiAxes[0]!;
  const radii = glyph.semiAxes.map((radius) => Math.max(radius / longest, leastAxis));
  // In parameter space the ellipsoid is the unit ball: o + t d for the ray of a pixel.
  const into = (v: Vector): number[] => glyph.axes.map((axis, i) => dot(axis, v) / radii[i]!);
  const [right, up, forward] = [into(view.right), into(view.up), into(view.forward)];
  const inner = (a: readonly number[], b: readonly number[]): number => a[0]! * b[0]! + a[1]! * b[1]! + a[2]! * b[2]!;
  const dd = inner(forward, forward);
  const rgb = color ?? directionColor(glyph);
  const pixels = new Uint8ClampedArray(4 * size * size);
  for (let row = 0; row < size; ++row) {
    for (let column = 0; column < size; ++column) {
      const x = (2 * (column + 0.5)) / size - 1;
      const y = 1 - (2 * (row + 0.5)) / size;
      const o = right.map((part, i) => 1.05 * (x * part + y * up[i]!));
      const od = inner(o, forward);
      const square = od * od - dd * (inner(o, o) - 1);
      if (square < 0) continue;
      const t = (-od - Math.sqrt(square)) / dd;
      const normal = o.map((part, i) => (part + t * forward[i]!) / radii[i]!);
      const along = glyph.axes.reduce((sum, axis, i) => sum + normal[i]! * dot(axis, view.forward), 0);
      const light = 0.15 + (0.85 * Math.abs(along)) / Math.hypot(...normal);
      pixels.set([...rgb.map((part) => part * Math.sqrt(light)), 255], 4 * (row * size + column));
    }
  }
  return pixels;
}

/** (1 - w) / 2 + w |v|, w = (l1 - l2) / l1: equal values leave the direction open. */
function directionColor({ semiAxes, axes }: Glyph): number[] {
  const w = (semiAxes[0]! - semiAxes[1]!) / semiAxes[0]!;
  const { x, y, z } = axes[0]!;
  return [x, y, z].map((part) => 255 * ((1 - w) / 2 + w * Math.abs(part)));
}
