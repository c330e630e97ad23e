import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { ScanStatus } from '../generated/surfcast_pb';
import { contentsOf, kindOf } from '../state/contents';
import { canJoin, withMember } from '../state/joined';
import { openModel, showInstead } from '../state/routes';
import { failed, progressText } from '../state/scans';
import { descriptions, galleryOpen, link, members, model, models, scans, uploads } from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';
import { Icon } from './icons';

const thumbnail = (name: string): string =>
  `api/models/${encodeURIComponent(name)}/image?resolution=480,300&spacing=1.5&format=jpg&quality=80&background=18,22,27`;

/** Two editions of a model are two pictures, which the browser is not to confuse. */
const thumbnailOf = (name: string, edition: bigint | undefined): string =>
  edition === undefined ? thumbnail(name) : `${thumbnail(name)}#${edition}`;

/** The picture is requested only when its card is visible, because the server draws it on request. */
function Thumbnail({ name, edition }: { name: string; edition: bigint | undefined }): JSX.Element {
  const [broken, setBroken] = useState(false);
  if (broken) return <div class="thumbnail" />;
  return (
    <img
      class="thumbnail"
      src={thumbnailOf(name, edition)}
      alt=""
      loading="lazy"
      decoding="async"
      onError={() => setBroken(true)}
    />
  );
}

/** A scan that cannot be opened, or not yet. */
function ScanCard({ scan }: { scan: ScanStatus }): JSX.Element {
  return (
    <li>
      <div class={failed(scan) ? 'model-card scan broken' : 'model-card scan'}>
        <div class="thumbnail" />
        <span class="name">{scan.model}</span>
        <span class="faint">{failed(scan) ? 'cannot be built' : progressText(scan)}</span>
        {failed(scan) ? <p class="problem">{scan.problem}</p> : <progress value={scan.done} />}
      </div>
    </li>
  );
}

function Card({ name }: { name: string }): JSX.Element {
  const scan = scans.value.get(name);
  if (scan && scan.edition === 0n) return <ScanCard scan={scan} />;
  return <OpenCard name={name} scan={scan} />;
}

function OpenCard({ name, scan }: { name: string; scan: ScanStatus | undefined }): JSX.Element {
  const { controller } = useActions();
  const description = descriptions.value.get(name);
  const open = link.value.kind === 'open';
  useEffect(() => {
    if (open && !description) controller.describe(name).catch(() => undefined);
  }, [open]);
  const choose = (): void => {
    galleryOpen.value = false;
    if (name !== model.peek()) openModel(name);
  };
  const shown = members.value.includes(name);
  const add = (): void => {
    galleryOpen.value = false;
    showInstead(withMember(members.peek(), name));
  };
  return (
    <li>
      {!shown && canJoin(members.value, name) && (
        <button type="button" class="add-model" title={`Show ${name}, too, in the open view`} onClick={add}>
          <Icon name="plus" size={16} /> Add to the view
        </button>
      )}
      <button type="button" class="model-card" aria-current={shown} onClick={choose}>
        <Thumbnail key={`${name} ${scan?.edition ?? ''}`} name={name} edition={scan?.edition} />
        <span class="name">{name}</span>
        {description && <span class="kind">{kindOf(description)}</span>}
        <span class="faint">
          {scan ? progressText(scan) : description ? contentsOf(description) : '…'}
        </span>
        {scan && !failed(scan) && <progress value={scan.done} />}
      </button>
    </li>
  );
}

function Cards(): JSX.Element {
  const [wanted, setWanted] = useState('');
  const broken = [...scans.value.values()].filter((scan) => failed(scan) && scan.edition === 0n);
  const all = [...new Set([...(models.value ?? []), ...broken.map((scan) => scan.model)])].sort();
  const names = all.filter((name) => name.toLowerCase().includes(wanted.toLowerCase()));
  return (
    <>
      {all.length > 8 && (
        <input
          type="search"
          placeholder="Find a model"
          aria-label="Find a model"
          value={wanted}
          onInput={(event) => setWanted(event.currentTarget.value)}
        />
      )}
      <ul class="model-cards">
        {names.map((name) => (
          <Card key={name} name={name} />
        ))}
      </ul>
      {all.length === 0 && models.value && (
        <p class="faint">
          This server has no models yet. Model files that are put into a folder that it serves appear here.
        </p>
      )}
    </>
  );
}

/** Chooses scans to send, for those who cannot drop files. */
function SendScans(): JSX.Element | null {
  const { uploader } = useActions();
  const rules = uploads.value;
  if (!rules) return null;
  const send = (event: JSX.TargetedEvent<HTMLInputElement>): void => {
    uploader.add([...(event.currentTarget.files ?? [])], rules);
    event.currentTarget.value = ''; // the same file may be chosen again
  };
  return (
    <label class="send-scans">
      <span class="faint">Send scans, volumes or Gaussians to this server: drop them on the page, or choose them</span>
      <input type="file" multiple accept={rules.extensions.join(',')} onChange={send} />
    </label>
  );
}

/** The models of the server. Shown when no model is open, and on a click on the model's name in the top bar. */
export function Gallery(): JSX.Element | null {
  if (model.value !== undefined && !galleryOpen.value) return null;
  return (
    <main class="gallery">
      <div class="gallery-inner">
        <header>
          <h1>Models on this server</h1>
          {model.value !== undefined && (
            <IconButton icon="close" label="Back to the model" onPress={() => (galleryOpen.value = false)} />
          )}
        </header>
        <Cards />
        <SendScans />
      </div>
    </main>
  );
}
