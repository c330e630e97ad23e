import { vector, type Vector } from '../camera/vector';
import { choices, type Choice } from '../generated/plain_options';

/** How ellipsoids are drawn, and the texts of it: those of the parameters `glyph`, `glyph_radius`, .., `lights`. */

export const glyphShapes = ['ellipsoid', 'superquadric'] as const;
export type GlyphShapeName = (typeof glyphShapes)[number];

export type GlyphRadiusName = Choice<'glyphRadius'>;

/** Ellipsoids are drawn whose attribute is in the range. */
export interface Threshold {
  readonly attribute: string;
  readonly smallest: number;
  readonly largest: number | undefined; // undefined: no limit
}

export interface GlyphOptions {
  readonly shape: GlyphShapeName;
  readonly sharpness: number; // of superquadrics, 0 to 10
  readonly radius: GlyphRadiusName;
  readonly scale: number | undefined; // semi-axis of a value, root or ratio of 1; undefined: the model's own
  readonly thresholds: readonly Threshold[];
}

export const defaultGlyphs: GlyphOptions = {
  shape: 'ellipsoid',
  sharpness: 3,
  radius: 'eigenvalue',
  scale: undefined,
  thresholds: [],
};

export interface Light {
  readonly direction: Vector; // towards it: x right, y up, z forward from the eye
  readonly power: number;
}

export interface Lighting {
  readonly ambient: number;
  readonly specular: number;
  readonly exponent: number;
  readonly lights: readonly Light[]; // one or more
}

export const maxSharpness = 10;
export const maxThresholds = 8;
export const maxLights = 64;

const numbersIn = (text: string): number[] => text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));

/** All parts of a list of so many at most, or undefined if one is wrong. */
function listOf<Item>(parts: readonly string[], most: number, parse: (part: string) => Item | undefined) {
  const items = parts.map(parse).filter((item) => item !== undefined);
  return items.length === parts.length && items.length <= most ? items : undefined;
}

const namedIn = <Name extends string>(names: readonly Name[], text: string | null | undefined): Name | undefined =>
  names.find((name) => name === text);

/** ATTRIBUTE,MIN or ATTRIBUTE,MIN,MAX. Names may contain commas: the numbers are the last parts. */
function thresholdIn(text: string): Threshold | undefined {
  const parts = text.split(',');
  for (const count of [2, 1]) {
    const attribute = parts.slice(0, -count).join(',');
    const [smallest = NaN, largest] = numbersIn(parts.slice(-count).join(','));
    const numbers = [smallest, largest ?? smallest];
    if (attribute === '' || !numbers.every(Number.isFinite)) continue;
    return numbers[0]! <= numbers[1]! ? { attribute, smallest, largest } : undefined;
  }
  return undefined;
}

const thresholdText = ({ attribute, smallest, largest }: Threshold): string =>
  [encodeURIComponent(attribute), smallest, ...(largest === undefined ? [] : [largest])].join(',');

function lightIn(text: string): Light | undefined {
  const numbers = numbersIn(text);
  const [x = NaN, y = NaN, z = NaN, power = NaN] = numbers;
  if (numbers.length !== 4 || !numbers.every(Number.isFinite) || power < 0) return undefined;
  return Math.hypot(x, y, z) > 0 ? { direction: vector(x, y, z), power } : undefined;
}

export function parseGlyphs(values: URLSearchParams): GlyphOptions {
  if (!['glyph', 'glyph_radius', 'glyph_scale', 'threshold'].some((name) => values.has(name))) return defaultGlyphs;
  const [kind, sharp] = (values.get('glyph') ?? '').split(',');
  const shape = namedIn(glyphShapes, kind);
  const [sharpness = NaN] = numbersIn(sharp ?? '');
  const scale = Number(values.get('glyph_scale') ?? NaN);
  const thresholds = values.get('threshold');
  return {
    shape: shape ?? defaultGlyphs.shape,
    sharpness: shape && sharpness >= 0 && sharpness <= maxSharpness ? sharpness : defaultGlyphs.sharpness,
    radius: namedIn(choices.glyphRadius, values.get('glyph_radius')) ?? defaultGlyphs.radius,
    scale: scale > 0 && Number.isFinite(scale) ? scale : undefined,
    thresholds: (thresholds && listOf(thresholds.split(';'), maxThresholds, thresholdIn)) || [],
  };
}

/** AMBIENT,SPECULAR,EXPONENT;X,Y,Z,POWER;..; undefined: a headlight. */
export function parseLights(text: string | null): Lighting | undefined {
  const [terms = '', ...rest] = (text ?? '').split(';');
  const numbers = numbersIn(terms);
  const [ambient = NaN, specular = NaN, exponent = NaN] = numbers;
  const known = numbers.length === 3 && numbers.every((part) => Number.isFinite(part) && part >= 0);
  const lights = listOf(rest, maxLights, lightIn);
  return known && lights && lights.length > 0 ? { ambient, specular, exponent, lights } : undefined;
}

/** Only the parameters that differ from their defaults. */
export function glyphParameters(glyphs: GlyphOptions, lighting: Lighting | undefined) {
  const { shape, sharpness, radius, scale, thresholds } = glyphs;
  const sharp = sharpness === defaultGlyphs.sharpness ? '' : `,${sharpness}`;
  const usual = shape === defaultGlyphs.shape && sharp === '';
  return {
    glyph: usual ? undefined : shape + sharp,
    glyph_radius: radius === defaultGlyphs.radius ? undefined : radius,
    glyph_scale: scale === undefined ? undefined : String(scale),
    threshold: thresholds.length > 0 ? thresholds.map(thresholdText).join(';') : undefined,
    lights: lighting && formatLights(lighting),
  };
}

function formatLights({ ambient, specular, exponent, lights }: Lighting): string {
  const parts = lights.map(({ direction: { x, y, z }, power }) => `${x},${y},${z},${power}`);
  return [`${ambient},${specular},${exponent}`, ...parts].join(';');
}

/** The first light over the right shoulder, with soft highlights. */
export const firstLight: Lighting = {
  ambient: 0.1,
  specular: 0.25,
  exponent: 32,
  lights: [{ direction: vector(0.5, 0.7, -0.6), power: 0.9 }],
};

const degrees = 180 / Math.PI;

/** Where a light comes from, degrees: to the right of the eye, and above it. */
export function anglesOf({ x, y, z }: Vector): { readonly right: number; readonly above: number } {
  const round = (angle: number): number => Math.round(angle * degrees);
  return { right: round(Math.atan2(x, -z)), above: round(Math.atan2(y, Math.hypot(x, z))) };
}

export function directionAt(right: number, above: number): Vector {
  const across = Math.cos(above / degrees);
  const part = (value: number): number => Number(value.toFixed(4)) + 0; // no -0 in links
  return vector(
    part(across * Math.sin(right / degrees)),
    part(Math.sin(above / degrees)),
    part(-across * Math.cos(right / degrees)),
  );
}
