import type { Projection } from '../camera/projection';
import { dot, subtract, type Vector } from '../camera/vector';

/**
 * A warp maps (x, y, 1, d), a pixel of the source picture and the inverse depth of what it shows, to (X, Y, W): the
 * pixel (X / W, Y / W) of the target picture and the inverse depth d / W there. It is linear, so that a plane of the
 * scene, whose inverse depth is affine in x and y, is mapped as a homography. d = 0 is infinitely far: it turns with
 * the camera and does not shift.
 */
export interface Warp {
  readonly x: Row;
  readonly y: Row;
  readonly w: Row;
}

/** Factors of x, y, 1 and d. */
type Row = readonly [number, number, number, number];

/** The warp between two cameras. The eyes are subtracted in double precision: world coordinates are large. */
export function warpBetween(source: Projection, target: Projection): Warp {
  const moved = subtract(source.eye, target.eye);
  const along = (axis: Vector): Row => {
    const perX = dot(source.axes.right, axis) / source.eta;
    const perY = -dot(source.axes.up, axis) / source.eta;
    const constant = dot(source.axes.forward, axis) - (perX * source.width + perY * source.height) / 2;
    return [perX, perY, constant, dot(moved, axis)];
  };
  const [right, up, w] = [along(target.axes.right), along(target.axes.up), along(target.axes.forward)];
  return {
    x: combined(target.eta, right, target.width / 2, w),
    y: combined(-target.eta, up, target.height / 2, w),
    w,
  };
}

const combined = (a: number, row: Row, b: number, other: Row): Row => [
  a * row[0] + b * other[0],
  a * row[1] + b * other[1],
  a * row[2] + b * other[2],
  a * row[3] + b * other[3],
];

/**
 * The warp as a matrix to clip coordinates of a target picture of `width` x `height` pixels, in columns. The window's
 * depth is 1 - nearest d', where d' is the inverse depth in the target picture. What is nearer to the eye than
 * `nearest` is cut off.
 */
export function clipMatrix({ x, y, w }: Warp, width: number, height: number, nearest: number): Float32Array {
  const columns = ([0, 1, 2, 3] as const).map((i) => [
    (2 * x[i]) / width - w[i],
    w[i] - (2 * y[i]) / height,
    w[i] - (i === 3 ? 2 * nearest : 0),
    w[i],
  ]);
  return new Float32Array(columns.flat());
}

/** From the eye of a source to that of a target, in the axes of a pixel and its inverse depth: x right and y down. */
export function eyeMovement(source: Projection, target: Projection): readonly [number, number, number] {
  const moved = subtract(target.eye, source.eye);
  const { right, up, forward } = source.axes;
  return [dot(moved, right), -dot(moved, up), dot(moved, forward)];
}

/** The rows of a warp as the columns of a matrix, for (x, y, 1, d) on its left. */
export const rowMatrix = ({ x, y, w }: Warp): Float32Array => new Float32Array([...x, ...y, ...w]);
