#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "scan/whole_scan.h"

namespace surfcast::testing {

/// A folder of its own for each test.
class ScanFolderTest : public ::testing::Test {
 protected:
  ScanFolderTest()
      : folder_(std::filesystem::path(::testing::TempDir()) /
                (std::string("scan_folder_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
                 std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
  }
  ~ScanFolderTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  [[nodiscard]] Result<WholeScan> read(const scan::Selection& selection = {}) const {
    return whole(scan::ScanStream::open(folder_, {}, {}, selection));
  }
  [[nodiscard]] std::string error() const {
    const Result<WholeScan> points = read();
    return points ? "" : points.error().message;
  }

  std::filesystem::path folder_;
};

}  // namespace surfcast::testing
