#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/run_series.hpp"

namespace stillpoint {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string yes(bool is) { return is ? "yes" : "no"; }

bool inside(const cv::Mat& image, const Eigen::Vector2i& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() < image.cols && p.y() < image.rows;
}

std::string mask_at(const cv::Mat& mask, const Eigen::Vector2i& p) {
  return inside(mask, p) ? yes(mask.at<std::uint8_t>(p.y(), p.x()) != 0) : "–";
}

std::string byte_at(const cv::Mat& image, const Eigen::Vector2i& p, const char* unit) {
  return inside(image, p) ? fmt::format("{} {}", image.at<std::uint8_t>(p.y(), p.x()), unit) : "–";
}

/// What is known of one pixel.
Rows pixel_rows(const FrameView& view, const Eigen::Vector2i& p) {
  Rows rows{{"Pixel", fmt::format("x {}, y {}", p.x(), p.y())},
            {"Grey", byte_at(view.frame.gray, p, "of 255")}};
  if (inside(view.frame.colour, p)) {
    const auto& bgr = view.frame.colour.at<cv::Vec3b>(p.y(), p.x());
    rows.emplace_back("Red, green, blue", fmt::format("{}, {}, {}", bgr[2], bgr[1], bgr[0]));
  }
  if (inside(view.frame.depth, p)) {
    const float z = view.frame.depth.at<float>(p.y(), p.x());
    rows.emplace_back("Depth", z > 0.0F ? fmt::format("{:.3f} m", z) : "not measured");
  }
  if (!view.motion.rounds.empty()) {
    const MotionRound& round = view.motion.rounds.back();
    rows.emplace_back("Difference, forward", byte_at(round.forward.difference, p, "grey levels"));
    rows.emplace_back("Threshold, forward", fmt::format("{:.0f} grey levels", round.forward.threshold));
    rows.emplace_back("In the forward mask", mask_at(round.forward.mask, p));
    rows.emplace_back("In the backward mask", mask_at(round.backward_mask_in_target, p));
    rows.emplace_back("In the union", mask_at(round.mask, p));
    if (inside(round.labels, p)) {
      const int region = round.labels.at<int>(p.y(), p.x());
      if (region > 0) {
        const auto& box = round.regions[static_cast<std::size_t>(region - 1)];
        rows.emplace_back("Region", fmt::format("{}: {} px", region, box.area));
      }
    }
  }
  rows.emplace_back("Removed", view.mask.empty() ? "no" : mask_at(view.mask, p));
  if (!view.truth.moving.empty()) rows.emplace_back("Truly moving", mask_at(view.truth.moving, p));
  return rows;
}

std::string position_text(const Pose& pose) {
  const Eigen::Vector3d t = pose.translation();
  return fmt::format("{:.3f}, {:.3f}, {:.3f} m", t.x(), t.y(), t.z());
}

Rows record_rows(const SessionView& session, const FrameRecord& r) {
  // Only methods that judge by homographies have rounds.
  const bool rounds = r.motion_rounds > 0;
  Rows rows{
      {"Frame", fmt::format("{} of {}", r.index, session.frame_count)},
      {"Time", fmt::format("{:.3f} s", r.timestamp - series_start(session))},
      {"Stamp", fmt::format("{:.4f} s", r.timestamp)},
      {"Status", std::string(to_string(r.status))},
      {"Note", r.note.empty() ? "–" : r.note},
      {"Position", position_text(r.world_from_camera)},
      {"Turned",
       fmt::format("{:.2f} °", rotation_angle(r.world_from_camera.linear()) * 180.0 / 3.14159265358979)},
      {"Pose", r.estimated ? "estimated" : "predicted"},
      {"Pose begun from", std::string(to_string(r.pose_start))},
      {"Refers to keyframe", r.reference_keyframe == kNone ? "–" : fmt::format("{}", r.reference_keyframe)},
      {"Features found", fmt::format("{}", r.features_found)},
      {"Features removed", fmt::format("{}", r.features_removed)},
      {"Features kept", fmt::format("{}", r.features_kept)},
      {"Mask", fmt::format("{:.2f} % of the pixels", 100.0 * r.mask_share)},
      {"Motion rounds", rounds ? fmt::format("{}", r.motion_rounds) : "–"},
      {"Static tracks", rounds ? fmt::format("{}", r.static_tracks) : "–"},
      {"Homography RMS", rounds ? fmt::format("{:.3f} px", r.homography_rms_px) : "–"},
      {"Matches", fmt::format("{}", r.matches)},
      {"Inliers", fmt::format("{}", r.inliers)},
      {"Reprojection RMS", fmt::format("{:.3f} px", r.rms_px)},
      {"Refining steps", fmt::format("{}", r.refine_iterations)},
      {"Keyframe", yes(r.keyframe)},
      {"New points", fmt::format("{}", r.new_points)},
      {"Fused points", fmt::format("{}", r.fused_points)},
      {"Culled points", fmt::format("{}", r.culled_points)},
      {"Culled keyframes", fmt::format("{}", r.culled_keyframes)},
      {"Map points", fmt::format("{}", r.map_points)},
      {"Map keyframes", fmt::format("{}", r.map_keyframes)}};
  if (r.bundle_iterations > 0) {
    rows.emplace_back("Bundle RMS", fmt::format("{:.3f} → {:.3f} px in {} steps", r.bundle_rms_before_px,
                                                r.bundle_rms_px, r.bundle_iterations));
  } else {
    rows.emplace_back("Bundle RMS", "none applied");
  }
  rows.emplace_back("Took", fmt::format("{:.1f} ms", r.ms.total));
  return rows;
}

/// The pixel the mouse points at, and the frame's record: every figure with its unit.
class InspectorPanel final : public NamedPanel {
 public:
  explicit InspectorPanel(Shared shared) : NamedPanel("inspector", "Inspector", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions&) override {
    const FrameView& view = *session.current;
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const bool wide = room.x > 700.0F * frame.scale;
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const bool has_pixel = shared_->pixel && inside(view.frame.gray, *shared_->pixel);
    const float left = std::floor(wide ? 0.36F * room.x : room.x);
    const float height = wide        ? room.y
                         : has_pixel ? std::floor(0.5F * room.y)
                                     : 2.6F * ImGui::GetTextLineHeightWithSpacing();
    ImGui::BeginChild("pixel", {left, height});
    heading(frame, "Pixel under the mouse");
    if (has_pixel)
      table(frame, "pixel", pixel_rows(view, *shared_->pixel), 1);
    else
      ImGui::TextDisabled("Point at an image to read its pixel.");
    ImGui::EndChild();
    if (wide) ImGui::SameLine(0.0F, gap);
    ImGui::BeginChild("record");
    heading(frame, fmt::format("Record of frame {}", view.index));
    if (view.record != nullptr)
      table(frame, "record", record_rows(session, *view.record), 2);
    else
      ImGui::TextDisabled("Frame %d has not been processed yet.", view.index);
    ImGui::EndChild();
  }

