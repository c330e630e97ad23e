import { releaseVelocity, recent, type Sample } from '../camera/inertia';
import type { Pixel } from '../camera/vector';
import { handleAt, pulled, pullOf, type Handle } from '../overlay/clip_handles';
import { diagonal } from '../camera/standard_views';
import * as store from '../state/store';
import { setWindow, windowed } from '../state/volume';
import { draggedWindow, windowNow, type Window, type Windowed } from '../volume/window';
import { type Anchor, type Probe } from '../view/probe';
import type { Drag } from '../view/camera_animator';
import type { CursorProbe } from '../view/cursor_probe';
import type { CameraNavigator } from '../view/camera_navigator';
import { isClick, isDouble, pinchBetween, wheelPixels, type Press } from './gestures';
import type { Tools } from './tools';

const handleReach = 18; // CSS pixels
const wheelPause = 300; // ms; after a longer pause the wheel zooms towards a new point
const wheelReach = 12; // CSS pixels

/** A drag with one pointer, from press to release. Positions are device pixels of the picture. */
interface Stroke {
  readonly down: Press; // in CSS pixels, for the detection of clicks
  readonly anchor: Anchor;
  readonly drag: Drag;
  samples: Sample[];
  moved: boolean;
  interested: boolean; // the depth of the anchor has been applied to the pose
  coasts: boolean;
}

/** A drag of the window of a volume, from the pixel where it began. */
interface WindowDrag {
  readonly from: Pixel;
  readonly of: Windowed;
  readonly start: Window;
}

/** Mouse, wheel and touch input on the picture. */
export class StageInput {
  private readonly pointers = new Map<number, Pixel>();
  private stroke: Stroke | undefined;
  private pinch: Anchor | undefined;
  private pull: { handle: Handle; value: number; index: number } | undefined;
  private windowDrag: WindowDrag | undefined;
  private wheelAnchor: { anchor: Anchor; time: number } | undefined;
  private lastClick: Press | undefined;

  constructor(
    private readonly element: HTMLElement,
    private readonly navigator: CameraNavigator,
    private readonly probe: Probe,
    private readonly tools: Tools,
    private readonly cursor: CursorProbe,
  ) {
    element.addEventListener('pointerdown', (event) => this.down(event));
    element.addEventListener('pointermove', (event) => this.move(event));
    element.addEventListener('pointerup', (event) => this.up(event));
    element.addEventListener('pointercancel', (event) => this.up(event, true));
    element.addEventListener('pointerleave', () => this.cursor.left());
    element.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    element.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  private get ratio(): number {
    const { width } = this.element.getBoundingClientRect();
    return width > 0 ? store.stageSize.peek().width / width : 1;
  }

  /** Pixel of the frame on the screen. The frame is centred and as high as the element, also after a resize. */
  private pixelOf(event: MouseEvent): Pixel {
    const box = this.element.getBoundingClientRect();
    const { width, height } = store.shownProjection.peek() ?? store.stageSize.peek();
    const ratio = height / Math.max(1, box.height);
    return {
      x: width / 2 + (event.clientX - box.left - box.width / 2) * ratio,
      y: (event.clientY - box.top) * ratio,
    };
  }

  private down(event: PointerEvent): void {
    event.preventDefault();
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    const at = this.pixelOf(event);
    this.pointers.set(event.pointerId, at);
    this.cursor.left();
    this.navigator.stop();
    if (this.pointers.size === 1) this.begin(event, at);
    else this.beginPinch();
  }

  private begin(event: PointerEvent, at: Pixel): void {
    if (this.grab(at) || this.beginWindow(event, at)) return;
    const anchor = this.probe.anchor(at);
    const drag = this.dragFor(event, anchor);
    const down = { at: { x: event.clientX, y: event.clientY }, time: event.timeStamp };
    this.stroke = { down, anchor, drag, samples: [{ time: event.timeStamp, at }], moved: false, interested: false, coasts: true };
  }

  private dragFor(event: PointerEvent, anchor: Anchor): Drag {
    const pans = event.button === 2 || event.button === 1 || event.shiftKey;
    if (pans) return this.navigator.panning(() => anchor.hit);
    return store.flying.peek() ? this.navigator.looking : this.navigator.orbiting(() => anchor.hit);
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      this.hover(event);
      return;
    }
    const at = this.pixelOf(event);
    if (this.pointers.size === 2) this.movePinch(event.pointerId, at);
    else if (this.windowDrag) this.moveWindow(this.windowDrag, at);
    else if (this.pull) this.movePull({ x: at.x - before.x, y: at.y - before.y });
    else if (this.stroke) this.moveStroke(this.stroke, event, before, at);
    this.pointers.set(event.pointerId, at);
  }

  /** Ignores movement that is small enough for a click. */
  private moveStroke(stroke: Stroke, event: PointerEvent, before: Pixel, at: Pixel): void {
    const here = { at: { x: event.clientX, y: event.clientY }, time: event.timeStamp };
    if (!stroke.moved && isClick(stroke.down, here)) return;
    const from = stroke.moved ? before : stroke.samples[0]!.at;
    stroke.moved = true;
    this.navigator.hold(true);
    if (stroke.anchor.hit && !stroke.interested) {
      stroke.interested = true;
      this.navigator.interestIn(stroke.anchor.hit);
    }
    stroke.samples = [...recent(stroke.samples, event.timeStamp), { time: event.timeStamp, at }];
    this.navigator.drag(stroke.drag, { x: at.x - from.x, y: at.y - from.y });
  }

