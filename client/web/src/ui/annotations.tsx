import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { longestText, shortened, type Annotation, type Kept } from '../state/annotations';
import { changeKept, kept } from '../state/annotation_storage';
import { parsePlace } from '../state/place';
import { currentHash } from '../state/routes';
import { linkOf, parametersOf } from '../state/saved_views';
import { inspection, model, showNotice, shownAnnotation } from '../state/store';
import type { Vector } from '../camera/vector';
import { useActions } from './actions';
import { copyText, notAllowed } from './clipboard';
import { IconButton, Section } from './controls';

/** Changes what the server keeps, or says why that is not possible. True: it is changed. */
export async function change(changed: (present: Kept) => Kept, done: string): Promise<boolean> {
  try {
    await changeKept(changed);
    showNotice(done);
    return true;
  } catch (error) {
    showNotice(error instanceof Error ? error.message : String(error));
    return false;
  }
}

interface LinkRowProps {
  readonly name: string;
  readonly link: string;
  readonly went?: () => void;
  readonly remove: (() => void) | undefined; // undefined: the user may not
}

/** A link to a view, which goes there without loading the page again. */
export function LinkRow({ name, link, went, remove }: LinkRowProps): JSX.Element {
  const { navigator } = useActions();
  const go = (event: MouseEvent): void => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return; // another tab or window
    event.preventDefault();
    const { camera, display } = parsePlace(link);
    if (camera) navigator.goTo(camera, display);
    went?.();
  };
  const address = location.href.replace(/#.*$/, '') + link;
  return (
    <li class="view-row">
      <a href={link} title={name} onClick={go}>
        {name}
      </a>
      <IconButton
        icon="link"
        label={`Copy a link to ${name}`}
        onPress={() => void copyText(address, 'Link copied.', notAllowed)}
      />
      {remove && <IconButton icon="trash" label={`Remove ${name}`} onPress={remove} />}
    </li>
  );
}

const same = (a: unknown, b: unknown): boolean => JSON.stringify(a) === JSON.stringify(b);

function removeAnnotation(annotation: Annotation): void {
  if (same(shownAnnotation.peek(), annotation)) shownAnnotation.value = undefined;
  void change(
    ({ views, annotations }) => ({ views, annotations: annotations.filter((other) => !same(other, annotation)) }),
    'Annotation removed.',
  );
}

/** The views and annotations of the open model that the server keeps. */
export function KeptSections(): JSX.Element | null {
  const here = kept.value;
  const name = model.value;
  if (!here || name === undefined) return null;
  const { views, annotations, writable } = here;
  return (
    <>
      <Section title="Views for all">
        {views.length === 0 && <p class="faint">The server has none of this model yet.</p>}
        <ul class="view-rows">
          {views.map((view) => (
            <LinkRow
              key={view.name}
              name={view.name}
              link={linkOf(view.parameters, name)}
              remove={
                writable
                  ? () =>
                      void change(
                        (present) => ({ ...present, views: present.views.filter((other) => !same(other, view)) }),
                        'View removed.',
                      )
                  : undefined
              }
            />
          ))}
        </ul>
      </Section>
      <Section title="Annotations">
        {annotations.length === 0 && (
          <p class="faint">{writable ? 'Inspect a point to write at it.' : 'There are none of this model yet.'}</p>
        )}
        <ul class="view-rows">
          {annotations.map((annotation, i) => (
            <LinkRow
              key={i}
              name={shortened(annotation.text)}
              link={linkOf(annotation.parameters, name)}
              went={() => (shownAnnotation.value = annotation)}
              remove={writable ? () => removeAnnotation(annotation) : undefined}
            />
          ))}
        </ul>
      </Section>
    </>
  );
}

/** Writes an annotation at a point, with the present view. Nothing where the user may not. */
export function AnnotationForm({ at }: { at: Vector }): JSX.Element | null {
  const [text, setText] = useState('');
  if (!kept.value?.writable) return null;
  const save = async (): Promise<void> => {
    const annotation = { text: text.trim(), position: at, parameters: parametersOf(currentHash()) };
    const saved = await change(
      ({ views, annotations }) => ({ views, annotations: [...annotations, annotation] }),
      'Annotation saved.',
    );
    if (saved && inspection.peek()?.at === at) inspection.value = undefined; // else the text stays to be sent again
  };
  return (
    <form
      class="save-view"
      onSubmit={(event) => {
        event.preventDefault();
        void save();
      }}
    >
      <input
        type="text"
        aria-label="Text of the annotation"
        placeholder="Write at this point"
        maxLength={longestText}
        value={text}
        onInput={(event) => setText(event.currentTarget.value)}
      />
      <button type="submit" class="primary" disabled={text.trim() === ''}>
        Annotate
      </button>
    </form>
  );
}

/** The whole text of an annotation that was clicked on. */
export function AnnotationCard(): JSX.Element | null {
  const { navigator } = useActions();
  const shown = shownAnnotation.value;
  const name = model.value;
  if (!shown || name === undefined) return null;
  const go = (): void => {
    const { camera, display } = parsePlace(linkOf(shown.parameters, name));
    if (camera) navigator.goTo(camera, display);
  };
  return (
    <section class="inspect-card" aria-label="Annotation">
      <header>
        <h2>Annotation</h2>
        <IconButton icon="bookmark" label="Go to its view" onPress={go} />
        <IconButton icon="close" label="Close" onPress={() => (shownAnnotation.value = undefined)} />
      </header>
      <p class="annotation-text">{shown.text}</p>
    </section>
  );
}
