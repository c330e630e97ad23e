import type { JSX } from 'preact';
import { viewNames, type ViewName } from '../camera/standard_views';
import { useActions } from './actions';

const labels: Readonly<Record<ViewName, string>> = {
  front: 'Front',
  back: 'Back',
  left: 'Left',
  right: 'Right',
  top: 'Top',
  bottom: 'Bottom',
  iso: 'Iso',
};

/** The standard views: in the top bar of a wide window, otherwise in the model panel. */
export function Views({ where }: { where: 'in-bar' | 'in-panel' }): JSX.Element {
  const { navigator } = useActions();
  return (
    <div class={`views ${where}`} role="group" aria-label="Standard views">
      {viewNames.map((name) => (
        <button key={name} type="button" onClick={() => navigator.standard(name)}>
          {labels[name]}
        </button>
      ))}
    </div>
  );
}
