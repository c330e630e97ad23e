import { create, type MessageInitShape } from '@bufbuild/protobuf';
import { deflateSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { poseAxes, type Camera, type Pose } from '../src/camera/pose';
import { look, orbit } from '../src/camera/motion';
import { pointAt, project, projectionOf, rayOf, type Projection } from '../src/camera/projection';
import { add, addScaled, normalize, vector, type Pixel } from '../src/camera/vector';
import { DrawPictureSchema, ViewFrameSchema, type DepthPlane as WirePlane } from '../src/generated/surfcast_pb';
import { FrameAssembler } from '../src/view/assembler';
import { coarser, decodePlane } from '../src/warp/depth_plane';
import { sameView, shownAs, type LayerFrame } from '../src/warp/layers';
import { clipMatrix, warpBetween, type Warp } from '../src/warp/warp_camera';
import { fillFloats, meshOf, sheetFloats, type WarpMesh } from '../src/warp/warp_mesh';
import { inverseDepthAt, inverseDepthOf, planeOf, wirePlane } from './support/planes';

const sky = vector(0, 0, 1);
const picture = { width: 50, height: 30 };

describe('a plane of depth', () => {
  const codes = Uint8Array.from({ length: 13 * 8 }, (_, i) => (i % 7 === 0 ? 0 : (i * 97) % 256));

  it('is decoded as it was encoded', async () => {
    const plane = await decodePlane(wirePlane(codes, picture, 4, 0.5, 2), picture);
    expect([plane.width, plane.height]).toEqual([13, 8]);
    codes.forEach((code, i) => {
      expect(plane.values[i]).toBeCloseTo(code === 0 ? 0 : 0.5 * 4 ** ((code - 1) / 254), 6);
    });
  });

  it('is decoded where it is one texel wide, and one high', async () => {
    for (const size of [{ width: 4, height: 400 }, { width: 400, height: 4 }]) {
      const line = Uint8Array.from({ length: 100 }, (_, i) => (i * 53) % 256);
      const { values } = await decodePlane(wirePlane(line, size, 4, 1, 2), size);
      expect([...values].map((value) => value && Math.round(1 + 254 * Math.log2(value)))).toEqual([...line]);
    }
  });

  it('is made coarser by the nearest surfaces of two by two texels', () => {
    const values = Float32Array.from([1, 0, 5, 2, 3, 4, 0, 0, 7]);
    const plane = { picture, cell: 4, width: 3, height: 3, values, first: 1, last: 7, seenThrough: true };
    const nearest = Float32Array.from([3, 5, 0, 7]);
    expect(coarser(plane)).toEqual({ ...plane, cell: 8, width: 2, height: 2, values: nearest });
  });

  const damaged: Readonly<Record<string, Partial<WirePlane>>> = {
    'is too narrow': { width: 12 },
    'is too high': { height: 9 },
    'has no cells': { cell: 0 },
    'has cells of another size': { cell: 5 },
    'begins where it ends': { first: 1 },
    'begins behind its end': { first: 2 },
    'begins at infinity': { first: 0 },
    'begins below 0': { first: -0.1 },
    'begins nowhere': { first: NaN },
    'ends nowhere': { last: NaN },
    'ends at infinity': { last: Infinity },
    'has no data': { codes: new Uint8Array() },
    'is not deflated': { codes: codes.slice() },
    'has too few texels': { codes: deflateSync(codes.subarray(1)) },
    'has too many texels': { codes: deflateSync(new Uint8Array(13 * 8 + 1)) },
    'is a bomb': { codes: deflateSync(new Uint8Array(1 << 26)) },
    'is cut off': { codes: deflateSync(codes).subarray(0, 40) },
  };
  for (const [what, change] of Object.entries(damaged)) {
    it(`is refused if it ${what}`, async () => {
      await expect(decodePlane({ ...wirePlane(codes, picture, 4), ...change }, picture)).rejects.toThrow();
    });
  }

  it('is refused if it has more texels than any server sends', async () => {
    const large = { width: 2000, height: 2000 };
    await expect(decodePlane(wirePlane(new Uint8Array(2000 * 2000), large, 1), large)).rejects.toThrow('too many');
  });

  it('comes with the first piece of a frame', () => {
    const depth = wirePlane(codes, picture, 4);
    const piece = (init: MessageInitShape<typeof ViewFrameSchema>): ReturnType<FrameAssembler['take']> =>
      assembler.take(create(ViewFrameSchema, { frame: 1n, ...init }), 10, 0);
    const assembler = new FrameAssembler();
    expect(piece({ picture: { data: Uint8Array.of(1, 2) }, depth, more: true })).toBeUndefined();
    const whole = piece({ picture: { data: Uint8Array.of(3) } });
    expect(whole?.frame.depth).toEqual(depth);
    expect([...whole!.frame.picture!.data]).toEqual([1, 2, 3]);
  });
});

// ---- meshes ----

type Corner = readonly [number, number, number]; // x, y, inverse depth
type Triangle = readonly [Corner, Corner, Corner];

function triangles(mesh: WarpMesh, indices: Uint32Array): Triangle[] {
  const corner = (i: number): Corner => [...mesh.vertices.subarray(3 * i, 3 * i + 3)] as unknown as Corner;
  const count = indices.length / 3;
  return Array.from({ length: count }, (_, t) => [0, 1, 2].map((k) => corner(indices[3 * t + k]!)) as never);
}

/** Of the indices of one kind of sheets. */
function sheets(mesh: WarpMesh, indices: Uint32Array): Triangle[] {
  const corner = (i: number): Corner => [...mesh.sheets.subarray(sheetFloats * i).subarray(0, 3)] as unknown as Corner;
  const count = indices.length / 3;
  return Array.from({ length: count }, (_, t) => [0, 1, 2].map((k) => corner(indices[3 * t + k]!)) as never);
}

const surfaces = (mesh: WarpMesh): Triangle[] => [...triangles(mesh, mesh.surface), ...sheets(mesh, mesh.near)];

const area = ([a, b, c]: Triangle): number =>
  Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2;
const areaOf = (list: readonly Triangle[]): number => list.reduce((sum, one) => sum + area(one), 0);
const fillCount = (mesh: WarpMesh): number => mesh.fills.length / fillFloats / 3;

const camera: Camera = { position: vector(0, 0, 2), focalPoint: vector(0, 10, 1), viewAngle: 50 };
const view = (of: Camera, width = 320, height = 180): Projection => projectionOf(of, sky, width, height);

describe('the mesh of a plane of depth', () => {
  it('of the ground has no cuts, and reaches the border of the picture', () => {
    const from = view({ ...camera, focalPoint: vector(0, 3, 0) });
    const ground = (x: number, y: number): number => inverseDepthOf(from, vector(0, 0, 0), sky, x, y);
    for (const cell of [8, 7, 3]) {
      const mesh = meshOf(planeOf(from, cell, ground));
      expect(fillCount(mesh)).toBe(0);
      expect(mesh.background).toHaveLength(0);
      const all = surfaces(mesh);
      expect(areaOf(all)).toBeCloseTo(from.width * from.height, 1);
      const largest = Math.max(...all.flat().map(([x, y, d]) => Math.abs(d - ground(x, y))));
      expect(largest).toBeLessThan(1e-5); // also on the border
    }
  });

  it('of a rough surface keeps its depths, which have no slope', () => {
    const size = { width: 320, height: 180 };
    const plane = planeOf(size, 4, () => 0.1);
    plane.values.forEach((_, i, values) => (values[i] = (i + Math.floor(i / 80)) % 2 === 0 ? 0.1 : 0.101));
    const { vertices } = meshOf(plane);
    for (const i of [2, 3, 40]) expect(vertices[3 * (82 * 20 + i) + 2]).toBeCloseTo(plane.values[80 * 19 + i - 1]!, 7);
  });

  it('of a single cell keeps its depth', () => {
    const { vertices } = meshOf(planeOf({ width: 4, height: 3 }, 8, () => 0.1));
    for (let i = 2; i < vertices.length; i += 3) expect(vertices[i]).toBeCloseTo(0.1, 6);
  });

  it('of background alone has no surface', () => {
    const plane = { ...planeOf(picture, 4, () => 1), values: new Float32Array(13 * 8) };
    const mesh = meshOf(plane);
    for (const list of [mesh.surface, mesh.near, mesh.far, mesh.fills, mesh.surroundings]) expect(list).toHaveLength(0);
  });

  it('goes on beyond the border where that shows a surface', () => {
    const size = { width: 320, height: 180 };
    const mesh = meshOf(planeOf(size, 4, (_x, y) => (y > 60 ? 0.1 : 0)));
    const inside = (x: number, y: number): boolean => x > 0 && x < 320 && y > 0 && y < 180;
    const vertex = (list: Float32Array, i: number): number[] =>
      [...list.subarray(i * fillFloats, (i + 1) * fillFloats)];
    const vertices = (list: Float32Array): number[][] =>
      Array.from({ length: list.length / fillFloats }, (_, i) => vertex(list, i));
    const beyond = vertices(mesh.surroundings);
    const [x, y] = [0, 1].map((axis) => beyond.map((one) => one[axis]!)) as [number[], number[]];
    expect([Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)]).toEqual([-45, 365, 62, 225]);
    for (const [x, y, , , , depth, fromX, fromY] of beyond) {
      expect(inside(x!, y!)).toBe(false);
      expect(depth).toBeCloseTo(0.1, 6);
      expect(Math.min(fromX!, 320 - fromX!, fromY!, 180 - fromY!)).toBe(0); // the border's pixel beside it
    }
    for (const [, , , , , depth, fromX] of vertices(mesh.holes)) expect([depth, fromX]).toEqual([0, -1]);
  });

  const inSquare = (x: number, y: number): boolean => x > 100 && x < 200 && y > 60 && y < 120;
  it('joins behind a surface no other one and the background', () => {
    const mesh = meshOf(
      planeOf({ width: 320, height: 180 }, 4, (x, y) => (inSquare(x, y) ? 0.5 : x + y < 240 ? 0.1 : 0)),
    );
    const depths = (list: Uint32Array): number[] => sheets(mesh, list).flatMap((one) => one.map(([, , d]) => d));
    expect(Math.min(...depths(mesh.far))).toBeCloseTo(0.1, 6);
    expect(new Set(depths(mesh.farBackground))).toEqual(new Set([0]));
  });

  for (const [what, far] of [['a plane', 0.1], ['the background', 0]] as const) {
    it(`of a square before ${what} is cut on its outline alone`, () => {
      const size = { width: 320, height: 180 };
      const mesh = meshOf(planeOf(size, 4, (x, y) => (inSquare(x, y) ? 0.5 : far)));
      const surface = surfaces(mesh);
      // Nothing joins the two, and each is shown as far as its cells go.
      for (const one of surface) expect(new Set(one.map(([, , d]) => d)).size).toBe(1);
      const near = surface.filter(([[, , d]]) => d === 0.5);
      expect(areaOf(near)).toBeCloseTo(100 * 60, 2);
      for (const [x, y] of near.flat()) expect(x >= 100 && x <= 200 && y >= 60 && y <= 120).toBe(true);
      const background = triangles(mesh, mesh.background);
      const behind = [...surface, ...background].filter(([[, , d]]) => d < 0.5);
      for (const [x, y] of behind.flat()) expect(inSquare(x, y)).toBe(false);
      if (far === 0) {
        expect(fillCount(mesh)).toBe(0);
        expect(areaOf(behind)).toBeCloseTo(2 * 2 * (100 + 60) + 4 * 4, 2); // half a cell around; the rest is open
      } else {
        expect(areaOf(near) + areaOf(behind)).toBeCloseTo(size.width * size.height, 1);
        expect(fillCount(mesh)).toBeGreaterThan(80);
      }
      for (let i = 0; i < mesh.fills.length; i += fillFloats) {
        const [x, y, , farX, farY, depth, fromX, fromY] = mesh.fills.subarray(i, i + fillFloats) as unknown as number[];
        expect(depth).toBeCloseTo(far, 6);
        expect(inSquare(farX!, farY!) || inSquare(fromX!, fromY!)).toBe(false);
        expect(Math.hypot(x! - farX!, y! - farY!)).toBeLessThan(6);
      }
    });

    it(`of a square before ${what} is two sheets in its outermost cells`, () => {
      const mesh = meshOf(planeOf({ width: 320, height: 180 }, 4, (x, y) => (inSquare(x, y) ? 0.5 : far)));
      const [shown, hidden] = far === 0 ? [mesh.farBackground, mesh.far] : [mesh.far, mesh.farBackground];
      expect(hidden).toHaveLength(0);
      const [near, behind] = [sheets(mesh, mesh.near), sheets(mesh, shown)];
      expect(areaOf(near)).toBeCloseTo(100 * 60 - 92 * 52, 2);
      expect(areaOf(behind)).toBeCloseTo(areaOf(near), 6);
      for (const [, , d] of near.flat()) expect(d).toBe(0.5);
      for (const [, , d] of behind.flat()) expect(d).toBeCloseTo(far, 6);
      for (let i = 0; i < mesh.sheets.length; i += sheetFloats) {
        const [x, y, , farX, farY] = mesh.sheets.subarray(i, i + sheetFloats) as unknown as number[];
        expect(inSquare(farX!, farY!)).toBe(false);
        if (far === 0) expect([farX, farY]).toEqual([-1, -1]);
        else expect(Math.hypot(x! - farX!, y! - farY!)).toBeLessThan(9);
      }
    });
  }

  it('keeps what is one cell thin', () => {
    const size = { width: 320, height: 180 };
    const mesh = meshOf(planeOf(size, 4, (x) => (x > 160 && x < 164 ? 0.5 : 0)));
    expect(areaOf(surfaces(mesh))).toBeCloseTo(4 * 180, 1);
  });
});

