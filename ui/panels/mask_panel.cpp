#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/mask_scores.hpp"
#include "core/motion/paper/compensation.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

constexpr float kBesideFrom = 640.0F;  // design px: from this width on the truth stands beside unasked

std::string name_of(MaskKind kind) {
  return kind == MaskKind::kForward    ? "forward_mask"
         : kind == MaskKind::kBackward ? "backward_mask"
                                       : "union_mask";
}

std::string title_of(MaskKind kind) {
  return kind == MaskKind::kForward    ? "Forward mask"
         : kind == MaskKind::kBackward ? "Backward mask"
                                       : "Union mask";
}

std::string percent(std::optional<double> share) {
  return share ? fmt::format("{:.0f} %", 100.0 * *share) : std::string("–");
}

/// A motion mask of the paper, as it stands after a round: over its frame or alone, beside what truly moves.
class MaskPanel final : public FramePanel {
 public:
  MaskPanel(MaskKind kind, Shared shared)
      : FramePanel(name_of(kind), title_of(kind), std::move(shared)),
        kind_(kind),
        role_(kind == MaskKind::kForward    ? Role::kForward
              : kind == MaskKind::kBackward ? Role::kBackward
                                            : Role::kUnion) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (draw_missing_motion(frame, session)) return;
    const FrameView& view = *session.current;
    const bool has_truth = !view.truth.moving.empty();
    draw_controls(frame, view, has_truth);
    const MotionRound& round = view.motion.rounds[static_cast<std::size_t>(round_shown(view, round_))];
    const int variant = variant_of(view);
    const Frame& ground = kind_ == MaskKind::kBackward && stage_ != kCarried ? view.reference : view.frame;
    const Texture& tint = tint_.get(frame, session.current, variant, [&] {
      mask_ = mask_of(round);
      outlines_ = outlines_of(mask_);
      score_ = has_truth ? score_mask(mask_in_target(round), view.truth.moving) : MaskScore{};
      return tinted_mask(mask_, role_colour(role_, frame.theme.name));
    });

