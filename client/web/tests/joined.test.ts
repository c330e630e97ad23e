import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ModelDescriptionSchema } from '../src/generated/surfcast_pb';
import { memberContents } from '../src/state/contents';
import { canJoin, hiddenAt, isServed, membersOf, shownName, withMember, withoutMember } from '../src/state/joined';
import { defaultDisplay } from '../src/state/display_options';
import { formatPlace, parsePlace } from '../src/state/place';

const joined = create(ModelDescriptionSchema, {
  members: [
    { model: 'nave', kinds: [{ kind: 'surfel', items: 1200n }] },
    { model: 'tower', kinds: [{ kind: 'grid', items: 8n }, { kind: 'gaussian', items: 2n }] },
  ],
});

describe('models that are shown together', () => {
  it('are named by their description', () => {
    expect(membersOf('nave+tower', joined)).toEqual(['nave', 'tower']);
    expect(membersOf('a+b', create(ModelDescriptionSchema, {}))).toEqual(['a+b']); // one model of this name
    expect(membersOf(undefined, undefined)).toEqual([]);
    expect(joined.members.map(memberContents)).toEqual(['1.2K points', '2 Gaussians, volume']);
  });

  it('are added and taken out', () => {
    expect(withMember(['nave'], 'tower')).toBe('nave+tower');
    expect(withoutMember(['nave', 'tower', 'crypt'], 'tower')).toBe('nave+crypt');
    expect(canJoin(['nave'], 'tower')).toBe(true);
    expect(canJoin(['nave'], 'a+b')).toBe(false);
    expect(canJoin(['a+b'], 'nave')).toBe(false);
    expect(canJoin(Array.from({ length: 64 }, (_, i) => `tile ${i}`), 'tower')).toBe(false);
    expect(canJoin([], 'tower')).toBe(false);
  });

  it('have the name of those that are not hidden', () => {
    expect(shownName(['nave', 'tower', 'crypt'], ['tower'])).toBe('nave+crypt');
    expect(shownName(['nave', 'tower'], ['tower', 'nave'])).toBe('nave+tower');
  });

  it('are on one side of a line each', () => {
    const swipe = { left: 'before', right: 'after' };
    expect(hiddenAt('left', ['tower'], swipe)).toEqual(['tower', 'after']);
    expect(hiddenAt('right', ['tower'], swipe)).toEqual(['tower', 'before']);
    expect(hiddenAt('right', ['tower'], undefined)).toEqual(['tower']);
  });

  it('are served if each of them is', () => {
    expect(isServed('nave+tower', ['nave', 'tower'])).toBe(true);
    expect(isServed('nave+crypt', ['nave', 'tower'])).toBe(false);
    expect(isServed('a+b', ['a+b'])).toBe(true);
  });

  it('have plus signs between them in a link', () => {
    const place = { model: 'nave+tower 2', camera: undefined, display: defaultDisplay };
    expect(formatPlace(place)).toBe('#/nave+tower%202');
    expect(parsePlace('#/nave+tower%202')).toEqual(place);
  });
});
