#include "gl/egl_context.h"

#include <array>
#include <string_view>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace surfcast::gl {
namespace {

constexpr EGLint kNoAttributes[] = {EGL_NONE};

bool has_word(const char* list, std::string_view word) {
  return list != nullptr && (" " + std::string(list) + " ").find(" " + std::string(word) + " ") != std::string::npos;
}

/// Uses the EXT entry point: libepoxy 1.5 resolves eglGetPlatformDisplay only once a display exists.
EGLDisplay platform_display(EGLenum platform, void* native) {
  EGLDisplay display = eglGetPlatformDisplayEXT(platform, native, kNoAttributes);
  if (display == EGL_NO_DISPLAY) return EGL_NO_DISPLAY;
  return eglInitialize(display, nullptr, nullptr) ? display : EGL_NO_DISPLAY;
}

std::vector<EGLDeviceEXT> egl_devices() {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_word(client, "EGL_EXT_device_enumeration") && !has_word(client, "EGL_EXT_device_base")) return {};
  std::array<EGLDeviceEXT, 64> devices{};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) return {};
  // Not in braces: a pointer to a device would do for a device, which is a pointer to anything.
  return std::vector<EGLDeviceEXT>(devices.begin(), devices.begin() + count);
}

bool is_software_device(EGLDeviceEXT device) {
  return has_word(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

/// A context that tells of a reset of the GPU (device_status.h), or one that does not where there is no such thing.
EGLContext new_context(EGLDisplay display) {
  std::array<EGLint, 9> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                      4,
                                      EGL_CONTEXT_MINOR_VERSION,
                                      5,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                      EGL_LOSE_CONTEXT_ON_RESET,
                                      EGL_NONE};
  const EGLContext telling = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  if (telling != EGL_NO_CONTEXT) return telling;
  attributes[6] = EGL_NONE;
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
}

/// Makes a context on `display` current without a surface. EGL_NO_CONTEXT on failure.
EGLContext current_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  EGLContext context = new_context(display);
  if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
  eglDestroyContext(display, context);
  return EGL_NO_CONTEXT;
}

struct Opened {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

Opened open_on(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY) return {};
  EGLContext context = current_context(display);
  if (context != EGL_NO_CONTEXT) return {display, context};
  eglTerminate(display);
  return {};
}

Opened open_device(EGLDeviceEXT device) {
  return open_on(platform_display(EGL_PLATFORM_DEVICE_EXT, device));
}

Opened open_first_that_works(const std::vector<EGLDeviceEXT>& devices) {
  for (EGLDeviceEXT device : devices) {
    if (is_software_device(device)) continue;
    if (Opened opened = open_device(device); opened.context != EGL_NO_CONTEXT) return opened;
  }
  return open_on(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY));
}

bool is_software_renderer(std::string_view renderer) {
  for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"}) {
    if (renderer.find(name) != std::string_view::npos) return true;
  }
  return false;
}

std::string gl_string(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

}  // namespace

Result<std::unique_ptr<EglContext>> EglContext::create(int gpu) {
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  Opened opened;
  if (gpu < 0) {
    opened = open_first_that_works(devices);
  } else if (static_cast<size_t>(gpu) < devices.size()) {
    opened = open_device(devices[static_cast<size_t>(gpu)]);
  } else {
    return fail(ErrorKind::kUnavailable, "no GPU " + std::to_string(gpu) + ": EGL lists " +
                                             std::to_string(devices.size()) + " device(s), counted from 0");
  }
  if (opened.context == EGL_NO_CONTEXT) {
    return fail(ErrorKind::kUnavailable,
                "EGL gives no OpenGL 4.5 core context (is a driver, or Mesa's libegl-mesa0, installed?)");
  }
  return std::unique_ptr<EglContext>(new EglContext(opened.display, opened.context));
}

size_t EglContext::devices() {
  return egl_devices().size();
}

EglContext::EglContext(void* display, void* context)
    : display_(display),
      context_(context),
      vendor_(gl_string(GL_VENDOR)),
      renderer_(gl_string(GL_RENDERER)),
      version_(gl_string(GL_VERSION)),
      software_(is_software_renderer(renderer_)) {}

EglContext::~EglContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

}  // namespace surfcast::gl
