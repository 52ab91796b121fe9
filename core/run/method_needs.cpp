#include "core/run/method_needs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

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

std::string why_no_mask_fits(const Config& config, const FrameSource& source) {
  constexpr int kMostFrames = 60;  // evenly chosen: masks of a sixtieth of the frames, in one piece, are met
  const OutsideMasks outside(config);
  if (!outside.any() || !outside.problem().empty()) return "";
  const int count = std::min(kMostFrames, source.size());
  std::string first;
  for (int i = 0; i < count; ++i) {
    const Frame frame = source.read(count == 1 ? 0 : i * (source.size() - 1) / (count - 1));
    if (!frame.readable()) continue;
    const auto found = outside.read(frame);
    if (!found->mask.empty()) return "";
    if (first.empty())
      first = fmt::format("frame {}, {}{:.3f} s: {}", frame.index,
                          frame.name.empty() ? "" : fmt::format("named '{}', ", frame.name), frame.timestamp,
                          found->problem);
  }
  if (first.empty()) return "";  // no frame can be read: that is told elsewhere
  return fmt::format("{}: none of {} frames looked at has a mask that can be used ({}). {}", source.name(),
                     count, first, fmt::join(outside.namings(), "; "));
}

}  // namespace stillpoint
