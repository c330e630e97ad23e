import type { JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Vector } from '../camera/vector';
import { bandAddress, bandOf, bandPoints, drawBand, usualWidth, type Band } from '../measure/band';
import { chartOf, type Chart } from '../measure/chart';
import { formatNumber } from '../measure/format';
import { profileOf } from '../measure/measurement';
import { description, lengthDecimals, shownModel, upAxis } from '../state/store';
import { useActions } from './actions';
import { NumberField } from './controls';
import { Icon } from './icons';

const frame = { width: 272, height: 132, left: 40, right: 8, top: 8, bottom: 22 };

const decimalsOfStep = (values: readonly number[]): number => {
  const step = values.length > 1 ? values[1]! - values[0]! : 1;
  return Math.min(8, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
};

type BandState =
  | { readonly kind: 'none' }
  | { readonly kind: 'asked' }
  | { readonly kind: 'there'; readonly band: Band }
  | { readonly kind: 'failed'; readonly message: string };

/** The points of the scan along a finished profile, from the server; asked for again when line or width change. */
function useBand(points: readonly Vector[], width: number, wanted: boolean): BandState {
  const { controller } = useActions();
  const [state, setState] = useState<BandState>({ kind: 'none' });
  const name = shownModel.value;
  useEffect(() => {
    if (!wanted || name === undefined) return undefined;
    let current = true;
    setState({ kind: 'asked' });
    controller.profile(name, points, width, bandPoints).then(
      (profile) => current && setState({ kind: 'there', band: bandOf(profile, upAxis.peek()) }),
      (error: unknown) =>
        current && setState({ kind: 'failed', message: error instanceof Error ? error.message : String(error) }),
    );
    return () => {
      current = false;
    };
  }, [name, points, width, wanted]);
  return state;
}

function BandPicture({ band, chart }: { band: Band; chart: Chart }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const pixels = Math.max(1, Math.min(3, devicePixelRatio));
  useEffect(() => {
    const context = canvas.current?.getContext('2d');
    if (context) drawBand(context, band, chart, pixels);
  }, [band, chart, pixels]);
  return <canvas ref={canvas} width={Math.round(frame.width * pixels)} height={Math.round(frame.height * pixels)} />;
}

function ChartLines({ chart, dotted }: { chart: Chart; dotted: boolean }): JSX.Element {
  const [alongDecimals, heightDecimals] = [decimalsOfStep(chart.alongTicks), decimalsOfStep(chart.heightTicks)];
  return (
    <svg viewBox={`0 0 ${frame.width} ${frame.height}`} role="img" aria-label="Height along the profile">
      {chart.heightTicks.map((value) => (
        <g key={value}>
          <line x1={frame.left} x2={frame.width - frame.right} y1={chart.y(value)} y2={chart.y(value)} />
          <text x={frame.left - 6} y={chart.y(value) + 3.5} text-anchor="end">
            {formatNumber(value, heightDecimals)}
          </text>
        </g>
      ))}
      {chart.alongTicks.map((value) => (
        <text key={value} x={chart.x(value)} y={frame.height - 6} text-anchor={value === 0 ? 'start' : 'middle'}>
          {formatNumber(value, alongDecimals)}
        </text>
      ))}
      <path d={chart.path} class={dotted ? 'dotted' : ''} />
      {chart.dots.length <= 40 && chart.dots.map(({ x, y }, i) => <circle key={i} cx={x} cy={y} r={2.6} />)}
    </svg>
  );
}

function bandText(state: BandState): string {
  if (state.kind === 'asked') return 'Looking for points…';
  if (state.kind === 'failed') return state.message;
  if (state.kind === 'none') return '';
  const [shown, total] = [state.band.along.length, state.band.total];
  const points = `${formatNumber(total, 0)} ${total === 1 ? 'point' : 'points'} in the band`;
  return shown < total ? `${points}, ${formatNumber(shown, 0)} of them shown` : points;
}

/**
 * The cross-section of the scan along a profile: height over horizontal distance, the points of the scan in a band, and
 * the line through the picked points. A profile that is not finished is the line alone.
 */
export function ProfileChart({ points, open }: { points: readonly Vector[]; open: boolean }): JSX.Element {
  const [width, setWidth] = useState(() => usualWidth(description.peek()?.spacing ?? 0));
  const state = useBand(points, width, !open);
  const band = state.kind === 'there' && state.band.along.length > 0 ? state.band : undefined;
  const chart = chartOf(profileOf(points, upAxis.value), frame, band ? [band.low, band.high] : []);
  const address = (format: 'csv' | 'las'): string => bandAddress(shownModel.value ?? '', points, width, format);
  return (
    <>
      <div class="chart">
        {band && <BandPicture band={band} chart={chart} />}
        <ChartLines chart={chart} dotted={band !== undefined} />
      </div>
      {!open && (
        <div class="band">
          <p class={state.kind === 'failed' ? 'problem' : 'faint'} role="status">
            {bandText(state)}
          </p>
          <NumberField
            label="Width of the band"
            value={width}
            decimals={lengthDecimals.value}
            onChange={(value) => value > 0 && setWidth(value)}
          />
          <div class="button-row">
            {(['csv', 'las'] as const).map((format) => (
              <a key={format} class="button" href={address(format)} download>
                <Icon name="download" size={16} /> Points as {format.toUpperCase()}
              </a>
            ))}
          </div>
        </div>
      )}
    </>
  );
}
