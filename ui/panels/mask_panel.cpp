#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/evaluation/mask_scores.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/regions.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/sequence/frame.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr float kBesideFrom = 640.0F;  // design px: from this width on the truth stands beside unasked

std::string as_sentence(std::string text) {
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

std::string percent(std::optional<double> share) {
  return share ? fmt::format("{:.0f} %", 100.0 * *share) : std::string("–");
}

/// A mask over its frame or alone, beside what is truly dynamic: the one that the run used, or one that a
/// stage of its method made.
class MaskPanel final : public FramePanel {
 public:
  MaskPanel(MaskPanelInfo info, Shared shared)
      : FramePanel(info.name, info.title, std::move(shared)), info_(std::move(info)) {}

  [[nodiscard]] bool shows_image_alone() const override { return true; }

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<MaskPanel>(info_, shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    if (view.image_alone) {
      draw_image_alone(frame, session, actions, ground_, *shared_);
      return;
    }
    if (is_the_runs()) {
      if (!view.frame.readable() || view.record == nullptr) {
        draw_absent(frame, missing_motion(session));
        return;
      }
      if (!view.record->measured.mask) {
        draw_without(frame, session, actions, ground_, *shared_,
                     fmt::format("{} left no mask of frame {}.", session.run->name, view.index));
        return;
      }
      log_ = view.motion.get();
      mask_ = view.mask.empty() ? cv::Mat::zeros(view.frame.gray.size(), CV_8UC1) : view.mask;
      in_target_ = mask_;
      space_ = FrameSpace::kTarget;
    } else {
      log_ = stages_or_absent(frame, session, actions, name(), info_.layer);
      if (log_ == nullptr) return;
    }
    const bool has_truth = !view.truth.moving.empty();
    draw_controls(frame, has_truth);
    if (!is_the_runs()) take_layers();
    const int variant = 3 * round_shown(*log_, round_) + stage_;
    const Frame& ground = space_ == FrameSpace::kReference ? view.reference : view.frame;
    const ImageOverlay tint = tint_.over(frame, session.current, variant, opacity_, colour(frame), [&] {
      outlines_ = outlines_of(mask_);
      regions_ = stage_ == kCleaned ? find_regions(mask_).regions : std::vector<MotionRegion>();
      score_ = has_truth && !in_target_.empty() ? score_mask(in_target_, view.truth.moving) : MaskScore{};
      return cover_of(mask_);
    });

    const bool beside = has_truth && !in_target_.empty() && shows_truth(frame);
    const Footer footer = footer_of(frame, session, ground, has_truth, beside);
    const ImVec2 room = room_above(frame, footer);
    const Tiling tiling = tile(frame, room, beside ? 2 : 1, picture_of(ground).size());
    ImageContent content;
    content.values = &ground.gray;
    if (look_ == kAlone) {
      content.texture = &alone_.get(frame, session.current, variant,
                                    [&] { return plain_mask(mask_, colour(frame), frame.theme.plot); });
      content.values = &mask_;
    } else {
      content.texture = &ground_.get(frame, session.current, &ground == &view.frame ? 0 : 1,
                                     [&] { return picture_of(ground); });
      content.overlays.push_back(tint);
    }
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const char* heading = &ground == &view.frame ? "Found in frame t" : "Found in the reference frame";
    const ImageResponse response = draw_frame_image(frame, "mask", content, *shared_, tiling.size,
                                                    {session, actions, space_}, beside ? heading : "");
    push_clip(response);
    if (look_ == kOverlay) draw_outlines(frame, response, outlines_, colour(frame));
    if (info_.numbered) draw_regions(frame, response);
    pop_clip();
    if (beside) draw_truth(frame, {session, actions}, tiling, start, variant);
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
  }

 private:
  enum StageShown { kCleaned, kRaw, kWarped };
  enum LookAt { kOverlay, kAlone };

  [[nodiscard]] bool is_the_runs() const { return info_.layer.empty(); }
  [[nodiscard]] Rgb colour(const UiFrame& frame) const { return role_colour(info_.role, frame.theme.name); }

  void draw_controls(const UiFrame& frame, bool has_truth) {
    Controls controls(frame);
    std::vector<std::string> stages{"Cleaned"};
    if (!info_.raw_layer.empty()) stages.emplace_back("Raw");
    if (!info_.warped_layer.empty()) stages.emplace_back("Warped to t");
    if (stages.size() > 1)
      controls.choice("stage", stages, stage_,
                      "Raw is what is above the threshold; erosion and dilation clean it");
    controls.choice("look", {"Overlay", "Alone"}, look_);
    if (look_ == kOverlay) controls.slider("##opacity", opacity_, 0.0F, 1.0F, "opacity %.2f");
    if (!is_the_runs()) controls.round(log_->rounds(), round_);
    if (!has_truth) return;
    bool beside = shows_truth(frame);
    if (controls.toggle("Truth", beside, "Shows what truly moves beside it")) beside_ = beside;
  }

  [[nodiscard]] bool shows_truth(const UiFrame& frame) const {
    return beside_.value_or(ImGui::GetContentRegionAvail().x >= kBesideFrom * frame.scale);
  }

  /// The mask shown, and the same in the target's camera, where the truth is known.
  void take_layers() {
    const int round = round_shown(*log_, round_);
    const Layer* cleaned = log_->layer(info_.layer, round);
    const Layer* warped = info_.warped_layer.empty() ? nullptr : log_->layer(info_.warped_layer, round);
    const Layer* raw = info_.raw_layer.empty() ? nullptr : log_->layer(info_.raw_layer, round);
    const Layer* shown = stage_ == kRaw ? raw : stage_ == kWarped ? warped : cleaned;
    mask_ = shown != nullptr ? shown->image : cv::Mat();
    space_ = shown != nullptr ? shown->space : FrameSpace::kTarget;
    in_target_ = space_ == FrameSpace::kTarget         ? mask_
                 : warped != nullptr && stage_ != kRaw ? warped->image
                                                       : cv::Mat();
  }

  void draw_regions(const UiFrame& frame, const ImageResponse& response) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 ink = to_u32(colour(frame));
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      const cv::Rect& box = regions_[i].box;
      const ImVec2 low = response.to_screen(RasterPoint(box.x, box.y));
      const ImVec2 high = response.to_screen(RasterPoint(box.x + box.width, box.y + box.height));
      list.AddRect(low, high, ink, 0.0F, ImDrawFlags_None, frame.scale);
      // A number inside a small region would cover it.
      const bool inside = high.y - low.y > 36.0F * frame.scale && high.x - low.x > 30.0F * frame.scale;
      const float above = inside ? -2.0F * frame.scale : frame.fonts.small->FontSize + 3.0F * frame.scale;
      draw_label(frame, {low.x + (inside ? 2.0F * frame.scale : 0.0F), low.y - above},
                 fmt::format("{}", i + 1), frame.theme.text);
    }
  }

  void draw_truth(const UiFrame& frame, const FramePlace& place, const Tiling& tiling, ImVec2 start,
                  int variant) {
    const SessionView& session = place.session;
    ImGui::SetCursorScreenPos(tiling.corner(start, 1));
    const FrameView& view = *session.current;
    const Texture& compared = compared_.get(frame, session.current, variant,
                                            [&] { return compared_masks(in_target_, view.truth.moving); });
    ImageContent content;
    content.texture = &truth_ground_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.truth.moving;
    content.overlays.push_back({&compared, 1.0F});
    draw_frame_image(frame, "truth", content, *shared_, tiling.size, place, "Against the truth in frame t");
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session, const Frame& ground,
                                 bool has_truth, bool beside) const {
    Footer footer;
    footer.legend.push_back({stage_ == kRaw ? std::string("above the threshold") : std::string("dynamic"),
                             colour(frame), Sign::kSquare});
    if (beside) {
      const ComparisonColours colours;
      footer.legend.push_back({"agrees with the truth", colours.agreed, Sign::kSquare});
      footer.legend.push_back({"missed", colours.missed, Sign::kHatch});
      footer.legend.push_back({"taken wrongly", colours.wrong, Sign::kBackHatch});
    }
    footer.caption =
        fmt::format("{}: {:.1f} % of the pixels", frame_text(session, ground), percent_set(mask_));
    if (info_.numbered)
      footer.caption += fmt::format(", {} region{}", regions_.size(), regions_.size() == 1 ? "" : "s");
    if (is_the_runs()) {
      footer.caption += fmt::format(": what method {} removed.", log_->method);
      if (!log_->note.empty()) footer.caption += fmt::format(" {}.", as_sentence(log_->note));
    } else {
      if (!info_.values_layer.empty())
        if (const Layer* values = log_->layer(info_.values_layer, round_shown(*log_, round_));
            values != nullptr && values->limit)
          footer.caption += fmt::format(", threshold {:.0f} {}", *values->limit, values->unit);
      if (log_->rounds() > 0)
        footer.caption += fmt::format(", round {} of {}", 1 + round_shown(*log_, round_), log_->rounds());
      footer.caption += '.';
      footer.caption += whose_stages(session, *log_);
    }
    if (has_truth && !in_target_.empty())
      footer.caption += fmt::format(" Precision {}, recall {}, IoU {}.", percent(score_.precision()),
                                    percent(score_.recall()), percent(score_.iou()));
    return footer;
  }

  MaskPanelInfo info_;
  int stage_ = kCleaned, look_ = kOverlay, round_ = -1;
  float opacity_ = 0.45F;
  std::optional<bool> beside_;
  FrameTexture ground_, alone_, compared_, truth_ground_, tint_ = FrameTexture::cover();
  // Of what is being drawn.
  const StageLog* log_ = nullptr;
  cv::Mat mask_, in_target_;
  FrameSpace space_ = FrameSpace::kTarget;
  Outlines outlines_;
  std::vector<MotionRegion> regions_;
  MaskScore score_;
};

}  // namespace

std::unique_ptr<Panel> make_mask_panel(MaskPanelInfo info, Shared shared) {
  return std::make_unique<MaskPanel>(std::move(info), std::move(shared));
}

}  // namespace stillpoint
