import type { JSX } from 'preact';
import { viewNames, type ViewName } from '../camera/standard_views';
import * as store from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';
import { Icon, Logo } from './icons';

const compact = new Intl.NumberFormat('en', { notation: 'compact', maximumFractionDigits: 1 });

function ModelButton(): JSX.Element | null {
  const name = store.model.value;
  if (name === undefined) return null;
  const points = store.description.value?.surfels;
  return (
    <button
      type="button"
      class="model-button"
      aria-expanded={store.galleryOpen.value}
      title="All models"
      onClick={() => (store.galleryOpen.value = !store.galleryOpen.value)}
    >
      <span class="name">{name}</span>
      {points !== undefined && <small>{compact.format(Number(points))} points</small>}
      <Icon name="chevron" size={18} />
    </button>
  );
}

const viewLabels: Readonly<Record<ViewName, string>> = {
  front: 'Front',
  back: 'Back',
  left: 'Left',
  right: 'Right',
  top: 'Top',
  bottom: 'Bottom',
  iso: 'Iso',
};

function Views(): JSX.Element {
  const { navigator } = useActions();
  return (
    <div class="views" role="group" aria-label="Standard views">
      {viewNames.map((name) => (
        <button key={name} type="button" onClick={() => navigator.standard(name)}>
          {viewLabels[name]}
        </button>
      ))}
    </div>
  );
}

export function TopBar(): JSX.Element {
  const { copyLink } = useActions();
  const shown = store.model.value !== undefined && !store.galleryOpen.value;
  return (
    <header class="top-bar">
      <div class="brand">
        <Logo />
        <span>surfcast</span>
      </div>
      <ModelButton />
      {shown && <Views />}
      <div class="top-actions">
        {shown && (
          <>
            <IconButton icon="link" label="Copy a link to this view" hint="L" onPress={copyLink} />
            <IconButton
              icon="camera"
              label="Save a picture"
              hint="X"
              onPress={() => (store.dialog.value = 'screenshot')}
            />
          </>
        )}
        <IconButton icon="help" label="Help" hint="?" onPress={() => (store.dialog.value = 'help')} />
      </div>
    </header>
  );
}
