import type { Size } from '../protocol/pictures';
import { decodePlane, type DepthPlane, type EncodedPlane } from './depth_plane';
import { meshOf, type WarpMesh } from './warp_mesh';

/** A plane of depth, and its triangles. */
export interface MeshedPlane {
  readonly plane: DepthPlane;
  readonly mesh: WarpMesh;
}

/** Undefined if the plane is damaged, or is not that of a picture of this size. */
export async function meshedPlane(encoded: EncodedPlane, picture: Size): Promise<MeshedPlane | undefined> {
  const plane = await decodePlane(encoded, picture).catch(() => undefined);
  return plane && { plane, mesh: meshOf(plane) };
}
