#pragma once

#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ui/panels/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

struct PainterOptions {
  std::string panels = "all";                        ///< all, workbench, or names with commas between
  std::pair<int, int> workbench_size = {1600, 900};  ///< px
  std::pair<int, int> panel_size = {960, 780};       ///< px
  Look look{};
  std::string layout{};  ///< the workbench's tiles and what is chosen in each panel, a JSON file; empty = the
                         ///< method's default tiles, and panels as they are by themselves
  std::string method{};  ///< chooses the default layout
  bool stereo = false;   ///< … for stereo pairs
  RunsShown runs{};      ///< which runs pictures show, and how
};

/// Draws panels and the workbench as images, in one GL context for all of them.
class Painter {
 public:
  /// A picture: what it shows, and how it is asked for.
  struct Picture {
    std::string name;  ///< "workbench" or a panel's
    cv::Mat image;     ///< CV_8UC3, BGR
  };

  /// @throws InputError for a panel or a layout that there is not
  explicit Painter(const PainterOptions& options);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Whether `name` is among the pictures chosen.
  [[nodiscard]] bool draws(const std::string& name) const;
  [[nodiscard]] std::size_t picture_count() const {
    return panels_chosen_.size() + (workbench_chosen_ ? 1 : 0);
  }

  /// Of the first of them, px.
  [[nodiscard]] cv::Size picture_size() const {
    const auto [width, height] = workbench_chosen_ ? options_.workbench_size : options_.panel_size;
    return {width, height};
  }

  /// Each picture chosen, of the frame shown.
  [[nodiscard]] std::vector<Picture> paint(const SessionView& view);

  /// Of the layout's choices, those that no control of a panel drawn so far took: misspelt, or of a control
  /// that was not there. "compensated: look=Wip"
  [[nodiscard]] std::vector<std::string> choices_left() const;

  /// One panel for print, without its buttons, whether it was chosen or not. @param size px
  [[nodiscard]] cv::Mat paint_panel(const SessionView& view, const std::string& name,
                                    std::pair<int, int> size);

  /// What `draw` draws, whatever it is. @param size px
  [[nodiscard]] cv::Mat paint_frame(const FrameFunction& draw, std::pair<int, int> size);

 private:
  void choose(const std::string& names);
  void take_choices(const LayoutNode& layout);
  [[nodiscard]] Panel& panel(const std::string& name) const;

  PainterOptions options_;
  Offscreen offscreen_;  // first: the panels' textures live in its context
  std::vector<std::unique_ptr<Panel>> panels_;
  Workbench workbench_;
  RunsShown runs_;  // of panels drawn alone
  bool workbench_chosen_ = false;
  std::vector<Panel*> panels_chosen_;
  std::set<const Panel*> named_;                  // of these, those that were not chosen as one of all
  std::map<const Panel*, PanelChoices> choices_;  // of panels drawn alone
};

/// Writes images beside who draws them: packing takes as long as drawing.
class ImageWriter {
 public:
  /// Begins to write, once fewer than there are processors are being written.
  /// @throws InputError when an earlier one could not be
  void write(const std::filesystem::path& path, const cv::Mat& image);
  /// Waits for all. @throws InputError when one could not be written
  void finish();

 private:
  std::deque<std::future<void>> writing_;
};

/// Writes an image by its name's ending.
/// @throws InputError when it cannot be written whole
void write_image(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace stillpoint
