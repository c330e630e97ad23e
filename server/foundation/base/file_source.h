#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "base/byte_source.h"
#include "base/positioned_file.h"

namespace surfcast {

/// A file of this machine.
class FileSource : public ByteSource {
 public:
  FileSource(PositionedFile file, const std::filesystem::path& name) : file_(std::move(file)), name_(name.string()) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] uint64_t size() const override { return file_.size(); }
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override {
    return file_.read(offset, bytes);
  }
  void prefetch(std::span<const ByteRange> ranges) const override {
    for (const ByteRange& range : ranges) file_.prefetch(range.offset, range.size);
  }
  [[nodiscard]] std::string version() const override { return file_.version(); }
  [[nodiscard]] int descriptor() const override { return file_.descriptor(); }

 private:
  PositionedFile file_;
  std::string name_;
};

}  // namespace surfcast
