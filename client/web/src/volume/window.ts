import { fitTo, rangeOf, windowOf, type Transfer, type TransferPoint } from './transfer';

/** Window and level: the width of the range of values that a transfer function spans, and its centre. */

export interface Window {
  readonly level: number;
  readonly width: number;
}

/** What a window is set of: the transfer function, the points that the server makes of it, and the span of all values. */
export interface Windowed {
  readonly transfer: Transfer;
  readonly points: readonly TransferPoint[];
  readonly span: number;
}

const narrowest = 1e-4; // of the span
const digits = 1e-5; // of the span: values are rounded, so that links are short

export function windowNow({ points }: Windowed): Window {
  const [first, last] = rangeOf(points);
  return { level: (first + last) / 2, width: last - first };
}

const rounded = (value: number, span: number): number => {
  const decimals = Math.min(12, Math.max(0, Math.ceil(-Math.log10((span || 1) * digits))));
  return Number(value.toFixed(decimals));
};

/** The transfer function with another window. Points of its own are moved; a preset has its ends stated. */
export function withWindow({ transfer, points, span }: Windowed, { level, width }: Window): Transfer {
  const [first, last] = windowOf(level, width, (span || 1) * narrowest);
  const range = [rounded(first, span), rounded(last, span)] as const;
  if (!(range[0] < range[1])) return transfer;
  if (transfer.points.length === 0) return { ...transfer, range };
  const from = rangeOf(points);
  if (from[0] === from[1]) return transfer; // a step has no width
  const moved = fitTo(transfer.points, from, range);
  return { ...transfer, points: moved.map((point) => ({ ...point, value: rounded(point.value, span) })) };
}

/**
 * The window after a drag over the picture, as viewers of CT and MR have it: to the right it becomes wider, upwards the
 * level falls and the picture gets brighter. Distances are shares of the picture's shorter side.
 */
export function draggedWindow(start: Window, span: number, right: number, up: number): Window {
  return { level: start.level - up * span, width: Math.max(0, start.width + right * span) };
}
