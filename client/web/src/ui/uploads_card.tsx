import type { JSX } from 'preact';
import { uploadList, type Upload } from '../input/uploads';
import { openModel } from '../state/routes';
import { dropping, galleryOpen } from '../state/store';
import { useActions } from './actions';
import { IconButton } from './controls';

/** The scans that the user sends to the server. */

function Row({ upload }: { upload: Upload }): JSX.Element {
  const { uploader } = useActions();
  const open = (): void => {
    galleryOpen.value = false;
    if (upload.model) openModel(upload.model);
    uploader.remove(upload.id);
  };
  return (
    <li class={upload.state}>
      <span class="name">{upload.name}</span>
      {upload.state === 'sending' && <span class="faint">{Math.floor(upload.sent * 100)} %</span>}
      {upload.state === 'done' && !upload.model && <span class="faint">waits for its header</span>}
      {upload.state === 'done' && upload.model && (
        <button type="button" onClick={open}>
          Open
        </button>
      )}
      <IconButton
        icon="close"
        label={upload.state === 'sending' ? `Cancel ${upload.name}` : `Remove ${upload.name}`}
        onPress={() => uploader.remove(upload.id)}
      />
      {upload.state === 'sending' && <progress value={upload.sent} />}
      {upload.problem && <p class="problem">{upload.problem}</p>}
    </li>
  );
}

export function UploadsCard(): JSX.Element | null {
  if (dropping.value) return <div class="drop-here">Drop scans, volumes or Gaussians here to send them to the server</div>;
  if (uploadList.value.length === 0) return null;
  return (
    <section class="uploads" aria-label="Scans on their way">
      <ul>
        {uploadList.value.map((upload) => (
          <Row key={upload.id} upload={upload} />
        ))}
      </ul>
    </section>
  );
}
