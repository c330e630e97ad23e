import { batch } from '@preact/signals';
import { look, orbit, pan, zoom, type Course } from '../camera/motion';
import { focalPoint, poseAxes, poseOf, type Camera, type Pose } from '../camera/pose';
import { diagonal, fit, standardView, type ViewName } from '../camera/standard_views';
import { depthOf } from '../camera/projection';
import { addScaled, distance, subtract, dot, type Pixel, type Vector } from '../camera/vector';
import type { Size } from '../protocol/pictures';
import type { DisplayOptions } from '../state/display_options';
import * as store from '../state/store';
import { CameraAnimator, type Drag } from './camera_animator';

const travelTime = 420; // ms
const glideDecay = 70; // ms; smooths the steps of a wheel
const halfTurn = Math.PI; // radians for a drag over the height of the picture
const zoomPerPixel = 0.0015;
const flightPerSecond = 0.06; // of the model's size
const nearestPart = 1e-6; // least distance, as a share of the model's size
const farthestPart = 20;

const reducedMotion = (): boolean => matchMedia('(prefers-reduced-motion: reduce)').matches;

/** All operations that move the eye; changes the store's pose. Pixels are device pixels of the picture. */
export class CameraNavigator {
  private readonly animator = new CameraAnimator();
  private dragging = false;
  private adjusting = false;
  private flightFactor = 1;

  /** Advances animations to `now`; true if an animation continues. */
  step(now: number): boolean {
    const pose = store.pose.peek();
    if (pose && this.animator.moving) store.pose.value = this.animator.step(pose, store.upAxis.peek(), now);
    this.publishMoving();
    return this.animator.moving;
  }

  /** Stops travel and coasting, as a press on the picture does. */
  stop(): void {
    this.animator.stop();
    this.publishMoving();
  }

  /** A drag of the picture has begun or ended. */
  hold(dragging: boolean): void {
    this.dragging = dragging;
    this.publishMoving();
  }

  /** The drag of a slider or handle has begun or ended. Meanwhile pictures are drawn for speed. */
  adjust(down: boolean): void {
    this.adjusting = down;
    this.publishMoving();
  }

  private publishMoving(): void {
    store.moving.value = this.dragging || this.adjusting || this.animator.moving;
  }

  private change(changed: (pose: Pose) => Pose): void {
    const pose = store.pose.peek();
    if (pose) store.pose.value = changed(pose);
  }

  drag(drag: Drag, moved: Pixel): void {
    this.change((pose) => drag(pose, moved));
  }

  coast(drag: Drag, velocity: Pixel): void {
    if (!reducedMotion() && (velocity.x !== 0 || velocity.y !== 0)) this.animator.coastOn(velocity, drag);
    this.publishMoving();
  }

  // ---- ways to drag ----

  orbiting(pivot: () => Vector | undefined): Drag {
    return (pose, moved) => {
      const up = store.upAxis.peek();
      const perPixel = halfTurn / store.stageSize.peek().height;
      return orbit(pose, up, pivot() ?? focalPoint(pose, up), moved.x * perPixel, -moved.y * perPixel);
    };
  }

  panning(point: () => Vector | undefined): Drag {
    return (pose, moved) => {
      const up = store.upAxis.peek();
      const target = point();
      const depth = target ? dot(subtract(target, pose.position), poseAxes(pose, up).forward) : pose.distance;
      return pan(pose, up, moved, Math.max(depth, pose.distance * 1e-3), store.stageSize.peek().height);
    };
  }

  readonly looking: Drag = (pose, moved) => {
    const perPixel = (pose.viewAngle * Math.PI) / 180 / store.stageSize.peek().height;
    return look(pose, moved.x * perPixel * 1.5, -moved.y * perPixel * 1.5);
  };

  /** Zooms towards a point, which stays in place on the screen. */
  zoomBy(factor: number, target: Vector): void {
    this.change((pose) => this.zoomed(pose, target, factor));
  }

  twistBy(radians: number, pivot: Vector): void {
    this.change((pose) => orbit(pose, store.upAxis.peek(), pivot, radians, 0));
  }

  /** A wheel step of `pixels`; scrolling down increases the distance. */
  wheel(pixels: number, target: (pose: Pose) => Vector): void {
    const drag: Drag = (pose, moved) => this.zoomed(pose, target(pose), Math.exp(moved.y * zoomPerPixel));
    const whole = this.animator.left.y + pixels;
    this.animator.coastOn({ x: 0, y: whole / glideDecay }, drag, glideDecay);
    this.publishMoving();
  }

