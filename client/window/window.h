#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "client/window/controls.h"
#include "client/window/decode_picture.h"

namespace surfcast::window {

/// What the hand can do, for a person: lines.
constexpr const char* kWindowHelp =
    "drag: turn\n"
    "right button, Shift: move\n"
    "middle button, Ctrl: look around\n"
    "wheel, + and -: come nearer, go away\n"
    "double click: focus\n"
    "arrows: turn, with Shift move\n"
    "W A S D Q E: fly, with Shift faster\n"
    "1 to 7: front, right, back, left, top, bottom, iso\n"
    "F: fit the model\n"
    "Home: the first view\n"
    "F1: this help\n"
    "Esc: end";

/// A window that shows pictures and passes on what the hand does.
class Window {
 public:
  static Result<Window> open(const std::string& title, int width, int height);
  Window(Window&& other) noexcept;
  Window& operator=(Window&&) = delete;
  ~Window();

  /// Passes on what has happened since the last call. False when the window is to be closed.
  bool take_events(Controls& controls);
  /// Shows a picture, stretched over the window.
  Status show(const PixelImage& image);
  void set_title(const std::string& title);

  /// Pixels of what can be shown.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::window
