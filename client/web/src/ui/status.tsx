import type { JSX } from 'preact';
import { FileFormat, type Picture } from '../generated/surfcast_pb';
import {
  figures,
  figuresOpen,
  link,
  moving,
  openScan,
  picking,
  pictureSettled,
  shownFrame,
  viewProblem,
} from '../state/store';
import { failed, progressText } from '../state/scans';
import { stageNames, type StageName, type StageTimes } from '../view/figures';
import { IconButton } from './controls';

/** The status line below the picture, and the card of performance figures that it opens. */

export function formatRate(bytesPerSecond: number): string {
  if (bytesPerSecond < 1000) return '0 kB/s';
  return bytesPerSecond < 1e6 ? `${Math.round(bytesPerSecond / 1e3)} kB/s` : `${(bytesPerSecond / 1e6).toFixed(1)} MB/s`;
}

interface State {
  readonly kind: 'sharp' | 'working' | 'offline' | 'preview';
  readonly text: string;
}

/** How far the model is of which a preview is shown. */
function previewText(): string {
  const scan = openScan.value;
  if (!scan) return 'Preview';
  return failed(scan) ? 'Preview; the model cannot be built' : `Preview: ${progressText(scan)}`;
}

function stateNow(): State {
  if (link.value.kind !== 'open') return { kind: 'offline', text: 'Offline' };
  if (viewProblem.value) return { kind: 'offline', text: 'No picture' };
  const frame = shownFrame.value;
  if (!frame) return { kind: 'working', text: 'Loading' };
  if (picking.value) return { kind: 'working', text: 'Looking' };
  if (moving.value) return { kind: 'working', text: 'Moving' };
  if (frame.picture?.preview) return { kind: 'preview', text: previewText() };
  return pictureSettled.value ? { kind: 'sharp', text: 'Sharp' } : { kind: 'working', text: 'Refining' };
}

export function Status(): JSX.Element {
  const { framesPerSecond, latency, bytesPerSecond } = figures.value;
  const state = stateNow();
  return (
    <button
      type="button"
      class="status"
      aria-expanded={figuresOpen.value}
      title="Figures (`)"
      onClick={() => (figuresOpen.value = !figuresOpen.value)}
    >
      <span class={`lamp ${state.kind}`} />
      <span class="word" aria-live="polite">
        {state.text}
      </span>
      {state.kind === 'working' && (
        <>
          <span class="figure">{Math.round(framesPerSecond)} fps</span>
          {latency !== undefined && <span class="figure latency">{Math.round(latency)} ms</span>}
          <span class="figure rate">{formatRate(bytesPerSecond)}</span>
        </>
      )}
    </button>
  );
}

const stageLabels: Readonly<Record<StageName, string>> = {
  wait: 'Waiting',
  load: 'Loading blocks',
  draw: 'Drawing',
  encode: 'Encoding',
  network: 'Network',
  decode: 'Decoding',
  paint: 'Painting',
};

function Stages({ stages }: { stages: StageTimes }): JSX.Element {
  const total = stageNames.reduce((sum, name) => sum + stages[name], 0) || 1;
  return (
    <>
      <div class="stage-bar" aria-hidden="true">
        {stageNames.map((name) => (
          <span key={name} class={name} style={{ width: `${(stages[name] / total) * 100}%` }} />
        ))}
      </div>
      <dl class="stages">
        {stageNames.map((name) => (
          <div key={name}>
            <dt>
              <i class={name} /> {stageLabels[name]}
            </dt>
            <dd>{stages[name].toFixed(1)} ms</dd>
          </div>
        ))}
      </dl>
    </>
  );
}

const formatName = (picture: Picture): string => FileFormat[picture.format] ?? '';

const compact = new Intl.NumberFormat('en', { notation: 'compact', maximumFractionDigits: 1 });

function PictureFacts({ picture }: { picture: Picture }): JSX.Element {
  const { resolution, levels } = picture;
  const drawn = levels.filter((level) => level.blocksDrawn > 0).map((level) => level.level);
  const range = drawn.length > 0 ? [Math.min(...drawn), Math.max(...drawn)] : undefined;
  const facts: [string, string][] = [
    ['Picture', `${resolution?.width ?? 0} × ${resolution?.height ?? 0} ${formatName(picture)}`],
    ['Level', range ? (range[0] === range[1] ? `${range[0]}` : `${range[0]} – ${range[1]}`) : '–'],
    ['Spacing', picture.spacing > 0 ? `${picture.spacing.toFixed(1)} px` : 'every point'],
    ['Surfels', compact.format(Number(picture.surfelsDrawn))],
    ['Weights', picture.normalization === 0 ? 'per pixel' : 'per surfel'],
  ];
  return (
    <dl class="stages">
      {facts.map(([name, value]) => (
        <div key={name}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </div>
      ))}
      <div class="wide">
        <dt>Drawn by</dt>
        <dd>{picture.glRenderer}</dd>
      </div>
    </dl>
  );
}

export function FiguresCard(): JSX.Element | null {
  if (!figuresOpen.value) return null;
  const { framesPerSecond, latency, bytesPerSecond, stages } = figures.value;
  const picture = shownFrame.value?.picture;
  return (
    <section class="figures" aria-label="Figures">
      <header>
        <h2>Figures</h2>
        <IconButton icon="close" label="Close" onPress={() => (figuresOpen.value = false)} />
      </header>
      <div class="big">
        <p>
          <b>{framesPerSecond.toFixed(0)}</b> frames/s
        </p>
        <p>
          <b>{latency === undefined ? '–' : latency.toFixed(0)}</b> ms to the screen
        </p>
        <p>
          <b>{formatRate(bytesPerSecond).split(' ')[0]}</b> {formatRate(bytesPerSecond).split(' ')[1]}
        </p>
      </div>
      {stages ? <Stages stages={stages} /> : <p class="faint">Move the view to measure the stages of a frame.</p>}
      {picture && <PictureFacts picture={picture} />}
    </section>
  );
}
