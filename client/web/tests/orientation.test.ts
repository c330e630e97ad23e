import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { appearance, east, north, scalePoint, unitPixelsAt } from '../src/camera/orientation';
import { depthOf, pointAt, project, projectionOf } from '../src/camera/projection';
import { addScaled, normalize, subtract, vector, type Vector } from '../src/camera/vector';
import { ModelDescriptionSchema } from '../src/generated/surfcast_pb';
import { roundLength, scaleBar } from '../src/measure/scale_bar';
import { lengthUnitOf, unitSymbol, type LengthUnit } from '../src/state/units';
import { systemFacts } from '../src/state/wkt';

const focal = vector(500_010, 5_400_020, 30);
const viewFrom = (position: Vector, viewAngle = 40) =>
  projectionOf({ position, focalPoint: focal, viewAngle }, vector(0, 0, 1), 800, 600);
const oblique = viewFrom(vector(499_950, 5_399_960, 85));

describe('how a direction appears', () => {
  const pixels = [{ x: 400, y: 300 }, { x: 30, y: 520 }, { x: 790, y: 20 }];
  it.each(pixels)('is the derivative of the projection at %o', (pixel) => {
    const at = pointAt(oblique, pixel, 70);
    const step = 1e-4;
    for (const direction of [north, east, normalize(vector(1, -2, 0.5))]) {
      const [before, after] = [-step, step].map((part) => project(oblique, addScaled(at, direction, part))!);
      const perUnit = oblique.eta / depthOf(oblique, at);
      const seen = appearance(oblique, at, direction)!;
      expect(seen.x).toBeCloseTo((after!.x - before!.x) / (2 * step * perUnit), 4);
      expect(seen.y).toBeCloseTo((after!.y - before!.y) / (2 * step * perUnit), 4);
    }
  });

  it('has north upwards for an eye in the south, and to the right for one in the east', () => {
    const fromSouth = appearance(viewFrom(vector(focal.x, focal.y - 50, 60)), focal, north)!;
    expect(Math.abs(fromSouth.x)).toBeLessThan(1e-9);
    expect(fromSouth.y).toBeLessThan(-0.1);
    const fromEast = appearance(viewFrom(vector(focal.x + 50, focal.y, 60)), focal, north)!;
    expect(fromEast.x).toBeCloseTo(1, 9);
    expect(Math.abs(fromEast.y)).toBeLessThan(1e-9);
  });

  it('is shortened as the view flattens, to nothing for a level view along it', () => {
    const level = appearance(viewFrom(vector(focal.x, focal.y - 50, focal.z)), focal, north)!;
    expect(Math.hypot(level.x, level.y)).toBeLessThan(1e-9);
  });

  it('is nothing behind the eye', () => {
    expect(appearance(oblique, addScaled(oblique.eye, oblique.axes.forward, -1), north)).toBeUndefined();
  });
});

describe('the scale', () => {
  it('is that of a line across the view at the depth of the point', () => {
    const at = pointAt(oblique, { x: 120, y: 450 }, 55);
    const [a, b] = [project(oblique, at)!, project(oblique, addScaled(at, oblique.axes.right, 7))!];
    expect(7 * unitPixelsAt(oblique, at)).toBeCloseTo(Math.hypot(b.x - a.x, b.y - a.y), 6);
  });

  it('is for the picked point while it is in the picture', () => {
    const picked = pointAt(oblique, { x: 790, y: 5 }, 20);
    expect(scalePoint(oblique, focal, picked)).toEqual({ at: picked, picked: true });
    const centre = { at: focal, picked: false };
    expect(scalePoint(oblique, focal, undefined)).toEqual(centre);
    expect(scalePoint(oblique, focal, pointAt(oblique, { x: 810, y: 5 }, 20))).toEqual(centre);
    const behind = subtract(oblique.eye, oblique.axes.forward);
    expect(scalePoint(oblique, focal, behind)).toEqual(centre);
  });

  it.each([
    [1, 1], [1.99, 1], [2, 2], [4.9, 2], [5, 5], [9.99, 5], [0.3, 0.2], [0.05, 0.05], [1234, 1000], [7e-7, 5e-7],
  ])('rounds %d down to %d', (most, expected) => {
    expect(roundLength(most)).toBe(expected);
  });

  const metre: LengthUnit = { symbol: 'm', metres: 1 };
  it.each([
    [10, metre, '10 m', 100],
    [0.01, metre, '10 km', 100],
    [0.03, metre, '2 km', 60],
    [400, metre, '20 cm', 80],
    [3000, metre, '2 cm', 60],
    [30_000, metre, '2 mm', 60],
    [10, { symbol: 'mm', metres: 1e-3 }, '1 cm', 100],
    [0.02, { symbol: 'mm', metres: 1e-3 }, '5 m', 100],
    [4, { symbol: 'ft', metres: 0.3048 }, '20 ft', 80],
    [4000, { symbol: 'ftUS', metres: 1200 / 3937 }, '0.02 ftUS', 80],
    [100, { symbol: 'parsec', metres: undefined }, '1 parsec', 100],
  ] as [number, LengthUnit, string, number][])('of %d pixels per %o is %s', (unitPixels, unit, label, pixels) => {
    const bar = scaleBar(unitPixels, unit, 100);
    expect(bar?.label.replaceAll('\u202f', '')).toBe(label);
    expect(bar?.pixels).toBeCloseTo(pixels, 6);
  });

  it('is not stated where there is none', () => {
    for (const unitPixels of [0, -1, NaN, Infinity]) expect(scaleBar(unitPixels, metre, 100)).toBeUndefined();
  });
});

