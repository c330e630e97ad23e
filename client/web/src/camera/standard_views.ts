import { axesOf, poseAxes, type Pose, type UpAxis } from './pose';
import { addScaled, dot, length, mix, subtract, vector, type Vector } from './vector';

export interface Box {
  readonly min: Vector;
  readonly max: Vector;
}

export const center = (box: Box): Vector => mix(box.min, box.max, 0.5);
export const diagonal = (box: Box): number => length(subtract(box.max, box.min));

export function corners(box: Box): Vector[] {
  const { min, max } = box;
  const points: Vector[] = [];
  for (const z of [min.z, max.z]) {
    for (const y of [min.y, max.y]) for (const x of [min.x, max.x]) points.push(vector(x, y, z));
  }
  return points;
}

export type ViewName = 'front' | 'back' | 'left' | 'right' | 'top' | 'bottom' | 'iso';

const quarter = Math.PI / 2;
/** Yaw and pitch of each view. The front view looks along y of a z-up model and along -z of a y-up model. */
const directions: Readonly<Record<ViewName, readonly [number, number]>> = {
  front: [0, 0],
  back: [2 * quarter, 0],
  left: [quarter, 0],
  right: [-quarter, 0],
  top: [0, -quarter],
  bottom: [0, quarter],
  iso: [-quarter / 2, -Math.atan(Math.SQRT1_2)],
};

export const viewNames = Object.keys(directions) as readonly ViewName[];

/** Computes, for one axis of the picture, the offset and the least distance of an eye that sees all included points. */
class AxisFit {
  private lowest = Infinity;
  private highest = -Infinity;

  constructor(private readonly tangent: number) {}

  /** Includes a point. `extent` is its offset along the axis, `nearer` towards the eye, both from the box's middle. */
  include(extent: number, nearer: number): void {
    this.lowest = Math.min(this.lowest, extent - this.tangent * nearer);
    this.highest = Math.max(this.highest, extent + this.tangent * nearer);
  }

  get offset(): number {
    return (this.lowest + this.highest) / 2;
  }

  get distance(): number {
    return (this.highest - this.lowest) / (2 * this.tangent);
  }
}

/**
 * The nearest pose with the same view direction that shows the whole box. Each corner gives two bounds of the eye's
 * position for each axis of the picture: |extent - offset| <= tangent * (distance - nearer).
 */
export function fit(pose: Pose, up: UpAxis, box: Box, aspect: number): Pose {
  const axes = poseAxes(pose, up);
  const middle = center(box);
  const tangent = Math.tan((pose.viewAngle * Math.PI) / 360) * 0.95; // a margin of 5 %
  const across = new AxisFit(tangent * aspect);
  const along = new AxisFit(tangent);
  for (const corner of corners(box)) {
    const offset = subtract(corner, middle);
    const nearer = -dot(offset, axes.forward);
    across.include(dot(offset, axes.right), nearer);
    along.include(dot(offset, axes.up), nearer);
  }
  const distance = Math.max(diagonal(box) * 1e-3, across.distance, along.distance);
  const target = addScaled(addScaled(middle, axes.right, across.offset), axes.up, along.offset);
  return { ...pose, distance, position: addScaled(target, axes.forward, -distance) };
}

/** The whole box in a standard view. */
export function standardView(name: ViewName, pose: Pose, up: UpAxis, box: Box, aspect: number): Pose {
  const [yaw, pitch] = directions[name];
  return fit({ ...pose, yaw, pitch }, up, box, aspect);
}

/** The standard view whose direction is closest to the given one, for the axes of the gizmo. */
export function viewAlong(direction: Vector, up: UpAxis): ViewName {
  const sides = viewNames.filter((name) => name !== 'iso');
  const agreement = (name: ViewName): number => dot(axesOf(...directions[name], up).forward, direction);
  return sides.reduce((best, name) => (agreement(name) > agreement(best) ? name : best));
}
