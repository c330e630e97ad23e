import type { Box } from '../camera/standard_views';
import { center } from '../camera/standard_views';
import { project, type Projection } from '../camera/projection';
import { addScaled, vector, type Pixel, type Vector } from '../camera/vector';

export type AxisName = 'x' | 'y' | 'z';
export const axisNames: readonly AxisName[] = ['x', 'y', 'z'];

/** The drag handle at the centre of one side of a box. */
export interface Handle {
  readonly axis: AxisName;
  readonly end: 'min' | 'max';
  readonly at: Vector;
}

const unit: Readonly<Record<AxisName, Vector>> = { x: vector(1, 0, 0), y: vector(0, 1, 0), z: vector(0, 0, 1) };

export function handlesOf(box: Box): Handle[] {
  const middle = center(box);
  return axisNames.flatMap((axis) =>
    (['min', 'max'] as const).map((end) => ({ axis, end, at: { ...middle, [axis]: box[end][axis] } })),
  );
}

/** The handle nearest to a pixel, if it is within reach. */
export function handleAt(box: Box, view: Projection, pixel: Pixel, reach: number): Handle | undefined {
  let best: Handle | undefined;
  let nearest = reach;
  for (const handle of handlesOf(box)) {
    const at = project(view, handle.at);
    const far = at ? Math.hypot(at.x - pixel.x, at.y - pixel.y) : Infinity;
    if (far < nearest) [best, nearest] = [handle, far];
  }
  return best;
}

/**
 * Distance along its axis by which a handle follows a pointer movement of `moved` pixels: the component of the movement
 * along the axis as projected onto the picture.
 */
export function pullOf(handle: Handle, view: Projection, moved: Pixel, size: number): number {
  const step = size * 1e-3;
  const from = project(view, handle.at);
  const to = project(view, addScaled(handle.at, unit[handle.axis], step));
  if (!from || !to) return 0;
  const along = { x: (to.x - from.x) / step, y: (to.y - from.y) / step }; // pixels per world unit
  const perUnit = along.x ** 2 + along.y ** 2;
  // An axis that points at the eye projects to a point and has no direction on the screen.
  return perUnit * size * size < 1 ? 0 : (moved.x * along.x + moved.y * along.y) / perUnit;
}

/** The box with one side moved. A side pushes the opposite one along, so that min never exceeds max. */
export function pulled(box: Box, handle: Pick<Handle, 'axis' | 'end'>, to: number): Box {
  const { axis, end } = handle;
  const moved = { ...box, [end]: { ...box[end], [axis]: to } };
  const other = end === 'min' ? 'max' : 'min';
  const crossed = moved.min[axis] > moved.max[axis];
  return crossed ? { ...moved, [other]: { ...box[other], [axis]: to } } : moved;
}
