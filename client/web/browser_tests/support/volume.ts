/** A ball in a volume: values fall from 1000 in the centre to 0 at its edge and beyond. */

const side = 33;

function samples(): Buffer {
  const bytes = Buffer.alloc(side ** 3 * 2);
  const middle = (side - 1) / 2;
  for (let k = 0; k < side; ++k) {
    for (let j = 0; j < side; ++j) {
      for (let i = 0; i < side; ++i) {
        const distance = Math.hypot(i - middle, j - middle, k - middle);
        const value = Math.max(0, Math.round(1000 * (1 - distance / middle)));
        bytes.writeUInt16LE(value, 2 * ((k * side + j) * side + i));
      }
    }
  }
  return bytes;
}

const nrrd = `NRRD0004
type: uint16
dimension: 3
sizes: ${side} ${side} ${side}
spacings: 1 1 1
endian: little
encoding: raw
`;

/** The volume in one file. */
export const ballNrrd = (): Buffer => Buffer.concat([Buffer.from(`${nrrd}\n`), samples()]);

/** The volume in two: the name of the second is in the first. */
export function detachedBall(data: string): { readonly header: Buffer; readonly samples: Buffer } {
  return { header: Buffer.from(`${nrrd}data file: ${data}\n`), samples: samples() };
}
