import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { formatNumber } from '../measure/format';
import {
  countPoints,
  countUrl,
  everyForLimit,
  fileUrl,
  pointFormats,
  type PointCount,
  type PointFormatName,
} from '../protocol/points';
import { systemName } from '../state/contents';
import { className } from '../state/palette';
import { regionOf, type Region, type ShownRegion } from '../state/region';
import { bounds, description, dialog, display, openScan, showNotice, shownModel } from '../state/store';
import { Choices, Dialog, NumberField, Switch } from './controls';
import { download } from './save_file';

const formatOptions = pointFormats.map((value) => ({ value, label: value.toUpperCase() }));

/** The count of a region, once the server has told it. */
type Counting = { readonly done: PointCount } | { readonly problem: string } | undefined;

function useCount(region: Region | undefined, every: number): Counting {
  const [counting, setCounting] = useState<Counting>(undefined);
  useEffect(() => {
    setCounting(undefined);
    if (!region) return undefined;
    const abort = new AbortController();
    countPoints(countUrl(location.href, shownModel.peek() ?? '', region, every), abort.signal).then(
      (done) => setCounting({ done }),
      (error: unknown) => {
        if (!abort.signal.aborted) setCounting({ problem: error instanceof Error ? error.message : String(error) });
      },
    );
    return () => abort.abort(); // the server ends its count, too
  }, [region, every]);
  return counting;
}

/** The part of the scan that is shown. */
function shownRegion(): ShownRegion {
  const classes = description.peek()?.classes.map(({ code }) => code) ?? [];
  const classified = description.peek()?.attributes.includes('classification') ?? false;
  return regionOf(display.peek(), { bounds: bounds.peek(), classified, classes });
}

const number = (value: number): string => formatNumber(value, 0);
const points = (value: number): string => (value === 1 ? '1 point' : `${number(value)} points`);

const ordinal = (n: number): string => {
  const ending = n % 100 >= 11 && n % 100 <= 13 ? 'th' : (['th', 'st', 'nd', 'rd'][n % 10] ?? 'th');
  return `${number(n)}${ending}`;
};

/** "What is shown: points inside 1 clip box, of Ground, Building." */
function limitsText(region: Region): string {
  const { clips } = display.peek();
  const [shows, hides] = [clips.filter((clip) => !clip.inverted).length, clips.filter((clip) => clip.inverted).length];
  const boxes = (count: number): string => (count === 1 ? '1 clip box' : `${count} clip boxes`);
  const parts = [shows > 0 && `inside ${boxes(shows)}`, hides > 0 && `outside ${boxes(hides)}`].filter(Boolean);
  const classes = region.classes.map(className);
  if (classes.length > 0) parts.push(classes.length > 4 ? `of ${classes.length} classes` : `of ${classes.join(', ')}`);
  return parts.length > 0 ? `What is shown: points ${parts.join(', ')}.` : 'The whole model: nothing of it is hidden.';
}

function TooMany(props: { count: PointCount; every: number; onEvery: (every: number) => void }): JSX.Element {
  const enough = everyForLimit(props.count, props.every);
  return (
    <div class="too-many">
      <p class="problem">
        The server sends at most {points(props.count.most)} in a file. Clip a smaller part, hide classes, or take fewer
        of the points.
      </p>
      <button type="button" onClick={() => props.onEvery(enough)}>
        Take every {ordinal(enough)} point
      </button>
    </div>
  );
}

function Count({ counting }: { counting: Counting }): JSX.Element {
  if (counting && 'problem' in counting) return <p class="problem">{counting.problem}</p>;
  return (
    <p class="count" role="status">
      {counting ? <b>{points(counting.done.points)}</b> : <><span class="spinner" /> Counting…</>}
    </p>
  );
}

/** Coordinates in the file, where the model's are others than those of its source. */
function Systems({ world, onChange }: { world: boolean; onChange: (world: boolean) => void }): JSX.Element | null {
  const { system, sourceSystem } = description.value ?? {};
  if (!sourceSystem) return null;
  const chosen = world ? system : sourceSystem;
  return (
    <>
      <Choices
        label="Coordinates"
        value={world ? 'world' : 'source'}
        options={[
          { value: 'source', label: 'Of the scan' },
          { value: 'world', label: 'Of the model' },
        ]}
        onChange={(value) => onChange(value === 'world')}
      />
      {chosen && <p class="faint">{systemName(chosen)}</p>}
    </>
  );
}

export function PointsDialog(): JSX.Element {
  const [shown] = useState(shownRegion); // the picture does not change behind the dialog
  const region = 'problem' in shown ? undefined : shown;
  const [format, setFormat] = useState<PointFormatName>('laz');
  const [every, setEvery] = useState(1);
  const [normals, setNormals] = useState(false);
  const [world, setWorld] = useState(false);
  const counting = useCount(region, every);
  const count = counting && 'done' in counting ? counting.done : undefined;
  const fits = count !== undefined && count.points <= count.most;
  const save = (): void => {
    if (!region) return;
    const name = shownModel.peek() ?? '';
    download(fileUrl(location.href, name, region, { format, every, normals, world }), `${name}-points.${format}`);
    showNotice('The server sends the points; the browser shows how far they are.');
    dialog.value = undefined;
  };
  return (
    <Dialog title="Save points" onClose={() => (dialog.value = undefined)}>
      {'problem' in shown && <p class="problem">{shown.problem}</p>}
      {region && <p class="faint">{limitsText(region)}</p>}
      {region && <Count {...{ counting }} />}
      {count && !fits && <TooMany {...{ count, every }} onEvery={setEvery} />}
      {openScan.value && <p class="faint">The model is not complete: these are the points of its preview.</p>}
      <Choices label="Format" value={format} options={formatOptions} onChange={setFormat} />
      <Systems {...{ world }} onChange={setWorld} />
      <NumberField
        label="Every n-th point (1: all)"
        value={every}
        decimals={0}
        onChange={(value) => setEvery(Math.max(1, Math.round(value)))}
      />
      <Switch label="Normals of the model" checked={normals} onChange={setNormals} />
      <footer>
        <button type="button" class="primary" disabled={!fits || count.points === 0} onClick={save}>
          Save as {format.toUpperCase()}
        </button>
      </footer>
    </Dialog>
  );
}
