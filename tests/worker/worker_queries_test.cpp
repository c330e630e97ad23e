// Picks, profiles, channels and points of regions from other processes, and what happens when these end.

#include "worker/worker_queries.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/types.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "builder/build_model.h"
#include "kinds/ball_scene.h"
#include "model/test_folder.h"
#include "model/write_model.h"
#include "service/local_queries.h"
#include "support/clouds.h"
#include "support/path_of.h"
#include "worker/messages.h"
#include "worker/shared_board.h"

namespace surfcast::worker {
namespace {

using std::chrono::milliseconds;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ModelPointer = service::ModelQueries::ModelPointer;

const std::atomic<bool> kNever{false};

ModelPointer open(const std::filesystem::path& path) {
  Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*model));
}

/// The scene of balls from the front.
service::SurfaceQuery scene_view(int width = 24, int height = 24) {
  service::SurfaceQuery view;
  view.request.camera = geometry::Camera{{0.5, 2, 6}, {0, 0, 0}, {0, 1, 0}, 36};
  view.request.width = width;
  view.request.height = height;
  return view;
}

service::PixelQuery pixel_of(const service::SurfaceQuery& view, int x, int y) {
  return {view, x, y, 256};
}

/// A file of /proc that belongs to a process.
std::string text_of_process(pid_t process, const char* file) {
  std::ifstream stream("/proc/" + std::to_string(process) + "/" + file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The query workers that this process has started, the oldest one first.
std::vector<pid_t> workers() {
  const std::string parent = "\nPPid:\t" + std::to_string(::getpid()) + "\n";
  std::vector<pid_t> found;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    const std::string name = process.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = text_of_process(std::stoi(name), "status");
    if (status.starts_with("Name:\tball_query") && status.find(parent) != std::string::npos) {
      found.push_back(std::stoi(name));
    }
  }
  std::ranges::sort(found);
  return found;
}

/// Waits until a worker has stopped at its block.
pid_t stopped_worker() {
  for (;;) {
    for (const pid_t worker : workers()) {
      if (text_of_process(worker, "status").find("\nState:\tT") != std::string::npos) return worker;
    }
    std::this_thread::sleep_for(milliseconds(1));
  }
}

/// The memory that this process shares with its workers.
std::vector<SharedBoard> boards() {
  std::vector<SharedBoard> found;
  for (const auto& link : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code code;
    if (!std::filesystem::read_symlink(link, code).string().starts_with("/memfd:surfcast-pictures")) continue;
    auto board = SharedBoard::adopt(Descriptor(::open(link.path().c_str(), O_RDWR | O_CLOEXEC)));
    if (board) found.push_back(std::move(*board));
  }
  return found;
}

/// Waits until a worker can see that its question is not wanted any more.
void wait_for_cancellation() {
  const std::vector<SharedBoard> shared = boards();
  ASSERT_FALSE(shared.empty());
  while (std::ranges::none_of(shared, [](const SharedBoard& board) { return board.cancelled(0).load(); })) {
    std::this_thread::sleep_for(milliseconds(1));
  }
}

class WorkerQueriesTest : public ::testing::Test {
 protected:
  void TearDown() override {
    for (const char* variable :
         {"SURFCAST_WORKER_CRASHING_BLOCK", "SURFCAST_WORKER_STOPPING_BLOCK", "SURFCAST_WORKER_LYING"})
      ::unsetenv(variable);
  }

  void start(const std::function<void(QueryWorkerConfig&)>& change = [](QueryWorkerConfig&) {}) {
    QueryWorkerConfig config;
    config.command = {path_of("ball_query_worker")};
    change(config);
    auto queries = worker_queries(config, counts_);
    ASSERT_TRUE(queries) << queries.error().message;
    queries_ = std::move(*queries);
  }
  /// Starts the worker of searches on this thread: it ends with the thread that has started it.
  void start_searches() { EXPECT_TRUE(queries_->band(scene_, {{{-1, 0, 0}, {1, 0, 0}}, 1, 9}, kNever)); }
  void set_block(const char* variable, uint32_t block) { ::setenv(variable, std::to_string(block).c_str(), 1); }

  /// The last block of the scene of balls, a leaf, and pixels in which its balls show and do not show.
  [[nodiscard]] uint32_t ball_leaf() const { return static_cast<uint32_t>(scene_->blocks().size() - 1); }
  static service::PixelQuery ball_pixel() { return pixel_of(scene_view(), 14, 15); }
  static service::PixelQuery square_pixel() { return pixel_of(scene_view(), 5, 14); }

  Result<std::optional<kinds::PickedSurfel>> pick(const service::PixelQuery& query) {
    return queries_->pick(scene_, query, kNever);
  }
  /// Expects what this process finds in some pixels, and that it finds something in some of them.
  void expect_equal_picks(const ModelPointer& model, const service::SurfaceQuery& view) {
    size_t found = 0;
    for (int y = 0; y < view.request.height; y += 2) {
      for (int x = 0; x < view.request.width; x += 2) {
        const auto here = here_->pick(model, pixel_of(view, x, y), kNever);
        const auto there = queries_->pick(model, pixel_of(view, x, y), kNever);
        ASSERT_TRUE(here && there) << (there ? "" : there.error().message);
        ASSERT_EQ(encode(Picked{*there}), encode(Picked{*here})) << x << ' ' << y;
        if (*here) ++found;
      }
    }
    EXPECT_GT(found, 4U);
    const auto front = queries_->front_surface(model, view, kNever);
    ASSERT_TRUE(front) << front.error().message;
    expect_equal_pixels(*front, *here_->front_surface(model, view, kNever));
  }
  static void expect_equal_pixels(const std::vector<pick::FrontPixel>& a, const std::vector<pick::FrontPixel>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
      ASSERT_TRUE(a[i].depth == b[i].depth && a[i].number == b[i].number && a[i].normal == b[i].normal &&
                  a[i].code == b[i].code)
          << i;
    }
  }
  ModelPointer build(const std::filesystem::path& input) {
    const auto built = builder::build_model({{input}}, folder_ / "built.surf", {}, [](const builder::BuildStep&) {});
    EXPECT_TRUE(built) << (built ? "" : built.error().message);
    return open(folder_ / "built.surf");
  }
  /// `side` x `side` points on a lattice, each with its number as an attribute.
  ModelPointer survey(int side) {
    surfel::SurfelCloud cloud = testing::square(side, 120, {0, 0, 0}, {0, 0, 1}, {10, 20, 30});
    std::vector<uint32_t> numbers;
    for (size_t i = 0; i < cloud.size(); ++i) numbers.push_back(static_cast<uint32_t>(i));
    cloud.scalars = {{"number", numbers}};
    EXPECT_TRUE(model::write_model(cloud, folder_ / "survey.surf", {}));
    return open(folder_ / "survey.surf");
  }

  model::TestFolder folder_;
  ModelPointer scene_ = open(testing::write_scene(folder_ / "scene.surf"));
  WorkerCounts counts_;
  std::unique_ptr<service::ModelQueries> here_ = service::local_queries(size_t{64} << 20, testing::kinds_with_balls());
  std::unique_ptr<service::ModelQueries> queries_;
};

