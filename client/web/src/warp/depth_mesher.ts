import type { Size } from '../protocol/pictures';
import type { EncodedPlane } from './depth_plane';
import type { MeshReply, MeshRequest } from './mesh_worker';
import { meshedPlanes, type MeshedPlanes, type WantedPlanes } from './meshed_plane';

interface Waiting {
  readonly request: MeshRequest;
  resolve(meshed: Promise<MeshedPlanes | undefined> | MeshedPlanes | undefined): void;
}

/** Of a message, which has more. Its codes are a part of the message's buffer, all of which would be copied. */
const plainPlane = ({ width, height, cell, first, last, seenThrough, codes }: EncodedPlane): EncodedPlane => ({
  ...{ width, height, cell, first, last, seenThrough, codes: codes.slice() },
});

/**
 * Decodes planes of depth and makes their triangles in a worker, so that pictures of the present camera go on being
 * drawn meanwhile. Without a worker, or if it fails, it does so on the thread of the page.
 */
export class DepthMesher {
  private worker: Worker | undefined;
  private requests = 0;
  private readonly waiting = new Map<number, Waiting>();

  constructor() {
    try {
      this.worker = new Worker(new URL('./mesh_worker.ts', import.meta.url), { type: 'module' });
    } catch {
      return; // blocked by a policy of the page around
    }
    this.worker.addEventListener('message', ({ data }: MessageEvent<MeshReply>) => this.take(data));
    this.worker.addEventListener('error', () => this.giveUp());
  }

  /** As `meshedPlanes`. */
  mesh(encoded: EncodedPlane, { width, height }: Size, wanted: WantedPlanes): Promise<MeshedPlanes | undefined> {
    const { worker } = this;
    const picture = { width, height };
    if (!worker) return meshedPlanes(encoded, picture, wanted);
    const request: MeshRequest = { id: ++this.requests, plane: plainPlane(encoded), picture, wanted };
    return new Promise((resolve) => {
      this.waiting.set(request.id, { request, resolve });
      worker.postMessage(request);
    });
  }

  private take({ id, meshed }: MeshReply): void {
    this.waiting.get(id)?.resolve(meshed);
    this.waiting.delete(id);
  }

  private giveUp(): void {
    this.worker?.terminate();
    this.worker = undefined;
    for (const { request, resolve } of this.waiting.values()) {
      resolve(meshedPlanes(request.plane, request.picture, request.wanted));
    }
    this.waiting.clear();
  }
}
