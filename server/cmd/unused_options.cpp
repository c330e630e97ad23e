#include "cmd/unused_options.h"

#include <algorithm>
#include <string_view>

#include "model/ellipsoid_source.h"
#include "model/volume.h"

namespace surfcast::cmd {

std::vector<std::string> unused_options(const wire::DrawPicture& request, const model::ModelInfo& info) {
  const auto has = [&info](std::string_view kind) {
    return std::ranges::any_of(info.kinds, [kind](const model::KindCount& count) { return count.kind == kind; });
  };
  std::vector<std::string> lines;
  const auto note = [&](bool stated, std::string_view kind, const char* options, const char* of) {
    if (!stated || has(kind)) return;
    lines.push_back(std::string(options) + " without effect: the model has no " + of);
  };
  note(request.has_lighting(), model::kEllipsoidKind, "--lights", "ellipsoids or tensors; surfels have --shading");
  note(request.has_glyphs(), model::kEllipsoidKind, "options of glyphs", "ellipsoids or tensors");
  note(request.has_transfer(), model::kGridKind, "--transfer", "volume");
  note(request.iso_surfaces_size() > 0, model::kGridKind, "--iso", "volume");
  note(request.slices_size() > 0, model::kGridKind, "--slice", "volume");
  return lines;
}

}  // namespace surfcast::cmd
