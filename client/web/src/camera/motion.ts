import { clampPitch, poseAxes, skyOf, type Pose, type UpAxis } from './pose';
import { etaOf } from './projection';
import { addScaled, dot, scale, subtract, type Pixel, type Vector } from './vector';

/** Turns the eye around a point, which stays in place on the screen. Radians. */
export function orbit(pose: Pose, up: UpAxis, pivot: Vector, yaw: number, pitch: number): Pose {
  const before = poseAxes(pose, up);
  const turned = { ...pose, yaw: pose.yaw + yaw, pitch: clampPitch(pose.pitch + pitch) };
  const after = poseAxes(turned, up);
  const offset = subtract(pivot, pose.position);
  let position = addScaled(pivot, after.right, -dot(offset, before.right));
  position = addScaled(position, after.up, -dot(offset, before.up));
  position = addScaled(position, after.forward, -dot(offset, before.forward));
  return { ...turned, position };
}

/** Turns the view direction without moving the eye. Radians. */
export function look(pose: Pose, yaw: number, pitch: number): Pose {
  return { ...pose, yaw: pose.yaw + yaw, pitch: clampPitch(pose.pitch + pitch) };
}

/** Moves the eye parallel to the picture, so that a point at `depth` moves by `drag` pixels. */
export function pan(pose: Pose, up: UpAxis, drag: Pixel, depth: number, height: number): Pose {
  const axes = poseAxes(pose, up);
  const perPixel = depth / etaOf(pose.viewAngle, height);
  const moved = addScaled(pose.position, axes.right, -drag.x * perPixel);
  return { ...pose, position: addScaled(moved, axes.up, drag.y * perPixel) };
}

/** Multiplies the distance of the eye from a point by `factor`. The point stays in place on the screen. */
export function zoom(pose: Pose, target: Vector, factor: number, nearest: number, farthest: number): Pose {
  const bounded = Math.min(farthest / pose.distance, Math.max(nearest / pose.distance, factor));
  return {
    ...pose,
    position: addScaled(target, subtract(pose.position, target), bounded),
    distance: pose.distance * bounded,
  };
}

/** Direction of flight; each component is between -1 and 1. */
export interface Course {
  readonly right: number;
  readonly forward: number;
  readonly up: number; // along the model's vertical axis
}

/** Moves the eye by a distance. Forward is the view direction. */
export function fly(pose: Pose, up: UpAxis, course: Course, far: number): Pose {
  const axes = poseAxes(pose, up);
  let step = scale(axes.forward, course.forward);
  step = addScaled(step, axes.right, course.right);
  step = addScaled(step, skyOf(up), course.up);
  const size = Math.hypot(step.x, step.y, step.z);
  return size > 0 ? { ...pose, position: addScaled(pose.position, step, far / Math.max(1, size)) } : pose;
}

/** The signed angle of the shorter turn from one direction to another, radians. */
export function turnBetween(from: number, to: number): number {
  const turn = (to - from) % (2 * Math.PI);
  if (turn > Math.PI) return turn - 2 * Math.PI;
  return turn < -Math.PI ? turn + 2 * Math.PI : turn;
}

/**
 * Interpolates between two poses, t from 0 to 1. The point of interest moves along a straight line, and its distance
 * changes by a constant factor per unit of t.
 */
export function between(from: Pose, to: Pose, up: UpAxis, t: number): Pose {
  const lerp = (a: number, b: number): number => a + (b - a) * t;
  const yaw = from.yaw + turnBetween(from.yaw, to.yaw) * t;
  const pitch = lerp(from.pitch, to.pitch);
  const far = from.distance * (to.distance / from.distance) ** t;
  const interest = (pose: Pose): Vector => addScaled(pose.position, poseAxes(pose, up).forward, pose.distance);
  const point = addScaled(interest(from), subtract(interest(to), interest(from)), t);
  const turned = { yaw, pitch, distance: far, viewAngle: lerp(from.viewAngle, to.viewAngle), position: point };
  return { ...turned, position: addScaled(point, poseAxes(turned, up).forward, -far) };
}

/** Smoothstep: speed 0 at both ends; t from 0 to 1. */
export const ease = (t: number): number => t * t * (3 - 2 * t);
