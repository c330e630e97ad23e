import { showNotice } from '../state/store';

export const notAllowed = 'The browser does not let this page copy.';

/** Browsers give the clipboard only to pages of this machine and those that come encrypted. */
export async function copyText(text: string, done: string, otherwise: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    showNotice(done);
  } catch {
    showNotice(otherwise);
  }
}
