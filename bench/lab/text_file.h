#pragma once

#include <filesystem>
#include <string>

namespace surfcast::lab {

/// The whole text of a file; empty if it cannot be read.
std::string content_of(const std::filesystem::path& path);
/// Ends the program with a message if the file cannot be written.
void write_or_exit(const std::filesystem::path& path, const std::string& content);

}  // namespace surfcast::lab
