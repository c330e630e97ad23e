import { add, addScaled, cross, distance, dot, normalize, scale, subtract, vector, type Vector } from './vector';

/** The axis of the model that points to the sky. */
export type UpAxis = 'y' | 'z';

/**
 * Where the eye is and where it looks, as one navigates: the horizon stays level, and looking straight up or down is a
 * value like any other. Angles are radians.
 */
export interface Pose {
  readonly position: Vector;
  readonly yaw: number; // clockwise seen from above; 0 looks along y (z-up) or along -z (y-up)
  readonly pitch: number; // -pi/2 straight down, pi/2 straight up
  readonly distance: number; // to the point of interest, world units
  readonly viewAngle: number; // vertical, degrees
}

/** A camera as the protocol and the command line state it. */
export interface Camera {
  readonly position: Vector;
  readonly focalPoint: Vector;
  readonly viewUp?: Vector | undefined;
  readonly viewAngle: number; // vertical, degrees
}

/** Orthonormal axes of the camera in the world. */
export interface Axes {
  readonly right: Vector;
  readonly up: Vector;
  readonly forward: Vector;
}

/** Two level directions and the vertical, right-handed: yaw 0 looks along `north`. */
interface Level {
  readonly east: Vector;
  readonly north: Vector;
  readonly sky: Vector;
}

const zUp: Level = { east: vector(1, 0, 0), north: vector(0, 1, 0), sky: vector(0, 0, 1) };
const yUp: Level = { east: vector(1, 0, 0), north: vector(0, 0, -1), sky: vector(0, 1, 0) };

const levelOf = (up: UpAxis): Level => (up === 'z' ? zUp : yUp);
export const skyOf = (up: UpAxis): Vector => levelOf(up).sky;

/** Height of a point above the origin, along the model's vertical axis. */
export const heightOf = (point: Vector, up: UpAxis): number => dot(point, skyOf(up));

export const maxPitch = Math.PI / 2;
/** Beyond this the vertical axis no longer tells how the picture is turned, so the camera states its own. */
const statedUpPitch = (80 * Math.PI) / 180;

export const clampPitch = (pitch: number): number => Math.min(maxPitch, Math.max(-maxPitch, pitch));

export function axesOf(yaw: number, pitch: number, up: UpAxis): Axes {
  const { east, north, sky } = levelOf(up);
  const heading = add(scale(east, Math.sin(yaw)), scale(north, Math.cos(yaw)));
  const right = subtract(scale(east, Math.cos(yaw)), scale(north, Math.sin(yaw)));
  const forward = add(scale(heading, Math.cos(pitch)), scale(sky, Math.sin(pitch)));
  return { right, up: cross(right, forward), forward };
}

export const poseAxes = (pose: Pose, up: UpAxis): Axes => axesOf(pose.yaw, pose.pitch, up);

export const focalPoint = (pose: Pose, up: UpAxis): Vector =>
  addScaled(pose.position, poseAxes(pose, up).forward, pose.distance);

/** Cameras of the poses that were made from one: until the eye moves, pictures are asked for with these, to the bit. */
const statedCameras = new WeakMap<Pose, Camera>();

/** The pose that sees what the camera sees, except that its horizon is level once it moves. */
export function poseOf(camera: Camera, up: UpAxis): Pose {
  const { east, north, sky } = levelOf(up);
  const forward = normalize(subtract(camera.focalPoint, camera.position));
  const pitch = Math.atan2(dot(forward, sky), Math.hypot(dot(forward, east), dot(forward, north)));
  // Close to the vertical, the heading is where the picture's upper edge points.
  const steep = Math.abs(pitch) > statedUpPitch && camera.viewUp !== undefined;
  const heading = steep ? scale(camera.viewUp, -Math.sign(pitch)) : forward;
  const yaw = Math.atan2(dot(heading, east), dot(heading, north));
  const far = distance(camera.position, camera.focalPoint);
  const pose = { position: camera.position, yaw, pitch, distance: far, viewAngle: camera.viewAngle };
  statedCameras.set(pose, camera);
  return pose;
}

/** Decimals that keep an error of the camera far below a pixel, for something seen at this distance. */
export function decimalsFor(size: number): number {
  if (!(size > 0)) return 6;
  return Math.min(12, Math.max(0, 6 - Math.floor(Math.log10(size))));
}

const rounded = (value: number, decimals: number): number => Number(value.toFixed(decimals));
const roundedVector = (v: Vector, decimals: number): Vector =>
  vector(rounded(v.x, decimals), rounded(v.y, decimals), rounded(v.z, decimals));

/**
 * The camera of a pose, in numbers short enough for a link. Pictures are asked for with exactly these, so that a link
 * and a command line show the same picture.
 */
export function cameraOf(pose: Pose, up: UpAxis): Camera {
  return statedCameras.get(pose) ?? roundedCamera(pose, up);
}

function roundedCamera(pose: Pose, up: UpAxis): Camera {
  const decimals = decimalsFor(pose.distance);
  const axes = poseAxes(pose, up);
  const camera = {
    position: roundedVector(pose.position, decimals),
    focalPoint: roundedVector(addScaled(pose.position, axes.forward, pose.distance), decimals),
    viewAngle: rounded(pose.viewAngle, 4),
  };
  return Math.abs(pose.pitch) > statedUpPitch ? { ...camera, viewUp: roundedVector(axes.up, 6) } : camera;
}
