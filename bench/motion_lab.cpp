// motion_lab PORT MODEL... [near] [fps=N] [link=MBIT,MS] [steps] [drop] [rest] [scales]: plays camera paths over
// emulated links to a server on this machine that serves these models, and compares what a client shows at each instant
// with the picture of its camera at that instant: as clients without depth show it (the newest frame), warped by depth,
// and warped from a video. `near`: from a quarter of the distance. `fps`: frames a second that the clients with depth
// ask for. `link`: this one alone.
//
// For each path and link a row of a Markdown table: frames a second, kilobytes a second, their width in pixels; then
// over instants 50 ms apart, PSNR in dB over covered pixels (mean, and the value that one in ten is below) and the
// share of pixels that are more than 20 levels off. Instants at which the model covers less than a fiftieth of the
// picture do not count.
//
// `steps`: instead, how much a picture on a display of 60 Hz changes from one to the next that its camera does not
// explain: the difference of two pictures less that of the true ones, root mean square over covered pixels, in levels
// (mean over all steps, and the value that one in twenty is above), beside PSNR. For frames that replace each other at
// once, and blended over the time between two of them.
//
// `drop`: instead, the link of the clients with depth has its rate for 4 s, a tenth of it for 4 s, and its rate again.
// For each half second: frames, kilobytes and width; and the longest time without a frame.
//
// `rest`: instead, a movement ends after a second. PSNR of what is shown at instants after that, by a client that shows
// whole frames only, and by one that shows early ones too (client::View::Frame::whole).
//
// `scales`: instead, PSNR of clients that warp with fewer pixels, coarser depths, and the newest frame alone.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <glm/common.hpp>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench_support.h"
#include "camera_paths.h"
#include "client/window/video_decoder.h"
#include "motion_player.h"
#include "service/first_look.h"
#include "support/link_relay.h"
#include "warp/warp.h"
#include "warp_error.h"

namespace {

using namespace surfcast;
using bench::Arrived;
using bench::decoded;
using bench::kHeight;
using bench::kWidth;
using bench::Path;
using bench::play;
using bench::value_or_exit;
using geometry::Camera;

constexpr double kSeconds = 2.5;  // of a movement
constexpr double kEvery = 0.05;   // between two instants that are judged
constexpr double kDropEvery = 4;
constexpr double kDropPart = 0.1;
constexpr double kDecode = 0.005;  // from the arrival of a frame until it can be shown

struct Link {
  double megabits = 0;  ///< a second
  int round_trip = 0;   ///< ms
};

/// Pictures of the instants of a path.
using Truth = std::vector<picture::Image>;

struct Judged {
  double rate = 0;       ///< frames a second
  double kilobytes = 0;  ///< a second
  double width = 0;      ///< of a frame, pixels
  double packets = 0;    ///< of a video: their share
  std::vector<bench::Figures> figures;
};

/// Whether the model covers enough of a picture.
bool counts(const picture::Image& image) {
  size_t covered = 0;
  for (size_t i = 3; i < image.pixels.size(); i += 4) covered += image.pixels[i] != std::byte{0} ? 1 : 0;
  return covered > image.pixels.size() / 4 / 50;
}

/// How a client warps.
struct Warping {
  double scale = 1;     ///< factor on width and height
  bool layered = true;  ///< the frame at rest is drawn over the newest one
  bool coarse = false;  ///< cells of depth have twice the size
};

Judged judge(const std::vector<Arrived>& frames, const Camera& begin, const Path& path, const Truth& truth,
             const Warping& warping = {}) {
  Judged judged;
  const auto count = static_cast<double>(frames.size() - 1);
  for (const Arrived& frame : std::span(frames).subspan(1)) {
    judged.kilobytes += static_cast<double>(frame.bytes) / 1000 / kSeconds;
    judged.width += frame.frame.picture().resolution().width() / count;
    judged.packets += frame.frame.has_video() ? 1 / count : 0;
  }
  judged.rate = count / kSeconds;
  window::VideoDecoder video;
  const warp::WarpFrame rest = decoded(frames.front().frame, video, warping.coarse);
  size_t newest = 0;
  warp::WarpFrame shown = rest;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double now = static_cast<double>(i) * kEvery;
    while (newest + 1 < frames.size() && frames[newest + 1].seconds + kDecode <= now) {
      shown = decoded(frames[++newest].frame, video, warping.coarse);
    }
    if (!counts(truth[i])) continue;
    const geometry::CameraFrame target =
        value_or_exit(geometry::make_camera_frame(path.at(begin, now), kWidth, kHeight));
    const bool warps = !shown.mesh.empty();
    const warp::WarpFrame* other = newest > 0 && !rest.mesh.empty() && warping.layered ? &rest : nullptr;
    judged.figures.push_back(bench::compare(
        warps ? bench::warped_at(warping.scale, shown, other, target) : bench::unwarped(shown, target), truth[i]));
  }
  return judged;
}

