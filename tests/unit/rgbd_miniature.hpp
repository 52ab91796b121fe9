#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

// Miniatures of RGB-D layouts, with exact truth.

inline constexpr int kMiniatureFrames = 5;
inline constexpr const char* kMiniatureKind = "walking_xyz";

/// The sequence that all miniatures are of, its frames rendered once.
inline const FrameSource& made() {
  static const auto sequence = make_generated_sequence(kMiniatureKind, kMiniatureFrames, 1);
  return *sequence;
}
inline const Frame& original(int i) {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> all;
    for (int k = 0; k < kMiniatureFrames; ++k) all.push_back(made().read(k));
    return all;
  }();
  return frames[static_cast<std::size_t>(i)];
}
inline const FrameTruth& true_of(int i) {
  static const std::vector<FrameTruth> truths = [] {
    std::vector<FrameTruth> all;
    for (int k = 0; k < kMiniatureFrames; ++k) all.push_back(made().truth(k));
    return all;
  }();
  return truths[static_cast<std::size_t>(i)];
}

/// One miniature for all tests of a layout: they copy what they change. Null: the TUM layout.
inline const std::filesystem::path& miniature(const RgbdLayout* layout) {
  static std::map<const RgbdLayout*, std::unique_ptr<TemporaryFolder>> folders;
  static std::map<const RgbdLayout*, std::filesystem::path> paths;
  if (!folders.contains(layout)) {
    folders[layout] = std::make_unique<TemporaryFolder>("miniature");
    paths[layout] = folders[layout]->path();
    write_sequence(made(), paths[layout], {.force = true, .rgbd = layout});
  }
  return paths[layout];
}

/// How a layout's truth is to be read: as it stands, but for those that the program tells the switch of.
inline OpenOptions options_of(const RgbdLayout& layout) {
  OpenOptions options;
  if (&layout == &kBonnLayout) options.truth = PoseConvention::bonn;
  if (&layout == &kIclLayout) options.truth = PoseConvention::mirrored_y;
  return options;
}

inline std::unique_ptr<FrameSource> open(const RgbdLayout& layout) {
  return open_sequence(miniature(&layout).string(), options_of(layout));
}

/// A copy of a miniature that a test may spoil.
struct Spoilt {
  explicit Spoilt(const RgbdLayout& layout) {
    std::filesystem::copy(miniature(&layout), folder.path(), std::filesystem::copy_options::recursive);
  }
  [[nodiscard]] std::string error() const {
    return input_error_of([this] { (void)open(); });
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void remove(const std::string& name) const {
    ASSERT_GT(std::filesystem::remove_all(folder.path(name)), 0U) << name;
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
