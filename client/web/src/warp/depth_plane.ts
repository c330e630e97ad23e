import type { DepthPlane as WirePlane } from '../generated/surfcast_pb';
import type { Size } from '../protocol/pictures';

/** Inverse depth of the nearest surface in each square of `cell` x `cell` pixels of a picture, in rows from the top. */
export interface DepthPlane {
  readonly picture: Size; // pixels
  readonly cell: number; // pixels
  readonly width: number; // texels
  readonly height: number;
  readonly values: Float32Array; // per world unit, along the view axis; 0: background
  readonly first: number; // least value of a surface
  readonly last: number; // largest value
  readonly seenThrough: boolean; // pixels may show things at several depths
}

/** A plane as it is received. */
export type EncodedPlane = Pick<WirePlane, 'width' | 'height' | 'cell' | 'first' | 'last' | 'seenThrough' | 'codes'>;

const maxTexels = 2 ** 20;
const steps = 254; // between the codes 1 and 255, even ones of the logarithm

/** Decodes the depth of a picture of the given size. Rejects planes that are damaged or do not fit the picture. */
export async function decodePlane(plane: EncodedPlane, picture: Size): Promise<DepthPlane> {
  const { width, height, cell, first, last, seenThrough } = plane;
  check(cell >= 1 && picture.width >= 1 && picture.height >= 1, 'no size');
  check(width === Math.ceil(picture.width / cell) && height === Math.ceil(picture.height / cell), 'another size');
  check(width * height <= maxTexels, 'too many texels');
  check(Number.isFinite(first) && Number.isFinite(last) && first > 0 && first < last, 'an invalid range');
  const codes = await inflate(plane.codes, width * height);
  undoPrediction(codes, width);
  return { picture, cell, width, height, values: valuesOf(codes, first, last), first, last, seenThrough };
}

/** The same depths in squares of twice the size, each with its nearest surface. */
export function coarser(plane: DepthPlane): DepthPlane {
  const width = Math.ceil(plane.width / 2);
  const height = Math.ceil(plane.height / 2);
  const values = new Float32Array(width * height);
  for (let i = 0; i < plane.values.length; ++i) {
    const row = Math.floor(i / plane.width);
    const to = (row >> 1) * width + ((i - row * plane.width) >> 1);
    values[to] = Math.max(values[to]!, plane.values[i]!);
  }
  return { ...plane, cell: 2 * plane.cell, width, height, values };
}

function check(holds: boolean, problem: string): asserts holds {
  if (!holds) throw new Error(`a plane of depth with ${problem}`);
}

/** Inflates data (RFC 1950) of a known size. Output beyond it is not asked for. */
async function inflate(data: Uint8Array, size: number): Promise<Uint8Array> {
  const stream = new Blob([data as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new DecompressionStream('deflate'));
  const reader = stream.getReader();
  const bytes = new Uint8Array(size);
  let at = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (at + value.length > size) {
      void reader.cancel().catch(() => undefined);
      throw new Error('a plane of depth with too much data');
    }
    bytes.set(value, at);
    at += value.length;
  }
  check(at === size, 'too little data');
  return bytes;
}

/** Codes from their differences to `left + above - upper left`, in place. */
export function undoPrediction(codes: Uint8Array, width: number): void {
  for (let i = 1; i < codes.length; ++i) {
    const column = i % width;
    const left = column > 0 ? codes[i - 1]! : 0;
    const above = i >= width ? codes[i - width]! : 0;
    let prediction = i < width ? left : above;
    if (i >= width && column > 0) prediction = Math.min(255, Math.max(0, left + above - codes[i - width - 1]!));
    codes[i] = codes[i]! + prediction; // modulo 256
  }
}

function valuesOf(codes: Uint8Array, first: number, last: number): Float32Array {
  const table = Float32Array.from({ length: 256 }, (_, code) =>
    code === 0 ? 0 : first * (last / first) ** ((code - 1) / steps),
  );
  return Float32Array.from(codes, (code) => table[code]!);
}
