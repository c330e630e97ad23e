#include "lab/mesh_scenes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace surfcast::lab {
namespace {

using Texel = std::array<uint8_t, 3>;

constexpr int kSide = 512;

std::vector<Texel> noise() {
  std::mt19937 random(5);
  std::vector<Texel> texels(kSide * kSide);
  for (Texel& texel : texels) {
    for (uint8_t& level : texel) level = static_cast<uint8_t>(random() >> 24);
  }
  return texels;
}

Texel strokes(int x, int y) {
  if ((x * 3 + y * 2) % 37 < 2) return {20, 20, 20};
  if (((x - 2 * y) % 53 + 53) % 53 < 3) return {200, 40, 30};
  return {235, 230, 210};
}

/// A quarter each of noise of single texels, a zone plate up to one period in two texels, strokes, and flat parts.
Texel detail(int x, int y) {
  static const std::vector<Texel> texels = noise();
  constexpr int kHalf = kSide / 2;
  if (x < kHalf && y < kHalf) return texels[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)];
  if (x < kHalf) return strokes(x, y);
  if (y >= kHalf) return (x / 32 + y / 32) % 2 != 0 ? Texel{60, 140, 90} : Texel{220, 190, 70};
  const double dx = x - 1.5 * kHalf;
  const double dy = y - 0.5 * kHalf;
  const double wave = std::cos(std::numbers::pi / kSide * (dx * dx + dy * dy));
  const auto level = static_cast<uint8_t>(127.5 + 127.5 * wave);
  return {level, level, static_cast<uint8_t>(255 - level)};
}

/// Targa, not compressed.
void write_image(const std::filesystem::path& file, int width, int height,
                 const std::function<Texel(int, int)>& texel) {
  std::string bytes(18, '\0');
  bytes[2] = 2;
  bytes[12] = static_cast<char>(width % 256);
  bytes[13] = static_cast<char>(width / 256);
  bytes[14] = static_cast<char>(height % 256);
  bytes[15] = static_cast<char>(height / 256);
  bytes[16] = 24;
  bytes[17] = 0x20;  // from the upper edge
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto [r, g, b] = texel(x, y);
      for (const uint8_t level : {b, g, r}) bytes += static_cast<char>(level);
    }
  }
  std::ofstream(file, std::ios::binary) << bytes;
}

void write_model(const std::filesystem::path& folder, const std::string& name, const std::string& faces) {
  std::ofstream(folder / (name + ".mtl")) << "newmtl m\nmap_Kd " << name << ".tga\n";
  std::ofstream(folder / (name + ".obj")) << "mtllib " << name << ".mtl\nusemtl m\n" << faces;
}

void write_plane(const std::filesystem::path& folder) {
  write_image(folder / "plane.tga", kSide, kSide, detail);
  write_model(folder, "plane",
              "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
              "f 1/1/1 2/2/1 3/3/1 4/4/1\n");
}

constexpr int kChartWidth = 240;
constexpr int kChartHeight = 368;
constexpr int kGap = 16;
constexpr int kWidth = 3 * kChartWidth + 4 * kGap;
constexpr int kHeight = 2 * kChartHeight + 3 * kGap;

Texel atlas(int x, int y) {
  for (int chart = 0; chart < 6; ++chart) {
    const int u = x - kGap - (chart % 3) * (kChartWidth + kGap);
    const int v = y - kGap - (chart / 3) * (kChartHeight + kGap);
    if (u < 0 || v < 0 || u >= kChartWidth || v >= kChartHeight) continue;
    return detail(u + 136 * (chart % 2), v + 72 * (chart / 3));
  }
  return {255, 0, 255};
}