 private:
  static void heading(const UiFrame& frame, const std::string& text) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopFont();
  }

  /// Names and values, in as many pairs of columns.
  static void table(const UiFrame& frame, const char* id, const Rows& rows, int pairs) {
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {4.0F * frame.scale, 1.5F * frame.scale});
    if (ImGui::BeginTable(id, 2 * pairs, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp)) {
      float widest = 0.0F;
      for (const auto& [name, value] : rows) widest = std::max(widest, ImGui::CalcTextSize(name.c_str()).x);
      for (int pair = 0; pair < pairs; ++pair) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, widest);
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
      }
      const auto count = static_cast<int>(rows.size()), lines = (count + pairs - 1) / pairs;
      for (int line = 0; line < lines; ++line) {
        ImGui::TableNextRow();
        for (int pair = 0; pair < pairs; ++pair) {
          const int i = line + pair * lines;
          if (i >= count) continue;
          const auto& [name, value] = rows[static_cast<std::size_t>(i)];
          ImGui::TableNextColumn();
          ImGui::TextDisabled("%s", name.c_str());
          ImGui::TableNextColumn();
          ImGui::TextWrapped("%s", value.c_str());
        }
      }
      ImGui::EndTable();
    }
    ImGui::PopStyleVar();
    ImGui::PopFont();
  }
};

}  // namespace

std::unique_ptr<Panel> make_inspector_panel(Shared shared) {
  return std::make_unique<InspectorPanel>(std::move(shared));
}

}  // namespace stillpoint
