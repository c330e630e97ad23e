import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useId, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { useActions } from './actions';
import { Icon, type IconName } from './icons';

/** The page's own form controls. */

interface IconButtonProps {
  readonly icon: IconName;
  readonly label: string;
  readonly hint?: string; // keyboard shortcut
  readonly pressed?: boolean;
  readonly disabled?: boolean;
  readonly onPress: () => void;
}

export function IconButton({ icon, label, hint, pressed, disabled, onPress }: IconButtonProps): JSX.Element {
  return (
    <button
      type="button"
      class="icon-button"
      aria-label={label}
      aria-pressed={pressed}
      title={hint ? `${label} (${hint})` : label}
      disabled={disabled}
      onClick={onPress}
    >
      <Icon name={icon} />
    </button>
  );
}

export function Section({ title, aside, children }: {
  title: string;
  aside?: ComponentChildren;
  children: ComponentChildren;
}): JSX.Element {
  return (
    <section class="section">
      <header>
        <h2>{title}</h2>
        {aside}
      </header>
      {children}
    </section>
  );
}

export function Field({ label, children }: { label: string; children: ComponentChildren }): JSX.Element {
  return (
    <label class="field">
      <span>{label}</span>
      {children}
    </label>
  );
}

interface ChoicesProps<Value extends string> {
  readonly label: string;
  readonly value: Value;
  readonly options: readonly { value: Value; label: string; disabled?: boolean }[];
  readonly onChange: (value: Value) => void;
}

/** The options of such a group, in the order of their labels. */
export const optionsOf = <Value extends string>(labels: Readonly<Record<Value, string>>) =>
  (Object.keys(labels) as Value[]).map((value) => ({ value, label: labels[value] }));

/** A group of radio buttons side by side. */
export function Choices<Value extends string>(props: ChoicesProps<Value>): JSX.Element {
  const name = useId();
  return (
    <div class="choices" role="radiogroup" aria-label={props.label}>
      {props.options.map((option) => (
        <label key={option.value} class={option.disabled ? 'choice disabled' : 'choice'}>
          <input
            type="radio"
            name={name}
            checked={option.value === props.value}
            disabled={option.disabled}
            onChange={() => props.onChange(option.value)}
          />
          <span>{option.label}</span>
        </label>
      ))}
    </div>
  );
}

interface SelectProps {
  readonly label: string;
  readonly value: string;
  readonly options: readonly string[];
  readonly onChange: (value: string) => void;
}

/** One of many names. */
export function Select({ label, value, options, onChange }: SelectProps): JSX.Element {
  return (
    <label class="number">
      <span>{label}</span>
      <select aria-label={label} value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        {options.map((option) => (
          <option key={option}>{option}</option>
        ))}
      </select>
    </label>
  );
}

interface SliderProps {
  readonly label: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  readonly step: number;
  readonly shown?: string;
  readonly onInput: (value: number) => void;
}

/** While the slider is dragged, the picture is updated with the quality of a moving view. */
export function Slider({ label, value, min, max, step, shown, onInput }: SliderProps): JSX.Element {
  const { navigator } = useActions();
  const part = max > min ? ((value - min) / (max - min)) * 100 : 0;
  return (
    <label class="slider">
      <span>{label}</span>
      <output>{shown ?? value}</output>
      <input
        type="range"
        aria-label={label} // a label element would name the output
        style={{ '--part': `${part}%` }}
        {...{ value, min, max, step }}
        onPointerDown={() => navigator.adjust(true)}
        onPointerUp={() => navigator.adjust(false)}
        onPointerCancel={() => navigator.adjust(false)}
        onInput={(event) => onInput(event.currentTarget.valueAsNumber)}
      />
    </label>
  );
}

interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  readonly decimals: number;
  readonly hideLabel?: boolean;
  readonly onChange: (value: number) => void;
}

/** Applies the input on Enter or when the field loses the focus. Input that is not a number is ignored. */
export function NumberField({ label, value, decimals, hideLabel, onChange }: NumberFieldProps): JSX.Element {
  const shown = String(Number(value.toFixed(decimals)));
  const [text, setText] = useState(shown);
  useLayoutEffect(() => setText(shown), [shown]); // before the next key: a later effect would replace what it typed
  const take = (): void => {
    const typed = Number(text.replace(',', '.'));
    if (text.trim() !== '' && Number.isFinite(typed) && text !== shown) onChange(typed);
    else setText(shown);
  };
  return (
    <label class="number">
      <span class={hideLabel ? 'hidden' : ''}>{label}</span>
      <input
        type="text"
        inputMode="decimal"
        value={text}
        onInput={(event) => setText(event.currentTarget.value)}
        onBlur={take}
        onKeyDown={(event) => {
          if (event.key === 'Enter') take();
        }}
      />
    </label>
  );
}

export function Switch({ label, checked, onChange }: {
  label: string;
  checked: boolean;
  onChange: (checked: boolean) => void;
}): JSX.Element {
  return (
    <label class="switch">
      <span>{label}</span>
      <input
        type="checkbox"
        role="switch"
        checked={checked}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
    </label>
  );
}

/** A modal dialog. Escape or a click outside closes it. */
export function Dialog({ title, onClose, children }: {
  title: string;
  onClose: () => void;
  children: ComponentChildren;
}): JSX.Element {
  const element = useRef<HTMLDialogElement>(null);
  useEffect(() => element.current?.showModal(), []);
  return (
    <dialog
      ref={element}
      aria-label={title}
      onClose={onClose}
      onClick={(event) => {
        if (event.target === element.current) element.current?.close();
      }}
    >
      <div class="dialog">
        <header>
          <h2>{title}</h2>
          <IconButton icon="close" label="Close" onPress={() => element.current?.close()} />
        </header>
        {children}
      </div>
    </dialog>
  );
}
