#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "builder/place_inputs.h"
#include "estimation/surfel_report.h"
#include "geometry/box.h"
#include "scan/scan_schema.h"
#include "scan/scan_stream.h"

namespace surfcast::builder {

/// Opens an input as a stream of points. `limit`: memory that it may use. `sample`: see ScanStream::open.
using OpenInput = std::function<Result<scan::ScanStream>(
    const std::filesystem::path& input, const scan::DecodingLimit& limit, std::optional<uint64_t> sample)>;

/// The clean points of one piece of an input, under the schema of the cloud.
struct InputPiece {
  size_t source = 0;
  scan::ScanPoints points;
};

/// What is known of an input once all of it was read.
struct InputFacts {
  scan::ScanFacts scan;  ///< of its points as they are in the file
  geometry::Box bounds;  ///< of its usable points as they are read here
  size_t pieces = 0;
};

/// How inputs are opened again.
struct Reopening {
  std::vector<std::filesystem::path> paths;
  std::vector<bool> read;  ///< for each input; the others are not opened, and none of their pieces may be read
  scan::Selection selection;
  std::optional<bool> z_up;
  uint64_t max_bytes = 0;  ///< see BuildInputs::open
  SystemOptions systems;
};

/// All inputs of a build as one stream of points with a common schema.
class BuildInputs {
 public:
  /// Opens all inputs, by `open` unless it is empty, which reads each file once. At most `max_bytes` of memory hold
  /// decoded inputs. `z_up` overrides the vertical axis that the inputs state. `sample` points of each input at most,
  /// see ScanStream. Errors name the file.
  static Result<BuildInputs> open(std::span<const std::filesystem::path> paths, const OpenInput& open,
                                  std::optional<bool> z_up, uint64_t max_bytes, std::optional<uint64_t> sample,
                                  const std::function<void(double)>& progress);

  /// Opens inputs that were opened and placed before, without reading all of them. `facts`: what was found then.
  static Result<BuildInputs> reopen(const Reopening& reopening, std::vector<InputFacts> facts);

  /// Brings all inputs into one metric coordinate system, if they state any. Those that are moved are read once more
  /// for their bounds.
  Result<Placement> place(const SystemOptions& options);

  [[nodiscard]] const scan::ScanSchema& schema() const { return schema_; }
  [[nodiscard]] const std::vector<InputFacts>& facts() const { return facts_; }            ///< of each input
  [[nodiscard]] const model::Georeference& georeference() const { return georeference_; }  ///< once they are placed
  [[nodiscard]] const std::vector<scan::ScanSchema>& schemas() const { return schemas_; }  ///< of each input
  [[nodiscard]] uint64_t size() const;           ///< points, including unusable ones
  [[nodiscard]] uint64_t size_of_files() const;  ///< points, beyond samples too
  [[nodiscard]] geometry::Box bounds() const;    ///< of the usable positions
  [[nodiscard]] uint64_t held_bytes() const;     ///< memory of inputs that are decoded as a whole, bytes
  [[nodiscard]] size_t pieces() const { return pieces_.size(); }
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Reads a piece. Counts dropped points in `report`. Thread-safe.
  [[nodiscard]] Result<InputPiece> read(size_t piece, estimation::SurfelReport& report) const;

 private:
  struct PieceOfInput {
    size_t source = 0;
    size_t piece = 0;
  };

  void add(InputFacts facts, std::optional<scan::ScanStream> stream);
  Result<Placement> find_place(const SystemOptions& options);
  Status measure(size_t input);
  void merge();

  std::vector<std::optional<scan::ScanStream>> streams_;
  std::vector<InputFacts> facts_;                                  ///< of the streams
  std::vector<scan::ScanSchema> schemas_;                          ///< of the streams, as their points are read here
  std::vector<std::shared_ptr<const crs::Transformation>> moves_;  ///< of the streams; null: points stay
  model::Georeference georeference_;
  std::optional<bool> z_up_;  ///< of all inputs
  std::vector<PieceOfInput> pieces_;
  scan::ScanSchema schema_;
};

}  // namespace surfcast::builder
