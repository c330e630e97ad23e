import type { Size } from '../protocol/pictures';
import { coarser, decodePlane, type DepthPlane, type EncodedPlane } from './depth_plane';
import { meshOf, type WarpMesh } from './warp_mesh';

/** A plane of depth, and its triangles. */
export interface MeshedPlane {
  readonly plane: DepthPlane;
  readonly mesh: WarpMesh;
}

/** The depth of a frame as it was received, and with a third of the triangles, for slow graphics. */
export interface MeshedPlanes {
  readonly fine: MeshedPlane | undefined; // if it is wanted: triangles take time
  readonly coarse: MeshedPlane;
}

/** Undefined if the plane is damaged, or is not that of a picture of this size. `fine`: not only the coarse one. */
export async function meshedPlanes(
  encoded: EncodedPlane,
  picture: Size,
  fine: boolean,
): Promise<MeshedPlanes | undefined> {
  const plane = await decodePlane(encoded, picture).catch(() => undefined);
  return plane && { fine: fine ? meshed(plane) : undefined, coarse: meshed(coarser(plane)) };
}

const meshed = (plane: DepthPlane): MeshedPlane => ({ plane, mesh: meshOf(plane) });