  /** One press of a zoom key: towards the centre of the picture, or away from it. */
  zoomStep(direction: number): void {
    const up = store.upAxis.peek();
    this.wheel(direction * 120, (pose) => focalPoint(pose, up));
  }

  private zoomed(pose: Pose, target: Vector, factor: number): Pose {
    const size = diagonal(store.bounds.peek());
    return zoom(pose, target, factor, size * nearestPart, size * farthestPart);
  }

  /** One press of an arrow key, in degrees. */
  nudge(drag: Drag, right: number, down: number): void {
    const pixels = store.stageSize.peek().height / 180;
    const left = this.animator.left;
    const decay = 120;
    const velocity = { x: (left.x + right * pixels) / decay, y: (left.y + down * pixels) / decay };
    this.animator.coastOn(velocity, drag, decay);
    this.publishMoving();
  }

  /**
   * Adapts the distance to a new shape of the picture. The view angle is vertical, so a picture that is higher than
   * wide shows a narrower part of the model. The distance changes so that the extent along the shorter side is kept.
   */
  resized(before: Size, after: Size): void {
    const slender = ({ width, height }: Size): number => Math.max(1, height / Math.max(1, width));
    const factor = slender(after) / slender(before);
    if (factor !== 1) this.change((pose) => this.zoomed(pose, focalPoint(pose, store.upAxis.peek()), factor));
  }

  // ---- flying ----

  flyAlong(course: Course, fast: boolean): void {
    this.animator.flyAlong(course, (this.flightSpeed() * (fast ? 4 : 1)) / 1000);
    this.publishMoving();
  }

  /** World units per second. */
  flightSpeed(): number {
    return diagonal(store.bounds.peek()) * flightPerSecond * this.flightFactor;
  }

  changeFlightSpeed(factor: number): void {
    this.flightFactor = Math.min(100, Math.max(0.001, this.flightFactor * factor));
  }

  // ---- places to go ----

  travelTo(to: Pose): void {
    const from = store.pose.peek();
    if (!from) return;
    this.animator.travel(from, to, performance.now(), reducedMotion() ? 0 : travelTime);
    this.publishMoving();
  }

  private aspect(): number {
    const { width, height } = store.stageSize.peek();
    return width / Math.max(1, height);
  }

  fit(): void {
    const pose = store.pose.peek();
    if (pose) this.travelTo(fit(pose, store.upAxis.peek(), store.bounds.peek(), this.aspect()));
  }

  /** Shows the whole model with its vertical axis pointing the other way. */
  turnOver(): void {
    this.animator.stop();
    const display = store.display.peek();
    batch(() => {
      store.display.value = { ...display, upsideDown: !display.upsideDown };
      this.change((pose) => fit(pose, store.upAxis.peek(), store.bounds.peek(), this.aspect()));
    });
  }

  standard(name: ViewName): void {
    const pose = store.pose.peek();
    if (pose) this.travelTo(standardView(name, pose, store.upAxis.peek(), store.bounds.peek(), this.aspect()));
  }

  /** Turns the view about its focal point until north is ahead. */
  faceNorth(): void {
    const pose = store.pose.peek();
    if (!pose) return;
    const up = store.upAxis.peek();
    const turned = { ...pose, yaw: 0 };
    const position = addScaled(focalPoint(pose, up), poseAxes(turned, up).forward, -pose.distance);
    this.travelTo({ ...turned, position });
  }

  /** Travels to a camera, with other display options from the start. */
  goTo(camera: Camera, display: DisplayOptions): void {
    this.animator.stop();
    const turned = display.upsideDown !== store.display.peek().upsideDown;
    batch(() => {
      store.display.value = display;
      const pose = poseOf(camera, store.upAxis.peek());
      if (turned) store.pose.value = pose; // between two vertical axes there is no path
      else this.travelTo(pose);
    });
  }

  /** Centres the view on a point and reduces the distance to it to a third. */
  focus(point: Vector): void {
    const pose = store.pose.peek();
    const up = store.upAxis.peek();
    if (!pose) return;
    const { forward } = poseAxes(pose, up);
    const far = distance(pose.position, point) / 3;
    const position = subtract(point, { x: forward.x * far, y: forward.y * far, z: forward.z * far });
    this.travelTo({ ...pose, position, distance: far });
  }

  /** Makes the depth of this point the distance of the focal point, which is the centre of later movements. */
  interestIn(point: Vector): void {
    const view = store.shownProjection.peek();
    if (!view) return;
    const depth = depthOf(view, point);
    if (depth > 0) this.change((pose) => ({ ...pose, distance: depth }));
  }
}