TEST_F(WorkerQueriesTest, PicksAndSurfacesOfSurfelsAreThoseOfThisProcess) {
  start();
  expect_equal_picks(scene_, scene_view());
  EXPECT_EQ(counts_.started, 2U) << "one for picks, which are never at the same time, and one for searches";
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, PicksInJoinedModelsAreThoseOfThisProcess) {
  Result<model::ModelFile> joined = model::ModelFile::join({{"survey", survey(40)}, {"scene", scene_}});
  ASSERT_TRUE(joined);
  const auto both = std::make_shared<const model::ModelFile>(std::move(*joined));
  start();
  expect_equal_picks(both, scene_view());
  service::SurfaceQuery without = scene_view();
  without.request.hidden_models = {"survey"};
  expect_equal_picks(both, without);
  const auto picked = queries_->pick(both, pixel_of(without, 14, 15), kNever);
  ASSERT_TRUE(picked && *picked);
  EXPECT_EQ((*picked)->member, 1U);
  const auto band = queries_->band(both, {{{-1, 0, 0}, {1, 0, 0}}, 1, 99}, kNever);
  ASSERT_TRUE(band) << band.error().message;
  EXPECT_EQ(band->total, here_->band(both, {{{-1, 0, 0}, {1, 0, 0}}, 1, 99}, kNever)->total);
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, PicksInVolumesAreThoseOfThisProcess) {
  std::ofstream file(folder_ / "cone.nrrd", std::ios::binary);
  file << "NRRD0004\ntype: float\ndimension: 3\nsizes: 32 32 32\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n";
  for (int n = 0; n < 32 * 32 * 32; ++n) {
    const auto value = static_cast<float>(16 - std::hypot(n % 32 - 15.5, n / 32 % 32 - 15.5, n / 1024 - 15.5));
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
  file.close();
  start();
  service::SurfaceQuery view = scene_view(20, 20);
  view.request.camera = geometry::Camera{{15.5, 15.5, -40}, glm::dvec3(15.5), {0, 1, 0}, 30};
  view.request.volumes.transfer.points = {{-100, glm::dvec3(1), 0}, {100, glm::dvec3(1), 0}};
  view.request.volumes.isos = {{5}};
  here_ = service::local_queries(size_t{64} << 20);
  expect_equal_picks(build(folder_ / "cone.nrrd"), view);
}

TEST_F(WorkerQueriesTest, PicksOfEllipsoidsAreThoseOfThisProcess) {
  std::ofstream(folder_ / "t.csv") << "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue,score\n"
                                      "0,0,0,2,1,0.5,1,0,0,0,255,128,0,7\n"
                                      "0,0,3,0.25,0.125,0.0625,0,1,0,0,0,0,255,8\n";
  start();
  service::SurfaceQuery view = scene_view(20, 20);
  view.request.camera = geometry::Camera{{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 30};
  here_ = service::local_queries(size_t{64} << 20);
  expect_equal_picks(build(folder_ / "t.csv"), view);
}

TEST_F(WorkerQueriesTest, SurfacesOfManyRegionsAreThoseOfThisProcess) {
  start();
  const service::SurfaceQuery view = scene_view(1100, 40);
  const auto there = queries_->front_surface(scene_, view, kNever);
  const auto here = here_->front_surface(scene_, view, kNever);
  ASSERT_TRUE(there && here) << (there ? "" : there.error().message);
  expect_equal_pixels(*there, *here);
}

TEST_F(WorkerQueriesTest, BandsOfManyPartsAreThoseOfThisProcess) {
  const ModelPointer model = survey(500);
  start();
  for (const pick::BandQuery& query :
       {pick::BandQuery{{{-50, 0, 0}, {50, 1, 0}}, 200, 1'000'000}, pick::BandQuery{{{-50, 0, 0}, {50, 1, 0}}, 4, 999},
        pick::BandQuery{{{-500, 900, 0}, {500, 900, 0}}, 4, 999}}) {
    const auto there = queries_->band(model, query, kNever);
    const auto here = here_->band(model, query, kNever);
    ASSERT_TRUE(there && here) << (there ? "" : there.error().message);
    const auto bytes_of = [](const pick::Band& band) {
      return encode(BandPart{band.total, band.length, band.grid, band.points, band.values, true});
    };
    EXPECT_EQ(bytes_of(*there), bytes_of(*here));
  }
}

/// All bytes of a stream, and the number of its points.
std::pair<std::vector<std::byte>, uint64_t> all_of(service::PointStream& stream, size_t piece_bytes) {
  for (Result<bool> whole = false; !*whole;) {
    whole = stream.count();
    EXPECT_TRUE(whole) << (whole ? "" : whole.error().message);
    if (!whole) return {};
  }
  std::vector<std::byte> bytes;
  for (bool last = false; !last;) {
    const Result<service::PointPiece> piece = stream.next(piece_bytes);
    EXPECT_TRUE(piece) << (piece ? "" : piece.error().message);
    if (!piece) return {};
    bytes.insert(bytes.end(), piece->bytes.begin(), piece->bytes.end());
    last = piece->last;
  }
  return {bytes, stream.facts().count};
}

TEST_F(WorkerQueriesTest, PointsOfRegionsAreThoseOfThisProcess) {
  const ModelPointer model = survey(300);
  start();
  const auto cancelled = std::make_shared<const std::atomic<bool>>(false);
  for (const exporter::PointFormat format : {exporter::PointFormat::kCsv, exporter::PointFormat::kLaz}) {
    service::PointsQuery query{"survey", {}, format, 1'000'000, false};
    query.selection.points.zone.boxes.push_back({{-40, -60, -1}, {40, 60, 1}});
    auto there = queries_->points(model, query, cancelled);
    auto here = here_->points(model, query, cancelled);
    ASSERT_TRUE(there && here) << (there ? "" : there.error().message);
    const auto [bytes, count] = all_of(**there, 65536);
    EXPECT_GT(count, 10'000U);
    EXPECT_EQ(std::pair(bytes, count), all_of(**here, 1 << 20));
  }
}

TEST_F(WorkerQueriesTest, PointsOfAWorkerThatEndsAreAnErrorAndOthersAreFoundAgain) {
  const ModelPointer model = survey(300);
  start();
  const auto cancelled = std::make_shared<const std::atomic<bool>>(false);
  const service::PointsQuery query{"survey", {}, exporter::PointFormat::kCsv, 1'000'000, false};
  auto lost = queries_->points(model, query, cancelled);
  ASSERT_TRUE(lost);
  for (const pid_t worker : workers()) ::kill(worker, SIGKILL);
  const auto counted = (*lost)->count();
  ASSERT_FALSE(counted);
  EXPECT_EQ(counted.error().kind, ErrorKind::kUnavailable);
  auto again = queries_->points(model, query, cancelled);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(all_of(**again, 65536).second, 90'000U);
  EXPECT_FALSE((*lost)->count()) << "another worker does not know them";
}

TEST_F(WorkerQueriesTest, ErrorsArriveAsTheyAre) {
  start();
  service::PixelQuery query = ball_pixel();
  query.picture.request.camera->view_angle = 400;
  const auto picked = pick(query);
  ASSERT_FALSE(picked);
  EXPECT_EQ(picked.error().kind, here_->pick(scene_, query, kNever).error().kind);
  EXPECT_EQ(picked.error().message, here_->pick(scene_, query, kNever).error().message);
  query = ball_pixel();
  query.most_blocks = 0;
  EXPECT_EQ(pick(query).error().kind, ErrorKind::kLimit);
  EXPECT_TRUE(pick(ball_pixel()));
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, KilledWorkersAreReplaced) {
  start();
  const auto expected = pick(ball_pixel());
  ASSERT_TRUE(expected && *expected);
  for (uint64_t kills = 1; kills <= 3; ++kills) {
    for (const pid_t worker : workers()) ::kill(worker, SIGKILL);
    const auto again = pick(ball_pixel());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(encode(Picked{*again}), encode(Picked{*expected}));
    EXPECT_EQ(counts_.ended, kills);
  }
  EXPECT_EQ(counts_.quarantined, 0U);
}

TEST_F(WorkerQueriesTest, AQuestionOutlivesTheWorkerThatIsKilledInItsMiddle) {
  set_block("SURFCAST_WORKER_STOPPING_BLOCK", ball_leaf());
  start();
  ::unsetenv("SURFCAST_WORKER_STOPPING_BLOCK");  // of the next one
  auto picked = std::async(std::launch::async, [&] { return pick(ball_pixel()); });
  ::kill(stopped_worker(), SIGKILL);
  const auto answer = picked.get();
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(encode(Picked{*answer}), encode(Picked{*here_->pick(scene_, ball_pixel(), kNever)}));
  EXPECT_EQ(counts_.ended, 1U);
}

// This process does not crash with the block: it decodes none.
TEST_F(WorkerQueriesTest, ABlockThatEndsTwoWorkersIsQuarantinedByName) {
  set_block("SURFCAST_WORKER_CRASHING_BLOCK", ball_leaf());
  start();
  const std::string expected = "scene.surf: block " + std::to_string(ball_leaf()) +
                               ": not loaded any more, because it has ended two query workers";
  const auto picked = pick(ball_pixel());
  ASSERT_FALSE(picked);
  EXPECT_THAT(picked.error().message, HasSubstr(expected));
  EXPECT_EQ(counts_.ended, 2U);
  EXPECT_EQ(counts_.quarantined, 1U);
  EXPECT_THAT(pick(ball_pixel()).error().message, HasSubstr(expected));
  EXPECT_TRUE(pick(square_pixel())) << "other blocks are read";
  // The worker of searches has not read it yet, and knows the verdict.
  EXPECT_THAT(queries_->front_surface(scene_, scene_view(), kNever).error().message, HasSubstr(expected));
  EXPECT_EQ(counts_.ended, 2U);
}

TEST_F(WorkerQueriesTest, AHungWorkerIsReplacedAndItsBlockQuarantined) {
  set_block("SURFCAST_WORKER_STOPPING_BLOCK", ball_leaf());
  start([](QueryWorkerConfig& config) { config.silence = milliseconds(2000); });
  const auto picked = pick(ball_pixel());
  ASSERT_FALSE(picked);
  EXPECT_THAT(picked.error().message, HasSubstr("not loaded any more"));
  EXPECT_EQ(counts_.ended, 2U);
  EXPECT_TRUE(pick(square_pixel()));
}

TEST_F(WorkerQueriesTest, APickDoesNotWaitForASearchOrForAnotherPick) {
  set_block("SURFCAST_WORKER_STOPPING_BLOCK", ball_leaf());
  start();
  start_searches();
  auto front = std::async(std::launch::async, [&] { return queries_->front_surface(scene_, scene_view(), kNever); });
  const pid_t searching = stopped_worker();
  EXPECT_TRUE(pick(square_pixel()));
  ::kill(searching, SIGCONT);
  EXPECT_TRUE(front.get());
  auto slow = std::async(std::launch::async, [&] { return pick(ball_pixel()); });
  const pid_t picking = stopped_worker();
  EXPECT_TRUE(pick(square_pixel()));
  ::kill(picking, SIGCONT);
  EXPECT_TRUE(slow.get());
  EXPECT_EQ(counts_.started, 3U);
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, CancelledSearchesEnd) {
  set_block("SURFCAST_WORKER_STOPPING_BLOCK", ball_leaf());
  start();
  start_searches();
  std::atomic<bool> cancelled{false};
  auto front = std::async(std::launch::async, [&] {
    return queries_->front_surface(scene_, scene_view(1100, 1100), cancelled);  // of four regions
  });
  const pid_t searching = stopped_worker();
  cancelled = true;
  wait_for_cancellation();
  ::kill(searching, SIGCONT);
  const auto found = front.get();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(queries_->front_surface(scene_, scene_view(), kNever));
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, WorkersThatAnswerNonsenseAreReplacedAndThenAnError) {
  ::setenv("SURFCAST_WORKER_LYING", "1", 1);
  start();
  const std::array<std::function<ErrorKind()>, 4> questions{
      [&] { return pick(ball_pixel()).error().kind; },
      [&] { return queries_->front_surface(scene_, scene_view(), kNever).error().kind; },
      [&] {
        return queries_->band(scene_, {{{-1, 0, 0}, {1, 0, 0}}, 1, 9}, kNever).error().kind;
      },
      [&] {
        const auto cancelled = std::make_shared<const std::atomic<bool>>(false);
        return queries_->points(scene_, {}, cancelled).error().kind;
      }};
  uint64_t ended = 0;
  for (const auto& ask : questions) {
    EXPECT_EQ(ask(), ErrorKind::kUnavailable);
    EXPECT_EQ(counts_.ended, ended += 2);
  }
}

TEST_F(WorkerQueriesTest, WorkersDoNotInheritSecrets) {
  ::setenv("AWS_SECRET_ACCESS_KEY", "kept to the server", 1);
  start([](QueryWorkerConfig& config) { config.sandbox = false; });  // a confined process hides its environment
  ASSERT_THAT(workers(), SizeIs(1));
  const std::string environment = text_of_process(workers().front(), "environ");
  EXPECT_THAT(environment, HasSubstr("PATH="));
  EXPECT_THAT(environment, Not(HasSubstr("AWS_SECRET_ACCESS_KEY")));
  ::unsetenv("AWS_SECRET_ACCESS_KEY");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(WorkerQueriesTest, WorkersAllocateNoMoreThanTheirShare) {
  constexpr uint64_t kBytes = uint64_t{600} << 20;
  start([](QueryWorkerConfig& config) { config.memory = kBytes; });
  ASSERT_THAT(workers(), SizeIs(1));
  const std::string limits = text_of_process(workers().front(), "limits");
  EXPECT_THAT(limits, ContainsRegex("Max data size +" + std::to_string(kBytes) + " +" + std::to_string(kBytes)));
  EXPECT_TRUE(pick(ball_pixel()));
}
#endif

TEST_F(WorkerQueriesTest, AProgramThatIsNoWorkerDoesNotStart) {
  QueryWorkerConfig config;
  config.command = {"/bin/true"};
  const auto queries = worker_queries(config, counts_);
  ASSERT_FALSE(queries);
  EXPECT_THAT(queries.error().message, HasSubstr("the query worker did not start"));
}

/// The files that a process has open, as far as they are of this folder.
std::vector<std::string> open_files(pid_t process, const std::filesystem::path& folder) {
  std::vector<std::string> files;
  for (const auto& link : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd")) {
    std::error_code code;
    const std::filesystem::path file = std::filesystem::read_symlink(link, code);
    if (file.parent_path() == folder) files.push_back(file.filename());
  }
  return files;
}

TEST_F(WorkerQueriesTest, ModelsThatTheServerHasClosedAreClosedWithoutAQuestion) {
  start([](QueryWorkerConfig& config) {
    config.sandbox = false;  // which hides the list of open files
    config.pause = milliseconds(1);
  });
  const std::filesystem::path folder = scene_->path().parent_path();
  ASSERT_TRUE(pick(square_pixel()));
  ASSERT_THAT(workers(), SizeIs(1));
  EXPECT_THAT(open_files(workers()[0], folder), ElementsAre("scene.surf"));
  scene_.reset();
  while (!open_files(workers()[0], folder).empty()) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerQueriesTest, AWorkerIsConfinedUnlessItIsNotToBe) {
  if (text_of_process(::getpid(), "status").find("\nSeccomp:\t") == std::string::npos)
    GTEST_SKIP() << "the kernel has no filters";
  start();
  EXPECT_THAT(text_of_process(workers().at(0), "status"), HasSubstr("\nSeccomp:\t2\n"));
  EXPECT_THAT(text_of_process(workers().at(0), "status"), HasSubstr("\nNoNewPrivs:\t1\n"));
  start([](QueryWorkerConfig& config) { config.sandbox = false; });
  const std::string own = text_of_process(::getpid(), "status");
  EXPECT_THAT(text_of_process(workers().at(0), "status"), HasSubstr(own.substr(own.find("\nNoNewPrivs:"), 14)));
}

TEST_F(WorkerQueriesTest, AnIdleWorkerThatIsKilledIsReplacedWithoutAQuestion) {
  start([](QueryWorkerConfig& config) { config.pause = milliseconds(1); });
  ::kill(workers().at(0), SIGKILL);
  while (counts_.started < 2) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(counts_.ended, 1U);
  EXPECT_TRUE(pick(ball_pixel()));
}

}  // namespace
}  // namespace surfcast::worker
