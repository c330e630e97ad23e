import { showNotice } from '../state/store';

export const notAllowed = 'The browser denies access to the clipboard.';

/** Browsers allow clipboard access only to pages from localhost or over HTTPS. */
export async function copyText(text: string, done: string, otherwise: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    showNotice(done);
  } catch {
    showNotice(otherwise);
  }
}
