import type { Size } from '../protocol/pictures';
import { coarser, decodePlane, type DepthPlane, type EncodedPlane } from './depth_plane';
import { meshOf, type WarpMesh } from './warp_mesh';

/** A plane of depth, and its triangles. */
export interface MeshedPlane {
  readonly plane: DepthPlane;
  readonly mesh: WarpMesh;
}

/** The depth of a frame as it was received, and with a third of the triangles, for slow graphics: what is wanted. */
export interface MeshedPlanes {
  readonly fine: MeshedPlane | undefined;
  readonly coarse: MeshedPlane | undefined;
}

/** Triangles take time. */
export interface WantedPlanes {
  readonly fine: boolean;
  readonly coarse: boolean;
}

/** Undefined if the plane is damaged, or is not that of a picture of this size. */
export async function meshedPlanes(
  encoded: EncodedPlane,
  picture: Size,
  wanted: WantedPlanes,
): Promise<MeshedPlanes | undefined> {
  const plane = await decodePlane(encoded, picture).catch(() => undefined);
  return (
    plane && {
      fine: wanted.fine ? meshed(plane) : undefined,
      coarse: wanted.coarse ? meshed(coarser(plane)) : undefined,
    }
  );
}

const meshed = (plane: DepthPlane): MeshedPlane => ({ plane, mesh: meshOf(plane) });