// ---- cameras ----

const applied = ({ x, y, w }: Warp, at: Pixel, d: number): { pixel: Pixel; d: number } => {
  const row = (r: Warp['x']): number => r[0] * at.x + r[1] * at.y + r[2] + r[3] * d;
  return { pixel: { x: row(x) / row(w), y: row(y) / row(w) }, d: d / row(w) };
};

const far = vector(452_000, 5_411_000, 200); // world coordinates of a survey
const pose: Pose = { position: add(far, vector(3, -40, 12)), yaw: 0.4, pitch: -0.2, distance: 40, viewAngle: 35 };
const cameraAt = (at: Pose): Camera => ({
  position: at.position,
  focalPoint: addScaled(at.position, poseAxes(at, 'z').forward, at.distance),
  viewAngle: at.viewAngle,
});
const pixels = [0, 0.31, 0.77, 1].flatMap((x) => [0, 0.4, 1].map((y) => ({ x: x * 1280, y: y * 720 })));

describe('the warp between two cameras', () => {
  const source = view(cameraAt(pose), 1280, 720);

  it('is the identity for the same camera', () => {
    for (const at of pixels) {
      for (const d of [0, 0.01, 3]) {
        const { pixel, d: there } = applied(warpBetween(source, source), at, d);
        expect(Math.hypot(pixel.x - at.x, pixel.y - at.y)).toBeLessThan(1e-9);
        expect(there).toBeCloseTo(d, 12);
      }
    }
  });

  it('of a pure rotation is the homography, whatever the depth', () => {
    const target = view(cameraAt(look(pose, 0.2, -0.1)), 1280, 720);
    for (const at of pixels) {
      const { axes } = target;
      const ray = rayOf(source, at);
      const along = (axis: typeof ray): number => ray.x * axis.x + ray.y * axis.y + ray.z * axis.z;
      const x = 640 + (target.eta * along(axes.right)) / along(axes.forward);
      const y = 360 - (target.eta * along(axes.up)) / along(axes.forward);
      for (const d of [0, 0.02, 1]) {
        const { pixel } = applied(warpBetween(source, target), at, d);
        expect(Math.hypot(pixel.x - x, pixel.y - y)).toBeLessThan(1e-4); // eyes of equal cameras differ by rounding
      }
    }
  });

  it('takes each point to where the other camera sees it, also in a picture of another size', () => {
    const moved = { ...orbit(pose, 'z', far, 0.3, 0.1), viewAngle: 42 };
    const target = view(cameraAt(moved), 900, 1000);
    for (const at of pixels) {
      for (const depth of [20, 45, 3000]) {
        const point = pointAt(source, at, depth);
        const expected = project(target, point);
        if (!expected) continue;
        const { pixel, d } = applied(warpBetween(source, target), at, 1 / depth);
        expect(Math.hypot(pixel.x - expected.x, pixel.y - expected.y)).toBeLessThan(1e-4); // 1e-9 m of a world of 5e6
        expect(d / inverseDepthAt(target, point)).toBeCloseTo(1, 8);
      }
    }
  });

  it('of a tilted plane agrees with it to a tenth of a pixel, in the floats of the GPU', () => {
    const target = view(cameraAt(orbit(pose, 'z', far, 0.15, 0.05)), 1280, 720);
    const normal = normalize(vector(0.2, -0.3, 1));
    const point = add(far, vector(0, 0, -5));
    const matrix = clipMatrix(warpBetween(source, target), 1280, 720, 1);
    const mesh = meshOf(planeOf(source, 8, (x, y) => inverseDepthOf(source, point, normal, x, y)));
    let compared = 0;
    for (const [x, y, d] of surfaces(mesh).flat()) {
      if (d < 0.002) continue; // at the horizon
      const product = (row: number, column: number, value: number): number =>
        Math.fround(matrix[4 * column + row]! * value);
      const clip = [0, 1, 2, 3].map((row) =>
        [x, y, 1, d].reduce((sum, value, column) => Math.fround(sum + product(row, column, value)), 0),
      );
      const exact = project(target, pointAt(source, { x, y }, 1 / inverseDepthOf(source, point, normal, x, y)));
      if (!exact) continue;
      compared += 1;
      expect(Math.abs(640 + (640 * clip[0]!) / clip[3]! - exact.x)).toBeLessThan(0.1);
      expect(Math.abs(360 - (360 * clip[1]!) / clip[3]! - exact.y)).toBeLessThan(0.1);
      expect((1 - clip[2]! / clip[3]!) / 2).toBeCloseTo(d / clip[3]!, 5); // the window's 1 - z is half of this
    }
    expect(compared).toBeGreaterThan(1000);
  });
});

