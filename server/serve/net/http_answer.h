#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"
#include "net/static_files.h"
#include "net/uploads.h"
#include "protocol/profile_query.h"
#include "service/model_source.h"
#include "service/render_service.h"

namespace surfcast::net {

/// An answer of HTTP before it is written.
struct HttpAnswer {
  unsigned status = 200;
  std::string content_type;
  std::vector<std::pair<std::string, std::string>> headers;
  std::vector<std::byte> body;
  std::shared_ptr<const void> memory{};  ///< counts the body of a picture
  /// Makes what follows behind `body`, piece by piece, until a piece is the last; null: nothing does.
  std::function<boost::asio::awaitable<Result<service::PointPiece>>()> more{};
};

HttpAnswer text_answer(std::string_view text, std::string_view content_type);

/// {"error": {"kind": "not_found", "message": "..."}} with the status that fits the kind.
HttpAnswer error_answer(const Error& error);
/// The same with a status that no kind stands for.
HttpAnswer error_answer(const Error& error, unsigned status);

/// {"models": ["a", "b"], "scans": [{"model": "b", "state": "building", "percent": 37, ...}]}
HttpAnswer models_answer(const service::ModelList& models, const UploadConfig& uploads);
/// 201: {"model": "a"}. `what` has arrived: a "model", or a "file" that a scan will name.
HttpAnswer uploaded_answer(const char* what, const std::string& name);
HttpAnswer model_answer(const std::string& name, const service::ModelDescription& description);
/// The picture, with what drawing it took in the headers Server-Timing and X-Surfcast-*.
HttpAnswer picture_answer(service::EncodedPicture picture);
/// A file of the viewer, or 304 when `if_none_match`, the request's header, already names what it holds.
HttpAnswer file_answer(const StaticFile& file, std::string_view if_none_match);
/// What a pixel shows, as pick_result_json writes it.
HttpAnswer pick_answer(const std::optional<service::PickedPoint>& picked);
/// The points of a profile as a file to save, and in the headers how many they are, and how many there are in the band.
HttpAnswer profile_answer(const std::string& name, const service::ProfileResult& profile,
                          protocol::ProfileFormat format);
/// {"points": 1234}, and in a header how many there may be at most in a file.
HttpAnswer point_count_answer(uint64_t points, uint64_t most);
/// The beginning of a file of points to save, without a body, and in a header how many they are.
HttpAnswer points_answer(const std::string& name, std::string_view format, uint64_t points);
/// The page at / of a server without the viewer: how to install it.
HttpAnswer no_viewer_answer();

}  // namespace surfcast::net
