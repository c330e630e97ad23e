import { createContext } from 'preact';
import { useContext } from 'preact/hooks';
import type { Uploader } from '../input/uploads';
import type { ViewController } from '../view/view_controller';
import type { CameraNavigator } from '../view/camera_navigator';

/** The actions available to the components. main.tsx creates the only instance. */
export interface Actions {
  readonly controller: ViewController;
  readonly navigator: CameraNavigator;
  readonly stage: HTMLElement; // holds the canvases
  readonly uploader: Uploader;
  copyLink(): void;
}

export const ActionsContext = createContext<Actions | undefined>(undefined);

export function useActions(): Actions {
  const actions = useContext(ActionsContext);
  if (!actions) throw new Error('used outside of the page');
  return actions;
}
