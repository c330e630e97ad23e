import { diagonal, type Box } from '../camera/standard_views';
import { add, subtract, vector } from '../camera/vector';
import { axisNames, type AxisName } from '../overlay/clip_handles';
import type { DisplayOptions } from './display_options';

/** The part of a scan that is shown, in the terms of the server's points of a region. */
export interface Region {
  readonly boxes: readonly Box[]; // a point is in one of them; none: everywhere
  readonly classes: readonly number[]; // none: all
}

/** `problem`: why no region can be asked for, as a sentence. */
export type ShownRegion = Region | { readonly problem: string };

/** What is known of a scan. */
export interface ScanExtent {
  readonly bounds: Box;
  readonly classified: boolean;
  readonly classes: readonly number[]; // those that occur; none: not known
}

const maxBoxes = 64; // the server's limit
const allClasses = Array.from({ length: 256 }, (_, code) => code);

/** The next double above a number, or below it. */
export function neighbour(value: number, direction: 1 | -1): number {
  if (value === 0) return direction * Number.MIN_VALUE;
  const bits = new BigInt64Array(new Float64Array([value]).buffer);
  bits[0]! += BigInt(value > 0 ? direction : -direction);
  return new Float64Array(bits.buffer)[0]!;
}

const moved = (box: Box, end: keyof Box, axis: AxisName, value: number): Box => ({
  ...box,
  [end]: { ...box[end], [axis]: value },
});

/** Boxes with the points of a box that are not in a hidden one. Faces belong to their box, also to a hidden one. */
export function without(box: Box, hidden: Box): Box[] {
  const apart = axisNames.some((axis) => box.max[axis] < hidden.min[axis] || box.min[axis] > hidden.max[axis]);
  if (apart) return [box];
  const left: Box[] = [];
  let rest = box;
  for (const axis of axisNames) {
    if (rest.min[axis] < hidden.min[axis]) {
      left.push(moved(rest, 'max', axis, neighbour(hidden.min[axis], -1)));
      rest = moved(rest, 'min', axis, hidden.min[axis]);
    }
    if (rest.max[axis] > hidden.max[axis]) {
      left.push(moved(rest, 'min', axis, neighbour(hidden.max[axis], 1)));
      rest = moved(rest, 'max', axis, hidden.max[axis]);
    }
  }
  return left;
}

/** A box that holds all points of a model, whatever the rounding of its bounds. */
function around(bounds: Box): Box {
  const margin = vector(diagonal(bounds), diagonal(bounds), diagonal(bounds));
  return { min: subtract(bounds.min, margin), max: add(bounds.max, margin) };
}

/** The shown part of the world; undefined: all of it. */
function shownBoxes({ clips }: DisplayOptions, bounds: Box): Box[] | undefined {
  const inside = clips.filter(({ inverted }) => !inverted).map(({ box }) => box);
  const hidden = clips.filter(({ inverted }) => inverted).map(({ box }) => box);
  if (clips.length === 0) return undefined;
  const all = inside.length > 0 ? inside : [around(bounds)];
  return hidden.reduce((boxes, hide) => boxes.flatMap((box) => without(box, hide)), all);
}

/** The classes that are shown; undefined: all of them. Those that are wholly transparent are hidden, too. */
function shownClasses({ hiddenClasses, classOpacities }: DisplayOptions, scan: ScanExtent): number[] | undefined {
  const clear = classOpacities.filter(({ opacity }) => opacity === 0).map(({ code }) => code);
  const hidden = new Set([...hiddenClasses, ...clear]);
  const known = scan.classes.length > 0 ? scan.classes : allClasses;
  const shown = known.filter((code) => !hidden.has(code));
  return scan.classified && shown.length < known.length ? shown : undefined;
}

export function regionOf(display: DisplayOptions, scan: ScanExtent): ShownRegion {
  const boxes = shownBoxes(display, scan.bounds);
  const classes = shownClasses(display, scan);
  if (boxes?.length === 0) return { problem: 'The clip boxes hide all points.' };
  if (classes?.length === 0) return { problem: 'All classes are hidden.' };
  if ((boxes?.length ?? 0) > maxBoxes) {
    return { problem: `The clip boxes divide the model into more than ${maxBoxes} parts. Use fewer boxes.` };
  }
  return { boxes: boxes ?? [], classes: classes ?? [] };
}
