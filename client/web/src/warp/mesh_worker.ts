import type { Size } from '../protocol/pictures';
import type { EncodedPlane } from './depth_plane';
import { meshedPlane, type MeshedPlane } from './meshed_plane';

/** The worker that decodes planes of depth and makes their triangles. It answers each request, not always in order. */

export interface MeshRequest {
  readonly id: number;
  readonly plane: EncodedPlane;
  readonly picture: Size;
}

export interface MeshReply {
  readonly id: number;
  readonly meshed: MeshedPlane | undefined;
}

async function answer({ id, plane, picture }: MeshRequest): Promise<void> {
  const meshed = await meshedPlane(plane, picture);
  const arrays: ArrayBufferView[] = meshed ? [meshed.plane.values, ...Object.values({ ...meshed.mesh })] : [];
  const reply: MeshReply = { id, meshed };
  self.postMessage(reply, { transfer: arrays.map(({ buffer }) => buffer as ArrayBuffer) });
}

self.addEventListener('message', ({ data }: MessageEvent<MeshRequest>) => void answer(data));
