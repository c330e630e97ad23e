import type { Pixel } from '../camera/vector';
import { addPoint, finish, measuring } from '../measure/measurement_list';
import { vectorFrom } from '../protocol/pictures';
import * as store from '../state/store';
import type { CameraNavigator } from '../view/camera_navigator';
import type { Probe } from '../view/probe';
import { addClipAround } from '../overlay/clip_list';

/** Applies the selected tool to clicks on the picture. */
export class Tools {
  constructor(
    private readonly navigator: CameraNavigator,
    private readonly probe: Probe,
  ) {}

  async click(pixel: Pixel): Promise<void> {
    const kind = measuring();
    const tool = store.tool.peek();
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
