import type { JSX } from 'preact';
import { chooseTool, togglePanel } from '../input/keyboard';
import { measureKinds, type MeasureKind } from '../measure/measurement';
import * as store from '../state/store';
import { openVolume } from '../state/volume';
import { IconButton } from './controls';
import { Icon, type IconName } from './icons';
import { measureLabels } from './measure_panel';

export const panelNames: Readonly<Record<store.Panel, { label: string; icon: IconName; hint: string }>> = {
  look: { label: 'Display', icon: 'look', hint: 'O' },
  measure: { label: 'Measure', icon: 'measure', hint: '' },
  clip: { label: 'Clip', icon: 'clip', hint: 'C' },
  views: { label: 'Views', icon: 'bookmark', hint: 'S' },
  model: { label: 'Model', icon: 'model', hint: '' },
};

const measureKeys: Readonly<Record<MeasureKind, string>> = {
  distance: 'M',
  height: 'H',
  angle: 'K',
  area: 'B',
  profile: 'P',
};

function setFlying(flying: boolean): void {
  store.flying.value = flying;
  chooseTool('navigate');
}

/** The tools at the left edge of a wide window. */
export function ToolRail(): JSX.Element {
  const { value: tool } = store.tool;
  const flying = store.flying.value;
  return (
    <nav class="rail" aria-label="Tools">
      <IconButton
        icon="orbit"
        label="Orbit"
        hint="N"
        pressed={tool === 'navigate' && !flying}
        onPress={() => setFlying(false)}
      />
      <IconButton icon="fly" label="Fly" hint="G" pressed={flying} onPress={() => setFlying(!flying)} />
      <hr />
      <IconButton
        icon="inspect"
        label="Inspect points"
        hint="I"
        pressed={tool === 'inspect'}
        onPress={() => chooseTool('inspect')}
      />
      {measureKinds.map((kind) => (
        <IconButton
          key={kind}
          icon={kind}
          label={measureLabels[kind]}
          hint={measureKeys[kind]}
          pressed={tool === kind}
          onPress={() => chooseTool(kind)}
        />
      ))}
      {openVolume() && (
        <IconButton
          icon="window"
          label="Window and level"
          hint="V"
          pressed={tool === 'window'}
          onPress={() => chooseTool('window')}
        />
      )}
      <hr />
      {(['look', 'clip', 'views', 'model'] as const).map((name) => (
        <IconButton
          key={name}
          icon={panelNames[name].icon}
          label={panelNames[name].label}
          hint={panelNames[name].hint}
          pressed={store.panel.value === name}
          onPress={() => togglePanel(name)}
        />
      ))}
    </nav>
  );
}

function PhoneButton(props: { icon: IconName; label: string; pressed: boolean; onPress: () => void }): JSX.Element {
  return (
    <button type="button" aria-pressed={props.pressed} onClick={props.onPress}>
      <Icon name={props.icon} size={22} />
      <span>{props.label}</span>
    </button>
  );
}

/** The tools at the lower edge of a phone, within reach of the thumb. */
export function PhoneBar(): JSX.Element {
  const { value: tool } = store.tool;
  const panel = store.panel.value;
  return (
    <nav class="phone-bar" aria-label="Tools">
      <PhoneButton
        icon={store.flying.value ? 'fly' : 'orbit'}
        label={store.flying.value ? 'Fly' : 'Orbit'}
        pressed={tool === 'navigate' && !panel}
        onPress={() => {
          if (tool === 'navigate' && !panel) store.flying.value = !store.flying.value;
          chooseTool('navigate');
          store.panel.value = undefined;
        }}
      />
      <PhoneButton
        icon="inspect"
        label="Inspect"
        pressed={tool === 'inspect'}
        onPress={() => {
          chooseTool('inspect');
          store.panel.value = undefined;
        }}
      />
      {openVolume() && (
        <PhoneButton
          icon="window"
          label="Window"
          pressed={tool === 'window'}
          onPress={() => {
            chooseTool(tool === 'window' ? 'navigate' : 'window');
            store.panel.value = undefined;
          }}
        />
      )}
      {(['measure', 'look', 'clip', 'views', 'model'] as const).map((name) => (
        <PhoneButton
          key={name}
          icon={panelNames[name].icon}
          label={panelNames[name].label}
          pressed={panel === name}
          onPress={() => togglePanel(name)}
        />
      ))}
    </nav>
  );
}
