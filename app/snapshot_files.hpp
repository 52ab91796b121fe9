#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/painter.hpp"
#include "app/video_file.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {

/// Where pictures go: files one by one with their plots and tables, a video, or both.
class SnapshotFiles {
 public:
  struct Wanted {
    std::string folder{};              ///< empty = no files
    std::vector<std::string> plots{};  ///< "svg": kinds of file for plots and tables; empty = none
    std::string video{};               ///< its file; empty = none
    double fps = 0.0;                  ///< of the video; 0 = frames' own times
    bool force = false;                ///< what is there already is overwritten
  };

  /// @param size px, of a video's pictures @param step_s s between frames, mostly
  /// @throws InputError for a folder or video that cannot be written, or is there already
  SnapshotFiles(Wanted wanted, std::pair<int, int> size, double step_s);

  /// Draws the frame shown. Packed and written beside the drawing of the next one.
  void add(const SessionView& view, Painter& painter);

  [[nodiscard]] int frames() const { return frames_; }

  /// Ends what was begun. @returns what was written, in a sentence each
  [[nodiscard]] std::string finish();

 private:
  void write_plots(const std::string& frame, const Painter::Picture& picture);

  Wanted wanted_;
  std::filesystem::path folder_;
  std::optional<NewFolders> made_;  // gone again where nothing comes to lie in them
  std::optional<VideoFile> video_;
  std::string list_;
  int files_ = 0, plot_files_ = 0, frames_ = 0;
  ImageWriter writer_;
};

}  // namespace stillpoint
