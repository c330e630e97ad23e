import type { JSX } from 'preact';
import { useActions } from './actions';

interface SpanSliderProps {
  readonly label: string;
  readonly low: number;
  readonly high: number;
  readonly from: number;
  readonly to: number;
  readonly onInput: (end: 'min' | 'max', value: number) => void;
}

/** A slider with two thumbs that selects an interval of a range. */
export function SpanSlider({ label, low, high, from, to, onInput }: SpanSliderProps): JSX.Element {
  const { navigator } = useActions();
  const span = high - low || 1;
  const percent = (value: number): number => Math.min(100, Math.max(0, ((value - low) / span) * 100));
  const thumb = (end: 'min' | 'max', value: number): JSX.Element => (
    <input
      type="range"
      aria-label={`${label} ${end === 'min' ? 'from' : 'to'}`}
      min={0}
      max={1000}
      step={1}
      value={percent(value) * 10}
      onPointerDown={() => navigator.adjust(true)}
      onPointerUp={() => navigator.adjust(false)}
      onPointerCancel={() => navigator.adjust(false)}
      onInput={(event) => onInput(end, low + (span * event.currentTarget.valueAsNumber) / 1000)}
    />
  );
  return (
    <div class="span-slider" style={{ '--from': `${percent(from)}%`, '--to': `${percent(to)}%` }}>
      {thumb('min', from)}
      {thumb('max', to)}
    </div>
  );
}
