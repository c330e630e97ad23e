import type { Size } from '../protocol/pictures';
import type { EncodedPlane } from './depth_plane';
import { meshedPlanes, type MeshedPlane, type MeshedPlanes, type WantedPlanes } from './meshed_plane';

/** The worker that decodes planes of depth and makes their triangles. It answers each request, not always in order. */

export interface MeshRequest {
  readonly id: number;
  readonly plane: EncodedPlane;
  readonly picture: Size;
  readonly wanted: WantedPlanes;
}

export interface MeshReply {
  readonly id: number;
  readonly meshed: MeshedPlanes | undefined;
}

const arraysOf = ({ plane, mesh }: MeshedPlane): ArrayBufferView[] => [plane.values, ...Object.values({ ...mesh })];

async function answer({ id, plane, picture, wanted }: MeshRequest): Promise<void> {
  const meshed = await meshedPlanes(plane, picture, wanted);
  const arrays = [meshed?.fine, meshed?.coarse].flatMap((one) => (one ? arraysOf(one) : []));
  const reply: MeshReply = { id, meshed };
  self.postMessage(reply, { transfer: arrays.map(({ buffer }) => buffer as ArrayBuffer) });
}

self.addEventListener('message', ({ data }: MessageEvent<MeshRequest>) => void answer(data));