void print(const Judged& judged) {
  std::vector<double> psnr;
  double off = 0;
  for (const bench::Figures& figures : judged.figures) {
    psnr.push_back(figures.psnr);
    off += figures.off / static_cast<double>(judged.figures.size());
  }
  const double mean = std::accumulate(psnr.begin(), psnr.end(), 0.0) / static_cast<double>(psnr.size());
  std::ranges::sort(psnr);
  std::printf(" %.0f, %.0f, %.0f | %.1f, %.1f / %.1f |", judged.rate, judged.kilobytes, judged.width, mean,
              psnr[psnr.size() / 10], off);
  if (judged.packets > 0) std::printf(" %.0f %% packets |", 100 * judged.packets);
}

void print_drop(const std::vector<Arrived>& frames) {
  constexpr double kPart = 0.5;  // seconds
  std::map<int, std::vector<const Arrived*>> parts;
  std::map<int, double> longest;
  double before = 0;
  for (const Arrived& frame : std::span(frames).subspan(1)) {
    const int part = static_cast<int>(frame.seconds / kPart);
    parts[part].push_back(&frame);
    longest[part] = std::max(longest[part], frame.seconds - std::exchange(before, frame.seconds));
  }
  for (const auto& [part, arrived] : parts) {
    double kilobytes = 0;
    double width = 0;
    for (const Arrived* frame : arrived) {
      kilobytes += static_cast<double>(frame->bytes) / 1000;
      width += frame->frame.picture().resolution().width() / static_cast<double>(arrived.size());
    }
    std::printf("%4.1f s: %3.0f frames/s, %4.0f KB/s, %5.0f pixels, longest %4.0f ms\n", kPart * part,
                static_cast<double>(arrived.size()) / kPart, kilobytes / kPart, width, 1000 * longest[part]);
  }
}

constexpr double kMoved = 1;  // seconds of a movement before a rest
constexpr std::array kRestedFor{0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.4, 1.6, 2.0, 2.5};

/// PSNR of what is shown at instants of a rest, at whose camera the true picture is.
std::vector<double> quality_at_rest(const std::vector<Arrived>& frames, bool early, const Camera& camera,
                                    const picture::Image& truth) {
  const geometry::CameraFrame target = value_or_exit(geometry::make_camera_frame(camera, kWidth, kHeight));
  window::VideoDecoder video;
  warp::WarpFrame rest = decoded(frames.front().frame, video);
  warp::WarpFrame shown = rest;
  bool shows_rest = false;
  std::vector<double> quality;
  size_t next = 1;
  for (const double seconds : kRestedFor) {
    for (; next < frames.size() && frames[next].seconds + kDecode <= kMoved + seconds; ++next) {
      const Arrived& frame = frames[next];
      if (!frame.whole && !early) continue;
      shown = decoded(frame.frame, video);
      shows_rest = !frame.frame.moving();
    }
    quality.push_back(
        bench::compare(warp::warp(shown, shows_rest ? nullptr : &rest, target, {0, 0, 0, 255}), truth).psnr);
  }
  return quality;
}

