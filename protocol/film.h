#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/descriptor.h"
#include "base/result.h"
#include "base/unfinished_file.h"

namespace surfcast::protocol {

/// Whether a file name is that of a film: it ends with .mp4 or .webm.
bool is_film(const std::filesystem::path& file);

/// A film, which the program ffmpeg encodes from pictures: H.264 in MP4, VP9 in WebM, both with the colours of BT.709.
/// The file appears under its name when it is whole.
class FilmWriter {
 public:
  /// Starts ffmpeg. kUnsupported if it is not installed.
  static Result<FilmWriter> create(const std::filesystem::path& target, double frames_per_second);
  FilmWriter(FilmWriter&& other) noexcept;
  FilmWriter& operator=(FilmWriter&&) = delete;
  /// Ends ffmpeg, and removes the file if `finish` has not been called.
  ~FilmWriter();

  /// Adds a picture, a PNG file. All pictures have the same size.
  Status append(std::string_view png);
  Status finish();

 private:
  FilmWriter(std::filesystem::path target, std::filesystem::path temporary, pid_t encoder, Descriptor input,
             Descriptor messages);
  /// The first line that ffmpeg has said.
  [[nodiscard]] std::string complaint() const;
  Status failed() const;
  /// The exit code of ffmpeg; 128 and the number of a signal that ended it.
  int wait();

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  UnfinishedFile unfinished_;
  pid_t encoder_ = -1;
  Descriptor input_;
  Descriptor messages_;  ///< what ffmpeg says
};

}  // namespace surfcast::protocol
