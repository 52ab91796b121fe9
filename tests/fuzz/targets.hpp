#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::fuzz {

/// Bytes that a parser may hold at once, its input included: so many, and so many for each byte of input.
struct Bound {
  std::size_t base = 0, per_byte = 0;
  [[nodiscard]] std::size_t of(std::size_t input) const { return base + per_byte * input; }
};

/// A parser that is given whatever there may be in a file.
struct Target {
  const char* name;
  Bound bound;
  /// Reads an input. Throws InputError for what is bad, and nothing else whatever it is given.
  void (*read)(std::string_view input);
  /// Small valid inputs, made by the program's own writers or the tests'.
  std::vector<std::string> (*seeds)();
};

/// All of them.
[[nodiscard]] const std::vector<Target>& targets();

// A file of targets each.
[[nodiscard]] std::vector<Target> text_targets();
[[nodiscard]] std::vector<Target> record_targets();
[[nodiscard]] std::vector<Target> bag_targets();
[[nodiscard]] std::vector<Target> archive_targets();
[[nodiscard]] std::vector<Target> image_targets();

/// Whether a target takes an input. What it throws but InputError goes on.
[[nodiscard]] bool accepts(const Target& target, std::string_view input);

/// A file for parsers that read nothing else, in memory where there is such a place: it holds the bytes until
/// the next call with that name. @return its path
[[nodiscard]] std::string file_of(std::string_view bytes, const std::string& name);

/// What `write` puts into a file.
[[nodiscard]] std::string written(const std::string& name,
                                  const std::function<void(const std::string& path)>& write);

/// The folder that these files lie in. It goes away with the process.
[[nodiscard]] const std::string& work_folder();

}  // namespace stillpoint::fuzz