// ---- layers ----

describe('what is shown', () => {
  const asked = create(DrawPictureSchema, { model: 'yard', spacing: 1 });
  const depth = planeOf(picture, 4, (x) => 0.01 + x * 1e-4);
  const turned = (degrees: number): Camera => cameraAt(orbit(pose, 'z', far, (degrees * Math.PI) / 180, 0));
  const frame = (change: Partial<LayerFrame> = {}): LayerFrame => ({
    ...{ camera: turned(0), view: picture, moving: false, preview: false, asked, depth },
    ...change,
  });
  const rest = frame();
  const newest = frame({ camera: turned(3), moving: true });

  it('stays while there is no frame of the model', () => {
    expect(shownAs(undefined, undefined, turned(0), sky).kind).toBe('kept');
  });

  it('is the frame as it is without a camera, without its depth, and where its camera is the present one', () => {
    expect(shownAs(rest, rest, undefined, sky).kind).toBe('picture');
    expect(shownAs(frame({ depth: undefined }), rest, turned(1), sky).kind).toBe('picture');
    expect(shownAs(newest, rest, turned(3), sky).kind).toBe('picture');
  });

  it('is the frame at rest alone until another one comes', () => {
    expect(shownAs(rest, rest, turned(1), sky)).toEqual({ kind: 'warped', below: rest, above: undefined });
    const next = frame({ camera: turned(2) });
    expect(shownAs(next, rest, turned(1), sky)).toEqual({ kind: 'warped', below: next, above: undefined });
  });

  it('is the newest frame in motion, sharpened by the last one at rest', () => {
    expect(shownAs(newest, rest, turned(4), sky)).toEqual({ kind: 'warped', below: newest, above: rest });
    expect(shownAs(newest, undefined, turned(4), sky)).toEqual({ kind: 'warped', below: newest, above: undefined });
  });

  const otherwise: Readonly<Record<string, LayerFrame>> = {
    'that has no depth': frame({ depth: undefined }),
    'of a preview': frame({ preview: true }),
    'of another shape': frame({ view: { width: 30, height: 50 } }),
    'of other options': frame({ asked: create(DrawPictureSchema, { model: 'yard', spacing: 1, hiddenClasses: [2] }) }),
    'of unknown options': frame({ asked: undefined }),
    'of another direction': frame({ camera: turned(60) }),
    'from far away': frame({ camera: { ...turned(0), position: add(pose.position, vector(0, -500, 0)) } }),
  };
  for (const [what, other] of Object.entries(otherwise)) {
    it(`is not sharpened by a frame ${what}`, () => {
      expect(shownAs(newest, other, turned(4), sky)).toEqual({ kind: 'warped', below: newest, above: undefined });
    });
  }

  it('is not sharpened by the model where its preview is the newest', () => {
    const older = { ...newest, preview: true };
    expect(shownAs(older, rest, turned(4), sky)).toEqual({ kind: 'warped', below: older, above: undefined });
  });

  it('is sharpened where requests differ in the camera alone', () => {
    const other = frame({ asked: create(DrawPictureSchema, { model: 'yard', spacing: 1, camera: { viewAngle: 35 } }) });
    expect(shownAs(newest, other, turned(4), sky)).toMatchObject({ above: other });
  });

  it('is of the same camera if that states the view up which the other one leaves out', () => {
    const plain = turned(0);
    expect(sameView(plain, { ...plain, viewUp: vector(0, 0, 1) }, sky)).toBe(true);
    expect(sameView(plain, { ...plain, viewUp: poseAxes(pose, 'z').up }, sky)).toBe(true);
    expect(sameView(plain, { ...plain, viewUp: vector(0.1, 0, 1) }, sky)).toBe(false);
    expect(sameView(plain, { ...plain, viewAngle: 35.0001 }, sky)).toBe(false);
  });
});
