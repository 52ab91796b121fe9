#include "core/media/media_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/assets.hpp"
#include "core/error.hpp"

namespace stillpoint {

const MediaModule& media_module() {
  static const MediaModule& module = []() -> const MediaModule& {
    const std::string path = (modules_folder() / "stillpoint_media.so").string();
    void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    const auto make = library == nullptr
                          ? nullptr
                          : reinterpret_cast<const MediaModule& (*)()>(::dlsym(library, "stillpoint_media"));
    if (make == nullptr)
      throw InputError(
          fmt::format("the module for videos, and for images other than PNG and JPEG, cannot be loaded ({}); "
                      "among Debian packages it is stillpoint-media",
                      ::dlerror()));
    return make();
  }();
  return module;
}

}  // namespace stillpoint
