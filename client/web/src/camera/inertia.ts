import type { Pixel } from './vector';

/** A hand's recent movement on the screen, and what goes on after it lets go. Pixels and milliseconds. */
export interface Sample {
  readonly time: number;
  readonly at: Pixel;
}

const memory = 80; // ms: older movement says nothing about how the hand left the screen
const stopped = 40; // ms without movement: the hand had come to rest
const slowest = 0.02; // pixels per ms below which nothing moves on
/** ms in which the speed of a drag that has let go falls to 1/e */
export const coastDecay = 180;

export function recent(samples: readonly Sample[], now: number): Sample[] {
  return samples.filter((sample) => now - sample.time <= memory);
}

/** Pixels per ms at which the hand let go; 0 if it had stopped. */
export function releaseVelocity(samples: readonly Sample[], now: number): Pixel {
  const kept = recent(samples, now);
  const [first, last] = [kept[0], kept[kept.length - 1]];
  if (!first || !last || now - last.time > stopped || last.time - first.time < 1) return { x: 0, y: 0 };
  const elapsed = last.time - first.time;
  return { x: (last.at.x - first.at.x) / elapsed, y: (last.at.y - first.at.y) / elapsed };
}

/** How far it coasts in `elapsed` ms, and the speed after them; at rest once too slow to see. */
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
