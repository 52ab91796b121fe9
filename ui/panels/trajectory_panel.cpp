#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/run_difference.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/scene_of_session.hpp"
#include "ui/plot/path_plot.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/scene/scene_widget.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

/// Where the camera went, in three dimensions: estimate, baseline and truth, keyframes and map.
class TrajectoryPanel final : public NamedPanel {
 public:
  explicit TrajectoryPanel(Shared shared) : NamedPanel("trajectory", "Trajectory", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {330.0F, 190.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.run->records.empty() || session.run->trajectory.empty()) {
      draw_absent(frame, session.run->records.empty()
                             ? "No frame has been processed yet."
                             : "No frame has a pose yet, so there is no trajectory.");
      return;
    }
    if (!widget_) widget_.emplace(frame.gl);
    update_scene(frame, session);
    draw_controls(frame, session);
    Footer footer;
    footer.legend = ghost_legend(frame, session);
    scene_.data.show_legend = has_room_for_legend(frame);
    footer.caption = alignment_text(session);
    if (!scene_.data.show_legend) add_path_legend(frame, footer);
    // Names that have no room below either are better over the picture than nowhere.
    if (!scene_.data.show_legend && footer.height(frame) >= 0.0F && !footer.has_room_for_legend()) {
      scene_.data.show_legend = true;
      footer.legend = ghost_legend(frame, session);
    }
    const ImVec2 room = room_above(frame, footer);
    look(room);
    const SceneView before = view_;
    const SceneResponse response = widget_->draw(frame, "scene", scene_.data, view_, room);
    offer_by_right_click(frame, "trajectory", ImGui::IsItemHovered(),
                         [&] { return offers(frame.theme.name); });
    // Once a person has taken hold of the view it is theirs; until then it keeps everything in sight.
    if (!before.target.isApprox(view_.target) || before.distance != view_.distance ||
        !before.world_from_view.isApprox(view_.world_from_view))
      keeps_fitting_ = false;
    draw_ghost_signs(frame, session, response);
    footer.draw(frame);
    if (response.pose) explain_pose(session, *response.pose, response.clicked, actions);
  }

 private:
  void update_scene(const UiFrame& frame, const SessionView& session) {
    std::vector<std::pair<const RunView*, std::size_t>> ghosts;
    for (const GhostView& ghost : session.debug.ghosts)
      ghosts.emplace_back(ghost.run.get(), ghost.run->records.size());
    const bool same_frame =
        !view_shown_.owner_before(session.current) && !session.current.owner_before(view_shown_);
    if (same_frame && revision_ == session.revision && run_ == session.run.get() &&
        baseline_ == session.baseline.get() && layers_ == layers_drawn_ && ghosts == ghosts_ &&
        theme_ == frame.theme.name)
      return;
    ghosts_ = std::move(ghosts);
    theme_ = frame.theme.name;
    const std::uint64_t revision = scene_.data.revision + 1;
    scene_ = scene_of_session(session, layers_);
    ghost_lines_.clear();
    for (std::size_t i = 0; i < scene_.ghost_paths.size(); ++i)
      ghost_lines_.push_back(ghost_look(session.debug.ghosts, i, theme_).line);
    for (std::size_t i = 0; i < scene_.ghost_paths.size(); ++i)
      scene_.data.paths[scene_.ghost_paths[i]].colour = ghost_look(session.debug.ghosts, i, theme_).colour;
    scene_.data.revision = scene_.data.image_revision = revision;
    sight_ = sight_of(scene_.data);
    view_shown_ = session.current;
    revision_ = session.revision;
    run_ = session.run.get();
    baseline_ = session.baseline.get();
    layers_drawn_ = layers_;
    if (scene_.data.current) follow(view_, *scene_.data.current);
  }

  /// The paths as they are laid out here: from the side that shows most of them, and as numbers.
  [[nodiscard]] std::vector<SaveOffer> offers(ThemeName theme) const {
    std::vector<std::array<std::vector<double>, 3>> positions(scene_.data.paths.size());
    std::vector<PlotPath> paths;
    Table table{{"path", "frame", "time (s)", "x (m)", "y (m)", "z (m)"}, {}};
    for (std::size_t p = 0; p < positions.size(); ++p) {
      const ScenePath& path = scene_.data.paths[p];
      for (std::size_t i = 0; i < path.positions.size(); ++i) {
        const Eigen::Vector3d at = path.positions[i].cast<double>();
        for (std::size_t axis = 0; axis < 3; ++axis)
          positions[p][axis].push_back(at[static_cast<Eigen::Index>(axis)]);
        const bool known = i < scene_.frames_of_path[p].size();
        table.rows.push_back(
            {path.name, known ? fmt::format("{}", scene_.frames_of_path[p][i].index) : std::string(),
             known ? fmt::format("{}", scene_.frames_of_path[p][i].seconds) : std::string(),
             fmt::format("{}", at.x()), fmt::format("{}", at.y()), fmt::format("{}", at.z())});
      }
      const auto ghost = std::find(scene_.ghost_paths.begin(), scene_.ghost_paths.end(), p);
      const SeriesStyle style =
          ghost == scene_.ghost_paths.end()
              ? (path.dash_m > 0.0 ? SeriesStyle::kDashed : SeriesStyle::kLine)
              : ghost_lines_[static_cast<std::size_t>(ghost - scene_.ghost_paths.begin())];
      paths.push_back({path.name, &positions[p], path_colour(path, theme), style});
    }
    SaveOffer poses = offer_of("poses", std::move(table));
    poses.what = "its poses";
    return {offer_of("trajectory", path_plot(paths).plot), std::move(poses)};
  }

