#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/drawn_truth.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/run/condition.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/outline_drawing.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/shell/input.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

constexpr float kCornerReach = 8.0F, kEdgeReach = 5.0F;  // design px, for the mouse
constexpr std::size_t kLeastCorners = 3;                 // corners: fewer enclose nothing

/// Truth by hand: outlines are drawn round what moves in some frames, and carried to the others.
class OutlinePanel final : public FramePanel {
 public:
  explicit OutlinePanel(Shared shared) : FramePanel("outline", "Truth by hand", std::move(shared)) {}

  [[nodiscard]] bool shows_a_run() const override { return false; }

  [[nodiscard]] std::vector<PanelCommand> commands() override {
    const auto command = [](const char* name, const char* title, std::vector<KeyChord> keys,
                            std::function<bool(const SessionView&)> enabled,
                            std::function<void(const SessionView&, PanelActions&)> run) {
      return PanelCommand{.name = name,
                          .title = title,
                          .group = "Truth",
                          .icon = {},
                          .keys = std::move(keys),
                          .shows = true,
                          .enabled = std::move(enabled),
                          .run = std::move(run)};
    };
    const auto is_drawn = [](const SessionView& session) {
      return drawn_at(session.debug.drawn, session.current->index) != nullptr;
    };
    return {
        command(
            "outline_close", "Close the outline being drawn", {{Key::kEnter, {}}, {Key::kKeypadEnter, {}}},
            [this](const SessionView&) { return unfinished().size() >= kLeastCorners; },
            [this](const SessionView& session, PanelActions& actions) { close(session, actions); }),
        command(
            "outline_undo", "Take out the last corner drawn", {{Key::kBackspace, {}}},
            [this](const SessionView&) { return !unfinished().empty(); },
            [this](const SessionView&, PanelActions&) { unfinished().pop_back(); }),
        command(
            "outline_delete", "Take out the outline under the mouse", {{Key::kDelete, {}}},
            [this](const SessionView& session) { return mover_at_cursor(session).has_value(); },
            [this](const SessionView& session, PanelActions& actions) {
              std::vector<Outline> movers = movers_of(session);
              movers.erase(movers.begin() + static_cast<std::ptrdiff_t>(*mover_at_cursor(session)));
              put(session, actions, std::move(movers));
            }),
        command("outline_nothing", "Nothing moves in this frame", {}, readable,
                [this](const SessionView& session, PanelActions& actions) { put(session, actions, {}); }),
        command(
            "outline_from_truth", "Outlines from the true mask", {},
            [](const SessionView& session) { return !session.current->truth.moving.empty(); },
            [this](const SessionView& session, PanelActions& actions) {
              put(session, actions, outlines_of_mask(session.current->truth.moving));
            }),
        command(
            "outline_from_mask", "Outlines from the run's mask", {},
            [](const SessionView& session) { return !session.current->mask.empty(); },
            [this](const SessionView& session, PanelActions& actions) {
              put(session, actions, outlines_of_mask(session.current->mask));
            }),
        command("outline_clear", "Take this frame out of those drawn", {}, is_drawn,
                [this](const SessionView& session, PanelActions& actions) {
                  forget();
                  actions.requests.emplace_back(
                      request::Drawn{without_drawn(session.debug.drawn, session.current->index)});
                }),
        command(
            "outline_carry", "Carry outlines to all frames, as the sequence's true masks", {},
            [](const SessionView& session) {
              return !session.debug.drawn.empty() && !session.debug.exporting;
            },
            [](const SessionView&, PanelActions& actions) {
              actions.requests.emplace_back(request::WriteTruth{});
            }),
        command(
            "outline_previous", "Previous drawn frame", {},
            [](const SessionView& session) { return neighbour(session, -1).has_value(); },
            [](const SessionView& session, PanelActions& actions) {
              actions.go_to_frame = neighbour(session, -1);
            }),
        command(
            "outline_next", "Next drawn frame", {},
            [](const SessionView& session) { return neighbour(session, 1).has_value(); },
            [](const SessionView& session, PanelActions& actions) {
              actions.go_to_frame = neighbour(session, 1);
            })};
  }

