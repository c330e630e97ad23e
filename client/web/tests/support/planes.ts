import { create } from '@bufbuild/protobuf';
import { deflateSync } from 'node:zlib';
import type { Projection } from '../../src/camera/projection';
import { depthOf, rayOf } from '../../src/camera/projection';
import { dot, subtract, type Vector } from '../../src/camera/vector';
import { DepthPlaneSchema, type DepthPlane as WirePlane } from '../../src/generated/surfcast_pb';
import type { Size } from '../../src/protocol/pictures';
import type { DepthPlane } from '../../src/warp/depth_plane';

/** Differences of codes to their predictions, as PROTOCOL.md has it. */
export function predicted(codes: Uint8Array, width: number): Uint8Array {
  return codes.map((code, i) => {
    const [x, y] = [i % width, Math.floor(i / width)];
    const at = (column: number, row: number): number => codes[row * width + column]!;
    if (x === 0 && y === 0) return code;
    if (y === 0) return code - at(x - 1, 0);
    if (x === 0) return code - at(0, y - 1);
    return code - Math.min(255, Math.max(0, at(x - 1, y) + at(x, y - 1) - at(x - 1, y - 1)));
  });
}

/** A plane of the protocol with the given codes, for a picture of `picture` pixels. */
export function wirePlane(codes: Uint8Array, picture: Size, cell: number, first = 0.1, last = 1): WirePlane {
  const [width, height] = [Math.ceil(picture.width / cell), Math.ceil(picture.height / cell)];
  return create(DepthPlaneSchema, { width, height, cell, first, last, codes: deflateSync(predicted(codes, width)) });
}

/** The plane of a function of the pixel; cells have the largest value at their centres and corners. */
export function planeOf(picture: Size, cell: number, depth: (x: number, y: number) => number): DepthPlane {
  const [width, height] = [Math.ceil(picture.width / cell), Math.ceil(picture.height / cell)];
  const places = (i: number, size: number): number[] => {
    const [start, end] = [i * cell, Math.min(size, (i + 1) * cell)];
    return [start, (start + end) / 2, end];
  };
  const values = Float32Array.from({ length: width * height }, (_, i) => {
    const rows = places(Math.floor(i / width), picture.height);
    return Math.max(...places(i % width, picture.width).flatMap((x) => rows.map((y) => depth(x, y))));
  });
  const shown = [...values].filter((value) => value > 0);
  const range = { first: Math.min(...shown), last: Math.max(...shown) };
  return { picture, cell, width, height, values, ...range, seenThrough: false };
}

/** Inverse depth at a pixel of a plane of the scene through a point; 0 where the ray does not meet it. */
export function inverseDepthOf(view: Projection, point: Vector, normal: Vector, x: number, y: number): number {
  const far = dot(subtract(point, view.eye), normal);
  return Math.max(0, dot(rayOf(view, { x, y }), normal) / far);
}

/** A point of the scene as the source of a warp: its pixel's coordinates and its inverse depth. */
export const inverseDepthAt = (view: Projection, point: Vector): number => 1 / depthOf(view, point);
