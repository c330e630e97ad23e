import { Buffer } from 'node:buffer';

/** A point of the test scan as stored in the file: integers on the lattice of the header. */
export interface LasPoint {
  readonly x: number;
  readonly y: number;
  readonly z: number;
  readonly intensity: number;
  readonly classification: number;
  readonly color: readonly [number, number, number]; // 16 bits
}

export const lattice = 0.001;
export const offset = { x: 452_000, y: 5_411_000, z: 200 };

/** World coordinates, computed as every LAS reader does. */
export const worldOf = (p: LasPoint): [number, number, number] => [
  p.x * lattice + offset.x,
  p.y * lattice + offset.y,
  p.z * lattice + offset.z,
];

const wide = 24; // metres, each way
const step = 0.08; // metres between points
const block = { from: 9, to: 15, height: 5 }; // a house without windows

function point(x: number, y: number, z: number, classification: number): LasPoint {
  const shade = 0.55 + 0.45 * Math.sin(1.9 * x) * Math.cos(1.3 * y + z);
  const tint = classification === 6 ? [1, 0.45, 0.3] : [0.45, 0.8, 0.35];
  const color = tint.map((part) => Math.round(65_535 * part * shade)) as [number, number, number];
  const grid = (value: number): number => Math.round(value / lattice);
  const intensity = Math.round(1000 + 900 * Math.sin(x) * Math.sin(y));
  return { x: grid(x), y: grid(y), z: grid(z), intensity, classification, color };
}

const steps = (from: number, to: number): number[] =>
  Array.from({ length: Math.round((to - from) / step) + 1 }, (_, i) => from + i * step);

/** Rolling ground (class 2) with a block on it (class 6). */
export function makeScene(): LasPoint[] {
  const { from, to, height } = block;
  const points: LasPoint[] = [];
  for (const x of steps(0, wide)) for (const y of steps(0, wide)) points.push(point(x, y, 0.6 * Math.sin(x / 4), 2));
  for (const a of steps(from, to)) {
    for (const b of steps(from, to)) points.push(point(a, b, height, 6));
    for (const z of steps(0, height)) {
      points.push(point(a, from, z, 6), point(a, to, z, 6), point(from, a, z, 6), point(to, a, z, 6));
    }
  }
  return points;
}

const headerBytes = 227;
const recordBytes = 34; // point format 3

/** LAS 1.2, point format 3. */
export function encodeLas(points: readonly LasPoint[]): Buffer {
  const file = Buffer.alloc(headerBytes + points.length * recordBytes);
  file.write('LASF');
  file.writeUInt8(1, 24);
  file.writeUInt8(2, 25);
  file.writeUInt16LE(headerBytes, 94);
  file.writeUInt32LE(headerBytes, 96);
  file.writeUInt8(3, 104);
  file.writeUInt16LE(recordBytes, 105);
  file.writeUInt32LE(points.length, 107);
  [lattice, lattice, lattice, offset.x, offset.y, offset.z].forEach((v, i) => file.writeDoubleLE(v, 131 + 8 * i));
  const world = points.map(worldOf);
  for (let axis = 0; axis < 3; ++axis) {
    const values = world.map((p) => p[axis]!);
    file.writeDoubleLE(values.reduce((a, b) => Math.max(a, b)), 179 + 16 * axis);
    file.writeDoubleLE(values.reduce((a, b) => Math.min(a, b)), 187 + 16 * axis);
  }
  points.forEach((p, i) => writeRecord(file, headerBytes + i * recordBytes, p));
  return file;
}

function writeRecord(file: Buffer, at: number, p: LasPoint): void {
  [p.x, p.y, p.z].forEach((v, i) => file.writeInt32LE(v, at + 4 * i));
  file.writeUInt16LE(p.intensity, at + 12);
  file.writeUInt8(p.classification, at + 15);
  p.color.forEach((v, i) => file.writeUInt16LE(v, at + 28 + 2 * i));
}
