import type { Pixel } from './vector';

/** Recent pointer positions of a drag, from which the inertia after its end is computed. Pixels and milliseconds. */
export interface Sample {
  readonly time: number;
  readonly at: Pixel;
}

const memory = 80; // ms: older samples do not count for the release velocity
const stopped = 40; // ms without movement after which the pointer counts as at rest
const slowest = 0.02; // pixels per ms; slower movement stops
/** Time constant of coasting, ms: the speed after a drag falls to 1/e in this time. */
export const coastDecay = 180;

export function recent(samples: readonly Sample[], now: number): Sample[] {
  return samples.filter((sample) => now - sample.time <= memory);
}

/** Velocity of the pointer at its release, pixels per ms; 0 if the pointer was at rest. */
export function releaseVelocity(samples: readonly Sample[], now: number): Pixel {
  const kept = recent(samples, now);
  const [first, last] = [kept[0], kept[kept.length - 1]];
  if (!first || !last || now - last.time > stopped || last.time - first.time < 1) return { x: 0, y: 0 };
  const elapsed = last.time - first.time;
  return { x: (last.at.x - first.at.x) / elapsed, y: (last.at.y - first.at.y) / elapsed };
}

/** Distance coasted in `elapsed` ms, and the velocity afterwards. Coasting ends below the least visible speed. */
export function coast(
  velocity: Pixel,
  elapsed: number,
  decay: number,
): { moved: Pixel; velocity: Pixel; moving: boolean } {
  const kept = Math.exp(-elapsed / decay);
  const reach = decay * (1 - kept);
  const after = { x: velocity.x * kept, y: velocity.y * kept };
  return {
    moved: { x: velocity.x * reach, y: velocity.y * reach },
    velocity: after,
    moving: Math.hypot(after.x, after.y) > slowest,
  };
}
