import type { Box } from '../camera/standard_views';
import type { Region } from '../state/region';

/** Points of a region as a file, which the server sends over HTTP. */

export const pointFormats = ['las', 'laz', 'ply', 'csv'] as const;
export type PointFormatName = (typeof pointFormats)[number];

export interface PointsOptions {
  readonly format: PointFormatName;
  readonly every: number; // of all points every n-th
  readonly normals: boolean;
  readonly world: boolean; // coordinates of the model, where those of its source are others
}

/** `base` is the address of the page, which the server's paths are relative to. */
const pointsUrl = (base: string, model: string, values: URLSearchParams): string =>
  new URL(`api/models/${encodeURIComponent(model)}/points?${values.toString()}`, base.replace(/[?#].*$/, '')).href;

const boxText = ({ min, max }: Box): string => [min.x, min.y, min.z, max.x, max.y, max.z].join(',');

function regionValues({ boxes, classes }: Region, every: number): URLSearchParams {
  const values = new URLSearchParams();
  if (boxes.length > 0) values.set('box', boxes.map(boxText).join(';'));
  if (classes.length > 0) values.set('classes', classes.join(','));
  if (every > 1) values.set('every', String(every));
  return values;
}

export function fileUrl(base: string, model: string, region: Region, options: PointsOptions): string {
  const values = regionValues(region, options.every);
  values.set('format', options.format);
  if (options.normals) values.set('normals', '1');
  if (options.world) values.set('coordinates', 'world');
  return pointsUrl(base, model, values);
}

export function countUrl(base: string, model: string, region: Region, every: number): string {
  const values = regionValues(region, every);
  values.set('count', '1');
  return pointsUrl(base, model, values);
}

export interface PointCount {
  readonly points: number;
  readonly most: number; // points that the server sends in a file
}

/** Rejects with the server's sentence. */
export async function countPoints(url: string, signal: AbortSignal): Promise<PointCount> {
  const answer = await fetch(url, { signal }).catch(() => {
    throw new Error('The server does not answer.');
  });
  const body = (await answer.json().catch(() => ({}))) as { points?: number; error?: { message: string } };
  if (!answer.ok || body.points === undefined) {
    throw new Error(body.error?.message ?? `The server answered with status ${answer.status}.`);
  }
  return { points: body.points, most: Number(answer.headers.get('X-Surfcast-Max-Points') ?? Infinity) };
}

/** How many points to leave out for a file that the server sends: every n-th point is taken. */
export const everyForLimit = ({ points, most }: PointCount, every: number): number =>
  points > most ? Math.ceil((points * every) / most) : every;
