import { batch } from '@preact/signals';
import { center, type Box } from '../camera/standard_views';
import { add, scale, subtract, type Vector } from '../camera/vector';
import type { Clip } from '../state/look';
import * as store from '../state/store';

/** Adds, changes and removes clip boxes of the look. */

const around = (middle: Vector, box: Box, part: number): Box => {
  const half = scale(subtract(box.max, box.min), part / 2);
  return { min: subtract(middle, half), max: add(middle, half) };
};

function addClip(box: Box): void {
  const look = store.look.peek();
  batch(() => {
    store.editedClip.value = look.clips.length;
    store.look.value = { ...look, clips: [...look.clips, { box, inverted: false }] };
  });
}

/** A box of a third of the model around a point. */
export function addClipAround(point: Vector): void {
  addClip(around(point, store.bounds.peek(), 1 / 3));
  store.panel.value = 'clip';
  store.tool.value = 'navigate';
}

export function addClipInTheMiddle(): void {
  const bounds = store.bounds.peek();
  addClip(around(center(bounds), bounds, 0.6));
}

export function changeClip(index: number, change: Partial<Clip>): void {
  const look = store.look.peek();
  const clips = look.clips.map((clip, i) => (i === index ? { ...clip, ...change } : clip));
  store.look.value = { ...look, clips };
}

export function removeClip(index: number): void {
  const look = store.look.peek();
  batch(() => {
    store.editedClip.value = undefined;
    store.look.value = { ...look, clips: look.clips.filter((_, i) => i !== index) };
  });
}
