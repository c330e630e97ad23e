import type { JSX } from 'preact';
import type { Choice } from '../generated/plain_options';
import type { DisplayOptions } from '../state/display_options';
import { className } from '../state/palette';
import { description, display } from '../state/store';
import { Choices, optionsOf, Section, Slider } from './controls';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });

const percent = (opacity: number): string => `${Math.round(opacity * 100)} %`;

const bounds = { min: 0, max: 1, step: 0.01 } as const;

const xrayLabels: Readonly<Record<Choice<'xray'>, string>> = { off: 'Off', sorted: 'Walls', density: 'Density' };

/** A factor of all opacities. */
export function Opacity(): JSX.Element {
  const { opacity } = display.value;
  return (
    <Slider
      label="Opacity of all"
      {...{ value: opacity, ...bounds }}
      shown={percent(opacity)}
      onInput={(value) => change({ opacity: value })}
    />
  );
}

/** What clip boxes hide. */
export function Ghost(): JSX.Element {
  const { ghost } = display.value;
  return (
    <Slider
      label="Opacity of what is hidden"
      {...{ value: ghost, ...bounds }}
      shown={percent(ghost)}
      onInput={(value) => change({ ghost: value })}
    />
  );
}

function ClassOpacities(): JSX.Element | null {
  const { classOpacities, hiddenClasses } = display.value;
  const shown = (description.value?.classes ?? []).filter(({ code }) => !hiddenClasses.includes(code));
  const set = (code: number, opacity: number): void => {
    const others = classOpacities.filter((each) => each.code !== code);
    change({ classOpacities: opacity === 1 ? others : [...others, { code, opacity }] });
  };
  return (
    <>
      {shown.map(({ code }) => {
        const value = classOpacities.find((each) => each.code === code)?.opacity ?? 1;
        return (
          <Slider
            key={code}
            label={`Opacity of ${className(code)}`}
            {...{ value, ...bounds }}
            shown={percent(value)}
            onInput={(opacity) => set(code, opacity)}
          />
        );
      })}
    </>
  );
}

export function OpacitySections(): JSX.Element {
  return (
    <>
      <Section title="Opacity">
        <Opacity />
        <ClassOpacities />
      </Section>
      <Section title="X-ray">
        <Choices
          label="X-ray"
          value={display.value.xray}
          options={optionsOf(xrayLabels)}
          onChange={(xray) => change({ xray })}
        />
      </Section>
    </>
  );
}
