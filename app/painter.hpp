#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
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
  bool offers = false;   ///< pictures come with the plots and tables they hold
};

/// Which pictures options ask for: known before anything is opened or drawn.
struct PictureChoice {
  bool workbench = false;
  std::vector<std::string> panels{};  ///< in the order they are drawn in
  std::set<std::string> named{};      ///< of these, those that were not chosen as one of all
  std::optional<LayoutNode> layout{};

  [[nodiscard]] std::size_t count() const { return panels.size() + (workbench ? 1 : 0); }
  /// Whether `name` is among them.
  [[nodiscard]] bool draws(const std::string& name) const;
};

/// @throws InputError for a panel or a layout that there is not
[[nodiscard]] PictureChoice choose_pictures(const PainterOptions& options);

/// Draws panels and the workbench as images, in one GL context for all of them.
class Painter {
 public:
  /// A picture: what it shows, and how it is asked for.
  struct Picture {
    std::string name;                 ///< "workbench" or a panel's
    cv::Mat image;                    ///< CV_8UC3, BGR
    std::vector<FileOffer> offers{};  ///< plots and tables in it, where options ask for them
  };

  /// @throws InputError as choose_pictures does
  explicit Painter(const PainterOptions& options) : Painter(options, choose_pictures(options)) {}
  Painter(const PainterOptions& options, PictureChoice chosen);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Each picture chosen, of the frame shown; given to `done` as soon as it is drawn.
  void paint(const SessionView& view, const std::function<void(const Picture&)>& done);

  /// Of the layout's choices, those that no control of a panel drawn so far took: misspelt, or of a control
  /// that was not there. "compensated: look=Wip"
  [[nodiscard]] std::vector<std::string> choices_left() const;

  /// One panel for print, without its buttons, whether it was chosen or not. @param size px
  [[nodiscard]] cv::Mat paint_panel(const SessionView& view, const std::string& name,
                                    std::pair<int, int> size);

  /// What `draw` draws, whatever it is. @param size px
  [[nodiscard]] cv::Mat paint_frame(const FrameFunction& draw, std::pair<int, int> size);

 private:
  /// paint_frame() of what `draw` draws, with its plots and tables.
  [[nodiscard]] Picture paint_picture(const std::string& name, const FrameFunction& draw,
                                      std::pair<int, int> size);
  void take_choices(const LayoutNode& layout);
  [[nodiscard]] Panel& panel(const std::string& name) const;

  PainterOptions options_;
  Offscreen offscreen_;  // first: the panels' textures live in its context
  std::vector<std::unique_ptr<Panel>> panels_;
  Workbench workbench_;
  PictureChoice chosen_;
  RunsShown runs_;                                // of panels drawn alone
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
