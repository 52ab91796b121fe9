#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/inspect/frame_verdict.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/session/actions.hpp"
#include "ui/session/session_view.hpp"
#include "ui/session/shown_runs.hpp"
#include "ui/shell/canvas.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/workbench/layout.hpp"
#include "ui/workbench/open_dialog.hpp"
#include "ui/workbench/palette.hpp"

namespace stillpoint {

/// Design px, between tiles.
inline constexpr float kTileGap = 5.0F;

/// What the workbench has done by whoever runs it. Functions left empty are not offered, as in images.
struct WorkbenchHost {
  std::function<void(int)> go_to_frame{};
  std::function<void(int)> step{};  ///< so many frames on from the one asked for last
  std::function<void(bool)> play{};
  std::function<void(double)> speed{};             ///< frames a second, while playing
  std::function<void(const std::string&)> open{};  ///< a folder or generated:KIND, as it was left
  std::function<void(const OpenAs&)> open_as{};    ///< the same, read as it says
  OpenDialog::Look look{};                         ///< what is in a place; called on threads of its own
  /// The sequence that is open, anew from its files; with a switch in place of how it was read, unless empty.
  std::function<void(const std::string& with)> reopen{};
  std::function<void(SessionRequest)> request{};  ///< what panels ask of the session
  std::function<void(bool)> compare{};            ///< whether FrameView::before is wanted; told each frame
  std::function<void(bool)> baseline{};           ///< whether pictures of the baseline are; told each frame
};

/// The whole interface: menus, toolbar, tiles with panels, status bar, palette, shortcut sheet, start page.
/// One function draws it in a window and offscreen alike. Panels keep textures of the GL context it was first
/// drawn in, which must be current when it goes.
class Workbench {
 public:
  explicit Workbench(std::vector<std::unique_ptr<Panel>> panels, WorkbenchHost host = {});

  /// Draws everything. Without a session it shows the start page.
  void draw(UiFrame& frame, const SessionView* session);
  /// The same for a session that goes on: when it shows another frame, or is another, tiles take to it in
  /// turn, some with each frame of the interface and pictures first, so that none takes long. While it plays,
  /// what need not keep up (Panel::keeps_up()) takes to it ten times a second.
  void draw_in_turn(UiFrame& frame, std::shared_ptr<const SessionView> session);
  /// Whether every tile shows what was given last.
  [[nodiscard]] bool is_level() const { return level_; }

  /// Draws one panel with a heading of its own over the whole frame.
  static void draw_alone(UiFrame& frame, const SessionView& session, Panel& panel);
  /// The same with choices for its controls.
  static void draw_alone(UiFrame& frame, const SessionView& session, Panel& panel, PanelChoices& choices);

  /// Which runs pictures show, and how.
  [[nodiscard]] const RunsShown& runs() const { return runs_; }
  void set_runs(RunsShown runs) { runs_ = std::move(runs); }

  /// The tiles, with what is chosen in each panel.
  [[nodiscard]] LayoutNode layout() const;
  void set_layout(LayoutNode layout);
  [[nodiscard]] const std::string& maximised() const { return maximised_; }

  /// Says something in the status bar until something else is said, and in the log. An error stands over the
  /// panels too until it is put away.
  void say(std::string message, bool error = false);
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] const EventLog& log() const { return log_; }

  /// A sequence that is being opened, as a notice over what is shown; empty ends it.
  void set_opening(std::string where) { opening_ = std::move(where); }

  /// Where a panel was drawn last, px; nothing where it is not seen, as behind another's tab.
  [[nodiscard]] std::optional<LayoutRect> tile_of(const std::string& panel) const;

  /// The tiles drawn last, with those that share a place.
  [[nodiscard]] const std::vector<PlacedPanel>& places() const { return places_; }

  /// A fact about what is shown, by name, for recordings that expect one: "frame", "panels", "theme", …;
  /// nothing for a name there is not.
  [[nodiscard]] std::optional<std::string> fact(const std::string& what, const SessionView* session) const;
  [[nodiscard]] static std::string fact_names();

