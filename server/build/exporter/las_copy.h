#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "exporter/las_file_writer.h"
#include "scan/las_records.h"

namespace surfcast::exporter {

/// How the points of a LAS file become those of another: every byte of a record stays as it is. The samples of
/// waveforms are not copied, and neither are the wave packets that refer to them.
struct LasCopy {
  LasHead head;
  size_t packet_offset = 0;        ///< of the wave packet in a record of the source
  size_t packet_size = 0;          ///< 0: none
  std::vector<std::string> notes;  ///< what is left out, for people
};

/// Scale, offset, identification, projection and all other records of the source are kept, but for those that describe
/// its compression, its index and its waveforms.
LasCopy plan_las_copy(const scan::LasHeader& header, std::span<const std::byte> file, bool compressed);

/// The records without their wave packets.
std::vector<std::byte> without_packets(std::vector<std::byte> records, const scan::LasHeader& header,
                                       const LasCopy& copy);

}  // namespace surfcast::exporter