  private up(event: PointerEvent, cancelled = false): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.pointers.size > 0) {
      this.endPinch();
      return;
    }
    const stroke = this.stroke;
    this.stroke = undefined;
    this.navigator.hold(false);
    this.hover(event);
    if (this.pull || this.windowDrag) {
      this.pull = undefined;
      this.windowDrag = undefined;
      this.navigator.adjust(false);
    } else if (stroke && !cancelled) {
      this.release(stroke, event);
    }
  }

  private release(stroke: Stroke, event: PointerEvent): void {
    if (stroke.moved) {
      if (stroke.coasts) this.navigator.coast(stroke.drag, releaseVelocity(stroke.samples, event.timeStamp));
      return;
    }
    const press = { at: { x: event.clientX, y: event.clientY }, time: event.timeStamp };
    if (event.button !== 0 || !isClick(stroke.down, press)) return;
    const double = isDouble(this.lastClick, press);
    this.lastClick = double ? undefined : press;
    const pixel = this.pixelOf(event);
    if (double) void this.tools.doubleClick(pixel);
    else void this.tools.click(pixel);
  }

  // ---- two fingers ----

  private two(): [Pixel, Pixel] {
    const [a, b] = [...this.pointers.values()];
    return [a ?? { x: 0, y: 0 }, b ?? { x: 0, y: 0 }];
  }

  private beginPinch(): void {
    this.stroke = undefined;
    if (this.windowDrag) this.navigator.adjust(false);
    this.windowDrag = undefined;
    this.navigator.hold(true);
    const [a, b] = this.two();
    this.pinch = this.probe.anchor({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
  }

  private movePinch(moved: number, at: Pixel): void {
    const { pinch } = this;
    if (!pinch) return;
    const before = this.two();
    this.pointers.set(moved, at);
    const step = pinchBetween(before, this.two());
    this.navigator.drag(this.navigator.panning(() => pinch.hit), step.moved);
    if (step.spread !== 1) this.navigator.zoomBy(1 / step.spread, pinch.point);
    if (step.twist !== 0) this.navigator.twistBy(-step.twist, pinch.point);
  }

  /** Continues with the remaining finger as a new drag that is never a click and does not coast. */
  private endPinch(): void {
    this.pinch = undefined;
    const [at] = [...this.pointers.values()];
    if (!at || this.pointers.size !== 1) return;
    const anchor = this.probe.anchor(at);
    const drag = store.flying.peek() ? this.navigator.looking : this.navigator.orbiting(() => anchor.hit);
    const down = { at: { x: -1e9, y: -1e9 }, time: 0 };
    this.stroke = { down, anchor, drag, samples: [], moved: true, interested: true, coasts: false };
  }

  // ---- the wheel ----

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const pixels = wheelPixels(event);
    if (store.flying.peek()) {
      this.navigator.changeFlightSpeed(Math.exp(-pixels * 0.002));
      return;
    }
    const { anchor } = this.wheelAt(this.pixelOf(event), event.timeStamp);
    this.navigator.wheel(pixels, () => anchor.point);
  }

  private wheelAt(pixel: Pixel, time: number): { anchor: Anchor } {
    const last = this.wheelAnchor;
    const near =
      last && Math.hypot(last.anchor.pixel.x - pixel.x, last.anchor.pixel.y - pixel.y) < wheelReach * this.ratio;
    const anchor = near && time - last.time < wheelPause ? last.anchor : this.probe.anchor(pixel);
    this.wheelAnchor = { anchor, time };
    return this.wheelAnchor;
  }

  // ---- window and level ----

  private beginWindow(event: PointerEvent, at: Pixel): boolean {
    const of = store.tool.peek() === 'window' && event.button === 0 && !event.shiftKey ? windowed() : undefined;
    if (!of) return false;
    this.windowDrag = { from: at, of, start: windowNow(of) };
    this.navigator.adjust(true);
    return true;
  }

  private moveWindow({ from, of, start }: WindowDrag, at: Pixel): void {
    const { width, height } = store.stageSize.peek();
    const side = Math.max(1, Math.min(width, height));
    setWindow(of, draggedWindow(start, of.span, (at.x - from.x) / side, (from.y - at.y) / side));
  }

  // ---- handles of clip boxes ----

  private handleUnder(at: Pixel): { handle: Handle; index: number } | undefined {
    const index = store.editedClip.peek();
    const view = store.shownProjection.peek();
    const clip = index === undefined ? undefined : store.display.peek().clips[index];
    const visible = store.panel.peek() === 'clip' || store.tool.peek() === 'clip';
    if (!clip || !view || index === undefined || !visible) return undefined;
    const handle = handleAt(clip.box, view, at, handleReach * this.ratio);
    return handle && { handle, index };
  }

  private grab(at: Pixel): boolean {
    const found = this.handleUnder(at);
    if (!found) return false;
    this.pull = { ...found, value: found.handle.at[found.handle.axis] };
    this.navigator.hold(false);
    this.navigator.adjust(true);
    return true;
  }

  private movePull(moved: Pixel): void {
    const { pull } = this;
    const view = store.shownProjection.peek();
    const display = store.display.peek();
    const clip = pull && display.clips[pull.index];
    if (!pull || !view || !clip) return;
    const at = { ...pull.handle.at, [pull.handle.axis]: pull.value };
    pull.value += pullOf({ ...pull.handle, at }, view, moved, diagonal(store.bounds.peek()));
    const changed = { ...clip, box: pulled(clip.box, pull.handle, pull.value) };
    store.display.value = { ...display, clips: display.clips.map((other, i) => (i === pull.index ? changed : other)) };
  }

  /** The pointer is over the picture with no button pressed. A finger is not: it is gone once it is lifted. */
  private hover(event: PointerEvent): void {
    if (event.pointerType === 'touch') return;
    const at = this.pixelOf(event);
    this.element.style.cursor = this.handleUnder(at) ? 'grab' : '';
    this.cursor.moved(at);
  }
}
