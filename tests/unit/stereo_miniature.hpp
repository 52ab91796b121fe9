#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

inline constexpr int kStereoFrames = 5;  ///< of a miniature

/// One miniature for all tests of a layout: they copy what they change.
inline const std::filesystem::path& miniature(SequenceLayout layout) {
  static std::map<SequenceLayout, std::unique_ptr<TemporaryFolder>> made;
  static std::map<SequenceLayout, std::filesystem::path> paths;
  if (!made.contains(layout)) {
    made[layout] = std::make_unique<TemporaryFolder>("miniature");
    paths[layout] = made[layout]->path();
    write_sequence(*make_generated_sequence("walking_xyz:stereo", kStereoFrames, 1), paths[layout],
                   {.force = true, .layout = layout});
  }
  return paths[layout];
}

/// A copy of a miniature that a test may spoil.
struct Spoilt {
  explicit Spoilt(SequenceLayout layout) {
    std::filesystem::copy(miniature(layout), folder.path(), std::filesystem::copy_options::recursive);
  }
  [[nodiscard]] std::string error() const {
    return input_error_of([this] { (void)open_sequence(folder.path()); });
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void remove(const std::string& name) const { std::filesystem::remove_all(folder.path(name)); }
  void rename(const std::string& from, const std::string& to) const {
    std::filesystem::rename(folder.path(from), folder.path(to));
  }
  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = folder.read(file);
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << file << " has no " << what;
    folder.write(file, text.replace(at, what.size(), by));
  }
  TemporaryFolder folder{"spoilt"};
};

}  // namespace stillpoint
