import type { Camera } from '../camera/pose';
import { projectionOf, type Projection } from '../camera/projection';
import type { Vector } from '../camera/vector';
import type { Size } from '../protocol/pictures';
import { sameView, shownAs, type LayerFrame } from '../warp/layers';
import type { MeshedPlane } from '../warp/meshed_plane';
import { WarpPainter, type WarpSource } from '../warp/warp_painter';
import type { DecodedFrame } from './frame_decoder';
import { PictureCanvas } from './picture_canvas';
import { bestQuality, WarpQualityControl, type WarpQuality } from './warp_quality';

/** A frame, and what it is warped from, if it has a depth. */
interface Shot extends LayerFrame {
  readonly bitmap: ImageBitmap;
  readonly sources: WarpSources | undefined;
}

/** With the depths of a frame, at least one. */
interface WarpSources {
  readonly fine: WarpSource | undefined;
  readonly coarse: WarpSource | undefined;
}

/** What was drawn last. */
interface Drawn {
  readonly below: Shot;
  readonly above: Shot | undefined; // may be left out
  readonly camera: Camera;
  readonly best: boolean; // of all qualities
}

const stillAfter = 100; // ms without another picture

/** The canvas of frames as they are, and above it that of warped ones. */
export interface Canvases {
  readonly picture: HTMLCanvasElement;
  readonly warped: HTMLCanvasElement;
}

/**
 * Shows the newest frame, and under it the last one at rest, as the present camera sees them, while a newer frame is on
 * its way. A frame of the present camera, or without a depth, is shown as it is.
 */
export class Screen {
  private readonly picture: PictureCanvas;
  private readonly canvas: HTMLCanvasElement; // of warped frames
  private readonly painter: WarpPainter | undefined;
  private painted: Shot | undefined; // on the canvas of pictures
  private newest: Shot | undefined;
  private rest: Shot | undefined;
  private drawn: Drawn | undefined;
  private readonly control = new WarpQualityControl();
  private still = false; // what is drawn has been shown for a while
  private stillTimer: ReturnType<typeof setTimeout> | undefined;

  /** `changed`: `show` is to be called again. */
  constructor(
    { picture, warped }: Canvases,
    private readonly changed: () => void,
  ) {
    this.picture = new PictureCanvas(picture);
    this.canvas = warped;
    warped.hidden = true;
    this.painter = WarpPainter.on(warped, () => {
      this.hide();
      changed();
    });
  }

  /** Whether frames should have a depth. */
  get warps(): boolean {
    return this.painter !== undefined;
  }

  /** Whether frames in motion are drawn with coarse depths. */
  get coarse(): boolean {
    return this.control.quality.coarse;
  }

  /** Takes the newest frame, and its bitmap. `sky` is the view up of a camera that states none. */
  take(frame: DecodedFrame, sky: Vector): void {
    const shot = shotOf(frame, sky);
    const former = [this.newest, this.rest];
    this.newest = shot;
    if (!shot.moving && shot.sources) this.rest = shot;
    for (const one of former) if (one !== this.newest && one !== this.rest) this.drop(one);
    this.tryQuality(shot);
  }

  /** Forgets the frames of a model. What is on the screen stays as it is until the next frame. */
  freeze(): void {
    this.paint();
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
    if (!below.sources || !this.painter || this.painter.lost) return false;
    const { drawn } = this;
    this.canvas.hidden = false;
    const same = drawn?.below === below && drawn.above === above && sameView(drawn.camera, camera, sky);
    if (same && (drawn.best || !this.still)) return true;
    const quality = same ? bestQuality : this.control.quality;
    this.drawn = { below, above, camera, best: quality === bestQuality };
    const target = targetOf(below, camera, sky, quality.scale);
    const lower = sourceOf(below.sources, quality);
    const upper = quality.layered && above?.sources ? sourceOf(above.sources, quality) : undefined;
    if (same || !this.control.measuresNext()) this.painter.draw(lower, upper, target);
    else this.drawMeasured(this.painter, lower, upper, target);
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
      const { sources, camera } = shot;
      const { painter, control } = this;
      if (!painter || painter.lost || !sources || this.rest !== shot || !this.canvas.hidden) return;
      if (!control.isUncertain) return;
      const { quality } = control;
      const source = sourceOf(sources, quality);
      const target = targetOf(shot, camera, source.projection.axes.up, quality.scale);
      this.drawMeasured(painter, source, quality.layered ? source : undefined, target);
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
    this.paint();
    this.canvas.hidden = true;
    this.drawn = undefined;
  }

  /** A frame that is covered by a warped one is not painted: that would take time from the warp. */
  private paint(): void {
    if (!this.newest || this.painted === this.newest) return;
    this.picture.paint(this.newest.bitmap, this.newest.view);
    this.painted = this.newest;
  }

  private drop(shot: Shot | undefined): void {
    for (const source of [shot?.sources?.fine, shot?.sources?.coarse]) if (source) this.painter?.forget(source);
    shot?.bitmap.close();
  }
}

/** The view of a camera with a part of the pixels. */
function targetOf({ view }: Shot, camera: Camera, sky: Vector, scale: number): Projection {
  return projectionOf(camera, sky, Math.round(scale * view.width), Math.round(scale * view.height));
}

const sourceOf = ({ fine, coarse }: WarpSources, quality: WarpQuality): WarpSource =>
  (quality.coarse ? (coarse ?? fine) : (fine ?? coarse))!;

function shotOf({ frame, asked, camera, bitmap, depth }: DecodedFrame, sky: Vector): Shot {
  const view: Size = frame.resolution ?? bitmap;
  const plane = (depth?.fine ?? depth?.coarse)?.plane;
  const fits = plane?.picture.width === bitmap.width && plane.picture.height === bitmap.height;
  const projection = projectionOf(camera, sky, bitmap.width, bitmap.height);
  const background = asked?.background ?? { red: 0, green: 0, blue: 0 };
  const source = (depth: MeshedPlane | undefined): WarpSource | undefined =>
    depth && { bitmap, depth: depth.plane, mesh: depth.mesh, projection, background };
  return {
    camera,
    bitmap,
    view: { width: view.width, height: view.height },
    moving: frame.moving,
    preview: frame.picture?.preview ?? false,
    asked,
    depth: fits ? plane : undefined,
    sources: fits && depth ? { fine: source(depth.fine), coarse: source(depth.coarse) } : undefined,
  };
}
