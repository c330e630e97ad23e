import { describe, expect, it } from 'vitest';
import { vector } from '../src/camera/vector';
import { glyphOf, glyphPixels, linesOf, type Value } from '../src/state/glyph';

const values: Value[] = [
  { attribute: 'fa', value: 0.5 },
  ...[4, 2, 1].map((value, i) => ({ attribute: `eigenvalue_${i + 1}`, value })),
  ...[1, 2, 3].flatMap((i) =>
    ['x', 'y', 'z'].map((part, k) => ({ attribute: `eigenvector_${i}_${part}`, value: i === k + 1 ? 1 : 0 })),
  ),
  ...['i', 'j', 'k'].map((attribute, i) => ({ attribute, value: 10 + i })),
  { attribute: 'confidence', value: 1 },
];

const front = { right: vector(1, 0, 0), up: vector(0, 0, 1), forward: vector(0, 1, 0) };

describe('the glyph of a pick', () => {
  it('is read from its attributes', () => {
    const glyph = glyphOf(values)!;
    expect(glyph.semiAxes).toEqual([4, 2, 1]);
    expect(glyph.axes[2]).toEqual(vector(0, 0, 1));
    expect(glyph.tensor).toBe(true);
  });

  it('is none of other items', () => {
    expect(glyphOf([{ attribute: 'intensity', value: 3 }])).toBeUndefined();
    expect(glyphOf(values.slice(0, 5))).toBeUndefined();
  });

  it('is told in a line for each axis', () => {
    const lines = linesOf(values, ({ value }) => String(value));
    expect(lines).toContainEqual(['eigenvalue', '4 2 1']);
    expect(lines).toContainEqual(['eigenvector 1', '1 0 0']);
    expect(lines).toContainEqual(['sample', '10 11 12']);
    expect(lines).toContainEqual(['confidence', '1']);
  });

  it('fills its picture along its longest axis', () => {
    const size = 64;
    const pixels = glyphPixels(glyphOf(values)!, front, undefined, size);
    const covered = (row: number, column: number): boolean => pixels[4 * (row * size + column) + 3]! > 0;
    const widest = [...Array(size).keys()].filter((column) => covered(size / 2, column)).length;
    const highest = [...Array(size).keys()].filter((row) => covered(row, size / 2)).length;
    expect(widest).toBeGreaterThan(58);
    expect(highest).toBeGreaterThanOrEqual(14);
    expect(highest).toBeLessThanOrEqual(16);
  });

  it('has the colour of its direction, brightest where it faces the eye', () => {
    const pixels = glyphPixels(glyphOf(values)!, front, undefined, 65);
    const [red, green] = pixels.slice(4 * (32 * 65 + 32), 4 * (32 * 65 + 32) + 2);
    expect(red).toBeGreaterThan(180);
    expect(green).toBeGreaterThan(50);
    expect(green).toBeLessThan(70);
  });

  it('stays finite when it is a flat disc', () => {
    const disc = { ...glyphOf(values)!, semiAxes: [1, 1, 0] };
    const pixels = glyphPixels(disc, { ...front, up: vector(0, 1, 0), forward: vector(0, 0, 1) }, [10, 20, 30], 33);
    expect([...pixels.slice(4 * (16 * 33 + 16), 4 * (16 * 33 + 16) + 4)]).toEqual([10, 20, 30, 255]);
  });
});
