#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "exporter/point_facts.h"
#include "model/model_file.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "scan/selection.h"

namespace surfcast::crs {
class Transformation;
}

namespace surfcast::exporter {

/// Which points of a model are taken, and how they are stated.
struct ModelSelection {
  /// The zone is in coordinates of the model. Where y is its vertical axis, the lines of corridors are z and x.
  /// `every`: of all points of the model, in the order of its file, every n-th.
  scan::Selection points;
  bool source_coordinates = false;  ///< positions in the system of the source, where the model states another one
  bool normals = false;             ///< with normals, as the model has them
};

/// The points of a scan as its model has them: the surfels of the finest level. Positions are exact on their lattice,
/// colours and attributes have the values and types of the source. Pieces are read in any order and from any thread;
/// only blocks that the zone may meet are pieces.
class ModelPoints {
 public:
  /// Fails if the model has no points (volumes, Gaussians and ellipsoids are none), if classes are selected and it has
  /// no classification, and if its coordinates cannot be brought into the system of the source. `name` is that of the
  /// model in errors.
  static Result<ModelPoints> open(std::shared_ptr<const model::ModelFile> model, const std::string& name,
                                  const ModelSelection& selection);

  ModelPoints(ModelPoints&&) noexcept;
  ModelPoints& operator=(ModelPoints&&) noexcept;
  ~ModelPoints();

  /// Without a lattice, which PointFacts has.
  [[nodiscard]] const scan::ScanSchema& schema() const { return schema_; }
  [[nodiscard]] size_t pieces() const { return leaves_.size(); }
  /// The points of a piece that are in the selection, in the order of the file; often none.
  [[nodiscard]] Result<scan::ScanPoints> read(size_t piece) const;
  /// What is known of these points. The facts of all pieces together are those of all points.
  [[nodiscard]] Result<PointFacts> count(size_t piece, WantedFacts wanted) const;

 private:
  struct Leaf {
    uint32_t block = 0;
    uint64_t first = 0;  ///< number of its first point in the model
  };

  ModelPoints(std::shared_ptr<const model::ModelFile> model, const std::string& name, const ModelSelection& selection);
  [[nodiscard]] tl::unexpected<Error> failed(ErrorKind kind, const std::string& what) const;
  Status describe();
  Status state_system();
  [[nodiscard]] bool may_hold(const geometry::Box& bounds) const;
  [[nodiscard]] bool holds(const glm::dvec3& point) const;
  [[nodiscard]] bool takes_all_of(const geometry::Box& bounds) const;
  [[nodiscard]] std::vector<bool> wanted_classes() const;
  [[nodiscard]] uint64_t step() const;
  /// The first row to take of a block whose first point has that number.
  [[nodiscard]] uint64_t first_row(uint64_t first) const;
  [[nodiscard]] std::vector<uint32_t> chosen(const model::DecodedBlock& block, uint64_t first) const;
  [[nodiscard]] Result<std::vector<glm::dvec3>> positions(const model::DecodedBlock& block,
                                                          const std::vector<uint32_t>& rows) const;

  std::shared_ptr<const model::ModelFile> model_;
  ModelSelection selection_;
  geometry::Zone corridors_;  ///< of the selection's zone; seen along z
  std::vector<Leaf> leaves_;
  scan::ScanSchema schema_;
  std::unique_ptr<const crs::Transformation> to_source_;  ///< null: positions stay what they are
};

}  // namespace surfcast::exporter
