import type { JSX } from 'preact';
import { useRef, useState } from 'preact/hooks';
import { fromHex, toHex, type Rgb } from '../state/rgb';
import {
  addPoint,
  barHeights,
  fitTo,
  lookUp,
  maxPoints,
  movePoint,
  rangeOf,
  recolorPoint,
  removePoint,
  windowOf,
  type TransferPoint,
} from '../volume/transfer';
import { useActions } from './actions';
import { NumberField } from './controls';

const width = 288; // user units of the drawing
const height = 120;
const bars = 96;
const shades = 32; // of the strip of colours
const handle = 6;
const reach = 2 * handle; // of the pointer around a point
const touchReach = 24; // CSS pixels
const narrowest = 1e-4; // window, of the range of the values

/** Small opacities matter most, so heights are their square roots. */
const heightOfOpacity = (opacity: number): number => Math.sqrt(opacity);
const opacityOfHeight = (part: number): number => Math.max(0, part) ** 2;

const css = ({ red, green, blue }: Rgb): string => `rgb(${red} ${green} ${blue})`;

interface TransferEditorProps {
  readonly points: readonly TransferPoint[];
  readonly low: number; // of the values
  readonly high: number;
  readonly counts: readonly number[]; // of the values, from `low` to `high`
  readonly decimals: number;
  readonly onChange: (points: readonly TransferPoint[]) => void;
}

/** The values that the editor shows: those of the volume, and all points. */
function shownWindow({ points, low, high }: TransferEditorProps): readonly [number, number] {
  const [first, last] = rangeOf(points);
  const from = Math.min(low, first);
  const to = Math.max(high, last);
  return to > from ? [from, to] : [from - 0.5, from + 0.5];
}

function Histogram(props: TransferEditorProps & { readonly logarithmic: boolean }): JSX.Element {
  const heights = barHeights(props.counts, props.low, props.high, shownWindow(props), bars, props.logarithmic);
  const step = width / bars;
  const path = heights.map((part, i) => `M${i * step} ${height}v${-part * height}h${step}v${part * height}z`).join('');
  return <path class="bars" d={path} />;
}

/** A strip of the colours. Dragging it moves the window sideways and widens it downwards. */
function ColorStrip(props: TransferEditorProps): JSX.Element {
  const { navigator } = useActions();
  const [from, to] = shownWindow(props);
  const start = useRef<{ x: number; y: number; points: readonly TransferPoint[] } | undefined>(undefined);
  const at = (i: number): number => from + ((to - from) * (i + 0.5)) / shades;
  const gradient = Array.from({ length: shades }, (_, i) => css(lookUp(props.points, at(i)).color)).join(', ');
  const drag = (event: JSX.TargetedPointerEvent<HTMLDivElement>): void => {
    const begun = start.current;
    if (!begun) return;
    const scale = (to - from) / event.currentTarget.clientWidth;
    const [first, last] = rangeOf(begun.points);
    const level = (first + last) / 2 + (event.clientX - begun.x) * scale;
    const span = last - first + (event.clientY - begun.y) * scale * 2;
    const window = windowOf(level, span, (props.high - props.low || 1) * narrowest);
    if (last > first) props.onChange(fitTo(begun.points, [first, last], window));
  };
  const stop = (): void => {
    start.current = undefined;
    navigator.adjust(false);
  };
  return (
    <div
      class="color-strip"
      role="img"
      aria-label="Colours. Drag sideways to move the window, up and down to change its width"
      title="Drag: level sideways, window up and down"
      style={{ background: `linear-gradient(to right, ${gradient})` }}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        start.current = { x: event.clientX, y: event.clientY, points: props.points };
        navigator.adjust(true);
      }}
      onPointerMove={drag}
      onPointerUp={stop}
      onPointerCancel={stop}
    />
  );
}

const curveLabel =
  'Opacity over value. Drag points; click to add one. ' +
  'Arrows move the chosen point, Page up and down choose, Delete removes';

/** What a key does to the chosen point: steps in value and height, hundredths of the drawing. */
const steps: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowDown: [0, -1],
  ArrowUp: [0, 1],
};

/** What a key chooses instead of a point: the one before or after it. */
const choices: Readonly<Record<string, number>> = { PageUp: -1, PageDown: 1 };

interface CurveProps extends TransferEditorProps {
  readonly chosen: number;
  readonly chosenNow: () => number; // also of a key that comes before the next drawing
  readonly logarithmic: boolean;
  readonly onChoose: (index: number) => void;
}