constexpr double kDisplayed = 1.0 / 60;
constexpr double kStepsFrom = 0.8;  // seconds of a movement in which steps are judged
constexpr double kStepsTo = 1.8;
constexpr double kLongestBlend = 0.1;

/// The newest frame at each instant, and the one before it.
class Shown {
 public:
  explicit Shown(const std::vector<Arrived>& frames) : frames_(frames), newest_(decoded(frames.front().frame, video_)) {
    rest_ = newest_;
  }

  void advance(double now) {
    while (at_ + 1 < frames_.size() && frames_[at_ + 1].seconds + kDecode <= now) {
      ++at_;
      former_ = std::exchange(newest_, decoded(frames_[at_].frame, video_));
      between_ = std::min(now - since_, kLongestBlend);
      since_ = now;
    }
  }

  [[nodiscard]] warp::Pixels picture(const geometry::CameraFrame& target, double now, bool blended) const {
    warp::Pixels pixels = warp::warp(newest_, &rest_, target, {0, 0, 0, 255});
    const double share = between_ > 0 ? (now - since_ + kDisplayed) / (between_ + kDisplayed) : 1;
    if (!blended || !former_ || share >= 1) return pixels;
    const warp::Pixels before = warp::warp(*former_, &rest_, target, {0, 0, 0, 255});
    for (size_t i = 0; i < pixels.bytes.size(); ++i) {
      const double sum = (1 - share) * before.bytes[i] + share * pixels.bytes[i];
      pixels.bytes[i] = static_cast<uint8_t>(std::lround(sum));
    }
    return pixels;
  }

 private:
  const std::vector<Arrived>& frames_;
  window::VideoDecoder video_;
  warp::WarpFrame rest_;
  warp::WarpFrame newest_;
  std::optional<warp::WarpFrame> former_;
  size_t at_ = 0;
  double since_ = 0;
  double between_ = 0;
};

/// The change from one picture to the next that is not one of the true pictures.
double unexplained(const warp::Pixels& before, const warp::Pixels& after, const picture::Image& true_before,
                   const picture::Image& true_after) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < after.bytes.size(); ++i) {
    if (i % 4 == 3 || true_after.pixels[i / 4 * 4 + 3] == std::byte{0}) continue;
    const int change = after.bytes[i] - before.bytes[i];
    const int truth = std::to_integer<int>(true_after.pixels[i]) - std::to_integer<int>(true_before.pixels[i]);
    sum += (change - truth) * (change - truth);
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(count, 1)));
}

void print_steps(const std::vector<Arrived>& frames, const Camera& begin, const Path& path, const Truth& truth) {
  for (const bool blended : {false, true}) {
    Shown shown(frames);
    std::vector<double> steps;
    double psnr = 0;
    warp::Pixels before;
    for (size_t i = 0; i < truth.size(); ++i) {
      const double now = kStepsFrom + static_cast<double>(i) * kDisplayed;
      shown.advance(now);
      const geometry::CameraFrame target =
          value_or_exit(geometry::make_camera_frame(path.at(begin, now), kWidth, kHeight));
      warp::Pixels picture = shown.picture(target, now, blended);
      psnr += bench::compare(picture, truth[i]).psnr / static_cast<double>(truth.size());
      if (i > 0) steps.push_back(unexplained(before, picture, truth[i - 1], truth[i]));
      before = std::move(picture);
    }
    const double mean = std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
    std::ranges::sort(steps);
    std::printf(" %.2f, %.2f / %.1f |", mean, steps[steps.size() * 19 / 20], psnr);
  }
}

class Lab {
 public:
  Lab(uint16_t server, const std::string& file, bool near, double fps, std::vector<Link> links)
      : server_(server),
        fps_(fps),
        links_(std::move(links)),
        model_(bench::open_or_exit(file)),
        name_(std::filesystem::path(file).stem()),
        renderer_(value_or_exit(render::Renderer::create({}))) {
    picture::PictureRequest request;
    request.width = request.height = 16;
    request.spacing = 1e6;
    begin_ = bench::draw_or_exit(*renderer_, model_, request).camera;
    if (near) begin_.position = glm::mix(begin_.focal_point, begin_.position, 0.25);
  }

