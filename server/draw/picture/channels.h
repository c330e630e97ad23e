#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace surfcast::picture {

/// What an EXR file can hold of each pixel beside its colour.
enum class Channel { kDepth, kNormal, kPosition, kCoverage, kClassification, kSurfel };

/// A set of channels, indexed by Channel.
using ChannelSet = std::bitset<6>;

[[nodiscard]] inline bool has(const ChannelSet& channels, Channel channel) {
  return channels[static_cast<size_t>(channel)];
}

/// A channel of the file, of 32 bits a pixel.
struct FileChannel {
  std::string name;
  bool whole_number = false;  ///< unsigned; otherwise a float
};

/// The channels of a picture beside its colours, and their content.
struct Channels {
  std::vector<FileChannel> channels;
  std::vector<uint32_t> words;  ///< the bits of the values, all channels of a pixel together, rows from top to bottom
  glm::dvec3 origin{0};         ///< what positions are relative to: world coordinates
};

}  // namespace surfcast::picture