/** The opacities over the histogram. Points are dragged; a click beside them adds one; Delete removes one. */
function Curve(props: CurveProps): JSX.Element {
  const { navigator } = useActions();
  const { points, chosen } = props;
  const [from, to] = shownWindow(props);
  const dragged = useRef<number | undefined>(undefined);
  const x = (value: number): number => ((value - from) / (to - from)) * width;
  const y = (opacity: number): number => height * (1 - heightOfOpacity(opacity));
  const placeOf = (event: JSX.TargetedPointerEvent<SVGSVGElement>): { value: number; opacity: number } => {
    const box = event.currentTarget.getBoundingClientRect();
    const part = (event.clientX - box.left) / box.width;
    const up = 1 - (event.clientY - box.top) / box.height;
    return { value: from + (to - from) * part, opacity: opacityOfHeight(Math.min(1, up)) };
  };
  const near = (event: JSX.TargetedPointerEvent<SVGSVGElement>): number => {
    const box = event.currentTarget.getBoundingClientRect();
    const scale = box.width / width;
    const away = points.map((point) =>
      Math.hypot(
        event.clientX - box.left - x(point.value) * scale,
        event.clientY - box.top - (y(point.opacity) * box.height) / height,
      ),
    );
    const nearest = Math.min(...away);
    return nearest <= (event.pointerType === 'touch' ? touchReach : reach) ? away.indexOf(nearest) : -1;
  };
  const begin = (event: JSX.TargetedPointerEvent<SVGSVGElement>): void => {
    event.currentTarget.setPointerCapture(event.pointerId);
    let index = near(event);
    if (index === -1) {
      if (points.length >= maxPoints) return;
      const { value, opacity } = placeOf(event);
      const added = addPoint(points, value, opacity);
      index = added.index;
      props.onChange(added.points);
    }
    dragged.current = index;
    props.onChoose(index);
    navigator.adjust(true);
  };
  const stop = (): void => {
    dragged.current = undefined;
    navigator.adjust(false);
  };
  const nudge = ([right, up]: readonly [number, number], factor: number): void => {
    const index = props.chosenNow();
    const point = points[index];
    if (!point) return;
    const value = point.value + ((to - from) * right * factor) / 100;
    const part = heightOfOpacity(point.opacity) + (up * factor) / 100;
    props.onChange(movePoint(points, index, value, opacityOfHeight(Math.min(1, part))));
  };
  const press = (event: JSX.TargetedKeyboardEvent<SVGSVGElement>): boolean => {
    const index = props.chosenNow();
    const step = steps[event.key];
    const choice = choices[event.key];
    if (step) nudge(step, event.shiftKey ? 0.1 : 1);
    else if (choice !== undefined) props.onChoose(Math.min(points.length - 1, Math.max(0, index + choice)));
    else if (event.key === 'Delete' || event.key === 'Backspace') {
      props.onChange(removePoint(points, index));
      props.onChoose(Math.max(0, index - 1));
    } else return false;
    return true;
  };
  const line = points.map((point) => `${x(point.value)},${y(point.opacity)}`).join(' ');
  const first = points[0];
  const last = points[points.length - 1];
  const ends = first && last ? `0,${y(first.opacity)} ${line} ${width},${y(last.opacity)}` : '';
  return (
    <svg
      class="curve"
      viewBox={`0 0 ${width} ${height}`}
      preserveAspectRatio="none"
      tabindex={0} // of an SVG element, as the attribute is written
      role="application"
      aria-label={curveLabel}
      onPointerDown={begin}
      onPointerMove={(event) => {
        if (dragged.current === undefined) return;
        const { value, opacity } = placeOf(event);
        props.onChange(movePoint(points, dragged.current, value, opacity));
      }}
      onPointerUp={stop}
      onPointerCancel={stop}
      onKeyDown={(event) => {
        if (!press(event)) return;
        event.preventDefault();
        event.stopPropagation();
      }}
    >
      <Histogram {...props} />
      <polyline class="opacity" points={ends} />
      {points.map((point, i) => (
        <circle
          key={i}
          class={i === chosen ? 'chosen' : ''}
          cx={x(point.value)}
          cy={y(point.opacity)}
          r={handle}
          fill={css(point.color)}
        />
      ))}
    </svg>
  );
}

/** Edits the colours and opacities of a volume over the histogram of its values. */
export function TransferEditor(props: TransferEditorProps): JSX.Element {
  const [choice, setChoice] = useState(0);
  const latest = useRef(choice);
  const setChosen = (index: number): void => {
    latest.current = index;
    setChoice(index);
  };
  const [logarithmic, setLogarithmic] = useState(true);
  const { points } = props;
  const chosen = Math.min(choice, points.length - 1);
  const point = points[chosen];
  return (
    <div class="transfer">
      <Curve
        {...props}
        {...{ chosen, logarithmic }}
        chosenNow={() => Math.min(latest.current, points.length - 1)}
        onChoose={setChosen}
      />
      <ColorStrip {...props} />
      {point && (
        <div class="point-fields">
          <NumberField
            label="Value"
            value={point.value}
            decimals={props.decimals}
            onChange={(value) => props.onChange(movePoint(points, chosen, value, point.opacity))}
          />
          <NumberField
            label="Opacity"
            value={point.opacity}
            decimals={4}
            onChange={(opacity) => props.onChange(movePoint(points, chosen, point.value, opacity))}
          />
          <input
            type="color"
            aria-label="Colour of the point"
            value={toHex(point.color)}
            onInput={(event) => props.onChange(recolorPoint(points, chosen, fromHex(event.currentTarget.value)))}
          />
          <button
            type="button"
            class="quiet"
            disabled={points.length <= 2}
            onClick={() => {
              props.onChange(removePoint(points, chosen));
              setChosen(Math.max(0, chosen - 1));
            }}
          >
            Remove
          </button>
        </div>
      )}
      <button type="button" class="quiet" aria-pressed={logarithmic} onClick={() => setLogarithmic(!logarithmic)}>
        {logarithmic ? 'Linear histogram' : 'Logarithmic histogram'}
      </button>
    </div>
  );
}