  [[nodiscard]] PanelSize least() const override { return {420.0F, 280.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    if (const std::string& now = session.debug.sequence_hash; !now.empty() && now != sequence_) {
      if (!sequence_.empty()) unfinished_.clear();
      sequence_ = now;
    }
    if (view.index != frame_) {
      forget();
      frame_ = view.index;
    }
    if (!view.frame.readable()) {
      draw_absent(frame, missing_motion(session));
      return;
    }
    if (asked_) {
      const DrawnFrame* kept = drawn_at(session.debug.drawn, view.index);
      if (kept != nullptr && kept->movers == *asked_) asked_.reset();
    }
    draw_controls(frame, session, actions);
    const std::vector<Outline> movers = movers_of(session);
    const bool drawn = is_drawn(session);
    const Footer footer = footer_of(frame, session, movers, drawn);
    ImageContent content;
    content.drawn_on = true;
    content.texture = &picture_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.frame.gray;
    if (!drawn && !view.truth.moving.empty())
      content.overlays.push_back(truth_.over(frame, session.current, 0, 0.4F, carried(frame),
                                             [&] { return cover_of(view.truth.moving); }));
    const ImageResponse response =
        draw_frame_image(frame, "outline", content, *shared_, room_above(frame, footer));
    if (response.hovered) hovered_in_ = ImGui::GetFrameCount();
    take_mouse(frame, session, actions, response);
    push_clip(response);
    draw_movers(frame, response, movers_of(session));
    draw_unfinished(frame, response);
    pop_clip();
    footer.draw(frame);
  }

 private:
  /// A corner of one of the frame's outlines.
  struct CornerOf {
    std::size_t mover = 0, corner = 0;
  };

  static bool readable(const SessionView& session) { return session.current->frame.readable(); }
  static Rgb carried(const UiFrame& frame) { return role_colour(Role::kGroundTruth, frame.theme.name); }
  static Rgb ink() { return okabe_ito::kYellow; }

  static std::optional<int> neighbour(const SessionView& session, int step) {
    std::optional<int> found;
    for (const DrawnFrame& drawn : session.debug.drawn) {
      if (step > 0 && drawn.frame > session.current->index) return drawn.frame;
      if (step < 0 && drawn.frame < session.current->index) found = drawn.frame;
    }
    return found;
  }

  /// The outline being drawn in the frame shown: whoever steps on and back finds it as it was.
  Outline& unfinished() { return unfinished_[frame_]; }
  [[nodiscard]] const Outline& unfinished() const {
    static const Outline none;
    const auto found = unfinished_.find(frame_);
    return found != unfinished_.end() ? found->second : none;
  }

  [[nodiscard]] bool is_drawn(const SessionView& session) const {
    return asked_ || grabbed_ || drawn_at(session.debug.drawn, session.current->index) != nullptr;
  }

  /// As they are being changed, as they were asked for, or as the session has them.
  [[nodiscard]] std::vector<Outline> movers_of(const SessionView& session) const {
    if (grabbed_) return held_;
    if (asked_) return *asked_;
    const DrawnFrame* drawn = drawn_at(session.debug.drawn, session.current->index);
    return drawn != nullptr ? drawn->movers : std::vector<Outline>();
  }

  void forget() {
    held_.clear();
    grabbed_.reset(), asked_.reset();
  }

  void put(const SessionView& session, PanelActions& actions, std::vector<Outline> movers) {
    grabbed_.reset();
    asked_ = movers;
    actions.requests.emplace_back(
        request::Drawn{with_drawn(session.debug.drawn, {session.current->index, std::move(movers)})});
  }

  void close(const SessionView& session, PanelActions& actions) {
    std::vector<Outline> movers = movers_of(session);
    movers.push_back(std::exchange(unfinished(), {}));
    put(session, actions, std::move(movers));
  }

  [[nodiscard]] std::optional<std::size_t> mover_at_cursor(const SessionView& session) const {
    if (!shared_->pixel || ImGui::GetFrameCount() - hovered_in_ > 1) return std::nullopt;
    const Corner at{static_cast<double>(shared_->pixel->x()), static_cast<double>(shared_->pixel->y())};
    const std::vector<Outline> movers = movers_of(session);
    for (std::size_t i = movers.size(); i-- > 0;)
      if (encloses(movers[i], at)) return i;
    return std::nullopt;
  }

  void draw_controls(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    Controls controls(frame);
    const auto button = [&](const char* label, const char* tooltip, bool enabled, const char* action) {
      ImGui::BeginDisabled(!enabled);
      if (controls.button(label, tooltip)) actions.perform.emplace_back(action);
      ImGui::EndDisabled();
    };
    const FrameView& view = *session.current;
    button(icons::kChevronLeft, "Previous drawn frame", neighbour(session, -1).has_value(),
           "outline_previous");
    button(icons::kChevronRight, "Next drawn frame", neighbour(session, 1).has_value(), "outline_next");
    button("Nothing moves", "This frame counts as drawn, without outlines", true, "outline_nothing");
    button("From truth", "Outlines of the true mask, carried or given, to be corrected",
           !view.truth.moving.empty(), "outline_from_truth");
    button("From the run", "Outlines of the mask that the run's method made, to be corrected",
           !view.mask.empty(), "outline_from_mask");
    button("Clear", "Takes this frame out of those drawn", is_drawn(session), "outline_clear");
    button("Carry to all frames",
           "Carries what is drawn to all frames by flow and depth, and writes it into the sequence as its "
           "true masks",
           !session.debug.drawn.empty() && !session.debug.exporting, "outline_carry");
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session,
                                 const std::vector<Outline>& movers, bool drawn) const {
    const FrameView& view = *session.current;
    Footer footer;
    footer.caption = frame_text(session, view.frame);
    // Always, so that the picture stays where it is while one draws.
    footer.legend.push_back({"drawn", ink(), Sign::kLine});
    if (drawn) {
      const double share = percent_set(mask_of_outlines(movers, view.frame.gray.size()));
      footer.caption += movers.empty() ? std::string(": drawn, nothing moves.")
                                       : fmt::format(": {} outline{}, {:.1f} % of the pixels.", movers.size(),
                                                     movers.size() == 1 ? "" : "s", share);
    } else if (!view.truth.moving.empty()) {
      footer.legend.push_back({"true mask", carried(frame), Sign::kSquare});
      footer.caption += fmt::format(": not drawn; its true mask holds {:.1f} % of the pixels.",
                                    percent_set(view.truth.moving));
    } else {
      footer.caption += ": not drawn.";
    }
    std::vector<int> frames;
    for (const DrawnFrame& one : session.debug.drawn) frames.push_back(one.frame);
    if (!frames.empty()) footer.caption += fmt::format(" Drawn: {}.", frames_text(frames));
    footer.caption += unfinished().empty()
                          ? " Click corner after corner round what moves; drag a corner or an edge, "
                            "right-click takes a corner out."
                          : " Enter or the first corner closes it, Backspace takes the last corner out.";
    return footer;
  }

  void take_mouse(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                  const ImageResponse& response) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const auto corner_under_mouse = [&] {
      const Eigen::Vector2d at =
          to_pixel(response.map.to_image({static_cast<double>(mouse.x - response.panel_min.x),
                                          static_cast<double>(mouse.y - response.panel_min.y)}));
      const cv::Size size = session.current->frame.gray.size();
      // A tenth of a pixel is finer than anybody points.
      const auto tidy = [](double value, int limit) {
        return std::clamp(std::round(10.0 * value) / 10.0, to_pixel(RasterCoordinate(0.0)),
                          to_pixel(RasterCoordinate<double>(limit)));
      };
      return Corner{tidy(at.x(), size.width), tidy(at.y(), size.height)};
    };
    if (grabbed_) {
      held_[grabbed_->mover][grabbed_->corner] = corner_under_mouse();
      if (ImGui::IsMouseReleased(ImGuiMouseButton_Left)) put(session, actions, std::exchange(held_, {}));
      return;
    }
    if (!response.hovered || !response.image_point) return;
    const float corner_reach = kCornerReach * frame.scale, edge_reach = kEdgeReach * frame.scale;
    if (unfinished().empty() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
      held_ = movers_of(session);
      grabbed_ = grab(response, mouse, corner_reach, edge_reach);
      if (grabbed_) return;
    }
    if (response.right_clicked && unfinished().empty()) {
      std::vector<Outline> movers = movers_of(session);
      if (const auto at = nearest_corner(movers, response, mouse, corner_reach)) {
        Outline& outline = movers[at->mover];
        outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(at->corner));
        if (outline.size() < kLeastCorners)
          movers.erase(movers.begin() + static_cast<std::ptrdiff_t>(at->mover));
        put(session, actions, std::move(movers));
      }
    }
    if (!response.clicked) return;
    if (unfinished().size() >= kLeastCorners &&
        distance_between(mouse, corner_on(response, unfinished().front())) < corner_reach)
      close(session, actions);
    else
      unfinished().push_back(corner_under_mouse());
  }

  static std::optional<CornerOf> nearest_corner(const std::vector<Outline>& movers,
                                                const ImageResponse& response, ImVec2 mouse, float reach) {
    std::optional<CornerOf> best;
    for (std::size_t i = 0; i < movers.size(); ++i)
      for (std::size_t k = 0; k < movers[i].size(); ++k)
        if (const float away = distance_between(mouse, corner_on(response, movers[i][k])); away < reach) {
          reach = away;
          best = CornerOf{i, k};
        }
    return best;
  }

  /// The corner of `held_` under the mouse, or a new one on the edge under it.
  std::optional<CornerOf> grab(const ImageResponse& response, ImVec2 mouse, float corner_reach,
                               float edge_reach) {
    if (const auto corner = nearest_corner(held_, response, mouse, corner_reach)) return corner;
    for (std::size_t i = 0; i < held_.size(); ++i)
      for (std::size_t k = 0; k < held_[i].size(); ++k) {
        Outline& outline = held_[i];
        const std::size_t next = (k + 1) % outline.size();
        if (distance_to_edge(mouse, corner_on(response, outline[k]), corner_on(response, outline[next])) >
            edge_reach)
          continue;
        outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(k + 1), outline[k]);
        return CornerOf{i, k + 1};
      }
    return std::nullopt;
  }

  static void draw_movers(const UiFrame& frame, const ImageResponse& response,
                          const std::vector<Outline>& movers) {
    for (const Outline& outline : movers) {
      std::vector<ImVec2> points;
      for (const Corner& corner : outline) points.push_back(corner_on(response, corner));
      draw_outline(frame, points, true, ink());
      draw_corners(frame, points, ink());
    }
  }

  void draw_unfinished(const UiFrame& frame, const ImageResponse& response) const {
    if (unfinished().empty()) return;
    std::vector<ImVec2> points;
    for (const Corner& corner : unfinished()) points.push_back(corner_on(response, corner));
    std::vector<ImVec2> line = points;
    if (response.hovered) line.push_back(ImGui::GetIO().MousePos);
    draw_outline(frame, line, false, ink());
    draw_corners(frame, points, ink());
    if (unfinished().size() < kLeastCorners) return;
    ImGui::GetWindowDrawList()->AddCircle(points.front(), kCornerReach * frame.scale, to_u32(ink()), 0,
                                          1.5F * frame.scale);
  }

  std::string sequence_;                       // its hash
  int frame_ = -1;                             // that what follows belongs to
  std::map<int, Outline> unfinished_;          // being drawn, by frame
  int hovered_in_ = -2;                        // ImGui's frame in which the mouse was over the picture last
  std::vector<Outline> held_;                  // while a corner of them is dragged
  std::optional<CornerOf> grabbed_;            // that corner
  std::optional<std::vector<Outline>> asked_;  // until the session has them
  FrameTexture picture_, truth_ = FrameTexture::cover();
};

}  // namespace

std::unique_ptr<Panel> make_outline_panel(Shared shared) {
  return std::make_unique<OutlinePanel>(std::move(shared));
}

}  // namespace stillpoint
