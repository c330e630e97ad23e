#include <iostream>
#include <string>

#include "cmd/commands.h"
#include "gl/egl_context.h"

namespace surfcast::cmd {
namespace {

/// One line for a device: its number, what it is, and its name or why it cannot be used.
std::string line_of(size_t device) {
  const Result<std::unique_ptr<gl::EglContext>> context = gl::EglContext::create(static_cast<int>(device));
  std::string line = std::to_string(device) + ' ';
  if (!context) return line + "unusable: " + context.error().message;
  line += (*context)->software() ? "software" : kHardwareDevice;
  return line + ": " + (*context)->renderer() + ", OpenGL " + (*context)->version();
}

Status list_gpus() {
  const size_t count = gl::EglContext::devices();
  for (size_t device = 0; device < count; ++device) std::cout << line_of(device) << std::endl;
  if (count == 0) std::cout << "EGL lists no devices; pictures are drawn on its default display\n";
  return {};
}

}  // namespace

void add_gpus_command(CLI::App& app, Status& outcome) {
  app.add_subcommand(kGpusCommand, "List the devices that --gpu names")->callback([&outcome] {
    outcome = list_gpus();
  });
}

}  // namespace surfcast::cmd
