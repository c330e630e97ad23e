import { heightOf, skyOf, type UpAxis } from '../camera/pose';
import { addScaled, cross, distance, dot, length, normalize, scale, subtract, vector, type Vector } from '../camera/vector';

export const measureKinds = ['distance', 'height', 'angle', 'area', 'profile'] as const;
export type MeasureKind = (typeof measureKinds)[number];

/** Points of the scan, in source coordinates, in the order in which they were picked. */
export interface Measurement {
  readonly id: number;
  readonly kind: MeasureKind;
  readonly points: readonly Vector[];
}

/** A measurement with this many points takes no more. */
export const maxPoints: Readonly<Record<MeasureKind, number>> = {
  distance: 64,
  height: 2,
  angle: 3,
  area: 64,
  profile: 64,
};

/** A measurement with fewer points has no result. */
export const minPoints: Readonly<Record<MeasureKind, number>> = {
  distance: 2,
  height: 2,
  angle: 3,
  area: 3,
  profile: 2,
};

export const isWhole = (m: Measurement): boolean => m.points.length >= minPoints[m.kind];
export const isFull = (m: Measurement): boolean => m.points.length >= maxPoints[m.kind];

const pairs = (points: readonly Vector[]): [Vector, Vector][] =>
  points.slice(1).map((point, i) => [points[i]!, point] as [Vector, Vector]);

/** Length of the polyline through the points. */
export const pathLength = (points: readonly Vector[]): number =>
  pairs(points).reduce((sum, [a, b]) => sum + distance(a, b), 0);

/** Length of the horizontal component of a vector. */
export function levelLength(v: Vector, up: UpAxis): number {
  return length(addScaled(v, skyOf(up), -heightOf(v, up)));
}

/** Height of b above a. */
export const rise = (a: Vector, b: Vector, up: UpAxis): number => heightOf(subtract(b, a), up);

/** Angle at the middle of three points, radians. */
export function angleAt(a: Vector, middle: Vector, b: Vector): number {
  const [u, v] = [subtract(a, middle), subtract(b, middle)];
  // acos is inaccurate for angles near 0 and pi; atan2 is not.
  return Math.atan2(length(cross(u, v)), dot(u, v));
}

/** Newell's sum over a closed polygon: a vector along its normal, twice as long as its area. Exact if it is planar. */
function newell(points: readonly Vector[]): Vector {
  let sum = vector(0, 0, 0);
  const origin = points[0];
  if (!origin) return sum;
  // Relative to the first point, so that large coordinates do not cancel significant digits.
  const local = points.map((point) => subtract(point, origin));
  local.forEach((point, i) => {
    sum = addScaled(sum, cross(point, local[(i + 1) % local.length]!), 1);
  });
  return sum;
}

/** Area of the polygon in its best-fitting plane. */
export const area = (points: readonly Vector[]): number => length(newell(points)) / 2;

/** Area of the polygon's projection onto a horizontal plane. */
export const levelArea = (points: readonly Vector[], up: UpAxis): number => Math.abs(heightOf(newell(points), up)) / 2;

export const perimeter = (points: readonly Vector[]): number =>
  points.length < 2 ? 0 : pathLength([...points, points[0]!]);

/** A point of a profile: horizontal distance along its course, and height. */
export interface ProfilePoint {
  readonly along: number;
  readonly height: number;
}

export function profileOf(points: readonly Vector[], up: UpAxis): ProfilePoint[] {
  let along = 0;
  return points.map((point, i) => {
    const previous = points[i - 1];
    if (previous) along += levelLength(subtract(point, previous), up);
    return { along, height: heightOf(point, up) };
  });
}

/** The corner of the height triangle: below or above `a`, at the height of `b`. */
export const cornerBelow = (a: Vector, b: Vector, up: UpAxis): Vector => addScaled(a, skyOf(up), rise(a, b, up));

/** Points on the arc that marks an angle, at `radius` from its vertex. */
export function arc(a: Vector, middle: Vector, b: Vector, radius: number, steps: number): Vector[] {
  const u = normalize(subtract(a, middle));
  const toB = subtract(b, middle);
  const v = normalize(addScaled(toB, u, -dot(toB, u)));
  const angle = angleAt(a, middle, b);
  return Array.from({ length: steps + 1 }, (_, i) => {
    const turned = addScaled(scale(u, Math.cos((angle * i) / steps)), v, Math.sin((angle * i) / steps));
    return addScaled(middle, turned, radius);
  });
}