  void run_links() {
    std::printf(
        "\n| %s | link | newest frame: frames/s, KB/s, width | dB, worst tenth / %% off | warped: frames/s, KB/s, "
        "width | "
        "dB, worst tenth / %% off | of a video: frames/s, KB/s, width | dB, worst tenth / %% off |\n"
        "|---|---|---|---|---|---|---|---|\n",
        name_.c_str());
    for (const Path& path : bench::paths()) {
      const Truth truth = truth_of(path, 0, kSeconds, kEvery);
      for (const Link& link : links_) run(path, link, truth);
    }
  }

  void run_steps() {
    std::printf("\n| %s | link | at once: levels, largest / dB | blended |\n|---|---|---|---|\n", name_.c_str());
    for (const Path& path : bench::paths()) {
      const Truth truth = truth_of(path, kStepsFrom, kStepsTo, kDisplayed);
      for (const Link& link : links_) {
        const testing::LinkRelay relay(server_, shape_of(link));
        std::printf("| %s | %.0f Mbit/s, %d ms |", path.name.c_str(), link.megabits, link.round_trip);
        print_steps(play({relay.port(), name_, begin_, {fps_, true}}, path, kSeconds, [](double) {}), begin_, path,
                    truth);
        std::printf("\n");
        std::fflush(stdout);
      }
    }
  }

  void run_scales() {
    // Those between which the viewer chooses (client/web/src/view/warp_quality.ts).
    constexpr Warping kWarpings[] = {{1, true, false},  {0.75, true, false}, {0.5, true, false},
                                     {0.5, true, true}, {0.375, true, true}, {0.375, false, true}};
    std::printf(
        "\n| %s | link | 1: frames/s, KB/s, width | dB, worst tenth / %% off | 0.75 | | 0.5 | | 0.5, coarse depths | | "
        "0.375, coarse depths | | 0.375, coarse depths, newest alone | |\n",
        name_.c_str());
    for (const Path& path : bench::paths()) {
      const Truth truth = truth_of(path, 0, kSeconds, kEvery);
      for (const Link& link : links_) {
        const testing::LinkRelay relay(server_, shape_of(link));
        std::printf("| %s | %.0f Mbit/s, %d ms |", path.name.c_str(), link.megabits, link.round_trip);
        const auto frames = play({relay.port(), name_, begin_, {fps_, true}}, path, kSeconds, [](double) {});
        for (const Warping& warping : kWarpings) print(judge(frames, begin_, path, truth, warping));
        std::printf("\n");
        std::fflush(stdout);
      }
    }
  }

  void run_rest() {
    std::printf("\n| %s | link | KB |", name_.c_str());
    for (const double seconds : kRestedFor) std::printf(" %.1f s |", seconds);
    std::printf("\n");
    for (const Path& path : bench::paths()) {
      const Camera camera = path.at(begin_, kMoved);
      const picture::Image truth = truth_at(camera);
      for (const Link& link : links_) {
        const testing::LinkRelay relay(server_, shape_of(link));
        client::ViewWishes wishes{fps_, true, true};
        wishes.early = true;
        const auto frames = play(
            {relay.port(), name_, begin_, wishes}, path, kMoved, [](double) {}, kRestedFor.back() + 1);
        for (const bool early : {false, true}) print_rest(path, link, frames, early, camera, truth);
      }
    }
  }

  void run_drop() {
    const Path path = bench::paths().front();
    for (const Link& link : links_) {
      for (const bool video : {false, true}) {
        testing::LinkRelay relay(server_, shape_of(link));
        const auto tick = [&](double seconds) {
          const bool dropped = seconds > kDropEvery && seconds < 2 * kDropEvery;
          relay.set_bits_per_second(link.megabits * 1e6 * (dropped ? kDropPart : 1));
        };
        std::printf("\n%s, %s, %.0f Mbit/s, %d ms\n", name_.c_str(), video ? "video" : "files", link.megabits,
                    link.round_trip);
        print_drop(play({relay.port(), name_, begin_, {fps_, true, video}}, path, 3 * kDropEvery, tick));
        std::fflush(stdout);
      }
    }
  }

