import { afterAll, beforeAll, beforeEach, describe, expect, it } from 'vitest';
import type { Projection } from '../src/camera/projection';
import type { DepthPlane } from '../src/warp/depth_plane';
import type * as WarpMeshModule from '../src/warp/warp_mesh';
import type * as WarpPainterModule from '../src/warp/warp_painter';
import { Session, use } from './support/session';
import { Sources } from './support/sources';

/** Pictures that the warp draws of made-up frames, against what a camera would see. */

type Rgb = readonly [number, number, number];

/** A frame whose pixels and depths are functions of the pixel, which must not use anything else. */
interface Frame {
  readonly color: (x: number, y: number) => Rgb;
  readonly depth: (x: number, y: number) => number; // inverse, at the centre of a cell
  readonly cell: number;
  readonly projection: Projection;
}

const session = use(new Session());
let sources: Sources;
beforeAll(async () => (sources = await Sources.start()));
afterAll(() => sources.stop());
beforeEach(() => sources.open(session.page));

const axes = { right: { x: 1, y: 0, z: 0 }, up: { x: 0, y: 0, z: 1 }, forward: { x: 0, y: 1, z: 0 } };
const camera = (x = 0, y = 0, size = 1): Projection => ({
  ...{ eye: { x, y, z: 0 }, axes, eta: 200 * size, width: 320 * size, height: 180 * size },
});

/** The camera turned to the right about its eye. */
function turned(radians: number): Projection {
  const [s, c] = [Math.sin(radians), Math.cos(radians)];
  return { ...camera(), axes: { right: { x: c, y: -s, z: 0 }, up: axes.up, forward: { x: s, y: c, z: 0 } } };
}

/** The pixels, rows from the top, each red, green and blue. */
async function warped(below: Frame, above: Frame | undefined, target: Projection): Promise<Uint8Array> {
  const passed = [below, above].map((frame) => frame && { ...frame, color: `${frame.color}`, depth: `${frame.depth}` });
  const base64 = await session.page.evaluate(
    async ({ passed, target, modules }) => {
      const { WarpPainter } = (await window.load(modules.painter)) as typeof WarpPainterModule;
      const { meshOf } = (await window.load(modules.mesh)) as typeof WarpMeshModule;
      const evaluated = <T>(text: string): T => (0, eval)(`(${text})`) as T;
      const sourceOf = async (frame: NonNullable<(typeof passed)[0]>): Promise<WarpPainterModule.WarpSource> => {
        const { width, height } = frame.projection;
        const color = evaluated<Frame['color']>(frame.color);
        const depthAt = evaluated<Frame['depth']>(frame.depth);
        const pixels = new Uint8ClampedArray(4 * width * height);
        for (let i = 0; i < width * height; ++i) {
          pixels.set([...color((i % width) + 0.5, Math.floor(i / width) + 0.5), 255], 4 * i);
        }
        const { cell } = frame;
        const [columns, rows] = [Math.ceil(width / cell), Math.ceil(height / cell)];
        const values = Float32Array.from({ length: columns * rows }, (_, i) => {
          const x = ((i % columns) * cell + Math.min(width, ((i % columns) + 1) * cell)) / 2;
          const row = Math.floor(i / columns);
          return depthAt(x, (row * cell + Math.min(height, (row + 1) * cell)) / 2);
        });
        const depth: DepthPlane = {
          ...{ picture: { width, height }, cell, width: columns, height: rows, values },
          ...{ first: 0.001, last: Math.max(...values), seenThrough: false },
        };
        const bitmap = await createImageBitmap(new ImageData(pixels, width, height), { premultiplyAlpha: 'none' });
        const background = { red: 0, green: 0, blue: 0 };
        return { bitmap, depth, mesh: meshOf(depth), projection: frame.projection, background };
      };
      const canvas = document.createElement('canvas');
      const painter = WarpPainter.on(canvas, () => undefined)!;
      const [below, above] = [await sourceOf(passed[0]!), passed[1] && (await sourceOf(passed[1]))];
      painter.draw(below, above, target);
      const gl = canvas.getContext('webgl2')!;
      const { width, height } = target;
      const bytes = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      let text = ''; // an array of as many numbers would take seconds to get here
      for (let y = height - 1; y >= 0; --y) {
        for (let x = 0; x < width; ++x) {
          const at = 4 * (y * width + x);
          text += String.fromCharCode(bytes[at]!, bytes[at + 1]!, bytes[at + 2]!);
        }
      }
      return btoa(text);
    },
    { passed, target, modules: { painter: '/src/warp/warp_painter.ts', mesh: '/src/warp/warp_mesh.ts' } },
  );
  return Buffer.from(base64, 'base64');
}

