#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/inspect/frame_view.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/theme/colormap.hpp"

namespace stillpoint {
namespace {

/// Says what is missing, where a frame has nothing of a stereo pair. @returns whether it has
bool has_stereo(const UiFrame& frame, const SessionView& session) {
  const Frame& shown = session.current->frame;
  if (!session.camera.is_stereo())
    draw_absent(frame, "This sequence is not stereo: its depth comes of a sensor.");
  else if (!shown.readable())
    draw_absent(frame, missing_motion(session));
  else if (!shown.stereo)
    draw_absent(frame, shown.problem.empty() ? "This frame has no right image."
                                             : fmt::format("This frame was not matched: {}", shown.problem));
  return session.camera.is_stereo() && shown.readable() && shown.stereo != nullptr;
}

/// How far apart left and right show each pixel: what depth is made of.
class DisparityPanel final : public FramePanel {
 public:
  explicit DisparityPanel(Shared shared) : FramePanel("disparity", "Disparity", std::move(shared)) {}

  [[nodiscard]] bool shows_a_run() const override { return false; }
  [[nodiscard]] bool is_for(const SessionView& session) const override { return session.camera.is_stereo(); }
  [[nodiscard]] PanelSize least() const override { return {300.0F, 190.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (!has_stereo(frame, session)) return;
    const FrameView& view = *session.current;
    Controls controls(frame);
    controls.choice("what", {"Disparity", "Right image"}, what_);
    const FramePlace place{session, actions, FrameSpace::kTarget};
    if (what_ == kRight) {
      draw_right(frame, place, view);
      return;
    }
    ColourScale scale;
    scale.unit = "px";
    scale.none = "no match";
    scale.none_colour = no_value_colour(frame.theme);
    scale.colour = [this](double d) {
      return map_colour(Colormap::kViridis, static_cast<float>(d / highest_px_));
    };
    const Texture& texture = texture_.get(frame, session.current, 0, [&] {
      collect(view.frame.depth, session.camera);
      scale.high = highest_px_;
      return coloured(disparity_, scale, true);
    });
    scale.high = highest_px_;
    Footer footer;
    footer.caption = fmt::format("{}. Matched on {:.0f} % of the pixels", frame_text(session, view.frame),
                                 100.0 * covered_);
    if (median_px_ > 0) {
      const double z = session.camera.fx * session.camera.baseline_m / median_px_;
      footer.caption += fmt::format(", median {:.1f} px: {:.2f} m ± {:.0f} mm (1 σ)", median_px_, z,
                                    1000.0 * session.camera.stereo_sigma(z));
    }
    footer.caption +=
        fmt::format(". Baseline {:.3f} m.", session.camera.baseline_m) + same_in_all_runs(frame);
    ImageContent content;
    content.texture = &texture;
    content.values = &disparity_;
    draw_scaled_image(frame, "disparity", content, *shared_, room_above(frame, footer), place, scale);
    footer.draw(frame);
  }

 private:
  enum What { kDisparity, kRight };

  void draw_right(const UiFrame& frame, const FramePlace& place, const FrameView& view) {
    const cv::Mat& right = view.frame.stereo->right;
    Footer footer;
    footer.caption = fmt::format("{}, as the right camera saw it; rows correspond.",
                                 frame_text(place.session, view.frame)) +
                     same_in_all_runs(frame);
    ImageContent content;
    content.texture = &right_.get(frame, place.session.current, 0, [&] { return right; });
    content.values = &right;
    draw_frame_image(frame, "right", content, *shared_, room_above(frame, footer));
    footer.draw(frame);
  }

  void collect(const cv::Mat& depth, const Camera& camera) {
    disparity_ =
        depth.empty() ? cv::Mat::zeros(camera.height, camera.width, CV_32FC1) : disparity_of(depth, camera);
    std::vector<float> known;
    for (int y = 0; y < disparity_.rows; y += 2)
      for (int x = 0; x < disparity_.cols; x += 2)
        if (const float d = disparity_.at<float>(y, x); d > 0.0F) known.push_back(d);
    covered_ = static_cast<double>(cv::countNonZero(disparity_)) / static_cast<double>(disparity_.total());
    median_px_ = 0.0, highest_px_ = 16.0;
    if (known.empty()) return;
    const auto at = [&known](double share) {
      const auto place =
          known.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(known.size() - 1));
      std::nth_element(known.begin(), place, known.end());
      return static_cast<double>(*place);
    };
    median_px_ = at(0.5);
    // In steps, so that the scale stays while playing.
    highest_px_ = std::max(16.0, 8.0 * std::ceil(at(0.98) / 8.0));
  }

