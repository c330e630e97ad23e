import { heightOf, type UpAxis } from '../camera/pose';
import { vector, type Vector } from '../camera/vector';
import type { Profile } from '../generated/surfcast_pb';
import type { Chart } from './chart';

/** The points of a scan in a band along a profile. */
export interface Band {
  readonly along: readonly number[];
  readonly heights: readonly number[];
  readonly colors: readonly string[]; // of CSS
  readonly total: number; // points in the band, of which these are an even sample
  readonly low: number; // least height
  readonly high: number;
}

/** The most points of a band on the screen. A chart has fewer pixels. */
export const bandPoints = 40_000;

/** A band as wide as ten points, as a round number. */
export function usualWidth(spacing: number): number {
  if (!(spacing > 0)) return 1;
  const rough = 10 * spacing;
  const power = 10 ** Math.floor(Math.log10(rough));
  return Number((Math.ceil(rough / power) * power).toPrecision(6));
}

export function bandOf(profile: Profile, up: UpAxis): Band {
  const heights = profile.x.map((x, i) => heightOf(vector(x, profile.y[i] ?? 0, profile.z[i] ?? 0), up));
  const shift = profile.colorBits === 16 ? 8 : 0;
  const part = (values: readonly number[], i: number): number => (values[i] ?? 0) >> shift;
  const colors = profile.x.map((_, i) =>
    profile.colorBits === 0
      ? '#b8c4cc'
      : `rgb(${part(profile.red, i)},${part(profile.green, i)},${part(profile.blue, i)})`,
  );
  const low = heights.reduce((a, b) => Math.min(a, b), Infinity);
  const high = heights.reduce((a, b) => Math.max(a, b), -Infinity);
  return { along: profile.along, heights, colors, total: Number(profile.total), low, high };
}

/** Draws the points of a band to the scale of a chart. `pixels`: device pixels for each unit of the chart. */
export function drawBand(context: CanvasRenderingContext2D, band: Band, chart: Chart, pixels: number): void {
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  const side = Math.max(1, Math.round(pixels));
  band.along.forEach((along, i) => {
    context.fillStyle = band.colors[i]!;
    const [x, y] = [chart.x(along) * pixels, chart.y(band.heights[i]!) * pixels];
    context.fillRect(Math.round(x - side / 2), Math.round(y - side / 2), side, side);
  });
}

/** The address of the points of a band as a file, relative to the page. */
export function bandAddress(model: string, points: readonly Vector[], width: number, format: 'csv' | 'las'): string {
  const line = points.map((p) => `${p.x},${p.y},${p.z}`).join(';');
  const query = new URLSearchParams({ line, width: String(width), format });
  return `api/models/${encodeURIComponent(model)}/profile?${query.toString()}`;
}
