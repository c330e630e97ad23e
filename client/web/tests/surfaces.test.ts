import { describe, expect, it } from 'vitest';
import {
  formatSlices,
  formatSurfaces,
  indexAcross,
  isoGray,
  maxSurfaces,
  parseSlices,
  parseSurfaces,
  withSlice,
  withSurface,
  type Slice,
} from '../src/volume/surfaces';

describe('the text of iso-surfaces', () => {
  it('is read back as it was written', () => {
    for (const text of ['300', '-500.5;300,230,220,200', '1e-7,0,0,255,0.5']) {
      expect(formatSurfaces(parseSurfaces(text))).toBe(text);
    }
    expect(formatSurfaces([])).toBeUndefined();
  });

  it('states the usual grey only beside an opacity', () => {
    expect(formatSurfaces([{ value: 5, color: undefined, opacity: 0.5 }])).toBe('5,231,231,231,0.5');
    expect(parseSurfaces('5,231,231,231,0.5')).toEqual([{ value: 5, color: isoGray, opacity: 0.5 }]);
  });

  it.each(['', 'x', '1,2', '1,2,3,4,5,6', '1,2,3,256', '1,2,3,4,1.5', '1;', Array(maxSurfaces + 1).fill('1').join(';')])(
    'with nonsense has none: %s',
    (text) => expect(parseSurfaces(text)).toEqual([]),
  );
});

describe('the text of slices', () => {
  it('is read back as it was written', () => {
    for (const text of ['i,12', 'j,0.5;k,40', '1,2,3,0,0,-1']) expect(formatSlices(parseSlices(text))).toBe(text);
  });

  it.each(['i', 'i,', 'l,3', 'k,1,2', '1,2,3,0,0,0', '1,2,3,4,5'])('with nonsense has none: %s', (text) => {
    expect(parseSlices(text)).toEqual([]);
  });
});

describe('slices', () => {
  const plane: Slice = { axis: undefined, point: { x: 0, y: 0, z: 0 }, normal: { x: 0, y: 0, z: 1 } };

  it('across an axis are moved and taken away one by one', () => {
    const both = withSlice(withSlice([plane], 'i', 3), 'k', 4);
    expect(indexAcross(both, 'i')).toBe(3);
    expect(indexAcross(both, 'j')).toBeUndefined();
    expect(indexAcross(withSlice(both, 'i', 9), 'i')).toBe(9);
    expect(withSlice(withSlice(both, 'i', undefined), 'k', undefined)).toEqual([plane]);
  });
});

describe('surfaces', () => {
  it('change one by one', () => {
    const two = parseSurfaces('1;2');
    expect(formatSurfaces(withSurface(two, 1, { value: 7 }))).toBe('1;7');
  });
});
