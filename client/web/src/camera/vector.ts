/** A point or direction in world coordinates of the source file, in double precision. */
export interface Vector {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

/** A position or offset on the screen: x to the right, y down. */
export interface Pixel {
  readonly x: number;
  readonly y: number;
}

export const vector = (x: number, y: number, z: number): Vector => ({ x, y, z });

export const add = (a: Vector, b: Vector): Vector => vector(a.x + b.x, a.y + b.y, a.z + b.z);
export const subtract = (a: Vector, b: Vector): Vector => vector(a.x - b.x, a.y - b.y, a.z - b.z);
export const scale = (a: Vector, s: number): Vector => vector(a.x * s, a.y * s, a.z * s);
export const dot = (a: Vector, b: Vector): number => a.x * b.x + a.y * b.y + a.z * b.z;
export const length = (a: Vector): number => Math.hypot(a.x, a.y, a.z);
export const distance = (a: Vector, b: Vector): number => length(subtract(a, b));
export const mix = (a: Vector, b: Vector, t: number): Vector => add(a, scale(subtract(b, a), t));

export const cross = (a: Vector, b: Vector): Vector =>
  vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);

/** a + s b */
export const addScaled = (a: Vector, b: Vector, s: number): Vector => add(a, scale(b, s));

export function normalize(a: Vector): Vector {
  const size = length(a);
  return size > 0 ? scale(a, 1 / size) : a;
}
