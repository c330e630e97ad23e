// video_bench MODEL... [bytes=N] [size=W,H] [frames=N] [fps=N]: encodes the frames of camera paths as the server does,
// as a video in so many bytes a frame, and as JPEG files of the qualities of its ladder. For each path a row of a
// Markdown table: kilobytes a frame and PSNR in dB over all pixels and colours against what the encoder got, then
// milliseconds of processor time a frame; the same for JPEG.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "bench_support.h"
#include "camera_paths.h"
#include "client/window/video_decoder.h"
#include "encode/encode_picture.h"
#include "video/video_stream.h"

namespace {

using namespace surfcast;
using bench::value_or_exit;

struct Settings {
  size_t bytes = 15000;
  int width = 1280;
  int height = 720;
  int frames = 30;
  double fps = 15;
};

/// What the frames of a path came to, in sums.
struct Sums {
  double bytes = 0;
  double psnr = 0;
  double worst = 1e9;
  double milliseconds = 0;
};

double psnr_of(const picture::Image& image, const window::PixelImage& shown) {
  double squares = 0;
  for (size_t i = 0; i < shown.pixels.size(); i += 4) {
    for (size_t channel = 0; channel < 3; ++channel) {
      const double error = static_cast<double>(image.pixels[i + channel]) - shown.pixels[i + 2 - channel];
      squares += error * error;
    }
  }
  return 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(shown.pixels.size() / 4) / squares);
}

void add(const picture::Image& image, const window::PixelImage& shown, size_t bytes, double milliseconds, Sums& sums) {
  const double psnr = psnr_of(image, shown);
  sums.bytes += static_cast<double>(bytes);
  sums.psnr += psnr;
  sums.worst = std::min(sums.worst, psnr);
  sums.milliseconds += milliseconds;
}

void print(const Sums& sums, int frames) {
  std::printf(" %.1f | %.1f, %.1f | %.1f |", sums.bytes / frames / 1000, sums.psnr / frames, sums.worst,
              sums.milliseconds / frames);
}

std::vector<picture::Image> images_of(render::Renderer& renderer, const std::shared_ptr<const model::ModelFile>& model,
                                      const bench::Path& path, const Settings& settings) {
  picture::PictureRequest request;
  request.width = settings.width;
  request.height = settings.height;
  request.spacing = 1;
  request.normalization = picture::Normalization::kSurfel;
  const bench::Camera begin = bench::draw_or_exit(renderer, model, request).camera;
  std::vector<picture::Image> images;
  for (int i = 0; i < settings.frames; ++i) {
    request.camera = path.at(begin, i / settings.fps);
    images.push_back(bench::draw_or_exit(renderer, model, request).image);
  }
  return images;
}

Sums video_of(const std::vector<picture::Image>& images, size_t bytes) {
  const auto stream = value_or_exit(video::VideoStream::open());
  window::VideoDecoder decoder;
  Sums sums;
  uint64_t frame = 0;
  for (const picture::Image& image : images) {
    const double begin = bench::processor_ms();
    const video::VideoPacket packet = value_or_exit(stream->encode(image, {++frame, bytes, image.width, image.height}));
    const double took = bench::processor_ms() - begin;
    const auto* data = reinterpret_cast<const char*>(packet.bytes.data());
    add(image, value_or_exit(decoder.decode({data, packet.bytes.size()})), packet.bytes.size(), took, sums);
  }
  return sums;
}

Sums files_of(const std::vector<picture::Image>& images, int quality) {
  Sums sums;
  for (const picture::Image& image : images) {
    const double begin = bench::processor_ms();
    const auto bytes = value_or_exit(encode::encode_picture(image, picture::FileFormat::kJpeg, quality));
    const double took = bench::processor_ms() - begin;
    wire::Picture picture;
    picture.set_format(wire::FILE_FORMAT_JPEG);
    picture.set_data(bytes.data(), bytes.size());
    add(image, value_or_exit(window::decode_picture(picture)), bytes.size(), took, sums);
  }
  return sums;
}

void run(render::Renderer& renderer, const std::string& file, const Settings& settings) {
  const auto model = bench::open_or_exit(file);
  for (const bench::Path& path : bench::paths()) {
    const std::vector<picture::Image> images = images_of(renderer, model, path, settings);
    std::printf("| %s, %s |", std::filesystem::path(file).stem().c_str(), path.name.c_str());
    print(video_of(images, settings.bytes), settings.frames);
    for (const int quality : {85, 65, 45}) print(files_of(images, quality), settings.frames);
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  std::vector<std::string> models;
  for (const std::string word : std::span(argv + 1, static_cast<size_t>(argc - 1))) {
    const char* value = word.c_str() + word.find('=') + 1;
    if (word.starts_with("bytes=")) {
      settings.bytes = static_cast<size_t>(std::atoi(value));
    } else if (word.starts_with("size=")) {
      settings.width = std::atoi(value);
      settings.height = std::atoi(word.c_str() + word.find(',') + 1);
    } else if (word.starts_with("frames=")) {
      settings.frames = std::atoi(value);
    } else if (word.starts_with("fps=")) {
      settings.fps = std::atof(value);
    } else {
      models.push_back(word);
    }
  }
  const auto renderer = value_or_exit(render::Renderer::create({}));
  std::printf(
      "| model, path | video: KB | dB, worst | ms | JPEG 85: KB | dB, worst | ms | 65: KB | dB, worst | ms | 45: KB | "
      "dB, worst | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& model : models) run(*renderer, model, settings);
  return 0;
}