  void draw_controls(const UiFrame& frame, const SessionView& session) {
    Controls controls(frame);
    const auto preset = [&](const char* label, ViewPreset kind, const char* tooltip) {
      if (!controls.button(label, tooltip)) return;
      look_from(view_, kind, scene_.data.up, scene_.data.current);
      preset_ = kind;
      keeps_fitting_ = kind != ViewPreset::kCamera;
    };
    preset("Oblique", ViewPreset::kOblique, "From above at a slant");
    preset("Top", ViewPreset::kTop, "From straight above");
    preset("Front", ViewPreset::kFront, "Level");
    preset("Camera", ViewPreset::kCamera, "Through the current camera");
    if (controls.button("Fit", "Everything in sight (double click)")) keeps_fitting_ = true;
    bool follows = view_.follow != Follow::kNone;
    if (controls.toggle("Follow", follows, "Moves with the current camera")) {
      view_.follow = follows ? Follow::kPosition : Follow::kNone;
      view_.followed = scene_.data.current;
      if (follows) keeps_fitting_ = false;
    }
    controls.toggle("Map points", layers_.points);
    controls.toggle("Keyframes", layers_.keyframes);
    if (!session.run->evaluation.matched.empty())
      controls.toggle("Errors", layers_.errors, "Lines from each pose to where it truly was");
  }

  /// Whether the names of the paths cover no more than a corner of the picture.
  [[nodiscard]] bool has_room_for_legend(const UiFrame& frame) const {
    constexpr float kMostHeight = 0.5F, kBelow = 60.0F;  // of the room; design px of what stands below
    const float line = frame.fonts.small->FontSize + 4.0F * frame.scale;
    const auto lines = static_cast<float>(scene_legend(scene_.data, frame.theme.name).size());
    return line * lines <= kMostHeight * (ImGui::GetContentRegionAvail().y - kBelow * frame.scale);
  }

  /// The paths' names below the picture, but for those of ghosts, which stand there anyway.
  void add_path_legend(const UiFrame& frame, Footer& footer) const {
    std::vector<LegendEntry> paths;
    for (const SceneLegendEntry& entry : scene_legend(scene_.data, frame.theme.name)) {
      if (entry.name.starts_with("ghost: ")) continue;
      const Sign sign = entry.width_px <= 0.0F ? Sign::kCircle : entry.broken ? Sign::kDashed : Sign::kLine;
      paths.push_back({entry.name, entry.colour, sign});
    }
    footer.legend.insert(footer.legend.begin(), paths.begin(), paths.end());
  }

  [[nodiscard]] static std::vector<LegendEntry> ghost_legend(const UiFrame& frame,
                                                             const SessionView& session) {
    std::vector<LegendEntry> legend;
    for (std::size_t i = 0; i < session.debug.ghosts.size(); ++i) {
      const GhostView& ghost = session.debug.ghosts[i];
      const RunLook look = ghost_look(session.debug.ghosts, i, frame.theme.name);
      const std::string parts =
          ghost.diverged ? fmt::format(", parts at frame {}", *ghost.diverged) : ", same way so far";
      legend.push_back({shortened(ghost.name) + parts, look.colour, look.sign});
    }
    return legend;
  }

