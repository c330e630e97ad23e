import type { Vector } from '../camera/vector';
import { measurements, growing, tool } from '../state/store';
import { isFull, isWhole, measureKinds, type MeasureKind, type Measurement } from './measurement';

/** Adds and removes measurements. */

let lastId = 0;

export const measuring = (): MeasureKind | undefined => measureKinds.find((kind) => kind === tool.peek());

const current = (): Measurement | undefined => measurements.peek().find((m) => m.id === growing.peek());

function put(changed: Measurement): void {
  const others = measurements.peek();
  const known = others.some((m) => m.id === changed.id);
  measurements.value = known ? others.map((m) => (m.id === changed.id ? changed : m)) : [...others, changed];
}

export function addPoint(kind: MeasureKind, point: Vector): void {
  const before = current();
  const m = before?.kind === kind ? before : { id: ++lastId, kind, points: [] };
  if (before && before !== m) finish();
  const grown = { ...m, points: [...m.points, point] };
  put(grown);
  growing.value = isFull(grown) ? undefined : grown.id;
}

/** Ends the measurement in progress; removes it if it has too few points. */
export function finish(): void {
  const m = current();
  growing.value = undefined;
  if (m && !isWhole(m)) remove(m.id);
}

export function undoPoint(): void {
  const m = current();
  if (!m) return;
  if (m.points.length <= 1) remove(m.id);
  else put({ ...m, points: m.points.slice(0, -1) });
}

export function remove(id: number): void {
  measurements.value = measurements.peek().filter((m) => m.id !== id);
  if (growing.peek() === id) growing.value = undefined;
}

export function clear(): void {
  measurements.value = [];
  growing.value = undefined;
}
