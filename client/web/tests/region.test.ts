import { describe, expect, it } from 'vitest';
import type { Box } from '../src/camera/standard_views';
import { vector, type Vector } from '../src/camera/vector';
import { countUrl, everyForLimit, fileUrl, type PointsOptions } from '../src/protocol/points';
import { defaultDisplay, type Clip, type DisplayOptions } from '../src/state/display_options';
import { neighbour, regionOf, without, type Region, type ScanExtent } from '../src/state/region';

const box = (low: number, high: number): Box => ({ min: vector(low, low, low), max: vector(high, high, high) });
const show = (low: number, high: number): Clip => ({ box: box(low, high), inverted: false });
const hide = (low: number, high: number): Clip => ({ box: box(low, high), inverted: true });

const scan: ScanExtent = { bounds: box(0, 10), classified: true, classes: [2, 6, 7] };

function region(change: Partial<DisplayOptions>, of = scan): Region {
  const shown = regionOf({ ...defaultDisplay, ...change }, of);
  if ('problem' in shown) throw new Error(shown.problem);
  return shown;
}

function problem(change: Partial<DisplayOptions>): string {
  const shown = regionOf({ ...defaultDisplay, ...change }, scan);
  return 'problem' in shown ? shown.problem : '';
}

const holds = ({ min, max }: Box, p: Vector): boolean =>
  p.x >= min.x && p.y >= min.y && p.z >= min.z && p.x <= max.x && p.y <= max.y && p.z <= max.z;

/** The server's rule of what a picture shows. */
function shows(clips: readonly Clip[], point: Vector): boolean {
  const [inside, outside] = [clips.filter((clip) => !clip.inverted), clips.filter((clip) => clip.inverted)];
  const within = inside.length === 0 || inside.some((clip) => holds(clip.box, point));
  return within && !outside.some((clip) => holds(clip.box, point));
}

describe('the neighbour of a number', () => {
  const numbers = [0, 1, -1, 0.1, -2.5e-310, 5_411_000.123, Number.MIN_VALUE, -Number.MIN_VALUE];
  it.each(numbers)('of %d is the next', (value) => {
    const [above, below] = [neighbour(value, 1), neighbour(value, -1)];
    expect(above).toBeGreaterThan(value);
    expect(below).toBeLessThan(value);
    expect(neighbour(above, -1)).toBe(value === 0 ? 0 : value);
    expect([value, above]).toContain(value + (above - value) / 2); // nothing is between them
  });
});

