import type { Camera } from '../camera/pose';
import { projectionOf, type Projection } from '../camera/projection';
import type { Vector } from '../camera/vector';
import { cameraFrom, type Size } from '../protocol/pictures';
import { sameView, shownAs, type LayerFrame } from '../warp/layers';
import { WarpPainter, type WarpSource } from '../warp/warp_painter';
import type { DecodedFrame } from './painter';
import { bestQuality, WarpQualityControl } from './warp_quality';

/** A painted frame, and what it is warped from, if it has a depth. */
interface Shot extends LayerFrame {
  readonly source: WarpSource | undefined;
}

/** What was drawn last. */
interface Drawn {
  readonly below: Shot;
  readonly above: Shot | undefined; // may be left out
  readonly camera: Camera;
  readonly best: boolean; // of all qualities
}

const stillAfter = 100; // ms without another picture

/**
 * The canvas over the painted frame. It shows the frame, and under it the last one at rest, as the present camera sees
 * them, while a newer frame is on its way. Where the frame is of the present camera, or has no depth, it is hidden.
 */
export class Screen {
  private readonly painter: WarpPainter | undefined;
  private newest: Shot | undefined;
  private rest: Shot | undefined;
  private drawn: Drawn | undefined;
  private readonly control = new WarpQualityControl();
  private still = false; // what is drawn has been shown for a while
  private stillTimer: ReturnType<typeof setTimeout> | undefined;

  /** `changed`: `show` is to be called again. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly changed: () => void,
  ) {
    canvas.hidden = true;
    this.painter = WarpPainter.on(canvas, () => {
      this.hide();
      changed();
    });
  }

  /** Whether frames should have a depth. */
  get warps(): boolean {
    return this.painter !== undefined;
  }

  /** Takes the frame that was painted last, and its bitmap. `sky` is the view up of a camera that states none. */
  take(frame: DecodedFrame, sky: Vector): void {
    const shot = shotOf(frame, sky);
    if (!shot?.source) frame.bitmap.close();
    if (!shot) return;
    const former = [this.newest, this.rest];
    this.newest = shot;
    if (!shot.moving && shot.source) this.rest = shot;
    for (const one of former) if (one !== this.newest && one !== this.rest) this.drop(one);
    this.tryQuality(shot);
  }

  /** Forgets the frames of a model. What is on the screen stays as it is until the next frame. */
  freeze(): void {
    this.drop(this.newest);
    if (this.rest !== this.newest) this.drop(this.rest);
    this.newest = undefined;
    this.rest = undefined;
  }

  /** Shows the view of a camera as well as it is known. Returns the camera of what is on the screen. */
  show(camera: Camera | undefined, sky: Vector): Camera | undefined {
    const shown = shownAs(this.newest, this.rest, camera, sky);
    if (shown.kind === 'kept') return undefined;
    if (shown.kind === 'warped' && camera && this.draw(shown.below, shown.above, camera, sky)) return camera;
    this.hide();
    return this.newest?.camera;
  }

  private draw(below: Shot, above: Shot | undefined, camera: Camera, sky: Vector): boolean {
    if (!below.source || !this.painter || this.painter.lost) return false;
    const { drawn } = this;
    this.canvas.hidden = false;
    const same = drawn?.below === below && drawn.above === above && sameView(drawn.camera, camera, sky);
    if (same && (drawn.best || !this.still)) return true;
    const quality = same ? bestQuality : this.control.quality;
    this.drawn = { below, above, camera, best: quality === bestQuality };
    const target = targetOf(below, camera, sky, quality.scale);
    const upper = quality.layered ? above?.source : undefined;
    if (same || !this.control.measuresNext()) this.painter.draw(below.source, upper, target);
    else this.drawMeasured(this.painter, below.source, upper, target);
    this.awaitStill();
    return true;
  }

  private drawMeasured(
    painter: WarpPainter,
    below: WarpSource,
    above: WarpSource | undefined,
    target: Projection,
  ): void {
    const begun = performance.now();
    painter.draw(below, above, target);
    painter.finish();
    this.control.record(performance.now() - begun, above !== undefined);
  }

  /** Before the first movement, the quality that it will have is found out with warps that are not shown. */
  private tryQuality(shot: Shot): void {
    setTimeout(() => {
      const { source, camera } = shot;
      const { painter, control } = this;
      if (!painter || painter.lost || !source || this.rest !== shot || !this.canvas.hidden) return;
      if (!control.isUncertain) return;
      const { scale, layered } = control.quality;
      const target = targetOf(shot, camera, source.projection.axes.up, scale);
      this.drawMeasured(painter, source, layered ? source : undefined, target);
      this.tryQuality(shot);
    });
  }

  /** Where nothing moves any more, what was drawn with less is drawn in the best quality. */
  private awaitStill(): void {
    clearTimeout(this.stillTimer);
    this.still = false;
    if (this.drawn?.best === true) return;
    this.stillTimer = setTimeout(() => {
      this.still = true;
      this.changed();
    }, stillAfter);
  }

  private hide(): void {
    this.canvas.hidden = true;
    this.drawn = undefined;
  }

  private drop(shot: Shot | undefined): void {
    if (!shot?.source) return;
    this.painter?.forget(shot.source);
    shot.source.bitmap.close();
  }
}

/** The view of a camera with a part of the pixels. */
function targetOf({ view }: Shot, camera: Camera, sky: Vector, scale: number): Projection {
  return projectionOf(camera, sky, Math.round(scale * view.width), Math.round(scale * view.height));
}

function shotOf({ frame, asked, bitmap, depth }: DecodedFrame, sky: Vector): Shot | undefined {
  const camera = cameraFrom(frame.picture?.camera);
  if (!camera) return undefined;
  const view: Size = frame.resolution ?? bitmap;
  const plane = depth?.plane;
  const fits = plane?.picture.width === bitmap.width && plane.picture.height === bitmap.height;
  const projection = projectionOf(camera, sky, bitmap.width, bitmap.height);
  const background = asked?.background ?? { red: 0, green: 0, blue: 0 };
  return {
    camera,
    view: { width: view.width, height: view.height },
    moving: frame.moving,
    preview: frame.picture?.preview ?? false,
    asked,
    depth: fits ? plane : undefined,
    source: fits && depth ? { bitmap, depth: plane, mesh: depth.mesh, projection, background } : undefined,
  };
}
