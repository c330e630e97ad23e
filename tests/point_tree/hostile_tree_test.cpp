#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "laz/byte_access.h"
#include "point_tree/open_in_place.h"
#include "point_tree/trees.h"
#include "scan/copc_file.h"

namespace surfcast::point_tree {
namespace {

using surfcast::testing::copc_file;
using ::testing::HasSubstr;
using testing::source_of;
using ::testing::StartsWith;

constexpr size_t kInfo = 375 + 54;

class HostileTreeTest : public ::testing::Test {
 protected:
  HostileTreeTest() {
    static const std::string kFile = copc_file();
    file_ = kFile;
  }

  template <typename Number>
  void set(size_t offset, Number number) {
    laz::store(reinterpret_cast<std::byte*>(&file_[offset]), number);
  }
  [[nodiscard]] size_t root_page() const {
    return laz::load<uint64_t>(reinterpret_cast<const std::byte*>(&file_[kInfo + 40]));
  }
  [[nodiscard]] std::string error(const InPlaceLimits& limits = {}) const {
    const Result<model::ModelFile> model = open_in_place(TreeFormat::kCopc, source_of(file_), nullptr, limits, nullptr);
    if (model) return {};
    EXPECT_THAT(model.error().message, StartsWith("tree.copc.laz: "));
    return model.error().message;
  }
  /// The error of the first block that has one.
  [[nodiscard]] std::string error_of_blocks() const {
    const Result<model::ModelFile> model = open_in_place(TreeFormat::kCopc, source_of(file_), nullptr, {}, nullptr);
    EXPECT_TRUE(model) << model.error().message;
    for (size_t i = 0; model && i < model->blocks().size(); ++i) {
      if (const auto block = model->decode(i); !block) return block.error().message;
    }
    return {};
  }

  std::string file_;
};

TEST_F(HostileTreeTest, TheWholeFileIsSound) {
  EXPECT_EQ(error(), "");
}

TEST_F(HostileTreeTest, PagesThatAreNoneAreNamed) {
  const size_t link = root_page() + size_t{32} * 21;
  const std::string whole = file_;
  set(kInfo + 40, file_.size());
  EXPECT_THAT(error(), HasSubstr("beyond the end"));
  file_ = whole;
  set(link + 16, root_page());
  EXPECT_THAT(error(), HasSubstr("within itself"));
  file_ = whole;
  set(link + 24, int32_t{-5});
  EXPECT_THAT(error(), HasSubstr("damaged"));
  file_ = whole;
  EXPECT_THAT(error({.hierarchy_bytes = 1024}), HasSubstr("more than the 1024 bytes that are allowed"));
}

TEST_F(HostileTreeTest, NodesThatAreNoneAreNamed) {
  const std::string whole = file_;
  set(root_page() + 32, int32_t{40});
  EXPECT_THAT(error(), HasSubstr("damaged"));
  file_ = whole;
  set(root_page() + 32 + 4, int32_t{7});
  EXPECT_THAT(error(), HasSubstr("damaged"));
  file_ = whole;
  set(root_page() + 32, int32_t{0});
  set(root_page() + 32 + 4, int32_t{0});
  EXPECT_THAT(error(), HasSubstr("a node twice"));
  file_ = whole;
  set(root_page() + 32 + 16, uint64_t{file_.size()});
  EXPECT_NE(error(), "");
  file_ = whole;
  set(root_page() + 32 + 28, int32_t{2'000'000'000});
  EXPECT_NE(error(), "") << "more points than the bytes of the chunk can have";
}

TEST_F(HostileTreeTest, PointsOfAnotherNodeAreAnErrorThatNamesTheNode) {
  // The chunk of 1-0-0-0 is that of 1-1-1-0.
  const size_t first = root_page() + 32;
  const size_t last = root_page() + size_t{32} * 4;
  for (size_t i = 16; i < 28; ++i) file_[first + i] = file_[last + i];
  EXPECT_THAT(error_of_blocks(), HasSubstr("node 1-0-0-0: has points outside of its cell"));
}

TEST_F(HostileTreeTest, FilesThatAreNoTreeAreNamed) {
  std::string plain = file_;
  plain.replace(375 + 2, 4, "cops");
  file_ = plain;
  EXPECT_THAT(error(), HasSubstr("no COPC file"));
  file_ = "nothing";
  EXPECT_THAT(error(), HasSubstr("no COPC file"));
}

TEST_F(HostileTreeTest, AFileThatIsCutOffAnywhereIsAnError) {
  const std::string whole = file_;
  for (size_t bytes = 0; bytes < whole.size(); bytes += 997) {
    file_ = whole.substr(0, bytes);
    EXPECT_NE(error(), "") << bytes;
  }
}

}  // namespace
}  // namespace surfcast::point_tree