  /// Each ghost's sign where it parts from the run, and where it is at the frame shown.
  void draw_ghost_signs(const UiFrame& frame, const SessionView& session,
                        const SceneResponse& response) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (std::size_t i = 0; i < scene_.ghost_paths.size() && i < session.debug.ghosts.size(); ++i) {
      const GhostView& ghost = session.debug.ghosts[i];
      const std::size_t path = scene_.ghost_paths[i];
      const RunLook look = ghost_look(session.debug.ghosts, i, frame.theme.name);
      const auto sign_at = [&](int wanted, float radius) {
        const auto& frames = scene_.frames_of_path[path];
        const auto found =
            std::lower_bound(frames.begin(), frames.end(), wanted,
                             [](const PathFrame& one, int index) { return one.index < index; });
        if (found == frames.end() || found->index != wanted) return;
        const auto& position =
            scene_.data.paths[path].positions[static_cast<std::size_t>(found - frames.begin())];
        const auto seen = project(view_, response.viewport, position.cast<double>());
        if (!seen || seen->x() < 0.0 || seen->y() < 0.0 || seen->x() > response.viewport.width ||
            seen->y() > response.viewport.height)
          return;
        const ImVec2 at = response.to_screen(seen->head<2>());
        draw_sign(frame, list, at, (radius + 1.5F) * frame.scale, look.sign, to_u32(frame.theme.plot));
        draw_sign(frame, list, at, radius * frame.scale, look.sign, to_u32(look.colour));
      };
      if (ghost.diverged) sign_at(*ghost.diverged, 4.0F);
      sign_at(session.current->index, 6.0F);
    }
  }

  /// Sets the view until a person does.
  void look(ImVec2 room) {
    if (!looked_) {
      look_from(view_, preset_, scene_.data.up);
      looked_ = true;
    }
    if (!keeps_fitting_) return;
    const Viewport viewport{std::max(16.0, static_cast<double>(room.x)),
                            std::max(16.0, static_cast<double>(room.y))};
    fit(view_, viewport, sight_);
  }

  void explain_pose(const SessionView& session, const ScenePose& pose, bool clicked,
                    PanelActions& actions) const {
    const auto& frames = scene_.frames_of_path[pose.path];
    if (pose.index >= frames.size()) return;
    const ScenePath& path = scene_.data.paths[pose.path];
    const Eigen::Vector3f& at = path.positions[pose.index];
    const PathFrame& which = frames[pose.index];
    std::string text = fmt::format("{}\nframe {}, {:.3f} s\nx {:.3f} m, y {:.3f} m, z {:.3f} m", path.name,
                                   which.index, which.seconds, at.x(), at.y(), at.z());
    if (which.error_m) text += fmt::format("\n{:.1f} mm from the truth", 1000.0 * *which.error_m);
    ImGui::SetTooltip("%s\nclick to go there", text.c_str());
    if (clicked && which.index < session.frame_count) actions.go_to_frame = which.index;
  }

  /// "12.3 mm"; of poses too few to be aligned there is none.
  [[nodiscard]] static std::string ate_text(const TrajectoryEvaluation& evaluation) {
    const AbsoluteTrajectoryError& ate = evaluation.ate;
    return ate.why_none.empty() ? fmt::format("{:.1f} mm", 1000.0 * ate.translation_m.rmse) : "–";
  }

  [[nodiscard]] static std::string alignment_text(const SessionView& session) {
    const std::size_t poses = session.run->trajectory.size();
    const auto& evaluation = session.run->evaluation;
    if (evaluation.matched.empty()) {
      return fmt::format("{} pose{} in the world of the first camera{}.", poses, poses == 1 ? "" : "s",
                         session.ground_truth->empty() ? "; there is no ground truth" : "");
    }
    const double degrees =
        rotation_angle(session.alignment.truth_from_estimate.linear()) * 180.0 / 3.14159265358979;
    std::string text = fmt::format(
        "{} pose{}, laid over the truth by a rigid motion without scale (Umeyama, {} pairs; moved {:.2f} m, "
        "turned {:.1f} "
        "°). ATE {}{}",
        poses, poses == 1 ? "" : "s", evaluation.matched.size(),
        session.alignment.truth_from_estimate.translation().norm(), degrees, ate_text(evaluation),
        evaluation.ate.why_none.empty() ? " RMSE" : "");
    if (session.baseline && !session.baseline->evaluation.matched.empty())
      text += fmt::format(", {} {}", baseline_name(session), ate_text(session.baseline->evaluation));
    if (session.alignment.degenerate) text += "; too few poses to fix the rotation by positions alone";
    const auto& ghosts = session.debug.ghosts;
    const auto apart = std::count_if(ghosts.begin(), ghosts.end(),
                                     [&](const auto& g) { return in_worlds_of_their_own(session, g); });
    if (apart < static_cast<std::ptrdiff_t>(ghosts.size())) text += "; ghosts are laid by the same motion";
    if (apart > 0)
      text += session.outside.empty() ? "; other programs' runs are laid each by its own"
                                      : "; ghosts are laid each by its own";
    return text + ".";
  }

  std::optional<SceneWidget> widget_;
  SessionScene scene_;
  SceneLayers layers_, layers_drawn_;
  SceneView view_;
  SceneBounds sight_;
  ViewPreset preset_ = ViewPreset::kOblique;
  bool looked_ = false, keeps_fitting_ = true;
  std::weak_ptr<const FrameView> view_shown_;
  std::uint64_t revision_ = 0;
  const void* run_ = nullptr;
  const RunView* baseline_ = nullptr;
  std::vector<SeriesStyle> ghost_lines_;                        // as plots draw them
  std::vector<std::pair<const RunView*, std::size_t>> ghosts_;  // with how many records
  ThemeName theme_ = ThemeName::kDark;
};

}  // namespace

std::unique_ptr<Panel> make_trajectory_panel(Shared shared) {
  return std::make_unique<TrajectoryPanel>(std::move(shared));
}

}  // namespace stillpoint
