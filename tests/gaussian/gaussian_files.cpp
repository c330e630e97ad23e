#include "gaussian/gaussian_files.h"

#include <stdexcept>

#include <webp/encode.h>
#include <zlib.h>

#include "support/packing.h"

namespace surfcast::testing {

std::string float_ply(const std::vector<std::string>& properties, const std::vector<std::vector<float>>& rows) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(rows.size()) + "\n";
  for (const std::string& property : properties) header += "property float " + property + "\n";
  Bytes bytes(header + "end_header\n");
  for (const std::vector<float>& row : rows) {
    for (const float value : row) bytes.add<float>(value);
  }
  return bytes.text();
}

namespace {

int rest_of(int degree) {
  return 3 * ((degree + 1) * (degree + 1) - 1);
}

std::string numbered(const std::string& name, int number) {
  return name + "_" + std::to_string(number);
}

}  // namespace

std::vector<std::string> gaussian_properties(int degree, int scales) {
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int k = 0; k < rest_of(degree); ++k) names.push_back(numbered("f_rest", k));
  names.emplace_back("opacity");
  for (int k = 0; k < scales; ++k) names.push_back(numbered("scale", k));
  for (int k = 0; k < 4; ++k) names.push_back(numbered("rot", k));
  return names;
}

std::vector<float> gaussian_row(int degree, int scales) {
  std::vector<float> row = {1, 2, 3, 0, 0, 0, 0.1F, 0.2F, 0.3F};
  for (int k = 0; k < rest_of(degree); ++k) row.push_back(static_cast<float>(k + 1));
  row.push_back(0);  // logit of one half
  for (int k = 0; k < scales; ++k) row.push_back(static_cast<float>(-k));
  for (const float part : {0.0F, 3.0F, 0.0F, 4.0F}) row.push_back(part);
  return row;
}

std::string compressed_ply(const std::vector<std::vector<float>>& chunks,
                           const std::vector<CompressedVertex>& vertices) {
  static constexpr const char* kChunk[] = {"min_x",       "min_y",       "min_z",       "max_x",       "max_y",
                                           "max_z",       "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x",
                                           "max_scale_y", "max_scale_z", "min_r",       "min_g",       "min_b",
                                           "max_r",       "max_g",       "max_b"};
  std::string header = "ply\nformat binary_little_endian 1.0\nelement chunk " + std::to_string(chunks.size()) + "\n";
  for (size_t i = 0; i < chunks[0].size(); ++i) header += std::string("property float ") + kChunk[i] + "\n";
  header += "element vertex " + std::to_string(vertices.size()) + "\n";
  for (const char* name : {"position", "rotation", "scale", "color"}) {
    header += std::string("property uint packed_") + name + "\n";
  }
  if (!vertices[0].harmonics.empty()) header += "element sh " + std::to_string(vertices.size()) + "\n";
  for (size_t k = 0; k < vertices[0].harmonics.size(); ++k) {
    header += "property uchar " + numbered("f_rest", static_cast<int>(k)) + "\n";
  }
  Bytes bytes(header + "end_header\n");
  for (const auto& chunk : chunks) {
    for (const float value : chunk) bytes.add<float>(value);
  }
  for (const CompressedVertex& v : vertices) {
    bytes.add<uint32_t>(v.position).add<uint32_t>(v.rotation).add<uint32_t>(v.scale).add<uint32_t>(v.color);
  }
  for (const CompressedVertex& v : vertices) {
    for (const uint8_t byte : v.harmonics) bytes.add<uint8_t>(byte);
  }
  return bytes.text();
}

std::string spz(const SpzContent& content) {
  Bytes bytes("NGSP");
  bytes.add<uint32_t>(content.version).add<uint32_t>(content.count).add<uint8_t>(content.degree);
  bytes.add<uint8_t>(content.fraction_bits).add<uint8_t>(content.flags).add<uint8_t>(0);
  for (const std::string& column : content.columns) bytes.add_text(column);
  return gzip(bytes.text());
}

