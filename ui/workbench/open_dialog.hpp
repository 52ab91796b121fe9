#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/check/findings.hpp"
#include "core/inspect/openable.hpp"
#include "ui/gl/texture.hpp"
#include "ui/shell/canvas.hpp"

namespace stillpoint {

/// What is to be opened, and how.
struct OpenAs {
  std::string where;
  std::vector<std::string> reading{};  ///< as RecentSequence has it
  std::string method{};                ///< empty = the config's
  bool operator==(const OpenAs&) const = default;
};

/// What was found in a place before it is opened.
struct PlaceLook {
  OpenAs of;
  std::string problem{};  ///< why it cannot be opened; empty when it can
  std::vector<SequenceFact> facts{};
  std::vector<Finding> findings{};  ///< of a look at its lists and some images
  cv::Mat picture{};                ///< its first frame, CV_8UC3 or CV_8UC1, small; empty where there is none
};

/// Looks at a place: on a thread of the caller's, since it may take seconds. @param opens as
/// ControllerOptions::open_source, under the config that it is to be run with
[[nodiscard]] PlaceLook look_at_place(const OpenAs& place,
                                      const std::function<struct OpenedSource(const OpenAs&)>& opens);

/// The question what to open: folders to go through, what was found in the one chosen, and how it is read.
class OpenDialog {
 public:
  using Look = std::function<PlaceLook(const OpenAs&)>;  ///< called on a thread of its own

  /// @param look empty: nothing is said of a place before it is opened
  explicit OpenDialog(Look look = {}) : look_at_(std::move(look)) {}
  /// Waits for the place that is being looked at.
  ~OpenDialog() = default;
  OpenDialog(OpenDialog&&) = default;
  OpenDialog& operator=(OpenDialog&&) = default;

  /// Shows it. @param beside a place whose folder is gone through first, where it is one
  /// @param method the one that is chosen at first
  void open(const std::string& beside, const std::string& method);
  [[nodiscard]] bool is_open() const { return open_; }
  /// What is known of the place chosen; null while nothing is.
  [[nodiscard]] const PlaceLook* seen() const { return seen_ ? &*seen_ : nullptr; }

  /// Draws it where it is open. @returns what a person wants opened
  std::optional<OpenAs> draw(UiFrame& frame, const std::vector<std::string>& recent);

 private:
  void go_to(const std::filesystem::path& folder);
  void choose(const std::string& where);
  void take_look(const UiFrame& frame);
  [[nodiscard]] OpenAs wanted() const;
  [[nodiscard]] std::optional<OpenAs> draw_places(const UiFrame& frame,
                                                  const std::vector<std::string>& recent);
  void draw_chosen(const UiFrame& frame);
  void draw_reading(const UiFrame& frame);
  [[nodiscard]] std::optional<OpenAs> accept();

  Look look_at_;
  bool open_ = false, opened_now_ = false;
  std::filesystem::path folder_;
  std::vector<OpenPlace> places_;
  std::string problem_;     // why the folder cannot be gone through
  char path_[1024] = "";    // the place chosen, as it is typed
  int camera_ = 0;          // of known_cameras(), from 1; 0 = as it is found
  int truth_ = 0;           // of other_conventions(), from 1; 0 = as written
  int frames_ = 0;          // 0 = all
  double depth_scale_ = 0;  // 0 = the camera's
  bool inverted_masks_ = false;
  std::string method_;
  bool is_folder_ = false;  // the place chosen is one of others
  std::optional<PlaceLook> seen_;
  std::optional<Texture> picture_;
  std::optional<OpenAs> asked_;     // what was looked at last, or is
  std::future<PlaceLook> looking_;  // last: it ends before what it works with
};

}  // namespace stillpoint
