import { afterEach, describe, expect, it, vi } from 'vitest';
import { DepthMesher } from '../src/warp/depth_mesher';
import { decodePlane } from '../src/warp/depth_plane';
import type { MeshReply, MeshRequest } from '../src/warp/mesh_worker';
import { meshedPlane } from '../src/warp/meshed_plane';
import { meshOf } from '../src/warp/warp_mesh';
import { wirePlane } from './support/planes';

const picture = { width: 50, height: 30 };
const codes = Uint8Array.from({ length: 13 * 8 }, (_, i) => (i % 7 === 0 ? 0 : (i * 97) % 256));
const wire = wirePlane(codes, picture, 4, 0.5, 2);

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
    const reply: MeshReply = { id: request.id, meshed: await meshedPlane(request.plane, request.picture) };
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
    const expected = { plane, mesh: meshOf(plane) };
    expect(await new DepthMesher().mesh(wire, picture)).toEqual(expected);
    const { mesher, worker } = start();
    const meshed = mesher.mesh(wire, picture);
    await worker.answer(worker.requests[0]!);
    expect(await meshed).toEqual(expected);
  });

  it('are sent to the worker without the rest of the message', () => {
    const message = new Uint8Array(1000);
    message.set(wire.codes, 500);
    const { mesher, worker } = start();
    void mesher.mesh({ ...wire, codes: message.subarray(500, 500 + wire.codes.length) }, picture);
    expect([...worker.requests[0]!.plane.codes]).toEqual([...wire.codes]);
    expect(worker.requests[0]!.plane.codes.buffer.byteLength).toBe(wire.codes.length);
  });

  it('belong to their request, whatever the order of the answers', async () => {
    const { mesher, worker } = start();
    const other = { width: 52, height: 32 };
    const [first, second] = [mesher.mesh(wire, picture), mesher.mesh(wirePlane(codes, other, 4, 1, 2), other)];
    await worker.answer(worker.requests[1]!);
    await worker.answer(worker.requests[0]!);
    expect([(await first)?.plane.first, (await second)?.plane.first]).toEqual([0.5, 1]);
  });

  it('are none if the plane is damaged', async () => {
    const { mesher, worker } = start();
    const damaged = { ...wire, codes };
    const meshed = mesher.mesh(damaged, picture);
    await worker.answer(worker.requests[0]!);
    expect(await meshed).toBeUndefined();
    vi.unstubAllGlobals();
    expect(await new DepthMesher().mesh(damaged, picture)).toBeUndefined();
  });

  it('are made here once the worker has failed', async () => {
    const { mesher, worker } = start();
    const waiting = mesher.mesh(wire, picture);
    worker.listeners.get('error')!({});
    expect(worker.terminated).toBe(true);
    expect((await waiting)?.plane.width).toBe(13);
    expect((await mesher.mesh(wire, picture))?.plane.width).toBe(13);
    expect(worker.requests.length).toBe(1);
  });
});