  /// Sequences opened before, newest first, for menu and start page.
  void set_recent(std::vector<std::string> recent) { recent_ = std::move(recent); }

  [[nodiscard]] const Actions& actions() const { return actions_; }
  /// Has something run at the beginning of the next frame drawn, as a key would.
  void before_next_frame(std::function<void()> run) { before_frame_ = std::move(run); }
  [[nodiscard]] std::vector<std::string> panel_names() const;
  [[nodiscard]] bool palette_open() const { return palette_.open; }
  [[nodiscard]] bool shortcuts_open() const { return shortcuts_open_; }

 private:
  struct Palette {
    bool open = false, opened_now = false;
    bool takes_keys = false;  ///< its field is given the keyboard again
    char query[128] = "";
    int chosen = 0;
  };
  /// A question for a path.
  struct PathDialog {
    bool open = false, opened_now = false;
    char path[1024] = "";
  };

  void add_actions();
  void add_playback_actions();
  void add_view_actions();
  void add_panel_actions();
  void add_panel_command(const std::string& panel, PanelCommand command);
  void add_layout_actions();
  void add_debug_actions();
  void add_mark_actions();
  void add_run_actions();
  void go_to(int frame);
  void step(int by);
  void ask(SessionRequest request);
  void toggle_bookmark();
  void tell_notice();
  void tell_refused(const Action* refused);
  [[nodiscard]] const std::vector<int>& worst();
  void toggle_panel(const std::string& name);
  void scale_by(float factor);
  [[nodiscard]] bool can_go() const { return session_ != nullptr && host_.go_to_frame; }
  [[nodiscard]] Panel* find_panel(const std::string& name) const;

  void draw_menu_bar();
  void draw_menu_row();
  void draw_toolbar();
  void draw_verdict();
  void draw_transport();
  void draw_frame_slider(float width);
  void draw_speed();
  void draw_status_bar(float height);
  void draw_tiles(const LayoutRect& area);
  void draw_splitters(const PlacedLayout& placed);
  void take_turns(const std::vector<PlacedPanel>& placed);
  [[nodiscard]] std::vector<const PlacedPanel*> waiting_tiles(const std::vector<PlacedPanel>& placed);
  [[nodiscard]] bool keeps_up(const PlacedPanel& tile) const;
  [[nodiscard]] const SessionView& view_of(const std::string& tile) const;
  [[nodiscard]] bool has_view(const std::string& tile) const;
  void draw_tile(const PlacedPanel& tile);
  [[nodiscard]] PlacedLayout placed_tiles(const LayoutRect& area) const;
  void bring_to_front(const std::string& panel);
  void next_tab();
  [[nodiscard]] bool is_behind(const std::string& panel) const;
  [[nodiscard]] const SessionView& previewed(const SessionView& session);
  [[nodiscard]] const SessionView& visible(const SessionView& session, const Panel& panel);
  void draw_tile_heading(Panel& panel, const PlacedPanel& tile, float height);
  void draw_tabs(const PlacedPanel& tile, float height, float width);
  void draw_tile_menu(const std::string& name);
  void draw_palette();
  void draw_palette_list();
  [[nodiscard]] std::vector<PaletteRow> palette_rows();
  void add_run_rows(std::vector<PaletteRow>& rows);
  void add_picture_rows(std::vector<PaletteRow>& rows);
  void add_parameter_rows(std::vector<PaletteRow>& rows);
  void show_parameter(const std::string& key);
  void draw_shortcuts();
  void draw_shortcut_list(int columns) const;
  [[nodiscard]] bool ask_for_path(PathDialog& dialog, const char* title, const char* what,
                                  const char* button);
  void draw_open_dialog();
  void draw_hand_on_dialog();
  void draw_save_dialog();
  void draw_exporting();
  void draw_start_page(const LayoutRect& area);
  void draw_opening();
  void draw_error();
  void follow_session();
  void remember_layout();
  void carry_out(const PanelActions& wanted);
  bool action_button(const char* name);

