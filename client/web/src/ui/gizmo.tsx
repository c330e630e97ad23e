import type { JSX } from 'preact';
import { dot, scale, vector, type Vector } from '../camera/vector';
import { viewAlong } from '../camera/standard_views';
import { shownProjection, upAxis } from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';

const size = 76;
const reach = 27;
const axes = [
  ['x', vector(1, 0, 0)],
  ['y', vector(0, 1, 0)],
  ['z', vector(0, 0, 1)],
] as const;

interface Tip {
  readonly axis: string;
  readonly positive: boolean;
  readonly x: number;
  readonly y: number;
  readonly depth: number;
  readonly direction: Vector;
}

/** The ends of the axes, projected as in the picture on the screen, the farthest first. */
function tips(): Tip[] {
  const view = shownProjection.value;
  if (!view) return [];
  const ends = axes.flatMap(([axis, direction]) =>
    [1, -1].map((sign) => {
      const v = scale(direction, sign);
      const [x, y] = [dot(v, view.axes.right) * reach, -dot(v, view.axes.up) * reach];
      return { axis, positive: sign > 0, x, y, depth: dot(v, view.axes.forward), direction: v };
    }),
  );
  return ends.sort((a, b) => b.depth - a.depth);
}

/** Shows the orientation of the model. A click on an axis selects the view along it. */
export function Gizmo(): JSX.Element | null {
  const { navigator } = useActions();
  const ends = tips();
  if (ends.length === 0) return null;
  const press = (tip: Tip): void => navigator.standard(viewAlong(scale(tip.direction, -1), upAxis.peek()));
  return (
    <div class="gizmo">
      <svg width={size} height={size} viewBox={`${-size / 2} ${-size / 2} ${size} ${size}`} role="group" aria-label="Views">
        {ends.map((tip) => (
          <g
            key={`${tip.axis}${tip.positive}`}
            class={`axis ${tip.axis}`}
            opacity={tip.depth > 0.2 ? 0.55 : 1}
            tabindex={0}
            role="button"
            aria-label={`From ${tip.positive ? '+' : '−'}${tip.axis}`}
            onClick={() => press(tip)}
            onKeyDown={(event) => {
              if (event.key === 'Enter') press(tip);
            }}
          >
            {tip.positive && <line x2={tip.x} y2={tip.y} />}
            <circle class={tip.positive ? 'full' : 'hollow'} cx={tip.x} cy={tip.y} r={tip.positive ? 8.5 : 6.5} />
            {tip.positive && (
              <text x={tip.x} y={tip.y + 3.6}>
                {tip.axis.toUpperCase()}
              </text>
            )}
          </g>
        ))}
      </svg>
      <IconButton icon="fit" label="Fit the model" hint="F" onPress={() => navigator.fit()} />
    </div>
  );
}
