import { effect, signal } from '@preact/signals';
import { formatKept, parseKept, type Kept } from './annotations';
import { link, model } from './store';

/** Keeps saved views and annotations beside the open model, on the server. */

/** What the server has of the open model. Undefined: it keeps none, or has not answered yet. */
export interface KeptOnServer extends Kept {
  readonly edition: string;
  readonly writable: boolean;
}

export const kept = signal<KeptOnServer | undefined>(undefined);

const urlOf = (name: string): string =>
  new URL(`api/models/${encodeURIComponent(name)}/annotations`, location.href.replace(/[?#].*$/, '')).href;

async function problemIn(answer: Response): Promise<Error> {
  const body = (await answer.json().catch(() => ({}))) as { error?: { message: string } };
  return new Error(body.error?.message ?? `The server answered with status ${answer.status}.`);
}

async function keptIn(answer: Response): Promise<KeptOnServer> {
  if (!answer.ok) throw await problemIn(answer);
  const edition = answer.headers.get('ETag') ?? '';
  const writable = answer.headers.get('Allow')?.includes('PUT') ?? false;
  return { ...parseKept(await answer.text()), edition, writable };
}

const read = async (name: string): Promise<KeptOnServer> => keptIn(await fetch(urlOf(name)));

/**
 * Changes what the server has of the open model; what others have written since it was read stays. Rejects with a
 * sentence.
 */
export async function changeKept(change: (present: Kept) => Kept): Promise<void> {
  const name = model.peek();
  if (name === undefined) return;
  const conflict = 412;
  const attempts = 3;
  for (let attempt = 1; ; ++attempt) {
    const present = await read(name);
    const headers = { 'Content-Type': 'application/json', 'If-Match': present.edition };
    const answer = await fetch(urlOf(name), { method: 'PUT', headers, body: formatKept(change(present)) });
    if (answer.status === conflict && attempt < attempts) continue;
    const changed = await keptIn(answer);
    if (name === model.peek()) kept.value = changed;
    return;
  }
}

/** Follows the open model, and reads again with each new connection. */
export function startAnnotationStorage(): void {
  effect(() => {
    const name = model.value;
    if (kept.peek()) kept.value = undefined;
    if (name === undefined || link.value.kind !== 'open') return;
    read(name).then(
      (found) => {
        if (name === model.peek()) kept.value = found;
      },
      () => undefined, // the server keeps none, or this model is not complete
    );
  });
}