std::string spz4(const SpzContent& content, const std::string& extensions) {
  Bytes bytes("NGSP");
  bytes.add<uint32_t>(4).add<uint32_t>(content.count).add<uint8_t>(content.degree);
  bytes.add<uint8_t>(content.fraction_bits).add<uint8_t>(content.flags);
  bytes.add<uint8_t>(static_cast<uint8_t>(content.columns.size()));
  bytes.add<uint32_t>(static_cast<uint32_t>(32 + extensions.size()));
  bytes.add_text(std::string(12, '\0') + extensions);
  std::string streams;
  for (const std::string& column : content.columns) {
    const std::string packed = zstd(column);
    bytes.add<uint64_t>(packed.size()).add<uint64_t>(column.size());
    streams += packed;
  }
  return bytes.add_text(streams).text();
}

SpzContent spz_pair(uint32_t version) {
  SpzContent content;
  content.version = version;
  content.count = 2;
  content.degree = 1;
  // 1.0, -0.5, 0 and the smallest and the largest number, with 12 bits behind the point.
  const std::string positions("\x00\x10\x00\x00\xf8\xff\x00\x00\x00\x00\x00\x80\xff\xff\x7f\x01\x00\x00", 18);
  const std::string first = version == 2 ? std::string("\xff\x80\x80", 3) : std::string("\x00\x00\x00\xc0", 4);
  // Left out: x, the first. Then y = -sqrt(1/2), z = 0, w = 256 / 511 * sqrt(1/2).
  const std::string second = version == 2 ? std::string("\x80\x80\x80", 3) : std::string("\x00\x01\xf0\x3f", 4);
  std::string harmonics;
  for (int k = 0; k < 18; ++k) harmonics += static_cast<char>(128 + k);
  content.columns = {positions,
                     std::string("\x00\xff", 2),
                     std::string("\x00\x80\xff\x33\x66\x99", 6),
                     std::string("\xa0\x90\x80\x00\xff\xa0", 6),
                     first + second,
                     harmonics};
  return content;
}

std::string webp(int width, int height, const std::vector<uint8_t>& rgba, bool lossless) {
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0) throw std::runtime_error("WebP");
  config.lossless = lossless ? 1 : 0;
  config.exact = 1;  // keeps colours where alpha is 0
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool done = WebPPictureImportRGBA(&picture, rgba.data(), 4 * width) != 0 && WebPEncode(&config, &picture) != 0;
  std::string text(reinterpret_cast<const char*>(writer.mem), writer.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!done) throw std::runtime_error("WebP");
  return text;
}

namespace {

/// 256 numbers: first + step * i.
std::string codebook(double first, double step) {
  std::string text;
  for (int i = 0; i < 256; ++i) text += (i == 0 ? "" : ",") + std::to_string(first + step * i);
  return "[" + text + "]";
}

/// 70 entries of three coefficients: entry e has the codes e, e + 1 and so on.
std::string palette() {
  std::vector<uint8_t> rgba(static_cast<size_t>(4 * 64 * 3 * 2));
  for (size_t entry = 0; entry < 70; ++entry) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t pixel = entry / 64 * 64 * 3 + entry % 64 * 3 + j;
      for (size_t c = 0; c < 3; ++c) rgba[4 * pixel + c] = static_cast<uint8_t>(entry + 3 * j + c);
    }
  }
  return webp(192, 2, rgba);
}

}  // namespace

