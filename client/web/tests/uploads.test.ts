import { describe, expect, it } from 'vitest';
import { inOrder, modelOf, problemOf, refusal } from '../src/input/uploads';

const rules = { maxBytes: 1000n, extensions: ['.laz', '.ply'] };

describe('a dropped file', () => {
  it('is sent if it is a scan by its name, in any case, and not too large', () => {
    expect(refusal({ name: 'Church.LAZ', size: 1000 }, rules)).toBeUndefined();
  });
  it('is not sent otherwise, with the reason', () => {
    expect(refusal({ name: 'notes.docx', size: 10 }, rules)).toContain('.laz .ply');
    expect(refusal({ name: 'laz', size: 10 }, rules)).toContain('Not a scan');
    expect(refusal({ name: 'a.laz', size: 0 }, rules)).toContain('empty');
    expect(refusal({ name: 'a.laz', size: 1001 }, rules)).toContain('Larger');
  });
  it('has the name that the server gives it', () => {
    expect(modelOf('{"model": "Two halves"}')).toBe('Two halves');
    expect(modelOf('{"file": "ct.raw"}')).toBeUndefined();
  });
  it('with two extensions is told by both', () => {
    const niftis = { ...rules, extensions: ['.nii.gz'] };
    expect(refusal({ name: 'brain.nii.gz', size: 9 }, niftis)).toBeUndefined();
    expect(refusal({ name: 'brain.gz', size: 9 }, niftis)).toContain('Not a scan');
  });
  it('goes before the header that names it', () => {
    const names = ['a.MHD', 'a.raw', 'b.nhdr', 'c.laz'];
    expect(inOrder(names.map((name) => ({ name }))).map(({ name }) => name)).toEqual([
      'a.raw', 'c.laz', 'a.MHD', 'b.nhdr',
    ]);
  });
  it('waits for the materials and pictures that it names', () => {
    const names = ['statue.obj', 'statue.png', 'scan.ply', 'statue.mtl', 'cat.gltf', 'cat.bin'];
    expect(inOrder(names.map((name) => ({ name }))).map(({ name }) => name)).toEqual([
      'statue.png', 'statue.mtl', 'cat.bin', 'statue.obj', 'scan.ply', 'cat.gltf',
    ]);
  });
  it('shows what the server says', () => {
    expect(problemOf(400, '{"error": {"message": "a.laz: there is a scan of that name already"}}')).toBe(
      'a.laz: there is a scan of that name already',
    );
    expect(problemOf(413, '<html>')).toBe('The server answered 413.');
    expect(problemOf(0, '')).toBe('The connection was lost.');
  });
});
