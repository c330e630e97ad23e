#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x3.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/log_format.h"
#include "base/result.h"
#include "exporter/point_facts.h"
#include "kinds/source_block.h"
#include "pick/band.h"
#include "picture/device_info.h"
#include "picture/picture.h"
#include "render/renderer.h"
#include "service/model_queries.h"
#include "service/point_stream.h"
#include "surfel/grid.h"

namespace surfcast::worker {

// What the server and a worker tell each other. The server begins. A render worker draws. Pictures nest: while the
// worker draws one, it asks now and then whether another one comes first, and waits for the answer. A query worker
// answers one question after the other.

/// Server: the first message to a render worker.
struct Configure {
  render::RendererConfig renderer;
  LogFormat log_format = LogFormat::kText;
  bool sandbox = true;
  std::vector<std::string> readable;  ///< further files and folders that the sandbox lets the worker read
  std::vector<std::string> writable;  ///< folders that it lets the worker change
};

/// Server: the first message to a query worker.
struct ConfigureQueries {
  LogFormat log_format = LogFormat::kText;
  bool sandbox = true;
  std::vector<std::string> readable;  ///< files and folders that the sandbox lets the worker read
  uint64_t block_bytes = 0;           ///< of decoded blocks that it keeps
  uint64_t memory = 0;                ///< bytes that it may allocate; 0: no limit
};

/// Worker: the answer to the first message. Without a device it is Refused. A query worker has none.
struct Ready {
  picture::DeviceInfo device;
  int max_resolution = 0;
};

/// Server: a model that will be used. Its file descriptor travels along.
struct OfferModel {
  uint64_t model = 0;                 ///< its number
  std::string path;                   ///< for errors
  std::vector<uint32_t> quarantined;  ///< blocks that are not loaded
  std::vector<uint32_t> suspected;    ///< blocks that are loaded while no other one is
};

/// Server: models that will be used as one. All have been offered.
struct OfferJoin {
  /// A member, as model::Member has it.
  struct Part {
    uint64_t model = 0;
    std::string name;
    std::vector<glm::dmat4x3> places;
  };
  uint64_t model = 0;  ///< its number
  std::vector<Part> parts;
  std::string path;                   ///< as in OfferModel
  std::vector<uint32_t> quarantined;  ///< likewise
  std::vector<uint32_t> suspected;    ///< likewise
};

/// Server: a model that will not be used again.
struct WithdrawModel {
  uint64_t model = 0;
};

/// Server: a picture. The worker answers with Drawn or Refused, after any number of AskUrgent.
struct Draw {
  uint64_t model = 0;
  picture::PictureRequest request;
};

/// Worker, in the middle of a picture: has more urgent work to run? Draw messages may come before the answer.
struct AskUrgent {};

/// Server: the answer to AskUrgent.
struct Continue {
  bool preempted = false;  ///< there was urgent work
};

/// Worker: the picture is finished. Its pixels, if it has any, are in the shared memory.
struct Drawn {
  picture::Frame frame;
  bool pixels = false;
};

/// Worker: there is no picture, no answer, or no renderer.
struct Refused {
  Error error;
};

/// Server: what is in a pixel? The answer is Picked.
struct Pick {
  uint64_t model = 0;
  service::PixelQuery query;
};
struct Picked {
  std::optional<kinds::PickedSurfel> item;
};

/// Server: what is in all pixels? The answer is a SurfacePart for each of pick::surface_regions, in their order.
struct SearchSurface {
  uint64_t model = 0;
  service::SurfaceQuery query;
};
struct SurfacePart {
  std::vector<std::byte> pixels;  ///< pick::FrontPixel as they are in memory
};

/// Server: what lies near a line? The answer is one BandPart or more.
struct FindBand {
  uint64_t model = 0;
  pick::BandQuery query;
};
struct BandPart {
  uint64_t total = 0;   ///< as in pick::Band
  double length = 0;    ///< likewise
  surfel::Grid grid{};  ///< likewise
  std::vector<pick::BandPoint> points;
  std::vector<double> values;  ///< of these points
  bool last = false;
};

/// Server: the points of a region are wanted, under a number of the server's. The answer is PointsCounted.
struct OpenPoints {
  uint64_t stream = 0;
  uint64_t model = 0;
  service::PointsQuery query;
};
/// Server: a turn of counting them. The answer is PointsCounted, too.
struct CountPoints {
  uint64_t stream = 0;
};
struct PointsCounted {
  exporter::PointFacts facts;
  bool whole = false;  ///< all are counted
};
/// Server: the next bytes of their file. The answer is PointsPiece.
struct NextPiece {
  uint64_t stream = 0;
  uint64_t bytes = 0;
};
struct PointsPiece {
  service::PointPiece piece;  ///< of as many bytes at most
};
/// Server: no more of them are wanted. There is no answer.
struct ClosePoints {
  uint64_t stream = 0;
};

using Message = std::variant<Configure, Ready, OfferModel, WithdrawModel, Draw, AskUrgent, Continue, Drawn, Refused,
                             ConfigureQueries, Pick, Picked, SearchSurface, SurfacePart, FindBand, BandPart, OpenPoints,
                             CountPoints, PointsCounted, NextPiece, PointsPiece, ClosePoints, OfferJoin>;

/// The error of a worker, which may be hostile and state any kind.
[[nodiscard]] Error checked(Error error);

[[nodiscard]] std::vector<std::byte> encode(const Message& message);
/// Fails on bytes that are no message, whatever they are.
[[nodiscard]] Result<Message> decode(std::span<const std::byte> bytes);

}  // namespace surfcast::worker
