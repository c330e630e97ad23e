import type { JSX } from 'preact';
import type { Vector } from '../camera/vector';
import { chartOf } from '../measure/chart';
import { formatNumber } from '../measure/format';
import { profileOf } from '../measure/measurement';
import { upAxis } from '../state/store';

const frame = { width: 272, height: 132, left: 40, right: 8, top: 8, bottom: 22 };

const decimalsOfStep = (values: readonly number[]): number => {
  const step = values.length > 1 ? values[1]! - values[0]! : 1;
  return Math.min(8, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
};

/** Chart of height over horizontal distance along the course of the profile. */
export function ProfileChart({ points }: { points: readonly Vector[] }): JSX.Element {
  const chart = chartOf(profileOf(points, upAxis.value), frame);
  const [alongDecimals, heightDecimals] = [decimalsOfStep(chart.alongTicks), decimalsOfStep(chart.heightTicks)];
  return (
    <svg class="chart" viewBox={`0 0 ${frame.width} ${frame.height}`} role="img" aria-label="Height along the profile">
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
      <path d={chart.path} />
      {chart.dots.length <= 40 && chart.dots.map(({ x, y }, i) => <circle key={i} cx={x} cy={y} r={2.6} />)}
    </svg>
  );
}
