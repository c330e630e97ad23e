#include "service/model_catalogue.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "access/authorization.h"
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

TEST_F(ModelCatalogueTest, AFileThatViewsShowHasAnotherEditionWhenItIsReplaced) {
  const fs::path path = write("a.surf", 3);
  write("b.surf", 3);
  ModelCatalogue catalogue({}, {folder_});
  int changes = 0;
  catalogue.on_change([&](bool published) { changes += published ? 1 : 0; });
  const uint64_t first = catalogue.edition("a");
  const uint64_t beside = catalogue.edition("b");
  const uint64_t joined = catalogue.edition("a+b");
  EXPECT_GT(first, 0U);
  catalogue.look_for_replaced();
  EXPECT_EQ(changes, 0);
  EXPECT_EQ(catalogue.edition("a"), first);

  fs::last_write_time(path, fs::last_write_time(path) - std::chrono::hours(1));  // an older file takes its place
  catalogue.look_for_replaced();
  EXPECT_EQ(changes, 1);
  EXPECT_GT(catalogue.edition("a"), first);
  EXPECT_EQ(catalogue.edition("b"), beside);
  EXPECT_GT(catalogue.edition("a+b"), joined);

  const uint64_t second = catalogue.edition("a");
  fs::remove(path);  // as between a removal and the next file
  catalogue.look_for_replaced();
  EXPECT_EQ(changes, 1);
  EXPECT_EQ(catalogue.edition("a"), second);
  EXPECT_EQ(catalogue.edition("none"), 0U);
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

TEST_F(ModelCatalogueTest, ANameWithPlusSignsJoinsModels) {
  write("a.surf", 3);
  write("b.surf", 4);
  const ModelCatalogue catalogue({}, {folder_});
  const auto joined = catalogue.open("a+b");
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_EQ((*joined)->info().surfels, 7U);
  EXPECT_EQ(*catalogue.open("a+b"), *joined) << "the same model as long as its members are";
  EXPECT_TRUE(catalogue.has("a+b"));
  EXPECT_FALSE(catalogue.has("a+c"));
  const auto description = catalogue.describe("b+a");
  ASSERT_TRUE(description);
  ASSERT_EQ(description->members.size(), 2U);
  EXPECT_EQ(description->members[0].name, "b");
  EXPECT_EQ(description->members[1].kinds.at(0).items, 3U);
  EXPECT_EQ(catalogue.names(), (std::vector<std::string>{"a", "b"})) << "joins are not listed";

  const auto absent = catalogue.open("a+c");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(absent.error().message, "there is no model 'c'");
}

TEST_F(ModelCatalogueTest, AModelOfExactlyThatNameIsNoJoin) {
  write("a.surf", 3);
  write("b.surf", 4);
  write("a+b.surf", 100);
  const ModelCatalogue catalogue({}, {folder_});
  EXPECT_EQ(catalogue.describe("a+b")->info.surfels, 100U);
  EXPECT_EQ(catalogue.describe("b+a")->info.surfels, 7U);
  const auto some = [](const std::vector<std::string>& patterns) {
    return access::Rights::of(std::make_shared<const access::Principal>(access::Principal{
                                  .name = "some", .sha256 = std::string(64, 'a'), .models = patterns}))
        .authorize("a+b")
        .served_name();
  };
  EXPECT_EQ(catalogue.describe(some({"a+b"}))->info.surfels, 100U);
  EXPECT_EQ(catalogue.describe(some({"a", "b"}))->info.surfels, 7U) << "they know of no model of that name";
  const auto hidden = catalogue.describe(some({"a"}));
  ASSERT_FALSE(hidden);
  EXPECT_EQ(hidden.error().message, "there is no model 'a+b'");
  fs::remove(folder_ / "a+b.surf");
  EXPECT_FALSE(catalogue.describe(some({"a+*"}))) << "the join needs rights to each of its members";
}

TEST_F(ModelCatalogueTest, AJoinIsMadeAnewWhenAMemberIsReplaced) {
  write("a.surf", 3);
  const fs::path path = write("b.surf", 4);
  const ModelCatalogue catalogue({}, {folder_});
  const auto first = catalogue.open("a+b");
  ASSERT_TRUE(first);
  write("b.surf", 5);
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(5));
  const auto second = catalogue.open("a+b");
  ASSERT_TRUE(second);
  EXPECT_EQ((*second)->info().surfels, 8U);
  EXPECT_EQ((*first)->info().surfels, 7U);
}

TEST_F(ModelCatalogueTest, AJoinWaitsForItsScans) {
  write("a.surf", 3);
  ModelCatalogue catalogue({}, {folder_});
  ASSERT_TRUE(catalogue.add_scan("scan"));
  EXPECT_TRUE(catalogue.awaited("a+scan"));
  EXPECT_EQ(catalogue.open("a+scan").error().kind, ErrorKind::kUnavailable);
  const auto built = std::make_shared<const model::ModelFile>(*model::ModelFile::open(write("other/scan.surf", 4)));
  const uint64_t before = catalogue.edition("a+scan");
  catalogue.publish("scan", {built, true});
  EXPECT_FALSE(catalogue.awaited("a+scan"));
  EXPECT_EQ(catalogue.edition("a+scan"), before + 1);
  const auto preview = catalogue.open_edition("a+scan", 0);
  ASSERT_TRUE(preview);
  EXPECT_TRUE(preview->preview);
  EXPECT_EQ(preview->model->info().surfels, 7U);
}

TEST_F(ModelCatalogueTest, AJoinHasAtMost64Members) {
  write("a.surf", 3);
  std::string name = "a";
  for (int i = 0; i < 64; ++i) name += "+a";
  const auto joined = ModelCatalogue({}, {folder_}).open(name);
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().kind, ErrorKind::kLimit);
}

}  // namespace
}  // namespace surfcast::service
