#include "lab/volume_subjects.h"

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "bench_support.h"
#include "builder/build_model.h"
#include "gaussian/gaussian_scenes.h"
#include "grid/grid_reader.h"
#include "reference/gaussian_renderer.h"
#include "render/transfer_presets.h"

namespace surfcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 128;           ///< of pictures of analytic fields, pixels
constexpr int kGaussianSide = 64;    ///< pixels
constexpr int kGaussianSamples = 3;  ///< of ideal pictures, per pixel and axis

/// The samples of a grid in single precision, i fastest, as MetaImage.
void write_meta_image(const reference::VolumeGrid& grid, const fs::path& header) {
  const fs::path raw = fs::path(header).replace_extension(".raw");
  std::ofstream text(header);
  text.precision(17);
  text << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  const auto line = [&](const char* name, const auto& v) {
    text << name << " = " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  };
  line("Offset", grid.origin);
  line("ElementSpacing", glm::dvec3(grid.axes[0].x, grid.axes[1].y, grid.axes[2].z));
  line("DimSize", grid.size);
  text << "ElementType = MET_FLOAT\nElementDataFile = " << raw.filename().string() << '\n';
  std::ofstream file(raw, std::ios::binary);
  for (const double value : grid.values) {
    const auto sample = static_cast<float>(value);
    file.write(reinterpret_cast<const char*>(&sample), sizeof sample);
  }
}

ModelPointer built(const fs::path& input, const fs::path& folder) {
  const fs::path target = folder / (input.stem().string() + ".surf");
  bench::value_or_exit(builder::build_model(std::array{input}, target, {}, [](const builder::BuildStep&) {}));
  return bench::open_or_exit(target);
}

picture::PictureRequest request_of(const geometry::CameraFrame& frame) {
  picture::PictureRequest request;
  request.width = frame.width;
  request.height = frame.height;
  request.camera = camera_of(frame);
  return request;
}

picture::Transfer transfer_of(const std::vector<reference::TransferPoint>& points, double spacing) {
  picture::Transfer transfer;
  for (const reference::TransferPoint& p : points) transfer.points.push_back({p.value, p.srgb, p.opacity});
  transfer.spacing = spacing;
  return transfer;
}

struct Analytic {
  const char* field;
  const char* view;
  glm::ivec3 size{32};
  double closer = 1;
};
constexpr std::array kAnalytic{
    Analytic{"torus", "mid"},
    Analytic{"torus", "mid", glm::ivec3(32), 1.1},
    Analytic{"torus", "mid", glm::ivec3(32), 0.9},
    Analytic{"torus", "low"},
    Analytic{"torus", "wide"},
    Analytic{"torus", "near"},
    Analytic{"torus", "inside"},
    Analytic{"torus", "mid", glm::ivec3(32, 32, 16)},
    Analytic{"torus", "far", glm::ivec3(64)},
    Analytic{"ball", "mid"},
    Analytic{"ball", "mid", glm::ivec3(32), 1.1},
    Analytic{"ball", "mid", glm::ivec3(32), 0.9},
    Analytic{"blobs", "mid"},
    Analytic{"blobs", "mid", glm::ivec3(32), 1.1},
    Analytic{"blobs", "mid", glm::ivec3(32), 0.9},
    Analytic{"ml", "mid", glm::ivec3(41)},
    Analytic{"ml", "mid", glm::ivec3(41), 1.1},
    Analytic{"ml", "mid", glm::ivec3(41), 0.9},
};

std::string name_of(const Analytic& analytic) {
  std::string name = std::string(analytic.field) + "_" + analytic.view;
  if (analytic.closer > 1) name += "_closer";
  if (analytic.closer < 1) name += "_farther";
  if (analytic.size.z != analytic.size.x) name += "_flat";
  return name;
}

std::string about(const glm::ivec3& size) {
  return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
}

VolumeSubject prepared(const Analytic& analytic, const fs::path& folder) {
  reference::VolumeScene scene = reference::make_volume_scene(analytic.field, analytic.view, analytic.size, kSide);
  scene.frame = reference::volume_view(analytic.view, kSide, analytic.closer);
  const fs::path grid = folder / (name_of(analytic) + ".mhd");
  write_meta_image(scene.grid, grid);
  VolumeSubject subject{name_of(analytic), about(analytic.size), built(grid, folder), request_of(scene.frame),
                        scene.grid,        scene.transfer,       scene.frame};
  subject.request.volumes.transfer = transfer_of(scene.points, scene.spacing);
  subject.ideal = ideal_picture(scene);
  return subject;
}

/// The samples of a file with axes along those of the world.
reference::VolumeGrid grid_of_file(const fs::path& path) {
  grid::GridReader reader = bench::value_or_exit(grid::GridReader::open(path));
  const grid::GridHeader& header = reader.header();
  std::vector<double> values(header.samples());
  if (const Status read = reader.read(std::span(values)); !read) {
    std::fprintf(stderr, "%s\n", read.error().message.c_str());
    std::exit(1);
  }
  for (double& value : values) value = header.slope * value + header.intercept;
  const glm::ivec3 size(header.size[0], header.size[1], header.size[2]);
  const glm::dmat4x3& place = header.index_to_world;
  size_t next = 0;
  return reference::make_grid(size, place[3], glm::dmat3(place[0], place[1], place[2]),
                              [&](const glm::dvec3&) { return values[next++]; });
}

