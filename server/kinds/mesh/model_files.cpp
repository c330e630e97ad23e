#include "mesh/model_files.h"

#include <utility>

#include "scan/text_tokens.h"

namespace surfcast::mesh {

ImageSource named_image(const std::filesystem::path& model, const std::string& name) {
  ImageSource image{scan::printable(name), {}, {}, {}};
  std::optional<std::filesystem::path> file = named_file(model, name);
  if (file) {
    image.file = std::move(*file);
  } else {
    image.unavailable = "is not in the model's folder";
  }
  return image;
}

}  // namespace surfcast::mesh