SogContent sog_pair(const std::string& count, uint8_t label) {
  SogContent content;
  content.meta = R"({"version":2,"count":)" + count +
                 R"(,"antialias":true,"means":{"mins":[-1,0,-2],"maxs":[1,2,0],"files":["l.webp","u.webp"]},)"
                 R"("scales":{"codebook":)" +
                 codebook(-8, 0.03125) +
                 R"(,"files":["s.webp"]},)"
                 R"("quats":{"files":["q.webp"]},"sh0":{"codebook":)" +
                 codebook(-2, 0.015625) + R"(,"files":["c.webp"]},"shN":{"count":70,"bands":1,"codebook":)" +
                 codebook(0, 0.5) + R"(,"files":["p.webp","n.webp"]}})";
  content.files = {
      // Pixels beyond the count hold what no Gaussian may have.
      {"l.webp", webp(2, 2, {0, 255, 0, 255, 255, 0, 255, 255, 9, 9, 9, 9, 9, 9, 9, 9})},
      {"u.webp", webp(2, 2, {0, 255, 128, 255, 255, 0, 127, 255, 9, 9, 9, 9, 9, 9, 9, 9})},
      {"s.webp", webp(2, 2, {0, 32, 64, 255, 255, 128, 0, 255, 9, 9, 9, 9, 9, 9, 9, 9})},
      {"q.webp", webp(2, 2, {255, 128, 128, 252, 128, 0, 128, 254, 9, 9, 9, 0, 9, 9, 9, 0})},
      {"c.webp", webp(2, 2, {169, 156, 110, 17, 1, 2, 3, 0, 9, 9, 9, 9, 9, 9, 9, 9})},
      {"p.webp", palette()},
      {"n.webp", webp(2, 2, {3, 0, 0, 255, label, 0, 0, 255, 255, 255, 0, 255, 255, 255, 0, 255})},
  };
  return content;
}

std::filesystem::path write_sog_folder(const std::filesystem::path& folder, const SogContent& content) {
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : content.files) write(folder / name, text);
  write(folder / "meta.json", content.meta);
  return folder;
}

namespace {

/// Appends the fields that the two headers of a zip entry share (APPNOTE 4.3.7).
void add_entry_fields(Bytes& bytes, bool deflated, const std::string& plain, const std::string& packed,
                      const std::string& name) {
  const auto sum =
      static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(plain.data()), static_cast<uInt>(plain.size())));
  bytes.add<uint16_t>(20).add<uint16_t>(0).add<uint16_t>(deflated ? 8 : 0).add<uint16_t>(0).add<uint16_t>(33);
  bytes.add<uint32_t>(sum).add<uint32_t>(static_cast<uint32_t>(packed.size()));
  bytes.add<uint32_t>(static_cast<uint32_t>(plain.size())).add<uint16_t>(static_cast<uint16_t>(name.size()));
  bytes.add<uint16_t>(0);
}

}  // namespace

std::string sog_zip(const SogContent& content, bool deflated, const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> files = content.files;
  files.emplace_back("meta.json", content.meta);
  Bytes local;
  Bytes directory;
  for (const auto& [file, text] : files) {
    const std::string name = folder + file;
    const std::string stream = zlib(text);
    const std::string packed = deflated ? stream.substr(2, stream.size() - 6) : text;  // without zlib's frame
    directory.add<uint32_t>(0x02014b50).add<uint16_t>(20);
    add_entry_fields(directory, deflated, text, packed, name);
    directory.add<uint16_t>(0).add<uint16_t>(0).add<uint16_t>(0).add<uint32_t>(0);
    directory.add<uint32_t>(static_cast<uint32_t>(local.text().size())).add_text(name);
    local.add<uint32_t>(0x04034b50);
    add_entry_fields(local, deflated, text, packed, name);
    local.add_text(name).add_text(packed);
  }
  const auto entries = static_cast<uint16_t>(files.size());
  const auto begin = static_cast<uint32_t>(local.text().size());
  const auto size = static_cast<uint32_t>(directory.text().size());
  local.add_text(directory.text()).add<uint32_t>(0x06054b50).add<uint16_t>(0).add<uint16_t>(0);
  local.add<uint16_t>(entries).add<uint16_t>(entries).add<uint32_t>(size).add<uint32_t>(begin).add<uint16_t>(0);
  return local.text();
}

}  // namespace surfcast::testing
