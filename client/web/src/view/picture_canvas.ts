import type { Size } from '../protocol/pictures';

/** A canvas with a frame as it is. */
export class PictureCanvas {
  private readonly context: CanvasRenderingContext2D;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const context = canvas.getContext('2d', { alpha: false });
    if (!context) throw new Error('This browser does not support 2D canvases.');
    this.context = context;
    canvas.hidden = true; // until the first picture
  }

  /** The canvas gets the size of the view. A smaller picture is scaled to it; one of the same size is copied exactly. */
  paint(bitmap: ImageBitmap, { width, height }: Size): void {
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    this.canvas.hidden = false;
    this.context.imageSmoothingQuality = 'medium';
    this.context.drawImage(bitmap, 0, 0, width, height);
  }
}
