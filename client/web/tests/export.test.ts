import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { vector } from '../src/camera/vector';
import { ProfileSchema } from '../src/generated/surfcast_pb';
import { bandAddress, bandOf, usualWidth } from '../src/measure/band';
import { chartOf } from '../src/measure/chart';
import { csvOf, figureNames, figuresOf, geoJsonOf } from '../src/measure/export';
import type { Measurement } from '../src/measure/measurement';

const far = vector(4_500_123.25, 300_000.1, 99.875);
const at = (x: number, y: number, z: number): typeof far => vector(far.x + x, far.y + y, far.z + z);
const list: Measurement[] = [
  { id: 7, kind: 'distance', points: [far, at(3, 4, 0), at(3, 4, 12)] },
  { id: 8, kind: 'height', points: [far, at(3, 4, -2)] },
  { id: 9, kind: 'angle', points: [at(1, 0, 0), far, at(0, 1, 0)] },
  { id: 10, kind: 'area', points: [far, at(4, 0, 0), at(4, 3, 0), at(0, 3, 0)] },
  { id: 11, kind: 'profile', points: [far, at(6, 8, 5)] },
  { id: 12, kind: 'area', points: [far, at(1, 1, 1)] }, // not finished
];

interface Feature {
  properties: Record<string, unknown>;
  geometry: { type: string; coordinates: unknown };
}

describe('measurements as GeoJSON', () => {
  const document = JSON.parse(geoJsonOf(list, 'z', 'town')) as { type: string; model: string; features: Feature[] };

  it('are features in source coordinates, without those that are not finished', () => {
    expect(document.type).toBe('FeatureCollection');
    expect(document.model).toBe('town');
    expect(document.features.map((feature) => feature.properties['kind'])).toEqual([
      'distance',
      'height',
      'angle',
      'area',
      'profile',
    ]);
    expect(document.features[0]!.geometry).toEqual({
      type: 'LineString',
      coordinates: [far, at(3, 4, 0), at(3, 4, 12)].map((p) => [p.x, p.y, p.z]),
    });
  });

  it('close the rings of areas', () => {
    const { type, coordinates } = document.features[3]!.geometry;
    const [ring] = coordinates as [number, number, number][][];
    expect(type).toBe('Polygon');
    expect(ring).toHaveLength(5);
    expect(ring![4]).toEqual(ring![0]);
  });

  it('have their results, not rounded', () => {
    const figures = document.features.map((feature) => feature.properties);
    expect(figures[0]).toMatchObject({ number: 1, rise: 12 });
    expect(figures[0]!['length']).toBeCloseTo(17, 9);
    expect(figures[1]).toMatchObject({ height: 2 });
    expect(figures[2]!['angle_degrees']).toBeCloseTo(90, 9);
    expect(figures[3]!['area']).toBeCloseTo(12, 6);
    expect(figures[4]!['level_distance']).toBeCloseTo(10, 9);
  });
});

describe('measurements as CSV', () => {
  it('have a line for each point, and figures in the first', () => {
    const lines = csvOf(list, 'z').split('\r\n');
    expect(lines[0]).toBe(`measurement,kind,point,x,y,z,${figureNames.join(',')}`);
    expect(lines).toHaveLength(1 + 3 + 2 + 3 + 4 + 2 + 1);
    expect(lines[1]).toMatch(/^1,distance,1,4500123\.25,300000\.1,99\.875,17/);
    expect(lines[2]).toBe(`1,distance,2,${far.x + 3},${far.y + 4},99.875,,,,,,,,`);
    for (const line of lines.slice(0, -1)) expect(line.split(',')).toHaveLength(6 + figureNames.length);
  });

  it('measure along the axis that is up', () => {
    const height: Measurement = { id: 1, kind: 'height', points: [vector(0, 0, 0), vector(3, 7, 4)] };
    expect(figuresOf(height, 'y')).toEqual({ height: 7, level_distance: 5 });
  });
});

describe('a band of points', () => {
  const profile = create(ProfileSchema, {
    total: 12n,
    zUp: true,
    x: [1, 2],
    y: [5, 6],
    z: [10, -3],
    along: [0, 4],
    across: [0, 0],
    colorBits: 16,
    red: [65535, 0],
    green: [256, 0],
    blue: [255, 0],
  });

  it('has heights along the vertical axis, and colours', () => {
    expect(bandOf(profile, 'z')).toEqual({
      along: [0, 4],
      heights: [10, -3],
      colors: ['rgb(255,1,0)', 'rgb(0,0,0)'],
      total: 12,
      low: -3,
      high: 10,
    });
    expect(bandOf(profile, 'y').heights).toEqual([5, 6]);
  });

  it('widens the chart', () => {
    const frame = { width: 100, height: 50, left: 10, right: 0, top: 0, bottom: 10 };
    const line = [{ along: 0, height: 5 }, { along: 2, height: 5 }];
    const chart = chartOf(line, frame, [0, 20]);
    expect(chart.y(20)).toBeGreaterThanOrEqual(0);
    expect(chart.y(0)).toBeLessThanOrEqual(40);
    expect(chart.x(2)).toBe(100);
  });

  it('is ten points wide at first, in round numbers', () => {
    expect(usualWidth(0.08)).toBe(0.8);
    expect(usualWidth(0.0123)).toBe(0.2);
    expect(usualWidth(0)).toBe(1);
  });

  it('has an address with every digit of its line', () => {
    const url = new URL(bandAddress('a b', [far, at(1, 0, 0)], 0.5, 'las'), 'http://host/sub/');
    expect(url.pathname).toBe('/sub/api/models/a%20b/profile');
    expect(url.searchParams.get('line')).toBe(`4500123.25,300000.1,99.875;4500124.25,300000.1,99.875`);
    expect(url.searchParams.get('width')).toBe('0.5');
    expect(url.searchParams.get('format')).toBe('las');
  });
});
