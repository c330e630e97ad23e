import { effect, signal } from '@preact/signals';
import { formatViews, mostViews, parseViews, type SavedView } from './saved_views';
import { model } from './store';

/** Keeps the views of each model in the browser, for this address of the server. */

export const savedViews = signal<readonly SavedView[]>([]);

const keyOf = (name: string): string => `surfcast.views ${location.pathname} ${name}`;

function stored(name: string): readonly SavedView[] {
  try {
    const text = localStorage.getItem(keyOf(name));
    return text === null ? [] : parseViews(text, name).views;
  } catch {
    return []; // the browser denies access, or the text is not ours
  }
}

/** Changes the views of the open model. Other pages may have changed them since. Throws where nothing can be kept. */
export function changeViews(change: (views: readonly SavedView[]) => readonly SavedView[]): void {
  const name = model.peek();
  if (name === undefined) return;
  const views = change(stored(name));
  if (views.length > mostViews) throw new Error(`At most ${mostViews} views of a model are kept.`);
  try {
    localStorage.setItem(keyOf(name), formatViews({ model: name, views }));
  } catch {
    throw new Error('The browser does not let the page keep views.');
  }
  savedViews.value = views;
}

/** Follows the open model, and other pages of this browser. */
export function startViewStorage(): void {
  const read = (name: string | undefined): void => {
    savedViews.value = name === undefined ? [] : stored(name);
  };
  effect(() => read(model.value));
  addEventListener('storage', () => read(model.peek()));
}
