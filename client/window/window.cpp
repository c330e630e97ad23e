#include "client/window/window.h"

#include <optional>

#include <SDL.h>

namespace surfcast::window {
namespace {

template <typename Handle, void (*destroy)(Handle*)>
struct Destroyer {
  void operator()(Handle* handle) const { destroy(handle); }
};
template <typename Handle, void (*destroy)(Handle*)>
using Owned = std::unique_ptr<Handle, Destroyer<Handle, destroy>>;

tl::unexpected<Error> sdl_failed(const std::string& what) {
  return fail(ErrorKind::kUnavailable, what + ": " + SDL_GetError());
}

/// Initializes SDL, and shuts it down in the destructor.
struct Library {
  bool up = SDL_Init(SDL_INIT_VIDEO) == 0;
  Library() = default;
  ~Library() { SDL_Quit(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

double held(SDL_Scancode key) {
  return SDL_GetKeyboardState(nullptr)[key] != 0 ? 1 : 0;
}

glm::dvec3 course_of_keys() {
  return {held(SDL_SCANCODE_D) - held(SDL_SCANCODE_A), held(SDL_SCANCODE_E) - held(SDL_SCANCODE_Q),
          held(SDL_SCANCODE_W) - held(SDL_SCANCODE_S)};
}

bool shift_held() {
  return (SDL_GetModState() & KMOD_SHIFT) != 0;
}

Controls::Drag drag_of(uint8_t button) {
  const bool control = (SDL_GetModState() & KMOD_CTRL) != 0;
  if (button == SDL_BUTTON_MIDDLE || control) return Controls::Drag::kLook;
  return button == SDL_BUTTON_RIGHT || shift_held() ? Controls::Drag::kPan : Controls::Drag::kOrbit;
}

/// Direction of an arrow key: to the right, up.
std::optional<glm::dvec2> arrow(SDL_Keycode key) {
  switch (key) {
    case SDLK_LEFT:
      return glm::dvec2(-1, 0);
    case SDLK_RIGHT:
      return glm::dvec2(1, 0);
    case SDLK_UP:
      return glm::dvec2(0, 1);
    case SDLK_DOWN:
      return glm::dvec2(0, -1);
    default:
      return std::nullopt;
  }
}

void press(const SDL_MouseButtonEvent& event, Controls& controls) {
  if (event.button == SDL_BUTTON_LEFT && event.clicks == 2) return controls.double_click({event.x, event.y});
  controls.press(drag_of(event.button));
}

void press_key(SDL_Keycode key, Controls& controls) {
  if (key >= SDLK_1 && key <= SDLK_7) return controls.set_standard_view(static_cast<StandardView>(key - SDLK_1));
  if (const auto by = arrow(key)) {
    return controls.nudge(shift_held() ? Controls::Drag::kPan : Controls::Drag::kOrbit, *by);
  }
  switch (key) {
    case SDLK_f:
      return controls.fit();
    case SDLK_HOME:
      return controls.go_home();
    case SDLK_PLUS:
    case SDLK_EQUALS:
    case SDLK_KP_PLUS:
      return controls.step(1);
    case SDLK_MINUS:
    case SDLK_KP_MINUS:
      return controls.step(-1);
    default:
      return;
  }
}

}  // namespace

struct Window::State {
  Library library;
  Owned<SDL_Window, SDL_DestroyWindow> window;
  Owned<SDL_Renderer, SDL_DestroyRenderer> renderer;
  Owned<SDL_Texture, SDL_DestroyTexture> texture;
  int texture_width = 0;
  int texture_height = 0;

  void wheel(const SDL_MouseWheelEvent& event, Controls& controls) const;
  bool take(const SDL_Event& event, Controls& controls);
  void show_help() const;
  void present() const;
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::Window(Window&& other) noexcept = default;
Window::~Window() = default;

Result<Window> Window::open(const std::string& title, int width, int height) {
  auto state = std::make_unique<State>();
  if (!state->library.up) return sdl_failed("there is no display");
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "linear");
  state->window.reset(SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width, height,
                                       SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI));
  if (!state->window) return sdl_failed("cannot open a window");
  state->renderer.reset(SDL_CreateRenderer(state->window.get(), -1, 0));
  if (!state->renderer) return sdl_failed("cannot draw in a window");
  return Window(std::move(state));
}

void Window::State::show_help() const {
  SDL_ShowSimpleMessageBox(SDL_MESSAGEBOX_INFORMATION, "Keys", kWindowHelp, window.get());
}

void Window::State::wheel(const SDL_MouseWheelEvent& event, Controls& controls) const {
  int x = 0;
  int y = 0;
  SDL_GetMouseState(&x, &y);
  controls.wheel(static_cast<double>(event.preciseY), {x, y});
}

bool Window::State::take(const SDL_Event& event, Controls& controls) {
  switch (event.type) {
    case SDL_QUIT:
      return false;
    case SDL_KEYDOWN:
      if (event.key.keysym.sym == SDLK_ESCAPE) return false;
      if (event.key.keysym.sym == SDLK_F1) show_help();
      press_key(event.key.keysym.sym, controls);
      break;
    case SDL_MOUSEBUTTONDOWN:
      press(event.button, controls);
      break;
    case SDL_MOUSEBUTTONUP:
      controls.release();
      break;
    case SDL_MOUSEMOTION:
      controls.move({event.motion.xrel, event.motion.yrel});
      break;
    case SDL_MOUSEWHEEL:
      wheel(event.wheel, controls);
      break;
    case SDL_WINDOWEVENT:
      present();
      break;
    default:
      break;
  }
  return true;
}

void Window::State::present() const {
  SDL_RenderClear(renderer.get());
  if (texture) SDL_RenderCopy(renderer.get(), texture.get(), nullptr, nullptr);
  SDL_RenderPresent(renderer.get());
}

bool Window::take_events(Controls& controls) {
  int logical_width = 0;
  int logical_height = 0;
  SDL_GetWindowSize(state_->window.get(), &logical_width, &logical_height);
  controls.resize(logical_width, logical_height);
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    if (!state_->take(event, controls)) return false;
  }
  controls.fly(course_of_keys(), shift_held());
  return true;
}

Status Window::show(const PixelImage& image) {
  if (!state_->texture || state_->texture_width != image.width || state_->texture_height != image.height) {
    state_->texture.reset(SDL_CreateTexture(state_->renderer.get(), SDL_PIXELFORMAT_BGRA32, SDL_TEXTUREACCESS_STREAMING,
                                            image.width, image.height));
    if (!state_->texture) return sdl_failed("cannot show a picture");
    SDL_SetTextureBlendMode(state_->texture.get(), SDL_BLENDMODE_NONE);
    state_->texture_width = image.width;
    state_->texture_height = image.height;
  }
  SDL_UpdateTexture(state_->texture.get(), nullptr, image.pixels.data(), image.width * 4);
  state_->present();
  return {};
}

void Window::set_title(const std::string& title) {
  SDL_SetWindowTitle(state_->window.get(), title.c_str());
}

int Window::width() const {
  int width = 0;
  SDL_GetRendererOutputSize(state_->renderer.get(), &width, nullptr);
  return width;
}

int Window::height() const {
  int height = 0;
  SDL_GetRendererOutputSize(state_->renderer.get(), nullptr, &height);
  return height;
}

}  // namespace surfcast::window
