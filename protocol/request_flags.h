#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/camera_path.h"
#include "surfcast.pb.h"

namespace CLI {
class App;
}

namespace surfcast::protocol {

/// The flags shared by all programs that request pictures. Each flag has an environment variable: SURFCAST_RESOLUTION
/// sets `--resolution`. The command line takes precedence. CLI11 reports an invalid value as a command line error.
class RequestFlags {
 public:
  /// Gives a field of the picture another default than that of its help. Call it before the flags are added.
  void set_default(std::string_view field, std::string_view text);
  /// Adds the flags to a command. The object must outlive the parsing.
  void add_to(CLI::App& command);
  /// Adds only the flags that describe the view, for programs that write no picture file.
  void add_view_flags_to(CLI::App& command);

  /// Checks that the flags are consistent. Callers report a failure as a command line error.
  [[nodiscard]] Status check() const;
  [[nodiscard]] Status check_view_flags() const;
  /// The request for `model`. Call it only after `check` has succeeded. Reads the camera file if one is given; flags
  /// take precedence over the fields of the file.
  [[nodiscard]] Result<wire::DrawPicture> request(std::string_view model) const;
  /// The same after `check_view_flags`. The format is that of --format, by default PNG.
  [[nodiscard]] Result<wire::DrawPicture> view_request(std::string_view model) const;
  /// File name of the picture; "-" is standard output.
  [[nodiscard]] const std::string& output() const { return output_; }
  /// File name of the statistics; empty: none are written.
  [[nodiscard]] const std::string& stats() const { return stats_; }
  /// File name of a camera path, of which every frame is drawn; empty: a single picture.
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] double frames_per_second() const { return fps_; }
  [[nodiscard]] double seconds_per_view() const { return seconds_per_view_; }

 private:
  void add_fields_to(CLI::App& command, bool file);
  [[nodiscard]] Result<wire::FileFormat> format() const;
  /// The request in this format; none: that of --format.
  [[nodiscard]] Result<wire::DrawPicture> request(std::string_view model, std::optional<wire::FileFormat> format) const;

  [[nodiscard]] bool is_replaced(const std::string& field) const;

  std::map<std::string, std::string> values_;    ///< by field name (picture_fields()); empty text: none
  std::map<std::string, std::string> defaults_;  ///< those of set_default
  std::string camera_file_;
  std::string output_;
  std::string stats_;
  std::string path_;
  double fps_ = 30;
  double seconds_per_view_ = CameraPath::kSecondsPerView;
};

/// The flags of `pick`.
class PickFlags {
 public:
  // These three are as in RequestFlags.
  void add_to(CLI::App& command);
  [[nodiscard]] Status check() const { return view_flags_.check_view_flags(); }
  [[nodiscard]] Result<wire::PickSurfel> request(std::string_view model) const;
  /// Writes the result to standard output, as text or as JSON.
  [[nodiscard]] Status print(const wire::PickResult& result) const;

 private:
  RequestFlags view_flags_;
  std::string pixel_;
  bool json_ = false;
};

/// The name of a flag's environment variable: SURFCAST_CAMERA_VIEW_UP for "camera-view-up".
std::string environment_name(std::string_view flag);

/// Sets the camera fields that are present in the JSON text ({"position": [x,y,z], "focal_point": ..., "view_up": ...,
/// "view_angle": degrees}); leaves the others unchanged.
Status parse_camera_json(std::string_view text, wire::Camera& camera);

}  // namespace surfcast::protocol
