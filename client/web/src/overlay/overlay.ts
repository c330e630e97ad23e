import { effect } from '@preact/signals';
import { depthOf, type Projection } from '../camera/projection';
import type { UpAxis } from '../camera/pose';
import { mix, type Vector } from '../camera/vector';
import { linesOf } from '../measure/format';
import { angleAt, arc, cornerBelow, isWhole, type Measurement } from '../measure/measurement';
import { kept } from '../state/annotation_storage';
import { shortened } from '../state/annotations';
import * as store from '../state/store';
import { handlesOf } from './clip_handles';
import { Pen } from './shapes';

export const colors = {
  measure: '#ffc27a',
  measureFaint: 'rgba(255, 194, 122, 0.55)',
  measureFill: 'rgba(255, 194, 122, 0.16)',
  clip: '#62d6c3',
  clipFaint: 'rgba(98, 214, 195, 0.6)',
  hide: '#f0857d',
  hideFaint: 'rgba(240, 133, 125, 0.6)',
  inspect: '#ffffff',
  annotation: '#ffe08a',
};

function angleOf(pen: Pen, [a, middle, b]: [Vector, Vector, Vector]): void {
  const radius = 36 / (pen.view.eta / Math.max(1e-12, depthOf(pen.view, middle))) * pen.ratio;
  if (angleAt(a, middle, b) > 0) pen.lines(arc(a, middle, b, radius, 24), colors.measure);
}

function shape(pen: Pen, m: Measurement, up: UpAxis): void {
  const { points } = m;
  const [a, b] = points;
  if (m.kind === 'area' && points.length >= 3) {
    pen.fill(points, colors.measureFill);
    pen.line(points[points.length - 1]!, a!, colors.measure);
  }
  if (m.kind === 'height' && a && b) {
    const corner = cornerBelow(a, b, up);
    pen.line(a, corner, colors.measure, 2);
    pen.line(corner, b, colors.measureFaint, 1.25, [4, 5]);
    return;
  }
  pen.lines(points, colors.measure, m.kind === 'profile' ? 2.25 : 1.75);
  if (m.kind === 'angle' && points.length === 3) angleOf(pen, points as unknown as [Vector, Vector, Vector]);
}

/** Position of the label with the measurement's main result. */
function labelPoint(m: Measurement, up: UpAxis): Vector {
  const { points } = m;
  const [a, b] = [points[0]!, points[1]!];
  if (m.kind === 'height') return mix(a, cornerBelow(a, b, up), 0.5);
  if (m.kind === 'angle') return b;
  if (m.kind === 'area') return points.reduce((sum, p, i) => mix(sum, p, 1 / (i + 1)), a);
  return points.length === 2 ? mix(a, b, 0.5) : points[points.length - 1]!;
}

function measurement(pen: Pen, m: Measurement, up: UpAxis, decimals: number, growing: boolean): void {
  shape(pen, m, up);
  for (const point of m.points) pen.dot(point, colors.measure, growing ? 4.5 : 3.5);
  const main = linesOf(m, up, decimals)[0];
  if (main && isWhole(m)) pen.label(labelPoint(m, up), main.value, colors.measure);
}

const showsClips = (): boolean => store.panel.value === 'clip' || store.tool.value === 'clip';

function clips(pen: Pen): void {
  if (!showsClips()) return;
  const edited = store.editedClip.value;
  store.display.value.clips.forEach(({ box, inverted }, i) => {
    const here = i === edited;
    const color = inverted ? (here ? colors.hide : colors.hideFaint) : here ? colors.clip : colors.clipFaint;
    pen.box(box, color, here ? 1.75 : 1.25, here ? [] : [5, 5]);
    if (here) for (const handle of handlesOf(box)) pen.dot(handle.at, color, 6);
  });
}

function annotations(pen: Pen): void {
  for (const annotation of kept.value?.annotations ?? []) {
    const shown = annotation === store.shownAnnotation.value;
    pen.dot(annotation.position, colors.annotation, shown ? 7 : 5);
    pen.label(annotation.position, shortened(annotation.text, 24), colors.annotation);
  }
}

function inspected(pen: Pen): void {
  const inspection = store.inspection.value;
  if (!inspection) return;
  pen.ring(inspection.at, colors.inspect, 9);
  pen.dot(inspection.at, colors.inspect, 2.5);
}

function isEmpty(): boolean {
  const clipped = showsClips() && store.display.value.clips.length > 0;
  const annotated = (kept.value?.annotations ?? []).length > 0;
  return !clipped && !annotated && store.measurements.value.length === 0 && !store.inspection.value;
}

function draw(context: CanvasRenderingContext2D, view: Projection, ratio: number): void {
  const pen = new Pen(context, view, ratio);
  const decimals = store.lengthDecimals.value;
  clips(pen);
  for (const m of store.measurements.value) {
    measurement(pen, m, store.upAxis.value, decimals, m.id === store.growing.value);
  }
  annotations(pen);
  inspected(pen);
}

/**
 * Redraws the overlay whenever the picture, a measurement or a clip box changes. An empty one is hidden: to lay it over
 * the picture would take time of each frame.
 */
export function startOverlay(canvas: HTMLCanvasElement): () => void {
  const context = canvas.getContext('2d');
  if (!context) throw new Error('This browser does not support 2D canvases.');
  return effect(() => {
    canvas.hidden = isEmpty();
    if (canvas.hidden) return;
    const view = store.shownProjection.value;
    const width = view?.width ?? 1;
    const height = view?.height ?? 1;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    context.clearRect(0, 0, width, height);
    if (view) draw(context, view, width / Math.max(1, canvas.clientWidth));
  });
}
