import { depthOf, project, type Projection } from './projection';
import { dot, subtract, vector, type Pixel, type Vector } from './vector';

/** What the north arrow and the scale bar are drawn from. */

export const north = vector(0, 1, 0);
export const east = vector(1, 0, 0);

/**
 * How a short line from a point appears in the picture, per length: x to the right, y down. The same length across the
 * view, at the same depth, is 1. This is the derivative of the projection, so that lines away from the picture's centre
 * appear as they are seen in perspective. Undefined for points that are not in front of the eye.
 */
export function appearance(view: Projection, at: Vector, direction: Vector): Pixel | undefined {
  const offset = subtract(at, view.eye);
  const { right, up, forward } = view.axes;
  const depth = dot(offset, forward);
  if (depth <= 0) return undefined;
  const away = dot(direction, forward) / depth; // relative growth of the depth
  return {
    x: dot(direction, right) - away * dot(offset, right),
    y: away * dot(offset, up) - dot(direction, up),
  };
}

/** Pixels of a unit of length across the view at the depth of a point in front of the eye. */
export const unitPixelsAt = (view: Projection, at: Vector): number => view.eta / depthOf(view, at);

/** The point whose depth the scale is for: the last picked point while it is in the picture, else the focal point. */
export function scalePoint(
  view: Projection,
  focalPoint: Vector,
  picked: Vector | undefined,
): { readonly at: Vector; readonly picked: boolean } {
  const pixel = picked && project(view, picked);
  const inside = pixel && pixel.x >= 0 && pixel.y >= 0 && pixel.x <= view.width && pixel.y <= view.height;
  return picked && inside ? { at: picked, picked: true } : { at: focalPoint, picked: false };
}