const unit = (name: string, size: number): string => `LENGTHUNIT["${name}",${size}]`;
const degree = 'ANGLEUNIT["degree",0.0174532925199433]';
const greenwich = `PRIMEM["Greenwich",0,${degree}]`;
const datum = `DATUM["a ""quoted"" name, with [brackets]",ELLIPSOID["GRS 1980",6378137,298.25,${unit('metre', 1)}]]`;
const base = `BASEGEOGCRS["ETRS89",${datum},${greenwich}]`;
const conversion = `CONVERSION["c",METHOD["m"],PARAMETER["False easting",500,${unit('kilometre', 1000)}]]`;
const axis = (name: string, direction: string, order: number, its: string): string =>
  `AXIS["${name}",${direction},ORDER[${order}],${its}]`;
const level = [axis('(E)', 'east', 1, unit('metre', 1)), axis('(N)', 'north', 2, unit('metre', 1))].join(',');
const utm = `PROJCRS["UTM",${base},${conversion},CS[Cartesian,2],${level},ID["EPSG",25832]]`;
const surveyFoot = unit('US survey foot', 0.304800609601219);
const heights = `VERTCRS["h",VDATUM["d"],CS[vertical,1],${axis('height (H)', 'up', 1, surveyFoot)}]`;
const round = [axis('lat', 'north', 1, degree), axis('lon', 'east', 2, degree), axis('h', 'up', 3, unit('metre', 1))];
const degrees = `GEOGCRS["WGS 84",DATUM["d"],${greenwich},CS[ellipsoidal,3],${round.join(',')}]`;
const meridian = (at: number): string => `AXIS["a",north,MERIDIAN[${at},${degree}],ORDER[1]]`;
const polar = `PROJCRS["Antarctic",${base},CS[Cartesian,2],${meridian(90)},${meridian(0)},${unit('metre', 1)}]`;

describe('a coordinate system', () => {
  it('has the units of its axes, not those of its parameters', () => {
    expect(systemFacts(utm)).toEqual({
      horizontal: { name: 'metre', size: 1, kind: 'length' },
      vertical: undefined,
      northIsY: true,
    });
  });

  it('has those of its heights where it is compound or bound', () => {
    const compound = `COMPOUNDCRS["both",${utm},${heights}]`;
    const bound = `BOUNDCRS[SOURCECRS[${compound}],TARGETCRS[${degrees}],ABRIDGEDTRANSFORMATION["t"]]`;
    for (const text of [compound, bound]) {
      const { horizontal, vertical, northIsY } = systemFacts(text);
      expect([unitSymbol(horizontal), unitSymbol(vertical), northIsY]).toEqual(['m', 'ftUS', true]);
    }
  });

  it('can be in degrees', () => {
    const { horizontal, vertical } = systemFacts(degrees);
    expect([horizontal?.kind, unitSymbol(horizontal), unitSymbol(vertical)]).toEqual(['angle', '°', 'm']);
  });

  it('may have no north along y: near a pole, or with axes to the south and the west', () => {
    expect(systemFacts(polar)).toMatchObject({ horizontal: { name: 'metre' }, northIsY: false });
    expect(systemFacts(utm.replace('east', 'south').replace('north', 'west')).northIsY).toBe(false);
  });

  it.each(['', 'nonsense', 'PROJCRS', ']]][[[', 'LOCAL_CS["x"'])('is not known from %j', (text) => {
    expect(systemFacts(text)).toEqual({ horizontal: undefined, vertical: undefined, northIsY: false });
  });
});

describe('the unit of a model', () => {
  it('is that of its system', () => {
    expect(lengthUnitOf(create(ModelDescriptionSchema, { system: { wkt: utm } }))).toEqual({ symbol: 'm', metres: 1 });
    expect(lengthUnitOf(create(ModelDescriptionSchema, { system: { wkt: degrees } }))).toBeUndefined();
  });

  it.each([
    ['mm', 'mm', 1e-3], ['Millimeters', 'mm', 1e-3], ['um', 'µm', 1e-6], ['microns', 'µm', 1e-6], ['metre', 'm', 1],
    ['feet', 'ft', 0.3048], ['parsec', 'parsec', undefined],
  ])('is what a volume states: %s', (lengthUnit, symbol, metres) => {
    expect(lengthUnitOf(create(ModelDescriptionSchema, { volumes: [{ lengthUnit }] }))).toEqual({ symbol, metres });
  });

  it('is not known of others', () => {
    expect(lengthUnitOf(create(ModelDescriptionSchema, { volumes: [{}] }))).toBeUndefined();
    expect(lengthUnitOf(create(ModelDescriptionSchema, {}))).toBeUndefined();
  });
});