    const bool beside = has_truth && shows_truth(frame);
    const Footer footer = footer_of(frame, session, round, ground, has_truth, beside);
    const ImVec2 room = room_above(frame, footer);
    const Tiling tiling = tile(frame, room, beside ? 2 : 1, picture_of(ground).size());
    ImageContent content;
    content.values = &ground.gray;
    if (look_ == kAlone) {
      content.texture = &alone_.get(frame, session.current, variant, [&] {
        return plain_mask(mask_, role_colour(role_, frame.theme.name), frame.theme.plot);
      });
      content.values = &mask_;
    } else {
      content.texture = &ground_.get(frame, session.current, &ground == &view.frame ? 0 : 1,
                                     [&] { return picture_of(ground); });
      content.overlays.push_back({&tint, opacity_});
    }
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const FramePlace place{session, actions,
                           &ground == &view.frame ? FrameSpace::kTarget : FrameSpace::kReference};
    const ImageResponse response = draw_frame_image(frame, "mask", content, *shared_, tiling.size, place,
                                                    beside ? heading(ground, session) : "");
    push_clip(response);
    if (look_ == kOverlay) draw_outlines(frame, response, outlines_, role_colour(role_, frame.theme.name));
    if (kind_ == MaskKind::kUnion && stage_ == kCleaned) draw_regions(frame, response, round.regions);
    pop_clip();
    if (beside) draw_truth(frame, {session, actions}, round, tiling, start, variant);
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
  }

 private:
  enum Stage { kCleaned, kRaw, kCarried };
  enum LookAt { kOverlay, kAlone };

  void draw_controls(const UiFrame& frame, const FrameView& view, bool has_truth) {
    Controls controls(frame);
    std::vector<std::string> stages{"Cleaned", "Raw"};
    if (kind_ == MaskKind::kBackward) stages.push_back("Carried to t");
    controls.choice("stage", stages, stage_,
                    "Raw is what is above the threshold; erosion and dilation clean it");
    controls.choice("look", {"Overlay", "Alone"}, look_);
    if (look_ == kOverlay) controls.slider("##opacity", opacity_, 0.0F, 1.0F, "opacity %.2f");
    controls.round(static_cast<int>(view.motion.rounds.size()), round_);
    if (!has_truth) return;
    bool beside = shows_truth(frame);
    if (controls.toggle("Truth", beside, "Shows what truly moves beside it")) beside_ = beside;
  }

  [[nodiscard]] bool shows_truth(const UiFrame& frame) const {
    return beside_.value_or(ImGui::GetContentRegionAvail().x >= kBesideFrom * frame.scale);
  }

  [[nodiscard]] int variant_of(const FrameView& view) const { return 3 * round_shown(view, round_) + stage_; }

  [[nodiscard]] cv::Mat mask_of(const MotionRound& round) const {
    if (kind_ == MaskKind::kForward) return stage_ == kRaw ? round.forward.raw_mask : round.forward.mask;
    if (kind_ == MaskKind::kBackward) {
      if (stage_ == kCarried) return round.backward_mask_in_target;
      return stage_ == kRaw ? round.backward.raw_mask : round.backward.mask;
    }
    return stage_ == kRaw ? raw_union(round) : round.mask;
  }

  /// The mask where the truth is known: in the target's camera.
  [[nodiscard]] cv::Mat mask_in_target(const MotionRound& round) const {
    if (kind_ != MaskKind::kBackward || stage_ == kCarried) return mask_of(round);
    if (stage_ == kCleaned) return round.backward_mask_in_target;
    return carried(round);
  }

  /// The backward direction's raw mask in the target's camera.
  [[nodiscard]] static cv::Mat carried(const MotionRound& round) {
    return carry_mask(round.backward.raw_mask, round.backward.homography.matrix.inv());
  }

  [[nodiscard]] static cv::Mat raw_union(const MotionRound& round) {
    if (round.forward.raw_mask.empty() || round.backward.raw_mask.empty()) return round.mask;
    return round.forward.raw_mask | carried(round);
  }

  [[nodiscard]] std::string heading(const Frame& ground, const SessionView& session) const {
    return &ground == &session.current->frame ? "Found in frame t" : "Found in the frame before";
  }

  void draw_regions(const UiFrame& frame, const ImageResponse& response,
                    const std::vector<MotionRegion>& regions) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 ink = to_u32(role_colour(role_, frame.theme.name));
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const cv::Rect& box = regions[i].box;
      const ImVec2 low = response.to_screen(Eigen::Vector2d(box.x, box.y));
      const ImVec2 high = response.to_screen(Eigen::Vector2d(box.x + box.width, box.y + box.height));
      list.AddRect(low, high, ink, 0.0F, ImDrawFlags_None, frame.scale);
      // A number inside a small region would cover it.
      const bool inside = high.y - low.y > 36.0F * frame.scale && high.x - low.x > 30.0F * frame.scale;
      const float above = inside ? -2.0F * frame.scale : frame.fonts.small->FontSize + 3.0F * frame.scale;
      draw_label(frame, {low.x + (inside ? 2.0F * frame.scale : 0.0F), low.y - above},
                 fmt::format("{}", i + 1), frame.theme.text);
    }
  }

  void draw_truth(const UiFrame& frame, const FramePlace& place, const MotionRound& round,
                  const Tiling& tiling, ImVec2 start, int variant) {
    const SessionView& session = place.session;
    ImGui::SetCursorScreenPos(tiling.corner(start, 1));
    const FrameView& view = *session.current;
    const Texture& compared = compared_.get(frame, session.current, variant, [&] {
      return compared_masks(mask_in_target(round), view.truth.moving);
    });
    ImageContent content;
    content.texture = &truth_ground_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.truth.moving;
    content.overlays.push_back({&compared, 1.0F});
    draw_frame_image(frame, "truth", content, *shared_, tiling.size, place, "Against the truth in frame t");
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session, const MotionRound& round,
                                 const Frame& ground, bool has_truth, bool beside) const {
    Footer footer;
    const char* what = stage_ == kRaw ? "above the threshold" : "taken for moving";
    footer.legend.push_back({what, role_colour(role_, frame.theme.name), Sign::kSquare});
    if (beside) {
      const ComparisonColours colours;
      footer.legend.push_back({"agrees with the truth", colours.agreed, Sign::kSquare});
      footer.legend.push_back({"missed", colours.missed, Sign::kHatch});
      footer.legend.push_back({"taken wrongly", colours.wrong, Sign::kBackHatch});
    }
    const double share =
        mask_.empty() ? 0.0
                      : static_cast<double>(cv::countNonZero(mask_)) / static_cast<double>(mask_.total());
    footer.caption = fmt::format("{}: {:.1f} % of the pixels", frame_text(session, ground), 100.0 * share);
    if (kind_ == MaskKind::kUnion && stage_ == kRaw) {
      footer.caption += ", both directions' before clean-up";
    } else if (kind_ == MaskKind::kUnion) {
      footer.caption +=
          fmt::format(", {} region{}", round.regions.size(), round.regions.size() == 1 ? "" : "s");
    } else {
      const DirectionTrace& direction = kind_ == MaskKind::kForward ? round.forward : round.backward;
      footer.caption += fmt::format(", threshold {:.0f} grey levels", direction.threshold);
      if (!direction.homography.valid) footer.caption += ", no homography of its own";
    }
    footer.caption += fmt::format(", round {} of {}.", 1 + round_shown(*session.current, round_),
                                  session.current->motion.rounds.size());
    if (has_truth) {
      footer.caption += fmt::format(" Precision {}, recall {}, IoU {}.", percent(score_.precision()),
                                    percent(score_.recall()), percent(score_.iou()));
    }
    footer.caption += whose_motion(session);
    return footer;
  }

  MaskKind kind_;
  Role role_;
  int stage_ = kCleaned, look_ = kOverlay, round_ = -1;
  float opacity_ = 0.45F;
  std::optional<bool> beside_;
  FrameTexture ground_, tint_, alone_, compared_, truth_ground_;
  cv::Mat mask_;
  Outlines outlines_;
  MaskScore score_;
};

}  // namespace

std::unique_ptr<Panel> make_mask_panel(MaskKind kind, Shared shared) {
  return std::make_unique<MaskPanel>(kind, std::move(shared));
}

}  // namespace stillpoint
