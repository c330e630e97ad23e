import type { JSX } from 'preact';
import { useRef, useState } from 'preact/hooks';
import { currentHash } from '../state/routes';
import {
  filmCommand,
  formatViews,
  longestName,
  parametersOf,
  parseViews,
  usualName,
  viewsFile,
  withViews,
  type SavedView,
} from '../state/saved_views';
import { model, pose, showNotice } from '../state/store';
import { kept } from '../state/annotation_storage';
import { changeViews, savedViews } from '../state/view_storage';
import { change as changeOnServer, KeptSections, LinkRow } from './annotations';
import { copyText, notAllowed } from './clipboard';
import { Section } from './controls';
import { Icon } from './icons';
import { saveFile } from './save_file';

/** Changes the list, or says why that is not possible. */
function change(changed: (views: readonly SavedView[]) => readonly SavedView[], done?: string): void {
  try {
    changeViews(changed);
    if (done) showNotice(done);
  } catch (error) {
    showNotice(error instanceof Error ? error.message : String(error));
  }
}

function SaveForm(): JSX.Element {
  const [name, setName] = useState('');
  const usual = usualName(savedViews.value);
  const save = (event: Event): void => {
    event.preventDefault();
    change((views) => withViews(views, [{ name: name.trim() || usual, link: currentHash() }]), 'View saved.');
    setName('');
  };
  const saveForAll = async (): Promise<void> => {
    const view = { name: name.trim() || usual, parameters: parametersOf(currentHash()) };
    const saved = await changeOnServer(
      ({ views, annotations }) => ({
        views: [...views.filter((other) => other.name !== view.name), view],
        annotations,
      }),
      'View saved for all.',
    );
    if (saved) setName('');
  };
  return (
    <form class="save-view" onSubmit={save}>
      <input
        type="text"
        aria-label="Name of the view"
        placeholder={usual}
        maxLength={longestName}
        value={name}
        onInput={(event) => setName(event.currentTarget.value)}
      />
      <button type="submit" class="primary" disabled={!pose.value}>
        Save
      </button>
      {kept.value?.writable && (
        <button type="button" disabled={!pose.value} onClick={() => void saveForAll()}>
          Save for all
        </button>
      )}
    </form>
  );
}

const exportViews = (): void =>
  saveFile(
    formatViews({ model: model.peek() ?? '', views: savedViews.peek() }),
    viewsFile(model.peek() ?? 'model'),
    'application/json',
  );

async function importViews(file: File): Promise<void> {
  try {
    const here = model.peek() ?? '';
    const { of, views } = parseViews(await file.text(), here);
    const before = savedViews.peek().length;
    changeViews((list) => withViews(list, views));
    const added = savedViews.peek().length - before;
    const count = added === 1 ? '1 view was added' : `${added} views were added`;
    showNotice(of === here ? `${count}.` : `${count}, which the file has of ${of}.`);
  } catch (error) {
    showNotice(error instanceof Error ? error.message : String(error));
  }
}

/** How the exported views become a film: the server draws it for the client program. */
function FilmHint(): JSX.Element | null {
  const name = model.value;
  if (name === undefined || savedViews.value.length < 2) return null;
  const command = filmCommand(location, name, viewsFile(name));
  return (
    <>
      <p class="faint">The exported file is also a path for a film:</p>
      <button type="button" title={command} onClick={() => void copyText(command, 'Command copied.', notAllowed)}>
        <Icon name="copy" size={16} /> Copy the command
      </button>
    </>
  );
}

function Files(): JSX.Element {
  const input = useRef<HTMLInputElement>(null);
  return (
    <div class="button-pair">
      <button type="button" disabled={savedViews.value.length === 0} onClick={exportViews}>
        <Icon name="download" size={16} /> Export
      </button>
      <button type="button" onClick={() => input.current?.click()}>
        <Icon name="upload" size={16} /> Import
      </button>
      <input
        ref={input}
        type="file"
        accept=".json,application/json"
        aria-label="File of views"
        hidden
        onChange={(event) => {
          const [file] = event.currentTarget.files ?? [];
          if (file) void importViews(file);
          event.currentTarget.value = ''; // so that the same file can be chosen again
        }}
      />
    </div>
  );
}

/** Named views of the open model, which this browser keeps. */
export function SavedViewsPanel(): JSX.Element {
  const views = savedViews.value;
  return (
    <>
      <Section title="Save this view">
        <SaveForm />
        <p class="faint">Camera, display and clip boxes. This browser keeps them; a file takes them elsewhere.</p>
      </Section>
      <Section title="Saved views">
        {views.length === 0 && <p class="faint">There are none of this model yet.</p>}
        <ul class="view-rows">
          {views.map((view) => (
            <LinkRow
              key={view.name}
              name={view.name}
              link={view.link}
              remove={() => change((list) => list.filter(({ name }) => name !== view.name))}
            />
          ))}
        </ul>
        <Files />
        <FilmHint />
      </Section>
      <KeptSections />
    </>
  );
}
