#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "client/window/controls.h"
#include "client/window/decode_picture.h"

namespace surfcast::window {

/// Help text of the mouse and key controls.
constexpr const char* kWindowHelp =
    "drag: orbit\n"
    "drag with right button or Shift: pan\n"
    "drag with middle button or Ctrl: look around\n"
    "wheel, + and -: zoom\n"
    "double click: centre on a point\n"
    "arrow keys: orbit; with Shift: pan\n"
    "W A S D Q E: fly; with Shift: faster\n"
    "1 to 7: front, right, back, left, top, bottom, iso\n"
    "F: fit the model\n"
    "Home: the initial view\n"
    "F1: this help\n"
    "Esc: quit";

/// A window that shows pictures and reports mouse and key input.
class Window {
 public:
  static Result<Window> open(const std::string& title, int width, int height);
  Window(Window&& other) noexcept;
  Window& operator=(Window&&) = delete;
  ~Window();

  /// Applies the input since the last call to `controls`. False when the user closes the window.
  bool take_events(Controls& controls);
  /// Shows a picture, scaled to the window.
  Status show(const PixelImage& image);
  void set_title(const std::string& title);

  /// Size of the drawable area, pixels.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::window
