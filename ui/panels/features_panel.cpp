#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/counted.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/feature_selection.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/feature_card.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/panels_shared.hpp"

namespace stillpoint {
namespace {

/// The ORB features: before removal kept and removed, after removal what tracking made of those kept.
class FeaturesPanel final : public FramePanel {
 public:
  FeaturesPanel(FeatureMoment moment, Shared shared)
      : FramePanel(moment == FeatureMoment::kBefore ? "features_before" : "features_after",
                   moment == FeatureMoment::kBefore ? "Features before removal" : "Features after removal",
                   std::move(shared)),
        moment_(moment) {}

  [[nodiscard]] bool shows_image_alone() const override { return true; }

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<FeaturesPanel>(moment_, shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    if (view.image_alone) {
      draw_image_alone(frame, session, actions, ground_, *shared_);
      return;
    }
    if (view.record == nullptr) {
      draw_absent(frame, fmt::format("Frame {} has not been processed yet.", view.index));
      return;
    }
    // Features of a record whose image is gone still say where they were.
    if (!view.record->measured.features) {
      draw_without(frame, session, actions, ground_, *shared_,
                   fmt::format("{} left no features of frame {}.", session.run->name, view.index));
      return;
    }
    if (!view.frame.readable() && view.record->features.empty()) {
      draw_absent(frame, missing_motion(session));
      return;
    }
    if (view.record->features.empty() && view.record->features_found > 0) {
      draw_absent(frame, fmt::format("Frame {}'s {} features were not kept in its record.", view.index,
                                     view.record->features_found));
      return;
    }
    Controls controls(frame);
    if (moment_ == FeatureMoment::kBefore) {
      controls.toggle("Mask", mask_, "Lays the mask under the features it removes");
    } else {
      controls.toggle("Unmatched", unmatched_, "Shows features for which no map point was found");
      controls.toggle("By scale", by_scale_, "Draws each feature as large as its pyramid level");
    }
    const Footer footer = footer_of(frame, session, *view.record);
    ImageContent content;
    content.texture = &ground_.get(frame, session.current, 0, [&] {
      return view.frame.readable()
                 ? view.frame.gray
                 : cv::Mat(session.camera.height, session.camera.width, CV_8UC1, cv::Scalar(70));
    });
    content.values = view.frame.readable() ? &view.frame.gray : nullptr;
    if (moment_ == FeatureMoment::kBefore && mask_ && !view.mask.empty()) {
      content.overlays.push_back(tint_.over(frame, session.current, 0, 0.35F,
                                            role_colour(Role::kUnion, frame.theme.name),
                                            [&] { return cover_of(view.mask); }));
    }
    const ImageResponse response =
        draw_frame_image(frame, "features", content, *shared_, room_above(frame, footer), {session, actions});
    push_clip(response);
    for (const FeatureRecord& feature : view.record->features) draw_feature(frame, response, feature);
    pop_clip();
    take_feature(frame, session, response);
    footer.draw(frame);
  }

 private:
  [[nodiscard]] LegendEntry look_of(FeatureFate fate, ThemeName theme) const {
    if (fate == FeatureFate::removed) return {"removed", role_colour(Role::kRemoved, theme), Sign::kCross};
    if (moment_ == FeatureMoment::kBefore) return {"kept", role_colour(Role::kKept, theme), Sign::kCircle};
    if (fate == FeatureFate::inlier) return {"inlier", role_colour(Role::kInlier, theme), Sign::kCircle};
    if (fate == FeatureFate::outlier) return {"outlier", role_colour(Role::kOutlier, theme), Sign::kTriangle};
    return {"unmatched", okabe_ito::kSkyBlue, Sign::kRing};
  }

  [[nodiscard]] bool shows(const FeatureRecord& feature) const {
    if (moment_ == FeatureMoment::kBefore) return true;
    return feature.fate != FeatureFate::removed && (feature.fate != FeatureFate::unmatched || unmatched_);
  }

  /// The feature under the mouse tells its explanation in short; a click chooses it for all panels, one
  /// beside every feature lets go.
  void take_feature(const UiFrame& frame, const SessionView& session, const ImageResponse& response) {
    if (!response.image_point) return;
    const FrameRecord& record = *session.current->record;
    const Eigen::Vector2d mouse = to_pixel(*response.image_point);
    const double reach = kReach * static_cast<double>(frame.scale) / response.map.scale();
    const auto index = feature_near(record, mouse, reach);
    if (index && !shows(record.features[static_cast<std::size_t>(*index)])) return;
    if (response.clicked && index) choose_feature(session, *shared_, *index);
    if (response.clicked && !index) shared_->feature.reset();
    if (!index) return;
    if (hovered_ != *index || !same_view(session.current)) {
      explanation_ =
          explain_feature(*session.current, *session.run, session.camera, *session.map_points, *index);
      hovered_ = *index;
      hovered_in_ = session.current;
    }
    push_clip(response);
    draw_explanation_marks(frame, response, explanation_);
    pop_clip();
    draw_explanation_tooltip(frame, explanation_);
  }

