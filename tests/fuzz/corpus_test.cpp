// Every file of the corpora, and of what fuzzing found, goes through its target.

#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz/targets.h"
#include "support/path_of.h"

namespace surfcast::fuzz {
namespace {

class FuzzCorpus : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, EveryInputIsReadOrRefused) {
  const std::filesystem::path folder = std::filesystem::path(path_of("tests/fuzz/corpus")) / GetParam().name;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    GetParam().run(std::as_bytes(std::span(bytes)));
    ++files;
  }
  EXPECT_GT(files, 0);
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpus, ::testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace surfcast::fuzz
