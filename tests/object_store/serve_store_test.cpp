#include <cstdlib>

#include "cmd/serve_fixture.h"
#include "object_store/hills.h"
#include "object_store/range_server.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

using testing::Fault;
using testing::RangeServer;

constexpr const char* kList = "/bucket/?delimiter=%2F&list-type=2&prefix=";

/// Points on a side of a surface whose model is larger than what is read when it is opened.
constexpr int kHillsSide = 200;

/// The server itself, with models in a store.
class ServeStoreTest : public ServeTest {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    ServeTest::SetUp();
    model_ = build("square", testing::hills(kHillsSide));
    ASSERT_GT(model_.size(), size_t{64} << 10);
    store_.put("/bucket/square.surf", model_);
  }

  /// The bytes of the model of a scan.
  [[nodiscard]] std::string build(const std::string& name, const std::string& ply) const {
    const std::string scan = file(name + "_source.ply");
    const std::string model = file(name + ".surf");
    EXPECT_TRUE(write_file_atomically(scan, ply));
    EXPECT_EQ(client::run_program(path_of("surfcastd") + " build " + scan + " --output " + model + " 2>&1").code, 0);
    return content(model);
  }
  /// The picture that the server draws.
  [[nodiscard]] std::string drawn(const std::string& model) const {
    const client::ProgramOutcome outcome = draw(model);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    return content(file("drawn.png"));
  }
  /// What a list of S3 says of objects with these keys.
  static std::string list_of(const std::vector<std::string>& keys) {
    std::string xml = "<?xml version=\"1.0\"?><ListBucketResult><IsTruncated>false</IsTruncated>";
    for (const std::string& key : keys) xml += "<Contents><Key>" + key + "</Key></Contents>";
    return xml + "</ListBucketResult>";
  }

  RangeServer store_;
  std::string model_;
};

TEST_F(ServeStoreTest, AUrlIsServedLikeAFile) {
  serve(store_.url("/bucket/square.surf"));
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
  const std::string from_store = drawn("square");
  end(SIGTERM);
  serve(file("square.surf"));
  EXPECT_TRUE(from_store == drawn("square"));
}

TEST_F(ServeStoreTest, TheModelsOfABucketAreListedAndNewOnesAreSeen) {
  store_.put_page(kList, list_of({"square.surf", "notes.txt"}));
  serve(store_.url("/bucket/") + " --store-refresh 0.1");
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
  EXPECT_FALSE(drawn("square").empty());
  store_.put("/bucket/another.surf", model_);
  store_.put_page(kList, list_of({"square.surf", "another.surf"}));
  EXPECT_NE(list_until("another").find("another"), std::string::npos);
  EXPECT_FALSE(drawn("another").empty());
}

TEST_F(ServeStoreTest, AFileIsDrawnByAWorkerAndAtOnceWhileAStoreHangs) {
  ASSERT_FALSE(build("near", square_of_points()).empty());
  store_.put_page(kList, list_of({"square.surf"}));
  serve(file("near.surf") + " " + store_.url("/bucket/") +
        " --store-timeout 1000 --store-stall-timeout 1000 --no-shader-warm-up");
  store_.hold();
  std::vector<pid_t> waiting;
  for (int client = 0; client < 4; ++client) {
    waiting.push_back(
        client::start_program({path_of("surfcast"), "render", url_ + "/square", "--timeout", "290", "--resolution",
                               "64,48", "--output", file("far" + std::to_string(client) + ".png")}));
  }
  store_.wait_for_held(1);
  EXPECT_FALSE(drawn("near").empty());
  EXPECT_NE(get("/api/models/near").find("\"near\""), std::string::npos);
  EXPECT_NE(get("/metrics").find("surfcast_workers_started_total 1\n"), std::string::npos);
  EXPECT_NE(get("/metrics").find("surfcast_query_workers_started_total 1\n"), std::string::npos);
  for (const pid_t client : waiting) EXPECT_EQ(::waitpid(client, nullptr, WNOHANG), 0) << "it waits for the store";
  store_.release();
  for (const pid_t client : waiting) EXPECT_EQ(client::wait_for_program(client), 0);
  EXPECT_TRUE(content(file("far0.png")) == drawn("square"));
}

