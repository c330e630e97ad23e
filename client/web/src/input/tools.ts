import { project } from '../camera/projection';
import type { Pixel } from '../camera/vector';
import { addPoint, finish, measuring } from '../measure/measurement_list';
import { vectorFrom } from '../protocol/pictures';
import { kept } from '../state/annotation_storage';
import type { Annotation } from '../state/annotations';
import * as store from '../state/store';
import type { CameraNavigator } from '../view/camera_navigator';
import type { Probe } from '../view/probe';
import { addClipAround } from '../overlay/clip_list';

const reach = 14; // CSS pixels from an annotation

/** The annotation whose mark is under a pixel of the picture. */
function annotationAt(pixel: Pixel): Annotation | undefined {
  const view = store.shownProjection.peek();
  if (!view) return undefined;
  return kept.peek()?.annotations.find(({ position }) => {
    const at = project(view, position);
    return at && Math.hypot(at.x - pixel.x, at.y - pixel.y) <= reach * devicePixelRatio;
  });
}

/** Applies the selected tool to clicks on the picture. */
export class Tools {
  constructor(
    private readonly navigator: CameraNavigator,
    private readonly probe: Probe,
  ) {}

  async click(pixel: Pixel): Promise<void> {
    const kind = measuring();
    const tool = store.tool.peek();
    if (tool === 'navigate' || tool === 'inspect') {
      store.shownAnnotation.value = annotationAt(pixel);
      if (store.shownAnnotation.peek()) return;
    }
    if (tool === 'navigate' || tool === 'window') {
      store.inspection.value = undefined;
      return;
    }
    const picked = await this.pick(pixel);
    if (!picked) {
      if (tool === 'inspect') store.inspection.value = undefined;
      return;
    }
    if (tool === 'inspect') store.inspection.value = picked;
    else if (tool === 'clip') addClipAround(picked.at);
    else if (kind) addPoint(kind, picked.at);
  }

  async doubleClick(pixel: Pixel): Promise<void> {
    if (measuring()) {
      finish();
      return;
    }
    const picked = await this.pick(pixel);
    if (picked) this.navigator.focus(picked.at);
  }

  private async pick(pixel: Pixel): Promise<store.Inspection | undefined> {
    store.picking.value = true;
    try {
      const result = await this.probe.pick(pixel);
      if (result?.hit && result.position) return { result, at: vectorFrom(result.position) };
      store.showNotice('There is no point of the scan here.');
    } catch (error) {
      store.showNotice(error instanceof Error ? error.message : String(error));
    } finally {
      store.picking.value = false;
    }
    return undefined;
  }
}
