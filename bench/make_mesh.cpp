// Writes textured meshes with detail of every kind: make_mesh plane|cube FOLDER. The plane is 2 x 2 with 512 x 512
// texels. The cube has six charts of 240 x 368 texels, with magenta between them.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

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
  if (x < kHalf && y < kHalf) return texels[static_cast<size_t>(y * kSide + x)];
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
      const auto at = static_cast<size_t>(3 * k);
      std::snprintf(line.data(), line.size(), "v %d %d %d\nvt %.12g %.12g\n", n[at], n[at + 1], n[at + 2], u / kWidth,
                    1 - v / kHeight);
      text += line.data();
      const std::string number = std::to_string(4 * face + k + 1);
      corners += " " + number + "/" + number;
    }
    text += corners + "\n";
  }
  write_model(folder, "cube", text);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc == 3 ? argv[1] : "";
  if (what != "plane" && what != "cube") {
    std::fputs("usage: make_mesh plane|cube FOLDER\n", stderr);
    return 2;
  }
  if (what == "plane") write_plane(argv[2]);
  if (what == "cube") write_cube(argv[2]);
  return 0;
}