describe('the shown region', () => {
  it('is the whole model where nothing is hidden', () => {
    expect(region({})).toEqual({ boxes: [], classes: [] });
  });

  it('is in the boxes that show', () => {
    expect(region({ clips: [show(1, 2), show(3, 4)] }).boxes).toEqual([box(1, 2), box(3, 4)]);
  });

  const arrangements: [string, Clip[]][] = [
    ['a hole', [hide(3, 6)]],
    ['a hole in a box', [show(2, 8), hide(3, 6)]],
    ['a corner cut off', [show(2, 8), hide(7, 9)]],
    ['two holes that overlap, in two boxes that overlap', [show(1, 6), show(5, 9), hide(2, 4), hide(3, 7)]],
    ['a slab through the middle', [{ box: { min: vector(-5, 4, -5), max: vector(15, 5, 15) }, inverted: true }]],
    ['a hole beside the box', [show(1, 2), hide(5, 6)]],
  ];
  it.each(arrangements)('is what a picture shows, with faces: %s', (_, clips) => {
    const { boxes } = region({ clips });
    const faces = [0, 1, 2, 2.5, 3, 4, 4.5, 5, 6, 7, 8, 9, 10];
    const ticks = faces.flatMap((at) => [neighbour(at, -1), at, neighbour(at, 1)]);
    const wrong: Vector[] = [];
    for (const x of ticks) for (const y of ticks) for (const z of ticks) {
      const point = vector(x, y, z);
      if (boxes.some((each) => holds(each, point)) !== shows(clips, point)) wrong.push(point);
    }
    expect(wrong).toEqual([]);
    for (const { min, max } of boxes) expect(min.x <= max.x && min.y <= max.y && min.z <= max.z).toBe(true);
  });

  it('holds points on the bounds of the model, and beside them', () => {
    const { boxes } = region({ clips: [hide(3, 6)] });
    for (const at of [0, 10, -0.001, 10.001]) expect(boxes.some((each) => holds(each, vector(at, at, at)))).toBe(true);
  });

  it('has the classes that are not hidden, nor wholly transparent', () => {
    expect(region({ hiddenClasses: [7] }).classes).toEqual([2, 6]);
    expect(region({ classOpacities: [{ code: 2, opacity: 0 }, { code: 6, opacity: 0.5 }] }).classes).toEqual([6, 7]);
    expect(region({ hiddenClasses: [9] }).classes).toEqual([]); // there are none of it
    expect(region({ hiddenClasses: [7] }, { ...scan, classified: false }).classes).toEqual([]);
    const unknown = region({ hiddenClasses: [7] }, { ...scan, classes: [] }).classes;
    expect(unknown).toHaveLength(255);
    expect(unknown).not.toContain(7);
  });

  it('says why there is none', () => {
    expect(problem({ clips: [show(1, 2), hide(0, 3)] })).toContain('hide all points');
    expect(problem({ hiddenClasses: [2, 6, 7] })).toContain('All classes');
    const holes = Array.from({ length: 14 }, (_, i) => hide(2 * i - 10, 2 * i - 9));
    expect(problem({ clips: holes })).toContain('more than 64');
  });

  it('is at most six boxes for one with a hole', () => {
    expect(without(box(0, 10), box(3, 6))).toHaveLength(6);
    expect(without(box(0, 10), box(-1, 11))).toEqual([]);
  });
});

describe('the address of points', () => {
  const options: PointsOptions = { format: 'laz', every: 1, normals: false, world: false };
  const some: Region = { boxes: [box(0, 1.5), box(-2, 1e21)], classes: [2, 6] };

  it('is relative to the page and has the parameters of the server', () => {
    const url = new URL(fileUrl('http://host:7600/scans/?v=1#/a?b', 'église 2', some, options));
    expect(url.origin + url.pathname).toBe('http://host:7600/scans/api/models/%C3%A9glise%202/points');
    const values = Object.fromEntries(url.searchParams);
    expect(values).toEqual({ box: '0,0,0,1.5,1.5,1.5;-2,-2,-2,1e+21,1e+21,1e+21', classes: '2,6', format: 'laz' });
  });

  it('states what differs from the usual', () => {
    const more: PointsOptions = { format: 'csv', every: 3, normals: true, world: true };
    const { searchParams } = new URL(fileUrl('http://h/', 'm', { boxes: [], classes: [] }, more));
    const expected = { every: '3', format: 'csv', normals: '1', coordinates: 'world' };
    expect(Object.fromEntries(searchParams)).toEqual(expected);
  });

  it('counts the same region', () => {
    const url = new URL(countUrl('http://h/', 'm', some, 5));
    expect(url.searchParams.get('box')).toBe(new URL(fileUrl('http://h/', 'm', some, options)).searchParams.get('box'));
    expect([url.searchParams.get('every'), url.searchParams.get('count')]).toEqual(['5', '1']);
  });

  it('leaves out as many points as the limit demands', () => {
    expect(everyForLimit({ points: 100, most: 100 }, 1)).toBe(1);
    expect(everyForLimit({ points: 101, most: 100 }, 1)).toBe(2);
    expect(everyForLimit({ points: 150, most: 100 }, 4)).toBe(6);
    expect(everyForLimit({ points: 9, most: Infinity }, 2)).toBe(2);
  });
});
