import { batch } from '@preact/signals';
import { center, type Box } from '../camera/standard_views';
import { add, scale, subtract, type Vector } from '../camera/vector';
import type { Clip } from '../state/display_options';
import * as store from '../state/store';

/** Adds, changes and removes clip boxes of the display options. */

const around = (middle: Vector, box: Box, part: number): Box => {
  const half = scale(subtract(box.max, box.min), part / 2);
  return { min: subtract(middle, half), max: add(middle, half) };
};

function addClip(box: Box): void {
  const display = store.display.peek();
  batch(() => {
    store.editedClip.value = display.clips.length;
    store.display.value = { ...display, clips: [...display.clips, { box, inverted: false }] };
  });
}

/** Adds a box around a point, a third of the size of the model. */
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
  const display = store.display.peek();
  const clips = display.clips.map((clip, i) => (i === index ? { ...clip, ...change } : clip));
  store.display.value = { ...display, clips };
}

export function removeClip(index: number): void {
  const display = store.display.peek();
  batch(() => {
    store.editedClip.value = undefined;
    store.display.value = { ...display, clips: display.clips.filter((_, i) => i !== index) };
  });
}
