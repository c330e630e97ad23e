#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::net {

/// Where saved views and annotations of models are kept.
struct AnnotationConfig {
  std::filesystem::path folder;      ///< of one file a model; empty: none are kept
  size_t bytes = size_t{256} << 10;  ///< of the file of one model at most
};

/// The saved views and annotations of a model: a document of JSON, which docs/serving.md describes.
struct Annotations {
  std::string document;
  std::string edition;  ///< of the document, a name that no other one has
};

inline constexpr size_t kMaxAnnotationTextBytes = 4000;
inline constexpr size_t kMaxViewNameBytes = 320;
inline constexpr size_t kMaxViewParameters = 100;
inline constexpr size_t kMaxViewParameterBytes = 32'768;  ///< of one, name and value

/// A document as it is kept: the same content in a fixed order, indented. Fails with what is wrong with it.
Result<std::string> normalized_annotations(std::string_view document, const std::string& model);

/// The file of a model. Characters of the name that a file name should not have are escaped as in URLs.
std::filesystem::path annotation_file(const AnnotationConfig& config, const std::string& model);

/// Waits for the disk. A model without a file has a document without views and annotations. Errors do not tell where
/// the folder is.
Result<Annotations> read_annotations(const AnnotationConfig& config, const std::string& model);

/// Replaces the document of a model, and waits for the disk. `replaced`: the edition that the new one was made from;
/// kReplaced if the present one is another. Calls must not overlap.
Result<Annotations> write_annotations(const AnnotationConfig& config, const std::string& model,
                                      std::string_view document, const std::optional<std::string>& replaced);

}  // namespace surfcast::net
