#include "core/run/method_needs.hpp"

#include <fmt/format.h>

#include "core/motion/masks/outside_masks.hpp"
#include "core/motion/methods.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

std::string why_no_masks(const Config& config, const FrameSource& source) {
  if (const std::string why = why_no_outside_masks(config); !why.empty()) return why;
  return method_of(config).needs.true_mask ? why_no_true_masks(source, source.name()) : "";
}

std::string why_no_outside_masks(const Config& config) {
  if (!method_of(config).needs.outside_masks || OutsideMasks(config).any()) return "";
  return fmt::format("method {} removes by masks made elsewhere: name them by --masks DIR|LIST",
                     config.run.method);
}

std::string why_no_true_masks(const FrameSource& source, const std::string& where) {
  if (source.has_masks()) return "";
  const std::string why = source.why_not(FramePart::masks);
  return fmt::format("{}: a method that is given the ground-truth masks needs them, and {}", where,
                     why.empty() ? "there is no mask.txt" : "the masks are of no use: " + why);
}

}  // namespace stillpoint