const noise = (x: number, y: number): Rgb => {
  const hash = (k: number): number => Math.abs(Math.floor(Math.sin(x * 12.9898 + y * 78.233 + k) * 43758.5453));
  const value = (k: number): number => 55 + (hash(k) % 200); // never that of the background
  return [value(1), value(2), value(3)];
};

const smooth = (x: number, y: number): Rgb => [
  Math.round(128 + 100 * Math.sin(x / 40)),
  Math.round(128 + 100 * Math.cos(y / 30)),
  Math.round(128 + 50 * Math.sin((x + y) / 50)),
];

/** Number of pixels that a function of the pixel and its colour counts. */
function count(pixels: Uint8Array, counts: (x: number, y: number, color: Rgb) => boolean): number {
  let sum = 0;
  for (let i = 0; i < pixels.length / 3; ++i) {
    const color = [pixels[3 * i]!, pixels[3 * i + 1]!, pixels[3 * i + 2]!] as const;
    if (counts((i % 320) + 0.5, Math.floor(i / 320) + 0.5, color)) sum += 1;
  }
  return sum;
}

const isRed = ([r, g]: Rgb): boolean => r > 128 && g < 128;
const isGreen = ([r, g]: Rgb): boolean => g > 128 && r < 128;

// A red square at a distance of 2 before a green wall at 10; the eye moves by 0.1: by 10 pixels and by 2.
const inSquare = (x: number, y: number): boolean => x > 112 && x < 208 && y > 48 && y < 128;
const square: Frame = {
  color: (x, y) => (x > 112 && x < 208 && y > 48 && y < 128 ? [255, 0, 0] : [0, 255, 0]),
  depth: (x, y) => (x > 112 && x < 208 && y > 48 && y < 128 ? 0.5 : 0.1),
  cell: 8,
  projection: camera(),
};

