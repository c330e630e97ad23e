#include "scan/samples.h"

#include <cmath>
#include <memory>

#include <draco/attributes/point_attribute.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include "scan/bytes.h"
#include "scan/las_file.h"

namespace surfcast::testing {
namespace {

std::string ply(const std::string& encoding) {
  const bool big = encoding == "binary_big_endian";
  Bytes file("ply\nformat " + encoding +
             " 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
             "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n");
  if (encoding == "ascii") return file.text() + "0 0 0 1 2 3\n1.5 0 0 4 5 6\n0 1e1 7 7 8 9\n3 0 1 2\n";
  for (int i = 0; i < 3; ++i) {
    file.add<float>(static_cast<float>(i), big).add<double>(i * i, big).add<int16_t>(static_cast<int16_t>(-i), big);
    file.add<uint8_t>(1).add<uint8_t>(2).add<uint8_t>(3);
  }
  return file.add<uint8_t>(3).add<int32_t>(0, big).add<int32_t>(1, big).add<int32_t>(2, big).text();
}

std::string las(int minor, int format) {
  LasFile file;
  file.minor = minor;
  file.format = format;
  for (int i = 0; i < 5; ++i) file.records.push_back(file.record(i * 100, i * i, -i).set<uint16_t>(12, 9).text());
  return file.text();
}

std::string pcd(const std::string& encoding) {
  const std::string fields = "FIELDS x y z rgb\nSIZE 4 4 8 4\nTYPE F F F U\nCOUNT 1 1 1 1\n";
  const std::string header = pcd_header(fields, 2, 2, encoding);
  if (encoding == "ascii") return header + "0 0 1 255\n1 0 1 65280\nnan nan nan 0\n1 1 1.25 16711680\n";
  Bytes data;  // planar for the compressed kind, and any numbers will do for the other
  for (int i = 0; i < 8; ++i) data.add<float>(static_cast<float>(i));
  for (int i = 0; i < 4; ++i) data.add<double>(i);
  for (int i = 0; i < 4; ++i) data.add<uint32_t>(255);
  return header + (encoding == "binary" ? data.text() : lzf_block(data.text()));
}

}  // namespace

std::string pcd_header(const std::string& fields, int width, int height, const std::string& encoding) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + fields + "WIDTH " + std::to_string(width) +
         "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) +
         "\nDATA " + encoding + "\n";
}

std::string lzf_block(const std::string& data) {
  std::string compressed;
  for (size_t at = 0; at < data.size();) {
    // Three bytes that repeat those of eight bytes before become a reference, everything else a literal of its own.
    if (at >= 8 && at + 3 <= data.size() && data.compare(at, 3, data, at - 8, 3) == 0) {
      compressed += {'\x20', '\7'};
      at += 3;
    } else {
      compressed += {'\0', data[at++]};
    }
  }
  Bytes block;
  block.add(static_cast<uint32_t>(compressed.size())).add(static_cast<uint32_t>(data.size()));
  return block.text() + compressed;
}

std::string draco_cloud(bool kd_tree) {
  constexpr uint32_t kPoints = 300;
  draco::PointCloudBuilder builder;
  builder.Start(kPoints);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const int quality = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16);
  for (uint32_t i = 0; i < kPoints; ++i) {
    const float t = static_cast<float>(i) * 0.1F;
    const float xyz[3] = {std::cos(t), std::sin(t), t};
    const uint8_t rgb[3] = {static_cast<uint8_t>(i % 256), 20, 30};
    const auto q = static_cast<uint16_t>(i * 7);
    builder.SetAttributeValueForPoint(position, draco::PointIndex(i), xyz);
    builder.SetAttributeValueForPoint(color, draco::PointIndex(i), rgb);
    builder.SetAttributeValueForPoint(quality, draco::PointIndex(i), &q);
  }
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString("name", "quality");
  cloud->AddAttributeMetadata(quality, std::move(metadata));
  draco::Encoder encoder;
  encoder.SetEncodingMethod(kd_tree ? draco::POINT_CLOUD_KD_TREE_ENCODING : draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}

std::string draco_batches(uint32_t points) {
  draco::PointCloudBuilder builder;
  builder.Start(points);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int batch = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16);
  for (uint32_t i = 0; i < points; ++i) {
    const float xyz[3] = {static_cast<float>(i), 0, 0};
    const auto id = static_cast<uint16_t>(1 - i % 2);
    builder.SetAttributeValueForPoint(position, draco::PointIndex(i), xyz);
    builder.SetAttributeValueForPoint(batch, draco::PointIndex(i), &id);
  }
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}

GltfFile draco_points() {
  draco::PointCloudBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
  const int number = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16);
  for (uint32_t i = 0; i < 2; ++i) {
    const float xyz[3] = {static_cast<float>(i), 2, 3};
    const uint8_t rgba[4] = {static_cast<uint8_t>(255 * i), 255, 0, 255};
    const auto value = static_cast<uint16_t>(500 + i);
    builder.SetAttributeValueForPoint(position, draco::PointIndex(i), xyz);
    builder.SetAttributeValueForPoint(color, draco::PointIndex(i), rgba);
    builder.SetAttributeValueForPoint(number, draco::PointIndex(i), &value);
  }
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok()) return {};
  GltfFile file;
  const size_t view = file.add_view({buffer.data(), buffer.size()});
  file.json["accessors"] = {{{"componentType", 5126}, {"count", 2}, {"type", "VEC3"}},
                            {{"componentType", 5121}, {"count", 2}, {"type", "VEC4"}, {"normalized", true}},
                            {{"componentType", 5123}, {"count", 2}, {"type", "SCALAR"}}};
  file.primitive()["attributes"] = {{"POSITION", 0}, {"COLOR_0", 1}, {"_INTENSITY", 2}};
  const nlohmann::json ids = {{"POSITION", cloud->attribute(position)->unique_id()},
                              {"COLOR_0", cloud->attribute(color)->unique_id()},
                              {"_INTENSITY", cloud->attribute(number)->unique_id()}};
  file.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view}, {"attributes", ids}};
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return file;
}

std::vector<Sample> samples() {
  return {
      {"ascii.ply", ply("ascii")},
      {"little.ply", ply("binary_little_endian")},
      {"big.ply", ply("binary_big_endian")},
      {"v12.las", las(2, 3)},
      {"v14.las", las(4, 7)},
      {"ascii.pcd", pcd("ascii")},
      {"binary.pcd", pcd("binary")},
      {"compressed.pcd", pcd("binary_compressed")},
      {"plain.xyz", "0 0 0\n1 0 0\n0 1 0.5\n"},
      {"counted.pts", "2\n1 2 3 -100 10 20 30\n4 5 6 200 40 50 60\n"},
      {"header.csv", "X,Y,Z,Red,Green,Blue\n1,2,3,255,0,0\n4,5,6,0,255,0\n"},
      {"station.ptx",
       "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n1 2 3 0.5 1 2 3\n0 0 0 0.5 0 0 0\n"},
      {"heights.asc",
       "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -9999\n1 2.5 3\n-9999 5 6\n"},
      {"kd_tree.drc", draco_cloud(true)},
      {"sequential.drc", draco_cloud(false)},
  };
}

}  // namespace surfcast::testing
