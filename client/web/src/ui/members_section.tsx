import type { JSX } from 'preact';
import type { MemberDescription } from '../generated/surfcast_pb';
import { memberContents } from '../state/contents';
import { canJoin, withoutMember, type Swipe } from '../state/joined';
import { showInstead } from '../state/routes';
import { description, display, galleryOpen, members, model, models, swipe, wantedSwipe } from '../state/store';
import { IconButton, Section, Select, Switch } from './controls';
import { Icon } from './icons';

/** Shows a model of several, or hides it. */
function toggle(name: string): void {
  const hidden = display.peek().hiddenModels;
  const hiddenModels = hidden.includes(name) ? hidden.filter((each) => each !== name) : [...hidden, name];
  display.value = { ...display.peek(), hiddenModels };
}

function Member({ member }: { member: MemberDescription }): JSX.Element {
  const name = member.model;
  const hidden = display.value.hiddenModels.includes(name);
  return (
    <li class={hidden ? 'member hidden-member' : 'member'}>
      <IconButton
        icon={hidden ? 'hidden' : 'eye'}
        label={hidden ? `Show ${name}` : `Hide ${name}`}
        pressed={!hidden}
        onPress={() => toggle(name)}
      />
      <span class="name">{name}</span>
      <span class="faint">{memberContents(member)}</span>
      <IconButton
        icon="close"
        label={`Take ${name} out of the view`}
        onPress={() => showInstead(withoutMember(members.peek(), name))}
      />
    </li>
  );
}

/** Divides the view between two of its models. */
function SwipeControls(): JSX.Element {
  const names = members.value;
  const { left, right } = swipe.value ?? { left: names[0]!, right: names[1]! };
  // A model is on one side: choosing it for the other exchanges both.
  const choose = (side: keyof Swipe, name: string): void => {
    const other = side === 'left' ? right : left;
    const rest = name === other ? (side === 'left' ? left : right) : other;
    wantedSwipe.value = side === 'left' ? { left: name, right: rest } : { left: rest, right: name };
  };
  return (
    <>
      <Switch
        label="Swipe between two"
        checked={swipe.value !== undefined}
        onChange={(on) => (wantedSwipe.value = on ? { left, right } : undefined)}
      />
      {swipe.value && (
        <>
          <Select label="Left" value={left} options={names} onChange={(name) => choose('left', name)} />
          <Select label="Right" value={right} options={names} onChange={(name) => choose('right', name)} />
        </>
      )}
    </>
  );
}

/** The models in the view. Each can be hidden or taken out, and others are added from the gallery. */
export function MembersSection(): JSX.Element | null {
  const others = (models.value ?? []).some((name) => canJoin(members.value, name) && !members.value.includes(name));
  const together = description.value?.members ?? [];
  if (model.value === undefined || (together.length === 0 && !others)) return null;
  return (
    <Section title="Models in this view">
      {together.length > 0 && (
        <ul class="members">
          {together.map((member) => (
            <Member key={member.model} member={member} />
          ))}
        </ul>
      )}
      {together.length > 1 && <SwipeControls />}
      {others && (
        <button type="button" onClick={() => (galleryOpen.value = true)}>
          <Icon name="plus" size={16} /> Add a model
        </button>
      )}
    </Section>
  );
}
