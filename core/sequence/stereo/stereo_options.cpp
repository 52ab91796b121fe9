#include "core/sequence/stereo/stereo_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr int kFewest = 16, kMost = 512;  // px, of disparities

int disparities_from(const std::string& value, const std::string& option) {
  const auto number = parse_number(value);
  const int whole = number && *number >= kFewest && *number <= kMost ? static_cast<int>(*number) : 0;
  if (whole == 0 || whole != *number || whole % kDisparityStep != 0)
    throw InputError(fmt::format("{}: disparities={} is no multiple of {} from {} to {}", option, value,
                                 kDisparityStep, kFewest, kMost));
  return whole;
}

/// Which of two words a value is. @returns whether it is the first
bool one_of(const std::string& key, const std::string& value, const char* yes, const char* no,
            const std::string& option) {
  if (value != yes && value != no)
    throw InputError(fmt::format("{}: {} takes {} or {}, not {}", option, key, yes, no, in_quotes(value)));
  return value == yes;
}

}  // namespace

std::string to_text(const StereoOptions& options) {
  std::string text;
  const auto add = [&text](const std::string& part) {
    if (!text.empty()) text += ',';
    text += part;
  };
  if (options.half) add("size=half");
  if (options.disparities > 0) add(fmt::format("disparities={}", options.disparities));
  if (!options.left_right_check) add("check=off");
  return text;
}

StereoOptions stereo_options_from(const std::string& text, const std::string& option) {
  StereoOptions options;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals),
                      value = equals == std::string::npos ? "" : part.substr(equals + 1);
    if (key == "size")
      options.half = one_of(key, value, "half", "full", option);
    else if (key == "disparities")
      options.disparities = disparities_from(value, option);
    else if (key == "check")
      options.left_right_check = one_of(key, value, "on", "off", option);
    else
      throw InputError(fmt::format("{}: {} is none of size=full|half, disparities=N and check=on|off", option,
                                   in_quotes(part)));
  }
  return options;
}

}  // namespace stillpoint