describe('a frame', () => {
  it('is itself for its own camera, to the last byte, with all its cuts', async () => {
    const depth = (x: number, y: number): number => (x > 100 && x < 200 && y > 60 && y < 120 ? 0.5 : x < 50 ? 0 : 0.1);
    const frame: Frame = { color: noise, depth, cell: 8, projection: camera() };
    const open = '0,0,0'; // of the background
    for (const rest of [undefined, frame]) {
      const pixels = await warped(frame, rest, camera());
      expect(count(pixels, (x, y, color) => `${color}` !== (x < 48 ? open : `${noise(x, y)}`))).toBe(0);
    }
  });

  it('takes no background with it at the edge of a surface', async () => {
    const frame: Frame = {
      color: (x) => (x < 101 ? [255, 0, 0] : [0, 0, 0]), // the last cell of the surface has 3 columns of background
      depth: (x) => (x < 104 ? 0.5 : 0),
      cell: 8,
      projection: camera(),
    };
    const wall: Frame = { ...frame, color: () => [0, 255, 0], depth: () => 0.1 };
    const pixels = await warped(frame, wall, camera(0.1)); // the surface moves by 10 pixels
    expect(count(pixels, (x, _y, [r, g]) => x < 90 && (r < 250 || g > 5))).toBe(0);
    expect(count(pixels, (x, _y, [r, g]) => x > 92 && x < 94 && r + g < 100)).toBe(0);
  });

  it('turns as a homography, whatever its depth', async () => {
    const target = turned(0.1);
    const depth = (x: number): number => (x < 104 ? 0.4 : 0.1 + x / 1000);
    const pixels = await warped({ color: smooth, depth, cell: 8, projection: camera() }, undefined, target);
    const wrong = count(pixels, (x, y, color) => {
      const [a, b] = [(x - 160) / 200, (90 - y) / 200];
      const { right, forward } = target.axes;
      const [dx, dy] = [forward.x + a * right.x, forward.y + a * right.y];
      const [sx, sy] = [160 + (200 * dx) / dy, 90 - (200 * b) / dy];
      if (sx < 1 || sy < 1 || sx > 319 || sy > 179) return false; // from outside of the frame
      const expected = smooth(sx, sy);
      return color.some((level, i) => Math.abs(level - expected[i]!) > 2); // 1 of rounding, 1 of interpolation
    });
    expect(wrong).toBe(0);
  });

  it('shows a near square where it is, and behind it no streak of it', async () => {
    for (const moved of [0.1, -0.1]) {
      const pixels = await warped(square, undefined, camera(moved));
      const shift = 100 * moved;
      const beyond = count(pixels, (x, y, color) => {
        const near = [-1, 0, 1].some((dx) => [-1, 0, 1].some((dy) => inSquare(x + shift + dx, y + dy)));
        return !near && !isGreen(color) && x > 4 && x < 316; // the wall goes 2 pixels away from the border
      });
      expect(beyond).toBe(0);
      expect(count(pixels, (x, y, color) => inSquare(x + shift, y) && !isRed(color))).toBeLessThan(2 * 80);
    }
  });

  it('shows in a cell before an outline what is behind where that is', async () => {
    // The last cell of the near surface has 3 columns of what is behind, which move by 2 pixels and not by 10.
    const frame: Frame = {
      color: (x) => (x < 101 ? [255, 0, 0] : [0, 255, 0]),
      depth: (x) => (x < 104 ? 0.5 : 0.1),
      cell: 8,
      projection: camera(),
    };
    for (const moved of [0.1, -0.1]) {
      const pixels = await warped(frame, undefined, camera(moved));
      const edge = 101 - 100 * moved;
      expect(count(pixels, (x, _y, color) => Math.abs(x - edge) > 1 && isRed(color) !== x < edge)).toBe(0);
    }
  });

  it('goes on beyond its border for an eye that turns, as far as a quarter of its height', async () => {
    const color = (_x: number, y: number): Rgb => (y < 90 ? [255, 0, 0] : [0, 255, 0]);
    const frame: Frame = { color, depth: () => 0.1, cell: 8, projection: camera() };
    const pixels = await warped(frame, undefined, turned(0.1)); // by about 25 pixels, and 36 at the border
    const wrong = (y: number, color: Rgb, near: number): boolean =>
      y < 90 - near ? !isRed(color) : y > 90 + near && !isGreen(color);
    expect(count(pixels, (x, y, color) => x < 280 && wrong(y, color, 5))).toBe(0); // what the frame shows
    expect(count(pixels, (_x, y, color) => wrong(y, color, 24))).toBe(0); // beyond, the fill colors mix three cells
    const open = await warped({ ...frame, depth: () => 0 }, undefined, turned(0.1));
    expect(count(open, (_x, _y, color) => `${color}` !== '0,0,0')).toBe(0);
  });

  it('is reflected at its border, and the reflection fades to the mean color there', async () => {
    const color = (x: number): Rgb => (x % 16 < 8 ? [200, 200, 200] : [100, 100, 100]);
    const target = turned(0.1);
    const pixels = await warped({ color, depth: () => 0.1, cell: 8, projection: camera() }, undefined, target);
    let compared = 0;
    for (let x = 0.5; x < 320; ++x) {
      const direction = Math.atan((x - 160) / 200) + 0.1;
      const beyond = 160 + 200 * Math.tan(direction) - 320; // pixels of the frame
      if (beyond < 0 || Math.abs(((beyond + 4) % 8) - 4) < 1.5) continue; // between two stripes
      const reflected = color(320 - beyond)[0];
      const kept = Math.max(0, 1 - beyond / 45) ** 2;
      const level = pixels[3 * (90 * 320 + Math.floor(x))]!;
      // The mean of the last three cells, of which two are dark.
      expect(Math.abs(level - (kept * reflected + (1 - kept) * 133)), `column ${x}`).toBeLessThan(8);
      compared += 1;
    }
    expect(compared).toBeGreaterThan(15);
  });

  it('fills what opens behind a surface with the mean color of what is behind', async () => {
    const color = (x: number, y: number): Rgb =>
      x > 112 && x < 208 && y > 48 && y < 128 ? [255, 0, 0] : (x + y) % 2 === 0 ? [0, 100, 0] : [0, 200, 0];
    const pixels = await warped({ ...square, color }, undefined, camera(0.3)); // by 30 pixels, and the wall by 6
    const opened = (x: number, y: number): boolean => x > 182 && x < 198 && y > 60 && y < 116;
    expect(count(pixels, (x, y, [r, g, b]) => opened(x, y) && Math.abs(g - 150) + r + b > 6)).toBe(0);
  });

  it('is cut off before the eye, and not seen from behind', async () => {
    const pixels = await warped(square, undefined, camera(0, 3)); // past the square
    expect(count(pixels, (_x, _y, color) => isRed(color))).toBe(0);
  });
});