struct NamedPreset {
  const char* name;
  picture::TransferPreset preset;
};
constexpr std::array kPresets{
    NamedPreset{"gray", picture::TransferPreset::kGray}, NamedPreset{"mr", picture::TransferPreset::kMr},
    NamedPreset{"ct-bone", picture::TransferPreset::kCtBone}, NamedPreset{"ct-soft", picture::TransferPreset::kCtSoft}};

/// The preset before the colon, gray without one, and the rest.
std::pair<NamedPreset, std::string> split(const std::string& text) {
  for (const NamedPreset& preset : kPresets) {
    const std::string start = std::string(preset.name) + ":";
    if (text.starts_with(start)) return {preset, text.substr(start.size())};
  }
  return {kPresets.front(), text};
}

/// A view of the whole grid from in front of its second axis, the third one upwards.
geometry::CameraFrame fitting(const reference::VolumeGrid& grid, int side) {
  constexpr double kAngle = 30;  // degrees
  const glm::dvec3 half = 0.5 * (grid.place(grid.high) - grid.place(grid.low));
  geometry::Camera camera;
  camera.focal_point = grid.centre();
  const double distance = 0.9 * glm::length(half) / std::sin(0.5 * kAngle * std::numbers::pi / 180);
  camera.position = camera.focal_point + distance * glm::normalize(glm::dvec3(0.4, -1, 0.25));
  camera.view_up = {0, 0, 1};
  camera.view_angle = kAngle;
  return bench::value_or_exit(geometry::make_camera_frame(camera, side, side));
}

GaussianSubject gaussians(const std::string& name, const fs::path& folder) {
  const bool inside = name == "near";
  const geometry::Camera camera = inside ? geometry::Camera{{0.1, 0.05, 0.2}, {-0.6, -0.1, -0.3}, {0, 1, 0}, 75}
                                         : geometry::Camera{{1.3, 1.1, 3}, {0, 0, 0}, {0, 1, 0}, 36};
  const auto frame = bench::value_or_exit(geometry::make_camera_frame(camera, kGaussianSide, kGaussianSide));
  GaussianSubject subject{name, inside ? "from within" : "from outside", {}, request_of(frame), {}, frame, {}};
  subject.splats = testing::in_single_precision(reference::make_gaussian_model(name));
  subject.model = built(testing::write_ply(folder / (name + ".ply"), subject.splats), folder);
  subject.ideal = reference::ideal_picture(subject.splats, frame, kGaussianSamples);
  return subject;
}

nlohmann::ordered_json json_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

geometry::Camera camera_of(const geometry::CameraFrame& frame) {
  const double angle = 2 * std::atan(0.5 * frame.height / frame.eta) * 180 / std::numbers::pi;
  return {frame.eye, frame.eye + frame.forward, frame.up, angle};
}

geometry::CameraFrame with_pixels(geometry::CameraFrame frame, int side, double finer) {
  frame.width = frame.height = side;
  frame.eta *= finer;
  return frame;
}

std::vector<VolumeSubject> analytic_volumes(const fs::path& folder) {
  std::vector<VolumeSubject> subjects;
  for (const Analytic& analytic : kAnalytic) subjects.push_back(prepared(analytic, folder));
  return subjects;
}

VolumeSubject volume_of_file(const std::string& grid, int side, const fs::path& folder) {
  const auto [preset, path] = split(grid);
  VolumeSubject subject;
  subject.name = fs::path(path).stem().string() + "_" + preset.name;
  subject.model = built(path, folder);
  subject.grid = grid_of_file(path);
  subject.about = about(subject.grid.size);
  subject.frame = fitting(subject.grid, side);
  subject.request = request_of(subject.frame);
  const double spacing = std::cbrt(std::abs(glm::determinant(subject.grid.axes)));
  std::vector<reference::TransferPoint> points;
  picture::Transfer transfer;
  transfer.preset = preset.preset;
  for (const picture::TransferPoint& p : render::preset_points(transfer, subject.model->volumes().front())) {
    points.push_back({p.value, glm::dvec3(1), p.opacity});
  }
  subject.transfer = reference::TransferFunction(points, spacing);
  subject.request.volumes.transfer = transfer_of(points, spacing);
  return subject;
}

void export_volume(const VolumeSubject& subject, const fs::path& folder) {
  write_meta_image(subject.grid, folder / (subject.name + ".mhd"));
  const geometry::Camera& camera = *subject.request.camera;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const picture::TransferPoint& p : subject.request.volumes.transfer.points) {
    points.push_back({{"value", p.value}, {"color", json_of(p.color)}, {"opacity", p.opacity}});
  }
  const nlohmann::ordered_json description{{"resolution", {subject.request.width, subject.request.height}},
                                           {"grid", subject.name + ".mhd"},
                                           {"transfer", points},
                                           {"spacing", *subject.request.volumes.transfer.spacing},
                                           {"camera",
                                            {{"position", json_of(camera.position)},
                                             {"focal_point", json_of(camera.focal_point)},
                                             {"view_up", json_of(camera.view_up)},
                                             {"view_angle", camera.view_angle}}}};
  std::ofstream(folder / (subject.name + ".json")) << description.dump(1) << "\n";
}

std::vector<GaussianSubject> gaussian_subjects(const fs::path& folder) {
  std::vector<GaussianSubject> subjects;
  for (const char* name : {"ball", "needles", "fog", "near"}) subjects.push_back(gaussians(name, folder));
  return subjects;
}

}  // namespace surfcast::lab