  [[nodiscard]] bool same_view(const std::shared_ptr<const FrameView>& view) const {
    return !hovered_in_.owner_before(view) && !view.owner_before(hovered_in_);
  }

  void draw_feature(const UiFrame& frame, const ImageResponse& response, const FeatureRecord& feature) const {
    if (!shows(feature)) return;
    const LegendEntry look = look_of(feature.fate, frame.theme.name);
    float radius = (look.sign == Sign::kCircle ? 2.6F : 3.2F) * frame.scale * share_of_sign(frame, response);
    if (by_scale_ && moment_ == FeatureMoment::kAfter)
      radius = std::max(radius, static_cast<float>(response.map.scale()) * 2.0F *
                                    std::pow(1.2F, static_cast<float>(feature.octave)));
    draw_sign(frame, *ImGui::GetWindowDrawList(), response.to_screen(to_raster(feature.pixel)), radius,
              look.sign, to_u32(look.colour, strength(feature)));
  }

  /// Small pictures get smaller signs, which would hide them.
  [[nodiscard]] static float share_of_sign(const UiFrame& frame, const ImageResponse& response) {
    constexpr float kFromScale =
        0.45F;  // design px an image's pixel: from there on signs have their full size
    return std::clamp(static_cast<float>(response.map.scale()) / frame.scale / kFromScale, 0.5F, 1.0F);
  }

  /// The less a feature weighs in the pose, the fainter it is drawn.
  [[nodiscard]] float strength(const FeatureRecord& feature) const {
    constexpr float kFaintest = 0.3F;  // opacity of a feature without weight: it is still seen
    const bool weighs = moment_ == FeatureMoment::kAfter && feature.fate == FeatureFate::inlier;
    return weighs ? kFaintest + (1.0F - kFaintest) * feature.static_weight : 1.0F;
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session,
                                 const FrameRecord& record) const {
    Footer footer;
    const auto add = [&](FeatureFate fate, int count) {
      LegendEntry entry = look_of(fate, frame.theme.name);
      entry.name = fmt::format("{} {}", count, entry.name);
      footer.legend.push_back(std::move(entry));
    };
    std::array<int, 4> counts{};
    for (const FeatureRecord& feature : record.features) ++counts[static_cast<std::size_t>(feature.fate)];
    std::string where = frame_text(session, session.current->frame);
    if (!session.current->frame.readable()) where += ", its image missing";
    if (moment_ == FeatureMoment::kBefore) {
      add(FeatureFate::unmatched, record.features_kept);
      add(FeatureFate::removed, record.features_removed);
      footer.caption = fmt::format("{}: {} found", where, counted(record.features_found, "feature"));
      // Another program's own mask, if it has one, need not be what took its features out.
      if (record.measured.solving)
        footer.caption += fmt::format("; method {} removes {}.", judge_of(session), removed_text(record));
      else if (record.measured.mask)
        footer.caption += fmt::format("; the mask is {:.1f} % of the image.", 100.0 * record.mask_share);
      else
        footer.caption += ".";
      return footer;
    }
    for (const FeatureFate fate : {FeatureFate::inlier, FeatureFate::outlier, FeatureFate::unmatched})
      add(fate, counts[static_cast<std::size_t>(fate)]);
    footer.caption = fmt::format("{}: {} features kept, {} matched to map points", where,
                                 record.features_kept, record.matches);
    footer.caption +=
        std::isnan(record.rms_px) ? "." : fmt::format("; inliers' residual {:.2f} px RMS.", record.rms_px);
    if (const int faint = weighing_little(record.features); faint > 0)
      footer.caption += fmt::format(" {} drawn faintly weigh less than half in the pose.", faint);
    return footer;
  }

  /// "those in its mask, 4.6 % of the image"; methods that judge features have none, and the baseline
  /// neither.
  [[nodiscard]] static std::string removed_text(const FrameRecord& record) {
    if (record.mask_share > 0.0)
      return fmt::format("those in its mask, {:.1f} % of the image", 100.0 * record.mask_share);
    return record.features_removed > 0 ? fmt::format("{} of them", record.features_removed) : "none";
  }

  FeatureMoment moment_;
  static constexpr double kReach = 9.0;  // design px about the mouse

  bool mask_ = true, unmatched_ = true, by_scale_ = false;
  int hovered_ = -1;
  std::weak_ptr<const FrameView> hovered_in_;
  FeatureExplanation explanation_;
  FrameTexture ground_, tint_ = FrameTexture::cover();
};

}  // namespace

std::unique_ptr<Panel> make_features_panel(FeatureMoment moment, Shared shared) {
  return std::make_unique<FeaturesPanel>(moment, std::move(shared));
}

}  // namespace stillpoint
