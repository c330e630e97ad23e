import type { JSX } from 'preact';
import { formatExact, formatNumber } from '../measure/format';
import { scaleBar } from '../measure/scale_bar';
import { systemName } from '../state/contents';
import { compass, pictureScale } from '../state/orientation';
import { cursor, description, frameIsCurrent, lengthDecimals } from '../state/store';
import { unitSymbol } from '../state/units';
import { systemFacts } from '../state/wkt';
import { useActions } from './actions';

/** What tells where north is, how long things are, and where the cursor is. */

const compassSize = 60;
const compassRadius = 20;
const letterGap = 8; // between the ring and the N

/** A compass that lies level in the middle of the view. */
export function Compass(): JSX.Element | null {
  const { navigator } = useActions();
  const axes = compass.value;
  if (!axes) return null;
  const { east, north } = axes;
  const long = Math.hypot(north.x, north.y);
  const reach = compassRadius * long + letterGap;
  // Where north is straight ahead of a level view, it has no direction on the screen: the letter is in the middle.
  const [x, y] = long > 0.02 ? [(north.x / long) * reach, (north.y / long) * reach] : [0, -letterGap];
  const level = `matrix(${[east.x, east.y, north.x, north.y, 0, 0].map((part) => part.toFixed(5)).join(' ')})`;
  const box = `${-compassSize / 2} ${-compassSize / 2} ${compassSize} ${compassSize}`;
  const label = 'Turn to the north';
  return (
    <button type="button" class="compass" title={label} aria-label={label} onClick={() => navigator.faceNorth()}>
      <svg width={compassSize} height={compassSize} viewBox={box} aria-hidden="true">
        <g transform={level}>
          <circle class="ring" r={compassRadius} />
          <path class="south" d="M-5 0L0 -17L5 0z" />
          <path class="north" d="M-5 0L0 17L5 0z" />
        </g>
        <text x={x} y={y}>
          N
        </text>
      </svg>
    </button>
  );
}

const longestBar = 130; // CSS pixels

/** A bar that is as long as it says, at the depth of the last picked point or of the view's centre. */
export function ScaleBar(): JSX.Element | null {
  const { stage } = useActions();
  const scale = pictureScale.value;
  if (!scale) return null;
  const shown = stage.clientHeight / scale.height; // CSS pixels of a pixel
  const bar = scaleBar(scale.unitPixels * shown, scale.unit, longestBar);
  if (!bar) return null;
  const where = scale.picked ? 'of the last picked point' : "of the view's centre";
  return (
    <figure class="scale-bar" title={`At the depth ${where}`} aria-label={`${bar.label} at the depth ${where}`}>
      <figcaption>{bar.label}</figcaption>
      <span style={{ width: `${bar.pixels}px` }} />
    </figure>
  );
}

const axes = ['x', 'y', 'z'] as const;
const degreeDecimals = 5; // more than of metres: 0.00001 degrees are a metre

/** Where the point under the resting pointer is, in the coordinates of the source. */
export function CursorReadout(): JSX.Element | null {
  const point = cursor.value;
  if (!point || !frameIsCurrent.value) return null;
  const { at, ofSource, stale } = point;
  const system = ofSource ? description.value?.sourceSystem : description.value?.system;
  const { horizontal, vertical } = systemFacts(system?.wkt ?? '');
  const angular = horizontal?.kind === 'angle';
  const level = unitSymbol(horizontal);
  const units = { x: level, y: level, z: unitSymbol(vertical) || (angular ? '' : level) };
  const decimals = lengthDecimals.value;
  return (
    <p class={stale ? 'cursor stale' : 'cursor'} aria-label="Point under the cursor">
      {axes.map((axis) => (
        <span key={axis} data-cursor-axis={axis} title={formatExact(at[axis])}>
          <b class={`axis ${axis}`}>{axis.toUpperCase()}</b>{' '}
          {formatNumber(at[axis], angular && axis !== 'z' ? decimals + degreeDecimals : decimals)}
          {units[axis] && <small>{units[axis] === '°' ? '°' : ` ${units[axis]}`}</small>}
        </span>
      ))}
      {system && (
        <small class="system" title={systemName(system)}>
          {systemName(system)}
        </small>
      )}
    </p>
  );
}
