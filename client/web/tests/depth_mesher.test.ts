import { afterEach, describe, expect, it, vi } from 'vitest';
import { DepthMesher } from '../src/warp/depth_mesher';
import { coarser, decodePlane } from '../src/warp/depth_plane';
import type { MeshReply, MeshRequest } from '../src/warp/mesh_worker';
import { meshedPlanes } from '../src/warp/meshed_plane';
import { meshOf } from '../src/warp/warp_mesh';
import { wirePlane } from './support/planes';

const picture = { width: 50, height: 30 };
const codes = Uint8Array.from({ length: 13 * 8 }, (_, i) => (i % 7 === 0 ? 0 : (i * 97) % 256));
const wire = wirePlane(codes, picture, 4, 0.5, 2);
const both = { fine: true, coarse: true };

/** A worker that does what the test says. */
class FakeWorker {
  static readonly all: FakeWorker[] = [];
  readonly requests: MeshRequest[] = [];
  readonly listeners = new Map<string, (event: object) => void>();
  terminated = false;

  constructor() {
    FakeWorker.all.push(this);
  }
  addEventListener(kind: string, listener: (event: object) => void): void {
    this.listeners.set(kind, listener);
  }
  postMessage(request: MeshRequest): void {
    this.requests.push(structuredClone(request));
  }
  terminate(): void {
    this.terminated = true;
  }
  async answer(request: MeshRequest): Promise<void> {
    const { id, plane, picture, wanted } = request;
    const reply: MeshReply = { id, meshed: await meshedPlanes(plane, picture, wanted) };
    this.listeners.get('message')!({ data: structuredClone(reply) });
  }
}

function start(): { mesher: DepthMesher; worker: FakeWorker } {
  vi.stubGlobal('Worker', FakeWorker);
  const mesher = new DepthMesher();
  return { mesher, worker: FakeWorker.all.at(-1)! };
}

describe('planes of depth and their triangles', () => {
  afterEach(() => void vi.unstubAllGlobals());

  it('are those of a plane that is decoded here, from a worker and without one', async () => {
    const plane = await decodePlane(wire, picture);
    const half = coarser(plane);
    const coarse = { plane: half, mesh: meshOf(half) };
    const fine = { plane, mesh: meshOf(plane) };
    for (const expected of [{ fine, coarse }, { fine, coarse: undefined }, { fine: undefined, coarse }]) {
      const wanted = { fine: expected.fine !== undefined, coarse: expected.coarse !== undefined };
      vi.unstubAllGlobals();
      expect(await new DepthMesher().mesh(wire, picture, wanted)).toEqual(expected);
      const { mesher, worker } = start();
      const meshed = mesher.mesh(wire, picture, wanted);
      await worker.answer(worker.requests[0]!);
      expect(await meshed).toEqual(expected);
    }
  });

  it('are sent to the worker without the rest of the message', () => {
    const message = new Uint8Array(1000);
    message.set(wire.codes, 500);
    const { mesher, worker } = start();
    void mesher.mesh({ ...wire, codes: message.subarray(500, 500 + wire.codes.length) }, picture, both);
    expect([...worker.requests[0]!.plane.codes]).toEqual([...wire.codes]);
    expect(worker.requests[0]!.plane.codes.buffer.byteLength).toBe(wire.codes.length);
  });

  it('belong to their request, whatever the order of the answers', async () => {
    const { mesher, worker } = start();
    const other = { width: 52, height: 32 };
    const [first, second] = [
      mesher.mesh(wire, picture, both),
      mesher.mesh(wirePlane(codes, other, 4, 1, 2), other, both),
    ];
    await worker.answer(worker.requests[1]!);
    await worker.answer(worker.requests[0]!);
    expect([(await first)?.coarse?.plane.first, (await second)?.coarse?.plane.first]).toEqual([0.5, 1]);
  });

  it('are none if the plane is damaged', async () => {
    const { mesher, worker } = start();
    const damaged = { ...wire, codes };
    const meshed = mesher.mesh(damaged, picture, both);
    await worker.answer(worker.requests[0]!);
    expect(await meshed).toBeUndefined();
    vi.unstubAllGlobals();
    expect(await new DepthMesher().mesh(damaged, picture, both)).toBeUndefined();
  });

  it('are made here once the worker has failed', async () => {
    const { mesher, worker } = start();
    const waiting = mesher.mesh(wire, picture, both);
    worker.listeners.get('error')!({});
    expect(worker.terminated).toBe(true);
    expect((await waiting)?.fine?.plane.width).toBe(13);
    expect((await mesher.mesh(wire, picture, both))?.fine?.plane.width).toBe(13);
    expect(worker.requests.length).toBe(1);
  });
});
