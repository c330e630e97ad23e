import type { UpAxis } from '../camera/pose';
import { subtract, type Vector } from '../camera/vector';
import {
  angleAt,
  area,
  isWhole,
  levelArea,
  levelLength,
  pathLength,
  perimeter,
  rise,
  type Measurement,
} from './measurement';

/** Measurements as files. Coordinates are those of the source file, with all their digits. */

export const figureNames = [
  'length',
  'level_distance',
  'rise',
  'height',
  'angle_degrees',
  'area',
  'level_area',
  'perimeter',
] as const;
export type FigureName = (typeof figureNames)[number];
export type Figures = Partial<Record<FigureName, number>>;

/** The results of a measurement, not rounded. Lengths are in units of the source. */
export function figuresOf(m: Measurement, up: UpAxis): Figures {
  const [a, b, c] = m.points as [Vector, Vector, Vector];
  const last = m.points[m.points.length - 1]!;
  const level = (to: Vector): number => levelLength(subtract(to, a), up);
  switch (m.kind) {
    case 'distance':
      return { length: pathLength(m.points), level_distance: level(last), rise: rise(a, last, up) };
    case 'height':
      return { height: Math.abs(rise(a, b, up)), level_distance: level(b) };
    case 'angle':
      return { angle_degrees: (angleAt(a, b, c) * 180) / Math.PI };
    case 'area':
      return { area: area(m.points), level_area: levelArea(m.points, up), perimeter: perimeter(m.points) };
    case 'profile':
      return { length: pathLength(m.points), level_distance: level(last), rise: rise(a, last, up) };
  }
}

const coordinates = (p: Vector): [number, number, number] => [p.x, p.y, p.z];

function geometryOf(m: Measurement): object {
  const points = m.points.map(coordinates);
  if (m.kind !== 'area') return { type: 'LineString', coordinates: points };
  return { type: 'Polygon', coordinates: [[...points, points[0]!]] };
}

/**
 * A GeoJSON document (RFC 7946) of the finished measurements. Coordinates are not longitudes and latitudes but those of
 * the source, as the member `coordinates_of` says.
 */
export function geoJsonOf(list: readonly Measurement[], up: UpAxis, model: string): string {
  const features = list.filter(isWhole).map((m, i) => ({
    type: 'Feature',
    properties: { number: i + 1, kind: m.kind, up_axis: up, ...figuresOf(m, up) },
    geometry: geometryOf(m),
  }));
  return `${JSON.stringify({ type: 'FeatureCollection', model, coordinates_of: 'source', features }, undefined, 2)}\n`;
}

/** A table with a line for each point; the figures are in the first line of their measurement. */
export function csvOf(list: readonly Measurement[], up: UpAxis): string {
  const lines = list.filter(isWhole).flatMap((m, number) =>
    m.points.map((point, i) => {
      const figures: Figures = i === 0 ? figuresOf(m, up) : {};
      return [number + 1, m.kind, i + 1, ...coordinates(point), ...figureNames.map((name) => figures[name] ?? '')];
    }),
  );
  const header = ['measurement', 'kind', 'point', 'x', 'y', 'z', ...figureNames];
  return [header, ...lines].map((line) => `${line.join(',')}\r\n`).join('');
}
