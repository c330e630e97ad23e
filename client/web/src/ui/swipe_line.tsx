import type { JSX } from 'preact';
import { swipe, swipeAt } from '../state/store';

const step = 0.02; // of the width, for a press of an arrow key

const moveTo = (share: number): number => (swipeAt.value = Math.min(1, Math.max(0, share)));

function drag(event: JSX.TargetedPointerEvent<HTMLDivElement>): void {
  const line = event.currentTarget;
  if (!line.hasPointerCapture(event.pointerId) || !line.parentElement) return;
  const { left, width } = line.parentElement.getBoundingClientRect();
  moveTo((event.clientX - left) / width);
}

function press(event: JSX.TargetedKeyboardEvent<HTMLDivElement>): void {
  const way = { ArrowLeft: -step, ArrowRight: step }[event.key];
  if (way === undefined) return;
  moveTo(swipeAt.peek() + way);
  event.preventDefault();
  event.stopPropagation();
}

/** The line between two models of the view. */
export function SwipeLine(): JSX.Element | null {
  if (!swipe.value) return null;
  return (
    <div
      class="swipe-line"
      role="slider"
      tabIndex={0}
      aria-label={`Between ${swipe.value.left} and ${swipe.value.right}`}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(100 * swipeAt.value)}
      style={{ left: `${100 * swipeAt.value}%` }}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onKeyDown={press}
    >
      <span class="of-left">{swipe.value.left}</span>
      <span class="of-right">{swipe.value.right}</span>
    </div>
  );
}
