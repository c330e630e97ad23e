import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { openModel } from '../state/routes';
import { descriptions, galleryOpen, link, model, models } from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';

const compact = new Intl.NumberFormat('en', { notation: 'compact', maximumFractionDigits: 1 });

const thumbnail = (name: string): string =>
  `api/models/${encodeURIComponent(name)}/image?resolution=480,300&spacing=1.5&format=jpg&quality=80&background=18,22,27`;

/** The picture is requested only when its card is visible, because the server draws it on request. */
function Thumbnail({ name }: { name: string }): JSX.Element {
  const [failed, setFailed] = useState(false);
  if (failed) return <div class="thumbnail" />;
  return (
    <img class="thumbnail" src={thumbnail(name)} alt="" loading="lazy" decoding="async" onError={() => setFailed(true)} />
  );
}

function Card({ name }: { name: string }): JSX.Element {
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
  return (
    <li>
      <button type="button" class="model-card" aria-current={name === model.value} onClick={choose}>
        <Thumbnail name={name} />
        <span class="name">{name}</span>
        <span class="faint">{description ? `${compact.format(Number(description.surfels))} points` : '…'}</span>
      </button>
    </li>
  );
}

function Cards(): JSX.Element {
  const [wanted, setWanted] = useState('');
  const all = models.value ?? [];
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
          This server has no models yet. Put a <code>.surf</code> file or a scan into a folder that it serves.
        </p>
      )}
    </>
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
      </div>
    </main>
  );
}
