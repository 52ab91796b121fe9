#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/pixel_conventions.hpp"
#include "ui/panels/frame_marks.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/view/image_widget.hpp"

namespace stillpoint {

class Texture;
enum class OneChannel;
enum class Sampling;

struct Frame;
struct FrameView;
struct StageLog;

// Pictures made of a frame's images, and textures that hold them as long as the frame stays.

/// A picture on the graphics card, made anew only when the frame, the theme or the variant changes.
class FrameTexture {
 public:
  FrameTexture();  ///< sharp when enlarged, smooth when reduced
  explicit FrameTexture(Sampling sampling);
  /// Of images of one channel, which cover what lies below where they are bright (OneChannel::kCover).
  [[nodiscard]] static FrameTexture cover();
  ~FrameTexture();
  FrameTexture(FrameTexture&&) noexcept;
  FrameTexture& operator=(FrameTexture&&) noexcept;

  const Texture& get(const UiFrame& frame, const std::shared_ptr<const FrameView>& view, int variant,
                     const std::function<cv::Mat()>& make);
  /// The same as something laid over a picture, drawn where it is not transparent alone.
  /// @param make gives CV_8UC4, or CV_8UC1 where this is a cover
  ImageOverlay over(const UiFrame& frame, const std::shared_ptr<const FrameView>& view, int variant,
                    float opacity, Rgb colour, const std::function<cv::Mat()>& make);

 private:
  Sampling sampling_;
  OneChannel one_channel_;
  std::unique_ptr<Texture> texture_;
  cv::Mat image_;                 // that it was made of
  std::optional<cv::Rect> part_;  // of it that is not transparent, once somebody asked
  std::weak_ptr<const FrameView> view_;
  int variant_ = -1;
  ThemeName theme_ = ThemeName::kDark;
};

/// The frame as it is looked at: colour where there is colour.
[[nodiscard]] const cv::Mat& picture_of(const Frame& frame);

/// CV_8UC1: 255 where the mask is set, for textures that cover (OneChannel).
[[nodiscard]] cv::Mat cover_of(const cv::Mat& mask);

/// CV_8UC3: `colour` where the mask is set, `ground` elsewhere.
[[nodiscard]] cv::Mat plain_mask(const cv::Mat& mask, Rgb colour, Rgb ground);

/// CV_8UC3 of CV_32FC1 or CV_8UC1 values by colour; NaN (and, where asked, 0) gets `none`.
[[nodiscard]] cv::Mat coloured(const cv::Mat& values, const ColourScale& scale, bool zero_is_none = false);

struct ComparisonColours {
  Rgb agreed = okabe_ito::kGreen, missed = okabe_ito::kVermillion, wrong = okabe_ito::kYellow;
};
/// CV_8UC4: where mask and truth agree, what the mask missed (hatched /), what it took wrongly (hatched \).
[[nodiscard]] cv::Mat compared_masks(const cv::Mat& mask, const cv::Mat& truth,
                                     const ComparisonColours& colours = {});

/// The outlines of a mask.
using Outlines = std::vector<std::vector<RasterPoint>>;
[[nodiscard]] Outlines outlines_of(const cv::Mat& mask);
void draw_outlines(const UiFrame& frame, const ImageResponse& response, const Outlines& outlines, Rgb colour);

/// Draws an image of a frame with the views all such images share: the cursor, pins and the chosen feature
/// are marked where it shows them, and what the mouse does there is told to all panels.
/// @param place whose pixels the image has
/// @param heading written into the picture's upper left corner
ImageResponse draw_frame_image(const UiFrame& frame, const char* id, const ImageContent& content,
                               PanelsShared& shared, ImVec2 size, const FramePlace& place,
                               const std::string& heading = {});

/// The same for an image with frame t's pixels, without pins and what hangs on the session.
/// @param heading written into the picture's upper left corner
ImageResponse draw_frame_image(const UiFrame& frame, const char* id, const ImageContent& content,
                               PanelsShared& shared, ImVec2 size, const std::string& heading = {});

/// The same for frame t's or another's values as colours, with their scale beside the picture.
/// @param size px, of both together
ImageResponse draw_scaled_image(const UiFrame& frame, const char* id, const ImageContent& content,
                                PanelsShared& shared, ImVec2 size, const FramePlace& place,
                                const ColourScale& scale);

/// The frame's image while what lies over it is still worked out, in the room that its panel leaves it.
void draw_image_alone(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                      FrameTexture& texture, PanelsShared& shared);

/// The same, with another line below it.
void draw_image_alone(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                      FrameTexture& texture, PanelsShared& shared, Footer footer);

/// The frame's image, and below it why nothing lies over it; the reason alone where there is no image, and in
/// a strip, which has no room below.
void draw_without(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                  FrameTexture& texture, PanelsShared& shared, const std::string& why);

/// Writes a heading into a picture's upper left corner, cut where there is no room for it.
void draw_heading(const UiFrame& frame, const ImageResponse& response, const std::string& heading);

/// Why the method's stages are not there for this frame, one sentence.
[[nodiscard]] std::string missing_motion(const SessionView& session);

/// The stages that hold a layer: the run's, or those laid beside. Where neither do, says so in the panel and
/// offers methods that have it.
/// @param panel name of the panel that asks
/// @returns null where there are none
const StageLog* stages_or_absent(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                                 const std::string& panel, const std::string& layer);

/// The round shown, from 0: the one chosen, or the last where none is (below 0) or there are not so many.
[[nodiscard]] int round_shown(const StageLog& log, int chosen);

/// " By method paper, laid beside; this run is by stillpoint.": whose stages these are, where they are not
/// the run's; else empty.
[[nodiscard]] std::string whose_stages(const SessionView& session, const StageLog& log);

/// " The same in every run.": told while pictures show several runs, of what does not depend on any; else
/// empty.
[[nodiscard]] std::string same_in_all_runs(const UiFrame& frame);

/// "Frame 42, 1.400 s": place and time since the sequence's first frame.
[[nodiscard]] std::string frame_text(const SessionView& session, const Frame& frame);

}  // namespace stillpoint
