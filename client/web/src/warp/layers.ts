import { equals } from '@bufbuild/protobuf';
import type { Camera } from '../camera/pose';
import { projectionOf } from '../camera/projection';
import { distance, dot, type Vector } from '../camera/vector';
import { DrawPictureSchema, type DrawPicture } from '../generated/surfcast_pb';
import type { Size } from '../protocol/pictures';
import type { DepthPlane } from './depth_plane';

/** What decides how a frame is shown. */
export interface LayerFrame {
  readonly camera: Camera;
  readonly view: Size; // of the view, pixels
  readonly moving: boolean;
  readonly preview: boolean; // of a scan that is being built
  readonly asked: DrawPicture | undefined; // the request that it shows
  readonly depth: DepthPlane | undefined;
}

export type Shown<Frame> =
  | { readonly kind: 'kept' } // what is on the screen stays
  | { readonly kind: 'picture' } // the newest frame as it is
  | { readonly kind: 'warped'; readonly below: Frame; readonly above: Frame | undefined };

/**
 * How the newest frame and the last one at rest show the view of a camera. Frames of other models must have been
 * forgotten. `sky` is the view up of a camera that states none.
 */
export function shownAs<Frame extends LayerFrame>(
  newest: Frame | undefined,
  rest: Frame | undefined,
  camera: Camera | undefined,
  sky: Vector,
): Shown<Frame> {
  if (!newest) return { kind: 'kept' };
  if (!camera || !newest.depth || sameView(newest.camera, camera, sky)) return { kind: 'picture' };
  return { kind: 'warped', below: newest, above: rest && sharpens(rest, newest, camera, sky) ? rest : undefined };
}

const sameRoll = 1e-6; // radians; below any pixel

/** Whether two cameras show the same, to the last bit of what requests state. */
export function sameView(a: Camera, b: Camera, sky: Vector): boolean {
  const same = (p: Vector, q: Vector): boolean => p.x === q.x && p.y === q.y && p.z === q.z;
  if (!same(a.position, b.position) || !same(a.focalPoint, b.focalPoint) || a.viewAngle !== b.viewAngle) return false;
  const up = (camera: Camera): Vector => projectionOf(camera, sky, 1, 1).axes.up;
  return distance(up(a), up(b)) < sameRoll;
}

const mostTurned = Math.cos(Math.PI / 4);

/**
 * Whether a frame at rest can add to the newest one, which is in motion. Pixel by pixel the painter chooses, so what is
 * left out here is what could not add anything, or what shows something else.
 */
function sharpens(rest: LayerFrame, newest: LayerFrame, camera: Camera, sky: Vector): boolean {
  if (!newest.moving || rest === newest || !rest.depth) return false;
  if (rest.preview || newest.preview) return false; // of two editions, the older one has less
  if (rest.view.width !== newest.view.width || rest.view.height !== newest.view.height) return false;
  if (!sameOptions(rest.asked, newest.asked)) return false;
  const [from, to] = [rest.camera, camera].map((one) => projectionOf(one, sky, 1, 1));
  // Nothing of the frame is recognizable once the eye has gone as far as the farthest surface was.
  const near = distance(from!.eye, to!.eye) * rest.depth.first < 1;
  return near && dot(from!.axes.forward, to!.axes.forward) > mostTurned;
}

/** Whether two requests differ in nothing but the camera. */
function sameOptions(a: DrawPicture | undefined, b: DrawPicture | undefined): boolean {
  if (!a || !b) return false;
  const options = ({ camera: _, ...rest }: DrawPicture): DrawPicture => rest;
  return a === b || equals(DrawPictureSchema, options(a), options(b));
}
