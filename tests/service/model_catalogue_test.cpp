#include "service/model_catalogue.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "model/write_model.h"

namespace surfcast::service {
namespace {

namespace fs = std::filesystem;

class ModelCatalogueTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("catalogue_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "other");
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A model of `count` surfels in a row.
  fs::path write(const fs::path& name, size_t count) const {
    surfel::SurfelCloud cloud;
    for (size_t i = 0; i < count; ++i) {
      cloud.positions.push_back({static_cast<double>(i), 0, 0});
      cloud.normals.push_back({0, 0, 1});
      cloud.radii.push_back(1);
      cloud.weights.push_back(1);
    }
    cloud.sources = {{"row", 0, count, std::nullopt}};
    cloud.z_up = false;
    EXPECT_TRUE(model::write_model(cloud, folder_ / name, {}));
    return folder_ / name;
  }

  fs::path folder_;
};

TEST_F(ModelCatalogueTest, ModelsOfStoresAreRemoteUnlessAFileHasTheirName) {
  write("a.surf", 3);
  ModelCatalogue catalogue({{"c", "https://host/c.surf"}, {"d", write("other/d.surf", 3)}}, {folder_});
  catalogue.set_stored({{"a", "https://host/a.surf"}, {"b", "https://host/b.surf"}, {"d", "https://host/d.surf"}});
  EXPECT_EQ(catalogue.names().size(), 4U);
  EXPECT_FALSE(catalogue.remote("a"));
  EXPECT_TRUE(catalogue.remote("b"));
  EXPECT_TRUE(catalogue.remote("c"));
  EXPECT_FALSE(catalogue.remote("d"));
  EXPECT_FALSE(catalogue.remote("none"));
}

TEST_F(ModelCatalogueTest, FoldersAreLookedAtAnew) {
  const ModelCatalogue catalogue({}, {folder_});
  EXPECT_TRUE(catalogue.names().empty());
  write("b.surf", 3);
  write("a.surf", 3);
  EXPECT_EQ(catalogue.names(), (std::vector<std::string>{"a", "b"}));
  fs::remove(folder_ / "a.surf");
  EXPECT_EQ(catalogue.names(), std::vector<std::string>{"b"});
}

TEST_F(ModelCatalogueTest, OnlyModelFilesOfAFolderAreModels) {
  write("a.surf", 3);
  fs::create_directories(folder_ / "folder.surf");
  ASSERT_TRUE(write_file_atomically(folder_ / "notes.txt", "text"));
  ASSERT_TRUE(write_file_atomically(folder_ / "b.surf.tmpAbCdEf", "half"));
  EXPECT_EQ(ModelCatalogue({}, {folder_}).names(), std::vector<std::string>{"a"});
}

TEST_F(ModelCatalogueTest, ASingleFileHidesOneInAFolderAndAnEarlierFolderALaterOne) {
  write("a.surf", 2);
  write("other/a.surf", 3);
  write("other/b.surf", 4);
  const fs::path single = write("single.surf", 5);
  const ModelCatalogue catalogue({{"b", single}}, {folder_, folder_ / "other"});
  EXPECT_EQ(catalogue.describe("a")->info.surfels, 2u);
  EXPECT_EQ(catalogue.describe("b")->info.surfels, 5u);
}

TEST_F(ModelCatalogueTest, AModelIsDescribed) {
  write("a.surf", 7);
  const auto description = ModelCatalogue({}, {folder_}).describe("a");
  ASSERT_TRUE(description);
  EXPECT_EQ(description->info.surfels, 7u);
  EXPECT_FALSE(description->info.z_up);
  EXPECT_EQ(description->levels, 1u);
  EXPECT_EQ(description->blocks, 1u);
}

TEST_F(ModelCatalogueTest, AFileIsOpenedOnceAndAgainWhenItIsReplaced) {
  const fs::path path = write("a.surf", 3);
  const ModelCatalogue catalogue({}, {folder_});
  const auto first = catalogue.open("a");
  ASSERT_TRUE(first);
  EXPECT_EQ(*catalogue.open("a"), *first);
  write("a.surf", 4);
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(5));
  const auto second = catalogue.open("a");
  ASSERT_TRUE(second);
  EXPECT_NE(*second, *first);
  EXPECT_EQ((*second)->info().surfels, 4u);
  EXPECT_EQ((*first)->info().surfels, 3u);  // the old model remains usable while it is held
}

TEST_F(ModelCatalogueTest, NamesThatAreNoneAreNotFoundAndNeverLeaveTheFolder) {
  write("a.surf", 3);
  const ModelCatalogue catalogue({}, {folder_ / "other"});
  for (const std::string name : {"", "a", "../a", "..", ".", "/etc/passwd", "other/../a"}) {
    const auto model = catalogue.open(name);
    ASSERT_FALSE(model) << name;
    EXPECT_EQ(model.error().kind, ErrorKind::kNotFound) << name;
  }
}

TEST_F(ModelCatalogueTest, ABrokenFileIsAnErrorThatNamesItEachTime) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a.surf", "not a model"));
  const ModelCatalogue catalogue({}, {folder_});
  for (int i = 0; i < 2; ++i) {
    const auto model = catalogue.open("a");
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find("a.surf"), std::string::npos);
  }
}

TEST_F(ModelCatalogueTest, AFolderThatVanishesHoldsNothing) {
  const ModelCatalogue catalogue({}, {folder_ / "absent"});
  EXPECT_TRUE(catalogue.names().empty());
}

TEST_F(ModelCatalogueTest, AFolderThatHasNotChangedIsNotReadAgain) {
  write("a.surf", 3);
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(folder_, long_ago);
  const ModelCatalogue catalogue({}, {folder_});
  EXPECT_EQ(catalogue.names(), std::vector<std::string>{"a"});
  write("b.surf", 3);
  fs::last_write_time(folder_, long_ago);  // as if nothing had happened
  EXPECT_EQ(catalogue.names(), std::vector<std::string>{"a"});
  write("c.surf", 3);
  EXPECT_EQ(catalogue.names(), (std::vector<std::string>{"a", "b", "c"}));
}

TEST_F(ModelCatalogueTest, AFileThatIsRemovedIsClosed) {
  write("a.surf", 3);
  const ModelCatalogue catalogue({}, {folder_});
  std::weak_ptr<const model::ModelFile> model = *catalogue.open("a");
  catalogue.close_removed();
  EXPECT_FALSE(model.expired());
  fs::remove(folder_ / "a.surf");
  catalogue.close_removed();
  EXPECT_TRUE(model.expired());
}

}  // namespace
}  // namespace surfcast::service
