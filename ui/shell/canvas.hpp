#pragma once

#include <imgui.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/gl/framebuffer.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/shell/graphics_context.hpp"
#include "ui/shell/input.hpp"
#include "ui/shell/ui_pace.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {

class ImGuiRenderer;
class PanelChoices;
class PictureStrips;
struct RunsShown;

/// ImGui lays new windows out over two frames, so what has changed is drawn this many times.
inline constexpr int kSettlingFrames = 3;

/// How the interface looks, in a window and in images alike.
struct Look {
  ThemeName theme = ThemeName::kDark;
  float scale = 1.0F;  ///< times the design size of text and spacing, 0.5 to 4
  bool operator==(const Look&) const = default;
};

/// Something shown that a person wants as a file.
struct FileOffer {
  std::string name;     ///< of the file, as it is proposed: "errors.svg"
  std::string endings;  ///< its file may have, for people: ".svg, .pdf or .csv"
  std::function<void(const std::string& path)> write;  ///< @throws InputError
};

/// What a frame function works with, and what it may ask of the shell in return.
struct UiFrame {
  const Gl& gl;
  const Fonts& fonts;
  const Theme& theme;
  ImVec2 size;                                ///< px, of the whole
  float scale = 1.0F;                         ///< px a design pixel: multiply lengths by it
  double time_s = 0.0;                        ///< of the interface's own clock; offscreen it ticks by frames
  bool controls = true;                       ///< false in pictures for print: panels leave out their buttons
  std::vector<std::string> dropped_files{};   ///< since the frame before
  bool close_requested = false;               ///< the person closes the window
  const UiPace* pace = nullptr;               ///< how fast the interface is; null where nobody measures
  const EventLog* log = nullptr;              ///< what was said; null where nothing is
  PanelChoices* choices = nullptr;            ///< of the panel being drawn; null where none are kept
  RunsShown* runs = nullptr;                  ///< which runs pictures show; null: the session's own
  PictureStrips* strips = nullptr;            ///< while pictures of several runs are drawn; null mostly
  std::optional<FileOffer>* offer = nullptr;  ///< where what is to be saved is put; null where nothing can be
  bool busy = false;                          ///< work goes on beside the interface: its pace counts
  Look wanted_look{};                         ///< from the next frame on
  double redraw_after_s = std::numeric_limits<double>::infinity();  ///< draw again by then even without input
  bool quit = false;                                                ///< leave the shell's loop
  bool changed = true;  ///< the picture is another than that of the frame before; known once it is drawn
};

/// Draws one frame of the interface through ImGui, whose context is current.
using FrameFunction = std::function<void(UiFrame&)>;

/// ImGui over one GL context: its state, fonts, theme and input. Window and Offscreen each have one, so that
/// both draw by the same way.
class Canvas {
 public:
  /// The GL context of `get_proc_address` must be current, here, in every call and in the destructor.
  Canvas(const GetProcAddress& get_proc_address, const Look& look);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Builds a frame of the target's size and brings the target from the frame drawn into it last to this one.
  /// Nothing else may draw into it between, or it is to be another.
  /// @returns the frame with what `function` asked for
  UiFrame frame(const Framebuffer& target, double delta_s, const FrameFunction& function,
                bool close_requested = false);

  /// The same without drawing: what was sent is taken, and windows find their sizes.
  UiFrame frame_unseen(int width, int height, double delta_s, const FrameFunction& function);

  void send(InputEvent event) { input_.push(std::move(event)); }

  /// Told each event when the interface takes it, for recordings; empty tells nobody.
  void set_listener(std::function<void(const InputEvent&)> listener) { listener_ = std::move(listener); }

  /// What the shell measured of its last frame.
  void note_pace(double ms) { pace_.add(ms, was_busy_); }
  [[nodiscard]] double time_s() const { return time_s_; }  ///< of the interface's clock
  [[nodiscard]] const UiPace& pace() const { return pace_; }
  [[nodiscard]] bool has_pending_input() const { return !input_.empty(); }

  /// Factor the display itself asks for, over Look::scale.
  void set_display_scale(float scale) { display_scale_ = scale; }

  [[nodiscard]] const Look& look() const { return look_; }
  void set_look(const Look& look) { look_ = look; }

  [[nodiscard]] const Gl& gl() const { return *gl_; }
  [[nodiscard]] ImGuiContext& imgui() const { return *imgui_; }

  /// What GL complained about since the last call.
  [[nodiscard]] std::vector<std::string> take_gl_errors() { return errors_->take(); }

 private:
  void dress();
  UiFrame build(int width, int height, double delta_s, const FrameFunction& function, bool close_requested);
  std::vector<std::string> take_input();

  std::unique_ptr<Gl> gl_;
  std::unique_ptr<GlErrorLog> errors_;
  ImGuiContext* imgui_ = nullptr;
  std::unique_ptr<ImGuiRenderer> renderer_;
  InputQueue input_;
  std::function<void(const InputEvent&)> listener_;
  UiPace pace_;
  bool was_busy_ = false;
  Fonts fonts_;
  Look look_;
  float display_scale_ = 1.0F;
  float dressed_scale_ = 0.0F;
  ThemeName dressed_theme_ = ThemeName::kDark;
  double time_s_ = 0.0;
};

}  // namespace stillpoint
