#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/georeference.h"
#include "model/model_file.h"
#include "picture/transfer.h"

namespace surfcast::service {

/// The points of each picture::TransferPreset for a volume.
using VolumePresets = std::array<std::vector<picture::TransferPoint>, picture::kTransferPresets>;

/// One of several models that are shown as one.
struct MemberDescription {
  std::string name;
  geometry::Box bounds;
  std::vector<model::KindCount> kinds;
};

/// The description of a model for users.
struct ModelDescription {
  model::ModelInfo info;
  uint32_t levels = 0;
  uint32_t blocks = 0;
  double spacing = 0;  ///< typical distance between neighbouring surfels of the source, world units
  std::vector<model::Volume> volumes{};
  std::vector<VolumePresets> presets{};  ///< for each of the volumes
  std::vector<model::EllipsoidSource> ellipsoids{};
  model::Georeference georeference{};
  std::vector<MemberDescription> members{};  ///< of a joined model
};

/// A scan whose model is not complete.
struct ScanStatus {
  enum class State { kWaiting, kBuilding, kFailed };
  std::string model;  ///< the name under which it is served
  State state = State::kWaiting;
  double done = 0;          ///< share of the build, in [0, 1]
  double seconds_left = 0;  ///< 0: not known
  std::string problem{};    ///< of kFailed: why there is no model, one line
  uint64_t edition = 0;     ///< of the preview that is served meanwhile; 0: none
};

/// All that a server has.
struct ModelList {
  std::vector<std::string> names;  ///< sorted; those too whose model or preview will be there soon
  std::vector<ScanStatus> scans;   ///< sorted by name
};

/// The served models, by name. Thread-safe; methods may access the disk.
class ModelSource {
 public:
  virtual ~ModelSource() = default;

  /// The names of all models, sorted. Those of scans are among them from the beginning, unless they fail.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  /// The scans whose models are not complete, sorted by name.
  [[nodiscard]] virtual std::vector<ScanStatus> scans() const { return {}; }
  /// True if there is nothing to draw under this name yet, and will be. Until then `open` and `describe` fail with
  /// kUnavailable.
  [[nodiscard]] virtual bool awaited(const std::string& /*name*/) const { return false; }
  /// Number of the newest edition of a scan's model: previews and the model itself follow each other, each better than
  /// the one before. 0: there is none, or the model is no scan's.
  [[nodiscard]] virtual uint64_t edition(const std::string& /*name*/) const { return 0; }
  /// Whether the bytes of the model come over the network, so that all who work on it may wait for long. Does not
  /// access the disk.
  [[nodiscard]] virtual bool remote(const std::string& /*name*/) const { return false; }
  [[nodiscard]] virtual Result<ModelDescription> describe(const std::string& name) const = 0;
  /// The model of this name. The pointer changes when the file is replaced.
  [[nodiscard]] virtual Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const = 0;
};

}  // namespace surfcast::service