 private:
  static void print_rest(const Path& path, const Link& link, const std::vector<Arrived>& frames, bool early,
                         const Camera& camera, const picture::Image& truth) {
    const auto refined = std::ranges::find_if(frames, [](const Arrived& one) {
      return one.seconds > kMoved && one.whole && !one.frame.moving() && !one.frame.picture().converged();
    });
    std::printf("| %s, %s | %.0f Mbit/s, %d ms | %.0f |", path.name.c_str(), early ? "early" : "whole", link.megabits,
                link.round_trip,
                refined == frames.end() ? 0.0 : static_cast<double>(refined->frame.picture().data().size()) / 1000);
    for (const double psnr : quality_at_rest(frames, early, camera, truth)) std::printf(" %.1f |", psnr);
    std::printf("\n");
    std::fflush(stdout);
  }

  static testing::LinkShape shape_of(const Link& link) {
    return {link.megabits * 1e6, std::chrono::microseconds(500 * link.round_trip)};
  }

  void run(const Path& path, const Link& link, const Truth& truth) {
    const testing::LinkRelay relay(server_, shape_of(link));
    std::printf("| %s | %.0f Mbit/s, %d ms |", path.name.c_str(), link.megabits, link.round_trip);
    const auto nothing = [](double) {};
    for (const client::ViewWishes& wishes :
         {client::ViewWishes{}, client::ViewWishes{fps_, true}, client::ViewWishes{fps_, true, true}}) {
      print(judge(play({relay.port(), name_, begin_, wishes}, path, kSeconds, nothing), begin_, path, truth));
    }
    std::printf("\n");
    std::fflush(stdout);
  }

  [[nodiscard]] picture::Image truth_at(const Camera& camera) const {
    const auto asked = bench::request_at_rest(camera, kWidth, kHeight);
    return bench::draw_or_exit(*renderer_, model_, service::with_first_look(asked, model_->info())).image;
  }

  [[nodiscard]] Truth truth_of(const Path& path, double from, double to, double every) const {
    Truth truth;
    for (int i = 0; from + i * every < to; ++i) truth.push_back(truth_at(path.at(begin_, from + i * every)));
    return truth;
  }

  uint16_t server_;
  double fps_;
  std::vector<Link> links_;
  std::shared_ptr<const model::ModelFile> model_;
  std::string name_;
  std::unique_ptr<render::Renderer> renderer_;
  Camera begin_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: motion_lab PORT MODEL... [near] [fps=N] [link=MBIT,MS] [steps] [drop] [rest] [scales]\n");
    return 2;
  }
  static const std::map<std::string, void (Lab::*)()> kModes{
      {"steps", &Lab::run_steps}, {"drop", &Lab::run_drop}, {"rest", &Lab::run_rest}, {"scales", &Lab::run_scales}};
  void (Lab::*run)() = &Lab::run_links;
  bool near = false;
  double fps = 0;
  std::vector<Link> links{{1000, 0}, {20, 50}, {20, 150}, {4, 150}, {20, 300}};
  std::vector<std::string> models;
  for (const std::string& word : std::vector<std::string>(argv + 2, argv + argc)) {
    if (word == "near") {
      near = true;
    } else if (const auto mode = kModes.find(word); mode != kModes.end()) {
      run = mode->second;
    } else if (word.starts_with("fps=")) {
      fps = std::atof(word.c_str() + 4);
    } else if (word.starts_with("link=")) {
      links = {{std::atof(word.c_str() + 5), std::atoi(word.c_str() + word.find(',') + 1)}};
    } else {
      models.push_back(word);
    }
  }
  for (const std::string& model : models) {
    Lab lab(static_cast<uint16_t>(std::atoi(argv[1])), model, near, fps, links);
    (lab.*run)();
  }
  return 0;
}