describe('a frame at rest over a newer one', () => {
  const wall = (color: Frame['color'], size = 1): Frame => ({
    ...{ color, depth: () => 0.1, cell: 8, projection: camera(0, 0, size) },
  });

  it('shows what both agree on', async () => {
    const pixels = await warped(wall(() => [255, 0, 0], 0.5), wall(() => [0, 255, 0]), camera(0.05));
    expect(count(pixels, (x, _y, color) => x < 316 && !isGreen(color))).toBe(0);
  });

  it('shows no surface that the newer one shows a nearer one before, or has gone', async () => {
    const color = (x: number): Rgb => (x < 160 ? [255, 0, 0] : [200, 0, 0]); // or there would be no outline to see
    const open: Frame = { ...wall(color), depth: (x) => (x < 160 ? 0.5 : 0.1) };
    const under = await warped(open, wall(() => [0, 255, 0]), camera());
    expect(count(under, (x, _y, color) => x < 156 && !isRed(color))).toBe(0);
    expect(count(under, (x, _y, color) => x > 164 && !isGreen(color))).toBe(0);
    const gone = await warped({ ...open, depth: (x) => (x < 160 ? 0 : 0.1) }, wall(() => [0, 255, 0]), camera());
    expect(count(gone, (x, _y, color) => x < 152 && isGreen(color))).toBe(0);
  });

  it('shows what the newer one does not, and only makes up', async () => {
    // Behind the square the newer one makes up the wall; the older one has seen it.
    const older = wall(() => [0, 0, 255]);
    const pixels = await warped(square, older, camera(0.3));
    const isBlue = ([r, g, b]: Rgb): boolean => b > 128 && r + g < 128;
    const opened = (x: number, y: number): boolean => x > 182 && x < 200 && y > 56 && y < 120; // from 178 to 202
    expect(count(pixels, (x, y, color) => opened(x, y) && !isBlue(color))).toBe(0);
    // Beyond the border, too.
    const beside = await warped(wall(() => [255, 0, 0]), { ...older, projection: turned(0.1) }, turned(0.1));
    expect(count(beside, (x, _y, color) => x > 300 && !isBlue(color))).toBe(0);
  });

  it('leaves to the newer one what is stretched more', async () => {
    // Ahead by 6 of 10, the older frame has 0.4 of a pixel for each; the newer one, of half the size, has half a pixel.
    const newer: Frame = { ...wall(() => [255, 0, 0], 0.5), depth: () => 0.25, projection: camera(0, 6, 0.5) };
    const pixels = await warped(newer, wall(() => [0, 255, 0]), camera(0, 6));
    expect(count(pixels, (_x, _y, color) => !isRed(color))).toBe(0);
    const farther = { ...newer, depth: () => 1 / 6, projection: camera(0, 4, 0.5) };
    const near = await warped(farther, wall(() => [0, 255, 0]), camera(0, 4));
    expect(count(near, (_x, _y, color) => !isGreen(color))).toBe(0);
  });

  it('leaves to the newer one what it saw from far around', async () => {
    const newer = (x: number): Frame => ({ ...wall(() => [255, 0, 0]), projection: camera(x) });
    const middle = (x: number, y: number): boolean => Math.abs(x - 160) < 4 && Math.abs(y - 90) < 4;
    for (const [x, isShown] of [[4, isGreen], [6, isRed]] as const) { // by 22 and by 31 degrees
      const pixels = await warped(newer(x), wall(() => [0, 255, 0]), camera(x));
      expect(count(pixels, (x, y, color) => middle(x, y) && !isShown(color))).toBe(0);
    }
    // Where the newer one shows nothing, even that is better.
    const target = { ...turned(-0.1), eye: camera(6).eye };
    const beside = await warped(newer(6), wall(() => [0, 255, 0]), target);
    expect(count(beside, (x, y, color) => x < 20 && Math.abs(y - 90) < 60 && !isGreen(color))).toBe(0);
  });
});
