import { describe, expect, it } from 'vitest';
import { formatKept, parseKept, shortened, type Kept } from '../src/state/annotations';
import { parsePlace } from '../src/state/place';
import { linkOf, parametersOf } from '../src/state/saved_views';

const parameters = { position: '1,2,3', focal_point: '0,0,0', of_another_program: 'yes' };
const kept: Kept = {
  views: [{ name: 'Gate', parameters }],
  annotations: [{ text: 'A crack\nin the wall', position: { x: 1.5, y: -2, z: 1e-7 }, parameters }],
};

describe('what the server keeps of a model', () => {
  it('comes back to the letter, with parameters that the page does not know', () => {
    expect(parseKept(formatKept(kept))).toEqual(kept);
  });

  it('has the places as lists of three numbers', () => {
    const document = JSON.parse(formatKept(kept)) as { annotations: { position: number[] }[] };
    expect(document.annotations[0]!.position).toEqual([1.5, -2, 1e-7]);
  });

  it('leads to views by links', () => {
    const link = linkOf(parameters, 'église 2');
    expect(parsePlace(link)).toMatchObject({ model: 'église 2', camera: { position: { x: 1, y: 2, z: 3 } } });
    expect(parametersOf(link)).toMatchObject({ position: '1,2,3', focal_point: '0,0,0' });
  });

  it('is shortened to the first words', () => {
    expect(shortened('A crack\nin the wall')).toBe('A crack');
    expect(shortened('x'.repeat(50), 10)).toBe(`${'x'.repeat(9)}…`);
  });
});
