#include "core/run/method_needs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/counted.hpp"
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
  const OutsideMasks outside(config);
  if (!outside.any() || !outside.problem().empty()) return "";
  std::string first;
  const auto fits = [&](int index) {
    const Frame frame = source.read(index);
    if (!frame.readable()) return false;
    const auto found = outside.read(frame);
    if (found->mask.empty() && first.empty())
      first = fmt::format("frame {}, {}{:.3f} s: {}", frame.index,
                          frame.name.empty() ? "" : fmt::format("named '{}', ", frame.name), frame.timestamp,
                          found->problem);
    return !found->mask.empty();
  };
  // Usually one of few frames has one; that none has is said when all were asked.
  constexpr int kFew = 60;
  const int step = std::max(1, source.size() / kFew);
  for (int i = 0; i < source.size(); i += step)
    if (fits(i)) return "";
  for (int i = 0; i < source.size(); ++i)
    if (i % step != 0 && fits(i)) return "";
  if (first.empty()) return "";  // no frame can be read: that is told elsewhere
  return fmt::format("{}: none of {} has a mask that can be used ({}). {}", source.name(),
                     counted(source.size(), "frame"), first, fmt::join(outside.namings(), "; "));
}

}  // namespace stillpoint
