#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/worst_frames.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/row_window.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/panels/timeline_rows.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

constexpr double kWheelFactor = 1.2;       // times the range, a notch of the wheel
constexpr double kLeastFrames = 4.0;       // in sight when zoomed in furthest
constexpr float kRoomForControls = 95.0F;  // design px, height of the panel
constexpr float kLeastLane = 20.0F;        // design px of a lane: a curve can still be read
constexpr float kGrip = 5.0F;              // design px about an end of the range
constexpr std::size_t kWorstShown = 5;     // frames that are marked: more would hide the rest

std::string earlier(const char* what) { return std::string(icons::kChevronLeft) + "  " + what; }
std::string later(const char* what) { return std::string(what) + "  " + icons::kChevronRight; }

/// The whole run at a glance, frame by frame, and the ways to what went wrong in it.
class TimelinePanel final : public NamedPanel {
 public:
  explicit TimelinePanel(Shared shared) : NamedPanel("timeline", "Timeline", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {440.0F, 185.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.frame_count <= 0 || session.run->records.empty()) {
      draw_absent(frame, "No frame has been processed yet.");
      return;
    }
    if (title_ != session.title) range_.reset();
    title_ = session.title;
    model_.update(session, lanes_);
    update_worst(session);
    if (ImGui::GetContentRegionAvail().y > kRoomForControls * frame.scale)
      draw_controls(frame, session, actions);
    const Footer footer =
        timeline_footer(frame, session, frame_figure_infos()[static_cast<std::size_t>(figure(session))]);
    const ImVec2 room = room_above(frame, footer);
    const ImVec2 low = ImGui::GetCursorScreenPos(), high{low.x + room.x, low.y + room.y};
    const TimelinePaint before(frame, low, high, range_.value_or(everything(session)));
    ImGui::SetCursorScreenPos({before.left, low.y});
    ImGui::InvisibleButton("lanes", {before.right - before.left, room.y},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    handle_mouse(frame, session, before, low.y + ruler_height(frame), actions);
    offer_by_right_click(frame, "timeline", ImGui::IsItemHovered(), [&] { return offers(frame, session); });
    // What the mouse changed shows in this frame, not the next.
    const TimelinePaint paint(frame, low, high, range_.value_or(everything(session)));
    draw_rows(frame, session, paint, low, high, actions);
    if (hovered_) ImGui::SetTooltip("%s", frame_report(session, model_, *hovered_).c_str());
    ImGui::SetCursorScreenPos(low);
    ImGui::Dummy(room);
    footer.draw(frame);
  }

 private:
  /// Each lane as a plot, and all of them as a table.
  [[nodiscard]] std::vector<SaveOffer> offers(const UiFrame& frame, const SessionView& session) const {
    std::vector<SaveOffer> offers;
    const std::vector<double> frames(model_.frames.begin(), model_.frames.end());
    std::vector<std::vector<double>> ghosts;
    for (const auto& of_ghost : model_.ghost_frames) ghosts.emplace_back(of_ghost.begin(), of_ghost.end());
    for (const TimelineLane& lane : model_.lanes) {
      const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(lane.figure)];
      Plot plot{
          .x_label = "frame", .y_label = shown_name(info), .y_unit = std::string(shown_unit(info.unit).unit)};
      plot.series.push_back({session.run->name, frames, lane.values, lane_colour(info, frame.theme.name)});
      for (std::size_t g = 0; g < lane.ghosts.size() && g < ghosts.size(); ++g) {
        const RunLook look = ghost_look(session.debug.ghosts, g, frame.theme.name);
        plot.series.push_back(
            {session.debug.ghosts[g].name, ghosts[g], lane.ghosts[g], look.colour, look.line});
      }
      if (range_) plot.x_limits = range_;
      SaveOffer offer = offer_of(std::string(info.name), plot);
      offer.what = fmt::format("{} as a plot", shown_name(info));
      offer.values = {};
      offers.push_back(std::move(offer));
    }
    Table table{{"frame", "status"}, {}};
    for (const TimelineLane& lane : model_.lanes) {
      const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(lane.figure)];
      const std::string unit(shown_unit(info.unit).unit);
      table.header.push_back(unit.empty() ? shown_name(info)
                                          : fmt::format("{} ({})", shown_name(info), unit));
    }
    for (std::size_t i = 0; i < model_.frames.size(); ++i) {
      std::vector<std::string> row{fmt::format("{}", model_.frames[i]),
                                   std::string(to_string(status_of_badness(model_.badness[i])))};
      for (const TimelineLane& lane : model_.lanes)
        row.push_back(std::isfinite(lane.values[i]) ? fmt::format("{}", lane.values[i]) : std::string());
      table.rows.push_back(std::move(row));
    }
    offers.push_back(offer_of("timeline", std::move(table)));
    offers.back().what = "all lanes as a table";
    return offers;
  }

  [[nodiscard]] static float ruler_height(const UiFrame& frame) {
    return frame.fonts.small->FontSize + 4.0F * frame.scale;
  }
  [[nodiscard]] static AxisRange everything(const SessionView& session) {
    return {-0.5, static_cast<double>(session.frame_count) - 0.5};
  }
  [[nodiscard]] int figure(const SessionView& session) const {
    return worst_by_.value_or(usual_figure(session.run->measured()));
  }

  void update_worst(const SessionView& session) {
    const auto key =
        std::tuple(session.run.get(), session.revision, session.run->records.size(), figure(session));
    if (worst_key_ == key) return;
    worst_key_ = key;
    worst_.clear();
    for (const WorstFrame& frame : worst_frames(session.run->measured(), figure(session)))
      worst_.push_back(frame.index);
  }

  void draw_controls(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    Controls controls(frame);
    const int here = session.current->index;
    const auto jump = [&](const char* label, const char* tooltip, std::optional<int> to) {
      ImGui::BeginDisabled(!to);
      if (controls.button(label, tooltip) && to) actions.go_to_frame = to;
      ImGui::EndDisabled();
    };
    ImGui::BeginDisabled(worst_.empty());
    if (controls.button(
            "Next worst",
            "The next worse-off frame by the figure chosen (N); click a lane's name to choose it"))
      actions.perform.emplace_back("next_worst");
    if (controls.button(icons::kChevronUp, "The one before it (Shift+N)"))
      actions.perform.emplace_back("previous_worst");
    ImGui::EndDisabled();
    if (!session.debug.breakpoints.empty()) {
      const std::vector<int> hits = hit_frames(session.debug);
      jump(earlier("Hit").c_str(), "Breakpoint hit before this frame (Shift+F8)", previous_in(hits, here));
      jump(later("Hit").c_str(), "Breakpoint hit after this frame (F8)", next_in(hits, here));
    }
    const std::vector<int> hurt = hurt_frames(session.debug);
    if (!hurt.empty())
      jump(later("Hurt").c_str(), "Next frame that removal made worse (J)", next_in(hurt, here));
    const Bookmark* bookmark = bookmark_at(session.debug, here);
    // A note is not thrown away by a click; the bookmarks panel deletes it.
    ImGui::BeginDisabled(bookmark != nullptr && !bookmark->note.empty());
    if (controls.button(icons::kBookmark, bookmark != nullptr ? "Take the bookmark off this frame (B)"
                                                              : "Bookmark this frame (B)"))
      actions.requests.push_back(request::Bookmarks{bookmark != nullptr
                                                        ? without_bookmark(session.debug.bookmarks, here)
                                                        : with_bookmark(session.debug.bookmarks, here)});
    ImGui::EndDisabled();
    if (controls.button("Lanes", "Which figures are shown")) ImGui::OpenPopup("which lanes");
    draw_lane_choice();
    if (session.debug.span) draw_span_controls(controls, session, actions);
  }

  /// A figure that people are offered: one with a title, or a method's own.
  [[nodiscard]] static bool is_lane(int figure) {
    return figure >= first_method_figure() ||
           !frame_figure_infos()[static_cast<std::size_t>(figure)].title.empty();
  }

  void draw_lane_choice() {
    if (!ImGui::BeginPopup("which lanes")) return;
    const auto& infos = frame_figure_infos();
    for (int figure = 0; figure < static_cast<int>(infos.size()); ++figure) {
      const FigureInfo& info = infos[static_cast<std::size_t>(figure)];
      if (!is_lane(figure)) continue;
      const auto at = std::find(lanes_.begin(), lanes_.end(), figure);
      bool on = at != lanes_.end();
      if (ImGui::Checkbox(shown_name(info).c_str(), &on)) {
        if (on)
          lanes_.push_back(figure);
        else
          lanes_.erase(at);
        // Lanes stand in the order of the list.
        std::sort(lanes_.begin(), lanes_.end());
      }
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", info.help.c_str());
    }
    ImGui::EndPopup();
  }

  void draw_span_controls(Controls& controls, const SessionView& session, PanelActions& actions) {
    const FrameSpan span = *session.debug.span;
    bool loop = session.debug.loop;
    if (controls.toggle("Loop range", loop, "Play goes round in the range (Ctrl+L)"))
      actions.requests.push_back(request::Span{span, loop});
    if (controls.button("Export…", "These frames as a small TUM folder")) ImGui::OpenPopup("export");
    if (controls.button(icons::kClose, "Clear the range")) actions.requests.push_back(request::Span{});
    if (!ImGui::BeginPopup("export")) return;
    ImGui::Text("Frames %d to %d as a TUM folder", span.first, span.last);
    ImGui::SetNextItemWidth(22.0F * ImGui::GetFontSize());
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputTextWithHint("##folder", "folder, made if missing", folder_.data(),
                                                  folder_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::BeginDisabled(folder_[0] == '\0');
    if (ImGui::Button("Export") || (entered && folder_[0] != '\0')) {
      actions.requests.push_back(request::ExportFrames{folder_.data()});
      ImGui::CloseCurrentPopup();
    }
    ImGui::EndDisabled();
    ImGui::EndPopup();
  }

  void handle_mouse(const UiFrame& frame, const SessionView& session, const TimelinePaint& paint,
                    float ruler_bottom, PanelActions& actions) {
    const ImGuiIO& io = ImGui::GetIO();
    const AxisMap& map = paint.map();
    const auto mouse = static_cast<double>(io.MousePos.x);
    const int pointed = frame_under(session, map.to_value(mouse));
    hovered_.reset();
    if (ImGui::IsItemHovered()) {
      hovered_ = pointed;
      if (io.MouseWheel != 0.0F && io.KeyShift)
        first_row_ -= std::min(first_row_, static_cast<std::size_t>(io.MouseWheel > 0.0F ? 1 : 0)),
            first_row_ += io.MouseWheel < 0.0F ? 1 : 0;
      else if (io.MouseWheel != 0.0F)
        zoom(session, zoomed(map, mouse, std::pow(kWheelFactor, -io.MouseWheel)));
      if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) range_.reset();
    }
    if (ImGui::IsItemActivated() && ImGui::IsMouseDown(ImGuiMouseButton_Left) &&
        (io.KeyShift || io.MousePos.y < ruler_bottom)) {
      const double pixels = static_cast<double>(paint.right - paint.left);
      drag_.begin(pointed, session.debug.span,
                  static_cast<double>(kGrip * frame.scale) * map.range.span() / pixels);
    }
    if (drag_.active()) {
      drag_.move(pointed);
      if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
      if (const auto selected = drag_.end(session.frame_count))
        actions.requests.push_back(request::Span{selected, session.debug.loop});
      else
        actions.go_to_frame = pointed;
      return;
    }
    if (!ImGui::IsItemActive()) return;
    for (const int button : {ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
      if (ImGui::IsMouseDragging(button) && range_)
        range_ = panned(map, static_cast<double>(io.MouseDelta.x));
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) actions.go_to_frame = pointed;
  }

  void zoom(const SessionView& session, AxisRange range) {
    const AxisRange all = everything(session);
    range = {std::max(range.low, all.low), std::min(range.high, all.high)};
    if (range.span() >= kLeastFrames) range_ = range;
  }

  [[nodiscard]] static int frame_under(const SessionView& session, double value) {
    return static_cast<int>(
        std::lround(std::clamp(value, 0.0, static_cast<double>(session.frame_count - 1))));
  }

  void draw_rows(const UiFrame& frame, const SessionView& session, const TimelinePaint& paint, ImVec2 low,
                 ImVec2 high, PanelActions& actions) {
    const float gap = 3.0F * frame.scale, thin = frame.fonts.small->FontSize + 2.0F * frame.scale;
    const float ruler_bottom = low.y + ruler_height(frame);
    paint.ruler(low.y, ruler_bottom);
    paint.name(low.y, "Frame", frame.theme.text_dim);
    paint.value(low.y, fmt::format("{}", session.current->index), frame.theme.text);
    float y = ruler_bottom + gap;
    const auto row = [&](const auto& draw) {
      if (y + thin > high.y) return;
      draw(y, y + thin);
      y += thin + gap;
    };
    const TimelineRows rows(frame, session, model_, paint);
    row([&](float top, float bottom) { rows.status(top, bottom); });
    row([&](float top, float bottom) { rows.marks(top, bottom); });
    const std::size_t ghosts = session.debug.ghosts.size(), all = ghosts + model_.lanes.size();
    const auto least = [&](std::size_t i) { return (i < ghosts ? thin : kLeastLane * frame.scale) + gap; };
    const RowWindow window = row_window(all, least, high.y - y + gap, first_row_);
    first_row_ = window.first;
    // Where all fit, lanes share what is left.
    const float spare = window.count == all ? high.y - y + gap - window.height : 0.0F;
    const float more = model_.lanes.empty() ? 0.0F : spare / static_cast<float>(model_.lanes.size());
    const float rows_top = y;
    for (std::size_t i = window.first; i < window.first + window.count; ++i) {
      const float bottom = y + least(i) - gap + (i < ghosts ? 0.0F : more);
      if (i < ghosts)
        rows.ghost(i, y, bottom);
      else
        draw_lane(frame, session, paint, model_.lanes[i - ghosts], y, bottom, actions);
      y = bottom + gap;
    }
    if (window.count < all) first_row_ = draw_row_bar(frame, window, all, {high.x, rows_top}, high.y);
    if (const auto span = drag_.active() ? drag_.span(session.frame_count) : session.debug.span)
      paint.span(*span, low.y, ruler_bottom, y);
    if (hovered_) paint.upright(*hovered_, frame.theme.text_dim, 0.7F, 1.0F, low.y, y);
    paint.upright(session.current->index, role_colour(Role::kCursor, frame.theme.name), 1.0F, 1.5F, low.y, y);
  }

  void draw_lane(const UiFrame& frame, const SessionView& session, const TimelinePaint& paint,
                 const TimelineLane& lane, float top, float bottom, PanelActions& actions) {
    const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(lane.figure)];
    const bool chosen = lane.figure == figure(session);
    const float line = frame.fonts.small->FontSize;
    const Rgb colour = lane_colour(info, frame.theme.name);
    paint.ground(top, bottom, model_.frames.back());
    ImGui::PushID(lane.figure);
    const ImVec2 low{ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMin().x, top};
    ImGui::SetCursorScreenPos(low);
    if (ImGui::InvisibleButton("name", {std::max(paint.left - low.x - 4.0F, 1.0F), bottom - top})) {
      worst_by_ = lane.figure;
      actions.worst_by = lane.figure;
    }
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\n%s", info.help.c_str(),
                        chosen ? "What \"worst\" goes by." : "Click: \"worst\" goes by it.");
    ImGui::PopID();
    if (chosen)
      ImGui::GetWindowDrawList()->AddRectFilled({low.x - 5.0F * frame.scale, top},
                                                {low.x - 2.0F * frame.scale, bottom},
                                                to_u32(frame.theme.accent));
    paint.name(top, shown_name(info), frame.theme.text);
    if (bottom - top > 2.0F * line) paint.name(top + line + 1.0F, lane.range_text(), frame.theme.text_dim);
    paint.lane(model_.frames, lane.values, lane.highest, colour, top, bottom);
    for (std::size_t g = 0; g < lane.ghosts.size() && g < model_.ghost_frames.size(); ++g)
      paint.ghost_lane(model_.ghost_frames[g], lane.ghosts[g], lane.highest,
                       ghost_look(session.debug.ghosts, g, frame.theme.name), top, bottom);
    if (chosen) draw_worst(frame, session, paint, lane, top, bottom);
    if (const auto here = record_of(session, session.current->index))
      paint.value(top, lane_text(lane.values[*here], info), frame.theme.text);
  }

  void draw_worst(const UiFrame& frame, const SessionView& session, const TimelinePaint& paint,
                  const TimelineLane& lane, float top, float bottom) const {
    for (std::size_t i = 0; i < std::min(worst_.size(), kWorstShown); ++i) {
      const auto at = record_of(session, worst_[i]);
      if (at && std::isfinite(lane.values[*at]))
        paint.ring(worst_[i], lane.values[*at], lane.highest, role_colour(Role::kWarning, frame.theme.name),
                   top, bottom);
    }
  }

  TimelineModel model_;
  std::size_t first_row_ = 0;  // the first seen of ghosts and lanes
  std::vector<int> lanes_{frame_figure("rpe"), frame_figure("mask"), frame_figure("kept"),
                          frame_figure("inliers"), frame_figure("ms.total")};
  std::optional<int> worst_by_;
  std::tuple<const RunView*, std::uint64_t, std::size_t, int> worst_key_{};
  std::vector<int> worst_;
  std::string title_;               // of the sequence shown last
  std::optional<AxisRange> range_;  // frames; none shows all
  std::optional<int> hovered_;
  SpanDrag drag_;
  std::array<char, 512> folder_{};
};

}  // namespace

std::unique_ptr<Panel> make_timeline_panel(Shared shared) {
  return std::make_unique<TimelinePanel>(std::move(shared));
}

}  // namespace stillpoint
