#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"
#include "exporter/point_facts.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"

namespace surfcast::exporter {

/// The formats in which points are written.
enum class PointFormat { kLas, kLaz, kPly, kCsv, kNpy };

/// Their names, which are also the extensions of files.
inline constexpr std::array<std::pair<std::string_view, PointFormat>, 5> kPointFormats = {{{"las", PointFormat::kLas},
                                                                                           {"laz", PointFormat::kLaz},
                                                                                           {"ply", PointFormat::kPly},
                                                                                           {"csv", PointFormat::kCsv},
                                                                                           {"npy", PointFormat::kNpy}}};

/// The format of that name, in small letters.
std::optional<PointFormat> point_format_of(std::string_view name);

/// Points of one schema as the bytes of a file, from its first byte to its last. The head is asked for first and once,
/// the tail last and once.
class PointEncoder {
 public:
  PointEncoder() = default;
  PointEncoder(const PointEncoder&) = delete;
  PointEncoder& operator=(const PointEncoder&) = delete;
  virtual ~PointEncoder() = default;

  virtual std::vector<std::byte> head() = 0;
  virtual Result<std::vector<std::byte>> rows(const scan::ScanPoints& points) = 0;
  virtual std::vector<std::byte> tail() { return {}; }
  /// What is not as in the source, for people; empty: nothing.
  [[nodiscard]] virtual std::string note() const { return {}; }
};

struct EncoderOptions {
  std::optional<double> scale;  ///< steps of LAS coordinates; none: those of the source, or see lattice_for
  /// Points of a chunk of LAZ; of octrees, OctreeOptions::leaf_points. None: the default of each.
  std::optional<uint32_t> chunk_size;
};

/// What the encoder of a format needs to know.
WantedFacts facts_for(PointFormat format);

/// An encoder for points with these facts. LAS and LAZ keep the lattice of the facts where it spans the points, see
/// las_table.h. Memory is that of a chunk of LAZ.
Result<std::unique_ptr<PointEncoder>> make_point_encoder(PointFormat format, scan::ScanSchema schema,
                                                         const PointFacts& facts, const EncoderOptions& options = {});

}  // namespace surfcast::exporter
