#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "client/window/controls.h"
#include "client/window/decode_picture.h"

namespace surfcast {

/// What the hand can do, for a person.
constexpr const char* kWindowHelp =
    "drag to turn, right button or Shift to move, wheel or + and - to come nearer, double click to focus, middle "
    "button "
    "or Ctrl to look around, W A S D Q E to fly (Shift: faster), arrows to turn, 1 to 7 for front, right, back, left, "
    "top, bottom and iso, F to fit the model, Home for the first view, F1 for this, Esc to end";

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

}  // namespace surfcast
