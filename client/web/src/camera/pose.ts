import { add, addScaled, cross, distance, dot, normalize, scale, subtract, vector, type Vector } from './vector';

/**
 * The vertical axis of the model. With '-y' and '-z' it points down: trained models mostly have the axes of their
 * cameras, and the slices of some scanners begin at the head.
 */
export type UpAxis = 'y' | 'z' | '-y' | '-z';

/**
 * Position and direction of the eye in the form used for navigation. The horizon is always level, and vertical view
 * directions are ordinary values. Angles are radians.
 */
export interface Pose {
  readonly position: Vector;
  readonly yaw: number; // clockwise seen from above; 0 looks along y (z-up and -z up), -z (y-up) or z (-y up)
  readonly pitch: number; // -pi/2 straight down, pi/2 straight up
  readonly distance: number; // to the point of interest, world units
  readonly viewAngle: number; // vertical, degrees
}

/** A camera in the form of the protocol and the command line. */
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

/** Two horizontal directions and the vertical one, right-handed. Yaw 0 looks along `north`. */
interface Level {
  readonly east: Vector;
  readonly north: Vector;
  readonly sky: Vector;
}

const zUp: Level = { east: vector(1, 0, 0), north: vector(0, 1, 0), sky: vector(0, 0, 1) };
const yUp: Level = { east: vector(1, 0, 0), north: vector(0, 0, -1), sky: vector(0, 1, 0) };

const yDown: Level = { east: vector(1, 0, 0), north: vector(0, 0, 1), sky: vector(0, -1, 0) };
const zDown: Level = { east: vector(-1, 0, 0), north: vector(0, 1, 0), sky: vector(0, 0, -1) };
const levels: Readonly<Record<UpAxis, Level>> = { y: yUp, z: zUp, '-y': yDown, '-z': zDown };

/** The same axis, pointing the other way. */
export const flipped = (up: UpAxis): UpAxis => (({ y: '-y', z: '-z', '-y': 'y', '-z': 'z' }) as const)[up];

const levelOf = (up: UpAxis): Level => levels[up];
export const skyOf = (up: UpAxis): Vector => levelOf(up).sky;

/** Height of a point above the origin, along the model's vertical axis. */
export const heightOf = (point: Vector, up: UpAxis): number => dot(point, skyOf(up));

export const maxPitch = Math.PI / 2;
/** At steeper pitches the vertical axis does not determine the picture's rotation, so the camera states its view up. */
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

/** The cameras that poses were made from. Until the eye moves, picture requests use these cameras without rounding. */
const statedCameras = new WeakMap<Pose, Camera>();

/** The pose of a camera. A tilted horizon becomes level with the first movement. */
export function poseOf(camera: Camera, up: UpAxis): Pose {
  const { east, north, sky } = levelOf(up);
  const forward = normalize(subtract(camera.focalPoint, camera.position));
  const pitch = Math.atan2(dot(forward, sky), Math.hypot(dot(forward, east), dot(forward, north)));
  // Close to the vertical, the view up determines the heading.
  const steep = Math.abs(pitch) > statedUpPitch && camera.viewUp !== undefined;
  const heading = steep ? scale(camera.viewUp, -Math.sign(pitch)) : forward;
  const yaw = Math.atan2(dot(heading, east), dot(heading, north));
  const far = distance(camera.position, camera.focalPoint);
  const pose = { position: camera.position, yaw, pitch, distance: far, viewAngle: camera.viewAngle };
  statedCameras.set(pose, camera);
  return pose;
}

/** Number of decimals that keeps rounding errors of a camera far below a pixel, for an object at distance `size`. */
export function decimalsFor(size: number): number {
  if (!(size > 0)) return 6;
  return Math.min(12, Math.max(0, 6 - Math.floor(Math.log10(size))));
}

const rounded = (value: number, decimals: number): number => Number(value.toFixed(decimals));
const roundedVector = (v: Vector, decimals: number): Vector =>
  vector(rounded(v.x, decimals), rounded(v.y, decimals), rounded(v.z, decimals));

/**
 * The camera of a pose, rounded to numbers short enough for a link. Picture requests use exactly these numbers, so that
 * a link and a command line give the same picture. `statesUp`: the vertical axis is not the one that the server
 * assumes.
 */
export function cameraOf(pose: Pose, up: UpAxis, statesUp: boolean): Camera {
  return statedCameras.get(pose) ?? roundedCamera(pose, up, statesUp);
}

function roundedCamera(pose: Pose, up: UpAxis, statesUp: boolean): Camera {
  const decimals = decimalsFor(pose.distance);
  const axes = poseAxes(pose, up);
  const camera = {
    position: roundedVector(pose.position, decimals),
    focalPoint: roundedVector(addScaled(pose.position, axes.forward, pose.distance), decimals),
    viewAngle: rounded(pose.viewAngle, 4),
  };
  const steep = Math.abs(pose.pitch) > statedUpPitch;
  return steep || statesUp ? { ...camera, viewUp: roundedVector(axes.up, 6) } : camera;
}