  std::vector<std::unique_ptr<Panel>> panels_;
  WorkbenchHost host_;
  Actions actions_;
  LayoutNode layout_ = default_layout();
  std::optional<LayoutNode> layout_seen_;   // when nobody was changing it last
  std::vector<LayoutNode> layouts_before_;  // what it was, the last at the end
  LayoutRect tiles_area_{};
  std::string maximised_, hovered_panel_;
  std::string message_;
  bool message_is_error_ = false, error_open_ = false;
  EventLog log_;
  std::string opening_, last_trouble_;
  std::map<std::string, PanelChoices> choices_;
  RunsShown runs_;
  std::map<std::string, LayoutRect> tiles_;  ///< of the last frame drawn
  std::vector<PlacedPanel> places_;          ///< … with the tabs that share them
  std::vector<std::string> fronts_;          ///< tabs that were brought to the front, the last at the end
  Look look_;
  double time_s_ = 0.0, said_s_ = 0.0;
  std::vector<std::string> recent_;
  Palette palette_;
  OpenDialog open_dialog_;
  PathDialog hand_on_dialog_, save_dialog_;
  std::optional<FileOffer> offered_, saving_;  // by what is drawn; what the save dialog is for
  bool shortcuts_open_ = false;
  double speed_ = 30.0;  // frames a second

  // What "worst" goes by, when a person has chosen; and the list it gave last.
  struct WorstKey {
    const RunView* run = nullptr;
    std::uint64_t revision = 0;
    std::size_t records = 0;
    int figure = 0;
    bool operator==(const WorstKey&) const = default;
  };
  // The verdict drawn last, and of what.
  struct VerdictKey {
    const RunView* run = nullptr;
    std::uint64_t revision = 0;
    std::size_t records = 0, row = 0;
    bool operator==(const VerdictKey&) const = default;
  };
  VerdictKey verdict_key_;
  FrameVerdict verdict_;
  std::optional<int> worst_by_;
  WorstKey worst_key_;
  std::vector<int> worst_;
  std::optional<int> worst_gone_to_;  // the frame that list was last gone to
  std::string notice_;                // of the session, told last
  struct Refused {
    std::string action, told;
    int frame = 0;  // that was shown
  };
  std::optional<Refused> refused_;  // while the status bar says why

  // For the frame of the interface being drawn only.
  UiFrame* frame_ = nullptr;
  const SessionView* session_ = nullptr;
  std::shared_ptr<const SessionView> turning_to_;  // what tiles take to in turn; null: all have the session
  std::unique_ptr<const SessionView> previewed_;   // as panels of the frame shown draw its preview
  std::map<const SessionView*, std::unique_ptr<const SessionView>> visible_;  // without hidden runs
  bool compare_frames_ = false;                       // whether a panel drawn wants the frame before
  std::function<void()> before_frame_, after_frame_;  // what would change the layout while it is drawn

  /// What a tile shows while others have their turn.
  struct TileView {
    std::shared_ptr<const SessionView> view;  // null until its first turn with another sequence
    long taken = 0;                           // the frame of the interface it was taken in …
    double taken_s = -std::numeric_limits<double>::infinity();  // … and its time
  };
  std::map<std::string, TileView> tile_views_;
  long drawn_ = 0;  // frames of the interface
  bool level_ = true;
  double next_turn_s_ = 0.0;  // until the next tile has its turn, where not all are level

  // How fast frames go by while playing.
  struct Pace {
    int begun_at = 0, shown = 0, dropped = 0;  // frames
    double begun_s = 0.0, seconds = 0.0;
  };
  void follow_play();
  [[nodiscard]] std::string pace_text() const;
  std::optional<Pace> pace_;  // of what is played; nothing while nothing is
  int last_dropped_ = 0;      // when it was played last
  int last_shown_ = -1;
};

/// Begins an overlay centred in x, its top at a share of the height; ImGui::End() ends it.
bool begin_overlay(const UiFrame& frame, const char* name, ImVec2 size, float top_share);

/// Draws `text` in small type at most `width` px wide, cut with an ellipsis.
void draw_clipped_text(ImVec2 at, const std::string& text, float width, ImU32 colour);

}  // namespace stillpoint
