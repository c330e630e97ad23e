#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace CLI {
class App;
}

namespace surfcast::protocol {

/// The flags that every program which asks for a picture shares. Each is also read from the environment:
/// `--resolution` is SURFCAST_RESOLUTION; the command line wins. Wrong values are reported by CLI11 as a wrong command
/// line.
class RequestFlags {
 public:
  /// Adds the flags to a command. The object must outlive the parsing.
  void add_to(CLI::App& command);
  /// Only those that say what is to be seen, for programs that keep no file.
  void add_view_flags_to(CLI::App& command);

  /// Whether the flags make sense together; what they get wrong is a wrong command line.
  [[nodiscard]] Status check() const;
  [[nodiscard]] Status check_view_flags() const;
  /// The request for `model`, once `check` is content; reads the camera's file if one is given. Flags win over the
  /// file's fields.
  [[nodiscard]] Result<wire::DrawPicture> request(std::string_view model) const;
  /// The same for `check_view_flags`; the format is that of --format, else PNG.
  [[nodiscard]] Result<wire::DrawPicture> view_request(std::string_view model) const;
  /// Where the picture goes; "-" is standard output.
  [[nodiscard]] const std::string& output() const { return output_; }
  /// Where the figures go, empty for nowhere.
  [[nodiscard]] const std::string& stats() const { return stats_; }
  /// The file of a camera path, of which every frame is drawn; empty for a single picture.
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] double frames_per_second() const { return fps_; }

 private:
  [[nodiscard]] Result<wire::FileFormat> format() const;

  std::map<std::string, std::string> values_;  ///< by name of picture_fields(); empty: not given
  std::string camera_file_;
  std::string output_;
  std::string stats_;
  std::string path_;
  double fps_ = 30;
};

/// The flags of `pick`.
class PickFlags {
 public:
  /// As in RequestFlags, like the next two.
  void add_to(CLI::App& command);
  [[nodiscard]] Status check() const { return view_flags_.check_view_flags(); }
  [[nodiscard]] Result<wire::PickSurfel> request(std::string_view model) const;
  /// The result as the flags want it, to standard output.
  [[nodiscard]] Status print(const wire::PickResult& result) const;

 private:
  RequestFlags view_flags_;
  std::string pixel_;
  bool json_ = false;
};

/// The name of the environment variable that mirrors a flag: "camera-view-up" is SURFCAST_CAMERA_VIEW_UP.
std::string environment_name(std::string_view flag);

/// Sets the fields of a camera that the JSON text states ({"position": [x,y,z], "focal_point": ..., "view_up": ...,
/// "view_angle": degrees}).
Status parse_camera_json(std::string_view text, wire::Camera& camera);

}  // namespace surfcast::protocol