TEST_F(ServeStoreTest, AReplacedModelIsNoticedWhileAllItsBlocksAreResident) {
  serve(store_.url("/bucket/square.surf") + " --store-refresh 0.1");
  const std::string before = drawn("square");
  EXPECT_TRUE(drawn("square") == before);
  store_.put("/bucket/square.surf", build("flat", square_of_points()));
  std::string after = before;
  for (int i = 0; i < 1000 && after == before; ++i) after = drawn("square");
  end(SIGTERM);
  serve(file("flat.surf"));
  EXPECT_TRUE(after == drawn("flat"));
}

/// With the default times.
TEST_F(ServeStoreTest, WhateverIsWrongWithAStoreIsAnErrorWithinTenSecondsThatNamesNoUrl) {
  store_.put_page(kList, list_of({"square.surf"}));
  for (const size_t after : {0U, 2U}) {  // of the first request, or of blocks
    for (const Fault fault :
         {Fault::kAbsent, Fault::kForbidden, Fault::kReplaced, Fault::kNoSuchRange, Fault::kBusy, Fault::kCut,
          Fault::kHanging, Fault::kStalling, Fault::kWrongBytes, Fault::kRedirection}) {
      store_.fail(Fault::kNone, 0);
      serve(store_.url("/bucket/") + " --no-shader-warm-up");
      store_.fail(fault, 10'000, after);
      const auto begin = std::chrono::steady_clock::now();
      const client::ProgramOutcome outcome = draw("square");
      EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10)) << outcome.output;
      EXPECT_NE(outcome.code, 0) << static_cast<int>(fault);
      EXPECT_NE(outcome.output.find(": square: "), std::string::npos) << outcome.output;
      EXPECT_EQ(outcome.output.find("bucket"), std::string::npos) << outcome.output;
      end(SIGTERM);
    }
  }
}

TEST_F(ServeStoreTest, ClientsSeeTheNameOfAModelAndTheLogItsUrl) {
  serve(store_.url("/bucket/square.surf") + " --no-shader-warm-up");
  store_.fail(Fault::kForbidden, 10'000);
  const client::ProgramOutcome outcome = draw("square");
  EXPECT_NE(outcome.output.find(": square: block 0: the store answers 403"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("bucket"), std::string::npos) << outcome.output;
  EXPECT_NE(content(file("log")).find(store_.url("/bucket/square.surf") + ": the store answers 403"),
            std::string::npos);
}

TEST_F(ServeStoreTest, AFolderThatCannotBeListedIsOneLineAndTheEnd) {
  const client::ProgramOutcome outcome =
      client::run_program(path_of("surfcastd") + " serve --listen 127.0.0.1:0 " + store_.url("/none/") + " 2>&1");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.output.find("surfcastd: " + store_.url("/none/") + ": the store answers 404"), std::string::npos)
      << outcome.output;
}

TEST_F(ServeStoreTest, WhatIsInTheBlockCacheIsNotFetchedAgain) {
  const std::string flags = store_.url("/bucket/square.surf") + " --block-cache 10M";
  serve(flags);
  const std::string first = drawn("square");
  end(SIGTERM);
  store_.forget_requests();
  store_.fail(Fault::kForbidden, 1000, /*after=*/2);  // the model is opened, and no block can be fetched
  serve(flags);
  EXPECT_TRUE(drawn("square") == first);
  end(SIGTERM);
  std::filesystem::remove_all(cache() + "/blocks");
  store_.fail(Fault::kNone, 0);
  serve(flags);
  EXPECT_TRUE(drawn("square") == first);
}

}  // namespace
}  // namespace surfcast::cmd