void write_cube(const std::filesystem::path& folder) {
  // Corners of each face, counter-clockwise as seen from outside.
  constexpr std::array<const char*, 6> kFaces{"-1 -1 1 1 -1 1 1 1 1 -1 1 1", "1 -1 -1 -1 -1 -1 -1 1 -1 1 1 -1",
                                              "1 -1 1 1 -1 -1 1 1 -1 1 1 1", "-1 -1 -1 -1 -1 1 -1 1 1 -1 1 -1",
                                              "-1 1 1 1 1 1 1 1 -1 -1 1 -1", "-1 -1 -1 1 -1 -1 1 -1 1 -1 -1 1"};
  write_image(folder / "cube.tga", kWidth, kHeight, atlas);
  std::string text;
  for (int face = 0; face < 6; ++face) {
    std::array<int, 12> n{};
    std::sscanf(kFaces[static_cast<size_t>(face)], "%d %d %d %d %d %d %d %d %d %d %d %d", &n[0], &n[1], &n[2], &n[3],
                &n[4], &n[5], &n[6], &n[7], &n[8], &n[9], &n[10], &n[11]);
    const int left = kGap + (face % 3) * (kChartWidth + kGap);
    const int top = kGap + (face / 3) * (kChartHeight + kGap);
    std::string corners = "f";
    for (int k = 0; k < 4; ++k) {
      const bool right = k == 1 || k == 2;
      const double u = left + (right ? kChartWidth : 0);
      const double v = top + (k < 2 ? kChartHeight : 0);
      std::array<char, 128> line{};
      const size_t at = 3 * static_cast<size_t>(k);
      std::snprintf(line.data(), line.size(), "v %d %d %d\nvt %.12g %.12g\n", n[at], n[at + 1], n[at + 2], u / kWidth,
                    1 - v / kHeight);
      text += line.data();
      const std::string number = std::to_string(4 * face + k + 1);
      corners.append(" ").append(number).append("/").append(number);
    }
    text += corners + "\n";
  }
  write_model(folder, "cube", text);
}

constexpr int kMeridians = 96;
constexpr int kParallels = 48;

/// The unit sphere, z up, with the image twice around it and a seam where it begins.
void write_sphere(const std::filesystem::path& folder) {
  write_image(folder / "sphere.tga", kSide, kSide, detail);
  std::string text;
  for (int j = 0; j <= kParallels; ++j) {
    for (int i = 0; i <= kMeridians; ++i) {
      const double around = 2 * std::numbers::pi * (i % kMeridians) / kMeridians;
      const double down = std::numbers::pi * j / kParallels;
      const double ring = j % kParallels == 0 ? 0 : std::sin(down);
      const double x = ring * std::cos(around);
      const double y = ring * std::sin(around);
      const double z = std::cos(down);
      std::array<char, 256> line{};
      std::snprintf(line.data(), line.size(), "v %.12g %.12g %.12g\nvn %.12g %.12g %.12g\nvt %.12g %.12g\n", x, y, z, x,
                    y, z, 2.0 * i / kMeridians, 1 - static_cast<double>(j) / kParallels);
      text += line.data();
    }
  }
  const auto corner = [](int i, int j) {
    const std::string number = std::to_string(j * (kMeridians + 1) + i + 1);
    return " " + number + "/" + number + "/" + number;
  };
  for (int j = 0; j < kParallels; ++j) {
    for (int i = 0; i < kMeridians; ++i) {
      if (j + 1 < kParallels) text += "f" + corner(i, j) + corner(i, j + 1) + corner(i + 1, j + 1) + "\n";
      if (j > 0) text += "f" + corner(i, j) + corner(i + 1, j + 1) + corner(i + 1, j) + "\n";
    }
  }
  write_model(folder, "sphere", text);
}

struct Writer {
  const char* name;
  void (*write)(const std::filesystem::path& folder);
};

constexpr std::array kWriters{Writer{"plane", write_plane}, Writer{"cube", write_cube}, Writer{"sphere", write_sphere}};

}  // namespace

std::vector<std::string> mesh_scene_names() {
  std::vector<std::string> names;
  names.reserve(kWriters.size());
  for (const Writer& writer : kWriters) names.emplace_back(writer.name);
  return names;
}

std::optional<std::filesystem::path> write_mesh_scene(const std::string& name, const std::filesystem::path& folder) {
  for (const Writer& writer : kWriters) {
    if (name != writer.name) continue;
    writer.write(folder);
    return folder / (name + ".obj");
  }
  return std::nullopt;
}

}  // namespace surfcast::lab
