import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { vector } from '../src/camera/vector';
import { EllipsoidDescriptionSchema, GlyphRadius, GlyphShape } from '../src/generated/surfcast_pb';
import { pictureOf } from '../src/protocol/pictures';
import { defaultDisplay } from '../src/state/display_options';
import { attributeNames, attributeRange, usualScale } from '../src/state/ellipsoids';
import { anglesOf, defaultGlyphs, directionAt, firstLight } from '../src/state/glyph_options';

const range = (attribute: string, smallest: number, largest: number) => ({ attribute, smallest, largest });
const sources = [
  create(EllipsoidDescriptionSchema, { scale: 2, rootScale: 3, ranges: [range('fa', 0.1, 0.8), range('md', 1, 2)] }),
  create(EllipsoidDescriptionSchema, { scale: 9, ranges: [range('fa', 0.05, 0.5), range('trace', -4, 4)] }),
];
const size = { width: 40, height: 30 };

describe('the ellipsoids of a model', () => {
  it('have the attributes of all sources, over the values of all', () => {
    expect(attributeNames(sources)).toEqual(['fa', 'md', 'trace']);
    expect(attributeRange(sources, 'fa')).toEqual([0.05, 0.8]);
    expect(attributeRange(sources, 'mass')).toEqual([0, 1]);
  });

  it('have the size that the server says, for each way to measure semi-axes', () => {
    expect(usualScale(sources, 'eigenvalue')).toBe(2);
    expect(usualScale(sources, 'root')).toBe(3);
    expect(usualScale(sources, 'unit')).toBeUndefined();
    expect(usualScale([], 'eigenvalue')).toBeUndefined();
  });

  it('are asked for as they are chosen', () => {
    const glyphs = {
      ...defaultGlyphs,
      shape: 'superquadric' as const,
      radius: 'unit' as const,
      scale: 0.5,
      thresholds: [{ attribute: 'fa', smallest: 0.2, largest: undefined }],
    };
    const display = { ...defaultDisplay, source: 'attribute' as const, attribute: 'md', glyphs, lighting: firstLight };
    const picture = pictureOf('brain', undefined, display, size);
    expect(picture.glyphs).toMatchObject({
      shape: GlyphShape.SUPERQUADRIC,
      radius: GlyphRadius.UNIT,
      scale: 0.5,
      thresholds: [{ attribute: 'fa', smallest: 0.2 }],
    });
    expect(picture.glyphs?.thresholds[0]?.largest).toBeUndefined();
    expect(picture.lighting).toMatchObject({ ambient: 0.1, lights: [{ power: 0.9, direction: { x: 0.5 } }] });
    expect(picture.coloring?.attribute).toBe('md');
  });

  it('are not spoken of in requests of usual pictures', () => {
    const picture = pictureOf('lion', undefined, defaultDisplay, size);
    expect(picture.glyphs).toBeUndefined();
    expect(picture.lighting).toBeUndefined();
  });
});

describe('a light', () => {
  it('of the eye is neither right of it nor above it', () => {
    expect(anglesOf(vector(0, 0, -2))).toEqual({ right: 0, above: 0 });
    expect(anglesOf(vector(1, 0, 0)).right).toBe(90);
    expect(anglesOf(vector(0, 1, -1)).above).toBe(45);
  });

  it('comes from where its angles say', () => {
    for (const right of [-170, -90, 0, 33, 180]) {
      for (const above of [-89, -10, 0, 60]) {
        expect(anglesOf(directionAt(right, above))).toEqual({ right, above });
      }
    }
  });
});
