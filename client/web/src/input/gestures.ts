import type { Pixel } from '../camera/vector';

/** The movement of two fingers between two events. */
export interface Pinch {
  readonly center: Pixel; // midpoint of the fingers, now
  readonly moved: Pixel; // movement of the midpoint
  readonly spread: number; // ratio of the fingers' distances, now to before
  readonly twist: number; // radians, clockwise on the screen
}

const middle = (a: Pixel, b: Pixel): Pixel => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
const closest = 8; // pixels; at smaller distances spread and twist are not measured

export function pinchBetween(before: readonly [Pixel, Pixel], after: readonly [Pixel, Pixel]): Pinch {
  const center = middle(...after);
  const from = middle(...before);
  const span = ([a, b]: readonly [Pixel, Pixel]): Pixel => ({ x: b.x - a.x, y: b.y - a.y });
  const [u, v] = [span(before), span(after)];
  const [sizeU, sizeV] = [Math.hypot(u.x, u.y), Math.hypot(v.x, v.y)];
  const apart = sizeU >= closest && sizeV >= closest;
  return {
    center,
    moved: { x: center.x - from.x, y: center.y - from.y },
    spread: apart ? sizeV / sizeU : 1,
    twist: apart ? Math.atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y) : 0,
  };
}

/** Scroll distance of a wheel event in pixels. Browsers report pixels, lines or pages. */
export function wheelPixels(event: Pick<WheelEvent, 'deltaY' | 'deltaMode' | 'ctrlKey'>): number {
  const unit = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
  // Browsers report a pinch on a trackpad as small wheel movements with the Ctrl modifier.
  const pinch = event.ctrlKey && event.deltaMode === 0 && Math.abs(event.deltaY) < 50 ? 7 : 1;
  return Math.max(-400, Math.min(400, event.deltaY * unit * pinch));
}

const clickReach = 5; // CSS pixels that the pointer may move during a click
const clickTime = 500; // ms
const doubleTime = 350;
const doubleReach = 16;

export interface Press {
  readonly at: Pixel;
  readonly time: number;
}

export const isClick = (down: Press, up: Press): boolean =>
  up.time - down.time < clickTime && Math.hypot(up.at.x - down.at.x, up.at.y - down.at.y) < clickReach;

export const isDouble = (first: Press | undefined, second: Press): boolean =>
  first !== undefined &&
  second.time - first.time < doubleTime &&
  Math.hypot(second.at.x - first.at.x, second.at.y - first.at.y) < doubleReach;
