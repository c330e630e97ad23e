import type { JSX } from 'preact';
import { dialog } from '../state/store';
import { Dialog } from './controls';

type Rows = readonly (readonly [string, string])[];

const mouse: Rows = [
  ['Drag', 'orbit around the point under the cursor'],
  ['Right drag, Shift drag', 'pan'],
  ['Wheel', 'zoom towards the cursor'],
  ['Double click', 'focus on a point'],
];

const touch: Rows = [
  ['One finger', 'orbit'],
  ['Two fingers', 'drag to pan, pinch to zoom, twist to rotate'],
  ['Double tap', 'focus on a point'],
];

const keys: Rows = [
  ['Arrows', 'orbit; with Shift pan'],
  ['+ −', 'zoom'],
  ['F', 'fit the model'],
  ['1 … 7', 'front, right, back, left, top, bottom, iso'],
  ['G', 'fly: W A S D, Q E down and up, Shift faster, wheel sets the speed'],
  ['N, I', 'navigate, inspect points'],
  ['V', 'window and level of a volume: drag, or arrows, with Shift faster'],
  ['M, H, K, B, P', 'distance, height, angle, area, profile'],
  ['O, C, S', 'display options, clip boxes, saved views'],
  ['X, E', 'save a picture, save points'],
  ['L', 'copy a link to this view'],
  ['`', 'performance figures'],
  ['Esc', 'end the measurement, leave the tool, close the panel'],
];

function Table({ title, rows }: { title: string; rows: Rows }): JSX.Element {
  return (
    <section>
      <h3>{title}</h3>
      <dl>
        {rows.map(([name, text]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

export function HelpDialog(): JSX.Element {
  return (
    <Dialog title="How to move" onClose={() => (dialog.value = undefined)}>
      <div class="help">
        <Table title="Mouse" rows={mouse} />
        <Table title="Touch" rows={touch} />
        <Table title="Keyboard" rows={keys} />
      </div>
    </Dialog>
  );
}
