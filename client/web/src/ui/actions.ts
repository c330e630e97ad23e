import { createContext } from 'preact';
import { useContext } from 'preact/hooks';
import type { Director } from '../view/director';
import type { Navigator } from '../view/navigator';

/** What the page's parts may ask for, made once by main.tsx. */
export interface Actions {
  readonly director: Director;
  readonly navigator: Navigator;
  readonly stage: HTMLElement; // holds the canvases
  copyLink(): void;
}

export const ActionsContext = createContext<Actions | undefined>(undefined);

export function useActions(): Actions {
  const actions = useContext(ActionsContext);
  if (!actions) throw new Error('used outside of the page');
  return actions;
}
