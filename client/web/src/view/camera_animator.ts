import { coast, coastDecay } from '../camera/inertia';
import { between, ease, fly, type Course } from '../camera/motion';
import type { Pose, UpAxis } from '../camera/pose';
import type { Pixel } from '../camera/vector';

/** Applies a movement in pixels to a pose, during a drag or its inertia. */
export type Drag = (pose: Pose, moved: Pixel) => Pose;

type Motion =
  | { readonly kind: 'travel'; readonly from: Pose; readonly to: Pose; readonly start: number; readonly length: number }
  | { readonly kind: 'coast'; velocity: Pixel; readonly drag: Drag; readonly decay: number };

/**
 * Movement of the eye without a drag: travel to another pose, coasting after a drag, flight while keys are held. The
 * caller passes the time in ms, so that tests can choose it.
 */
export class CameraAnimator {
  private motion: Motion | undefined;
  private course: Course = { right: 0, forward: 0, up: 0 };
  private speed = 0; // world units per ms
  private last: number | undefined;

  stop(): void {
    this.motion = undefined;
  }

  travel(from: Pose, to: Pose, now: number, length: number): void {
    this.motion = { kind: 'travel', from, to, start: now, length };
  }

  /** Coasts at a speed that falls to 1/e in `decay` ms. The total distance is `velocity` times `decay`. */
  coastOn(velocity: Pixel, drag: Drag, decay: number = coastDecay): void {
    this.motion = { kind: 'coast', velocity, drag, decay };
  }

  /** Remaining distance of coasting, pixels. */
  get left(): Pixel {
    if (this.motion?.kind !== 'coast') return { x: 0, y: 0 };
    const { velocity, decay } = this.motion;
    return { x: velocity.x * decay, y: velocity.y * decay };
  }

  flyAlong(course: Course, speed: number): void {
    this.course = course;
    this.speed = speed;
  }

  get moving(): boolean {
    return this.motion !== undefined || this.flying;
  }

  private get flying(): boolean {
    return this.course.right !== 0 || this.course.forward !== 0 || this.course.up !== 0;
  }

  /** The pose at `now`. Times must not decrease. */
  step(pose: Pose, up: UpAxis, now: number): Pose {
    const elapsed = Math.min(100, now - (this.last ?? now));
    this.last = this.moving ? now : undefined;
    let next = this.flying ? fly(pose, up, this.course, this.speed * elapsed) : pose;
    if (this.motion?.kind === 'travel') next = this.travelled(this.motion, up, now);
    else if (this.motion?.kind === 'coast') next = this.coasted(this.motion, next, elapsed);
    if (!this.moving) this.last = undefined;
    return next;
  }

  private travelled(motion: Motion & { kind: 'travel' }, up: UpAxis, now: number): Pose {
    const t = motion.length > 0 ? (now - motion.start) / motion.length : 1;
    if (t < 1) return between(motion.from, motion.to, up, ease(Math.max(0, t)));
    this.motion = undefined;
    return motion.to;
  }

  private coasted(motion: Motion & { kind: 'coast' }, pose: Pose, elapsed: number): Pose {
    const { moved, velocity, moving } = coast(motion.velocity, elapsed, motion.decay);
    motion.velocity = velocity;
    if (!moving) this.motion = undefined;
    return motion.drag(pose, moved);
  }
}
