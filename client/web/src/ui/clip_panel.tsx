import type { JSX } from 'preact';
import { openPointsDialog } from '../input/keyboard';
import { axisNames, pulled, type AxisName } from '../overlay/clip_handles';
import { addClipInTheMiddle, changeClip, removeClip } from '../overlay/clip_list';
import type { Clip } from '../state/display_options';
import { bounds, editedClip, hasSurfels, lengthDecimals, display, tool } from '../state/store';
import { Choices, IconButton, NumberField, Section } from './controls';
import { Icon } from './icons';
import { Ghost } from './opacity_section';
import { SpanSlider } from './span_slider';

function AxisRow({ clip, index, axis }: { clip: Clip; index: number; axis: AxisName }): JSX.Element {
  const { min, max } = bounds.value;
  const set = (end: 'min' | 'max', value: number): void =>
    changeClip(index, { box: pulled(clip.box, { axis, end }, value) });
  const shared = { decimals: lengthDecimals.value, hideLabel: true };
  return (
    <div class="axis-row">
      <b class={`axis ${axis}`}>{axis.toUpperCase()}</b>
      <NumberField
        label={`${axis} from`}
        value={clip.box.min[axis]}
        {...shared}
        onChange={(value) => set('min', value)}
      />
      <NumberField label={`${axis} to`} value={clip.box.max[axis]} {...shared} onChange={(value) => set('max', value)} />
      <SpanSlider
        label={axis}
        low={min[axis]}
        high={max[axis]}
        from={clip.box.min[axis]}
        to={clip.box.max[axis]}
        onInput={set}
      />
    </div>
  );
}

function ClipCard({ clip, index }: { clip: Clip; index: number }): JSX.Element {
  const edited = editedClip.value === index;
  return (
    <li class={edited ? 'card open' : 'card'}>
      <header>
        <button
          type="button"
          class="title"
          aria-expanded={edited}
          onClick={() => (editedClip.value = edited ? undefined : index)}
        >
          <Icon name="clip" size={18} />
          <h3>Box {index + 1}</h3>
          <small>{clip.inverted ? 'hides inside' : 'shows inside'}</small>
        </button>
        <IconButton icon="trash" label={`Remove box ${index + 1}`} onPress={() => removeClip(index)} />
      </header>
      {edited && (
        <>
          <Choices
            label="Effect of the box"
            value={clip.inverted ? 'out' : 'in'}
            options={[
              { value: 'in', label: 'Show inside' },
              { value: 'out', label: 'Hide inside' },
            ]}
            onChange={(value) => changeClip(index, { inverted: value === 'out' })}
          />
          {axisNames.map((axis) => (
            <AxisRow key={axis} {...{ clip, index, axis }} />
          ))}
        </>
      )}
    </li>
  );
}

export function ClipPanel(): JSX.Element {
  const { clips } = display.value;
  return (
    <Section title="Add a clip box">
      <div class="button-pair">
        <button type="button" onClick={addClipInTheMiddle}>
          <Icon name="plus" size={16} /> In the middle
        </button>
        <button type="button" aria-pressed={tool.value === 'clip'} onClick={() => (tool.value = 'clip')}>
          <Icon name="inspect" size={16} /> Around a point
        </button>
      </div>
      {clips.length === 0 && (
        <p class="faint">
          A box shows or hides the part of the scan inside it. Drag the dots on its sides to fit it.
        </p>
      )}
      {clips.length > 0 && <Ghost />}
      <ul class="cards">
        {clips.map((clip, index) => (
          <ClipCard key={index} {...{ clip, index }} />
        ))}
      </ul>
      {clips.length > 0 && hasSurfels() && (
        <button type="button" onClick={openPointsDialog}>
          <Icon name="download" size={16} /> Save the points that are shown
        </button>
      )}
    </Section>
  );
}
