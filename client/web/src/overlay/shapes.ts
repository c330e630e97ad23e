import { corners, type Box } from '../camera/standard_views';
import { project, projectLine, type Projection } from '../camera/projection';
import type { Pixel, Vector } from '../camera/vector';

/** Draws shapes in world coordinates on the overlay canvas. Sizes are CSS pixels; `ratio` canvas pixels each. */
export class Pen {
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly view: Projection,
    readonly ratio: number,
  ) {}

  line(a: Vector, b: Vector, color: string, width = 1.5, dash: readonly number[] = []): void {
    const ends = projectLine(this.view, a, b);
    if (!ends) return;
    this.path(ends, false);
    this.stroke(color, width, dash);
  }

  lines(points: readonly Vector[], color: string, width = 1.5, dash: readonly number[] = []): void {
    points.slice(1).forEach((point, i) => this.line(points[i]!, point, color, width, dash));
  }

  /** Fills a polygon. Draws nothing if a corner is behind the eye. */
  fill(points: readonly Vector[], color: string): void {
    const pixels = points.map((point) => project(this.view, point));
    if (pixels.some((pixel) => pixel === undefined)) return;
    this.path(pixels as Pixel[], true);
    this.context.fillStyle = color;
    this.context.fill();
  }

  dot(point: Vector, color: string, radius = 4): void {
    const at = project(this.view, point);
    if (!at) return;
    const { context, ratio } = this;
    context.beginPath();
    context.arc(at.x, at.y, radius * ratio, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
    context.lineWidth = 1.5 * ratio;
    context.strokeStyle = 'rgba(8, 11, 14, 0.85)';
    context.stroke();
  }

  ring(point: Vector, color: string, radius: number): void {
    const at = project(this.view, point);
    if (!at) return;
    this.context.beginPath();
    this.context.arc(at.x, at.y, radius * this.ratio, 0, 2 * Math.PI);
    this.stroke(color, 1.5, []);
  }

  /** Draws a text label above a point. */
  label(point: Vector, text: string, color: string): void {
    const at = project(this.view, point);
    if (!at) return;
    const { context, ratio } = this;
    context.font = `550 ${12 * ratio}px "Inter Variable", system-ui, sans-serif`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const width = context.measureText(text).width + 14 * ratio;
    const height = 22 * ratio;
    const y = at.y - 20 * ratio;
    context.beginPath();
    context.roundRect(at.x - width / 2, y - height / 2, width, height, 6 * ratio);
    context.fillStyle = 'rgba(13, 17, 21, 0.88)';
    context.fill();
    context.fillStyle = color;
    context.fillText(text, at.x, y + 0.5 * ratio);
  }

  box(box: Box, color: string, width = 1.25, dash: readonly number[] = []): void {
    const points = corners(box);
    for (let i = 0; i < 8; ++i) {
      for (const bit of [1, 2, 4]) if (!(i & bit)) this.line(points[i]!, points[i | bit]!, color, width, dash);
    }
  }

  private path(pixels: readonly Pixel[], closed: boolean): void {
    this.context.beginPath();
    pixels.forEach(({ x, y }, i) => (i === 0 ? this.context.moveTo(x, y) : this.context.lineTo(x, y)));
    if (closed) this.context.closePath();
  }

  /** Strokes the path with a dark outline beneath, so that it is visible on any picture. */
  private stroke(color: string, width: number, dash: readonly number[]): void {
    const { context, ratio } = this;
    context.lineCap = 'round';
    context.setLineDash([]);
    context.lineWidth = (width + 2) * ratio;
    context.strokeStyle = 'rgba(8, 11, 14, 0.45)';
    context.stroke();
    context.setLineDash(dash.map((part) => part * ratio));
    context.lineWidth = width * ratio;
    context.strokeStyle = color;
    context.stroke();
    context.setLineDash([]);
  }
}
