import type { JSX } from 'preact';
import { openPointsDialog } from '../input/keyboard';
import { contentsOf } from '../state/contents';
import * as store from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';
import { Icon, Logo } from './icons';
import { Views } from './views';

function ModelButton(): JSX.Element | null {
  const name = store.model.value;
  if (name === undefined) return null;
  const description = store.description.value;
  return (
    <button
      type="button"
      class="model-button"
      aria-expanded={store.galleryOpen.value}
      title="All models"
      onClick={() => (store.galleryOpen.value = !store.galleryOpen.value)}
    >
      <span class="name">{name}</span>
      {description && <small>{contentsOf(description)}</small>}
      <Icon name="chevron" size={18} />
    </button>
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
      {shown && <Views where="in-bar" />}
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
            {store.description.value && store.hasSurfels() && (
              <IconButton icon="download" label="Save points" hint="E" onPress={openPointsDialog} />
            )}
          </>
        )}
        <IconButton icon="help" label="Help" hint="?" onPress={() => (store.dialog.value = 'help')} />
      </div>
    </header>
  );
}