  int what_ = kDisparity;
  FrameTexture texture_, right_;
  cv::Mat disparity_;
  double covered_ = 0.0, median_px_ = 0.0, highest_px_ = 16.0;
};

struct HoleKind {
  StereoHole hole;
  const char* name;
  Rgb colour;
};
constexpr std::array<HoleKind, 4> kHoles{
    {{StereoHole::outside, "beyond the right image", okabe_ito::kSkyBlue},
     {StereoHole::rejected, "plain, repeated or hidden", okabe_ito::kVermillion},
     {StereoHole::speckle, "speckle", okabe_ito::kYellow},
     {StereoHole::range, "too near or too far", okabe_ito::kPurple}}};

/// Where left and right were not matched, and why.
class StereoHolesPanel final : public FramePanel {
 public:
  explicit StereoHolesPanel(Shared shared) : FramePanel("stereo_holes", "Stereo holes", std::move(shared)) {}

  [[nodiscard]] bool shows_a_run() const override { return false; }
  [[nodiscard]] bool is_for(const SessionView& session) const override { return session.camera.is_stereo(); }
  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (!has_stereo(frame, session)) return;
    const FrameView& view = *session.current;
    Controls(frame).slider("##opacity", opacity_, 0.0F, 1.0F, "opacity %.2f");
    const Texture& tint =
        tint_.get(frame, session.current, 0, [&] { return tinted(view.frame.stereo->holes); });
    Footer footer;
    for (std::size_t i = 0; i < kHoles.size(); ++i)
      footer.legend.push_back(
          {fmt::format("{} {:.1f} %", kHoles[i].name, 100.0 * shares_[i]), kHoles[i].colour, Sign::kSquare});
    footer.caption = fmt::format("{}. No depth on {:.1f} % of the pixels.", frame_text(session, view.frame),
                                 100.0 * all_) +
                     same_in_all_runs(frame);
    ImageContent content;
    content.texture = &ground_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.frame.stereo->holes;
    content.overlays.push_back({&tint, opacity_});
    draw_frame_image(frame, "holes", content, *shared_, room_above(frame, footer),
                     {session, actions, FrameSpace::kTarget});
    footer.draw(frame);
  }

 private:
  /// CV_8UC4: each hole in the colour of its kind; counts them, too.
  cv::Mat tinted(const cv::Mat& holes) {
    cv::Mat tint(holes.size(), CV_8UC4, cv::Scalar::all(0));
    all_ = 0.0;
    for (std::size_t i = 0; i < kHoles.size(); ++i) {
      const cv::Mat mask = holes == static_cast<int>(kHoles[i].hole);
      shares_[i] = static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
      all_ += shares_[i];
      const Rgb colour = kHoles[i].colour;
      tint.setTo(cv::Scalar(colour.b, colour.g, colour.r, 255), mask);
    }
    return tint;
  }

  float opacity_ = 0.6F;
  FrameTexture ground_, tint_;
  std::array<double, kHoles.size()> shares_{};
  double all_ = 0.0;
};

}  // namespace

std::unique_ptr<Panel> make_disparity_panel(Shared shared) {
  return std::make_unique<DisparityPanel>(std::move(shared));
}

std::unique_ptr<Panel> make_stereo_holes_panel(Shared shared) {
  return std::make_unique<StereoHolesPanel>(std::move(shared));
}

}  // namespace stillpoint
