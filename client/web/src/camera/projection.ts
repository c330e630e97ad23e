import type { Axes, Camera } from './pose';
import { addScaled, cross, dot, normalize, subtract, type Pixel, type Vector } from './vector';

/** A camera with the size of its picture: maps world coordinates to pixels in the same way as the server's renderer. */
export interface Projection {
  readonly eye: Vector;
  readonly axes: Axes;
  readonly eta: number; // pixels per unit of tangent
  readonly width: number;
  readonly height: number;
}

export function etaOf(viewAngle: number, height: number): number {
  return height / (2 * Math.tan((viewAngle * Math.PI) / 360));
}

/** `sky` is the view up of a camera that states none. */
export function projectionOf(camera: Camera, sky: Vector, width: number, height: number): Projection {
  const forward = normalize(subtract(camera.focalPoint, camera.position));
  const right = normalize(cross(forward, camera.viewUp ?? sky));
  const axes = { right, up: cross(right, forward), forward };
  return { eye: camera.position, axes, eta: etaOf(camera.viewAngle, height), width, height };
}

/** Distance in front of the eye, along the view direction. */
export const depthOf = (view: Projection, point: Vector): number => dot(subtract(point, view.eye), view.axes.forward);

/** The pixel of a point; undefined for points that are not in front of the eye. */
export function project(view: Projection, point: Vector): Pixel | undefined {
  const offset = subtract(point, view.eye);
  const depth = dot(offset, view.axes.forward);
  if (depth <= 0) return undefined;
  return {
    x: view.width / 2 + (view.eta * dot(offset, view.axes.right)) / depth,
    y: view.height / 2 - (view.eta * dot(offset, view.axes.up)) / depth,
  };
}

/** The viewing ray of a pixel, scaled to a length of 1 along the view direction. */
export function rayOf(view: Projection, pixel: Pixel): Vector {
  const x = (pixel.x - view.width / 2) / view.eta;
  const y = (view.height / 2 - pixel.y) / view.eta;
  return addScaled(addScaled(view.axes.forward, view.axes.right, x), view.axes.up, y);
}

/** The point on a pixel's viewing ray at a depth. */
export const pointAt = (view: Projection, pixel: Pixel, depth: number): Vector =>
  addScaled(view.eye, rayOf(view, pixel), depth);

/** The pixels of the part of a line in front of the eye. A line that crosses the eye's plane is cut just before it. */
export function projectLine(view: Projection, a: Vector, b: Vector): [Pixel, Pixel] | undefined {
  const [depthA, depthB] = [depthOf(view, a), depthOf(view, b)];
  const nearest = 1e-3 * Math.max(depthA, depthB);
  if (nearest <= 0) return undefined;
  const cut = (from: Vector, to: Vector, depthFrom: number, depthTo: number): Vector =>
    depthFrom >= nearest
      ? from
      : addScaled(from, subtract(to, from), (nearest - depthFrom) / (depthTo - depthFrom));
  const start = project(view, cut(a, b, depthA, depthB));
  const end = project(view, cut(b, a, depthB, depthA));
  return start && end ? [start, end] : undefined;
}
