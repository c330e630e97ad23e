#include "grid/grid_format.h"

#include "grid/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {

std::optional<GridFormat> grid_format_of(const stream::FilePtr& file) {
  const std::string_view text = scan::as_text(file->bytes());
  if (text.starts_with("NRRD000")) return GridFormat::kNrrd;
  if (text.starts_with("# vtk DataFile")) return GridFormat::kVtkLegacy;
  if (text.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return GridFormat::kVtkXml;
  if (looks_like_nifti(file->bytes()) || looks_like_packed_nifti(file)) return GridFormat::kNifti;
  if (looks_like_mrtrix(file)) return GridFormat::kMrtrix;
  if (looks_like_meta_image(text)) return GridFormat::kMetaImage;
  return std::nullopt;
}

}  // namespace surfcast::grid
