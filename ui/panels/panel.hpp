#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ui/session/session_view.hpp"

namespace stillpoint {

struct PanelCommand;
struct UiFrame;

/// What a person asks for in a panel; the session carries it out.
struct PanelActions {
  std::optional<int> go_to_frame;        ///< 0 to frame_count - 1
  std::vector<SessionRequest> requests;  ///< in order
  bool compare_frames = false;           ///< FrameView::before is wanted
  std::optional<int> worst_by;  ///< the figure (frame_figure_infos()) that "worst" is to go by from now on
  std::string
      reopen_with;  ///< the sequence anew, with a switch in place of how it was read: "camera=freiburg1"
  std::vector<std::string> perform;  ///< named actions to run, in order
};

/// Design px, of a panel's tile with its heading.
struct PanelSize {
  float width = 0.0F, height = 0.0F;
};

/// One view of the session. What it draws is the same in a window and in an image file.
///
/// It draws its controls, captions, legends and scales; its title is left to whoever gives it a place. It
/// keeps textures of the GL context it was first drawn in, which must be current whenever it is drawn, and
/// when it goes.
class Panel {
 public:
  Panel() = default;
  virtual ~Panel() = default;
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// For layouts, the command line and file names: "forward_mask".
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// For people: "Forward mask".
  [[nodiscard]] virtual const std::string& title() const = 0;
  /// Draws into the current ImGui window or child, filling what is left of it.
  virtual void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) = 0;
  /// In a smaller tile it cannot be read: it shares one with its neighbour then.
  [[nodiscard]] virtual PanelSize least() const { return {270.0F, 180.0F}; }
  /// Whether it shows the frame at hand, and so, while there is one, its preview (with_preview()).
  [[nodiscard]] virtual bool previews() const { return false; }
  /// Whether it shows each frame while they are played, as far as there is time: a picture. Curves and
  /// numbers follow more slowly, for nobody reads them as fast.
  [[nodiscard]] virtual bool keeps_up() const { return previews(); }
  /// Whether what it shows of the frame is a run's, and so can be another run's as well (as_run()).
  [[nodiscard]] virtual bool shows_a_run() const { return false; }
  /// Whether it lists all runs, those too that other panels are not to show.
  [[nodiscard]] virtual bool lists_runs() const { return false; }
  /// One more of its kind, in the same set, for another run's pictures in its place; null where its pictures
  /// cannot be set against others.
  [[nodiscard]] virtual std::unique_ptr<Panel> another() const { return nullptr; }
  /// Panels made by another() so far: where it is drawn of several runs at once, each keeps its own textures.
  std::vector<std::unique_ptr<Panel>> others;
  /// Whether it shows a frame of which the image alone is there (FrameView::image_alone); else it goes on
  /// showing the one before until the rest has come.
  [[nodiscard]] virtual bool shows_image_alone() const { return !previews(); }
  /// Whether there may be anything to show of this sequence: where not, the panel is none of all.
  [[nodiscard]] virtual bool is_for(const SessionView& session) const {
    (void)session;
    return true;
  }
  /// Brings up what has these words in its name, where there is a list to be searched.
  virtual void find(const std::string& words) { (void)words; }
  /// Valid as long as the panel.
  [[nodiscard]] virtual std::vector<PanelCommand> commands();
};

/// All of them, in the order one reads them. Image panels among them zoom and pan together, and tell the
/// inspector which pixel the mouse is on.
[[nodiscard]] std::vector<std::unique_ptr<Panel>> make_panels();

}  // namespace stillpoint
