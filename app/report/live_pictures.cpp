#include "app/report/live_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <set>

#include "app/layer_pictures.hpp"
#include "app/layered_frames.hpp"
#include "app/report/html.hpp"
#include "core/media/image_codec.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {
namespace {

constexpr int kLiveJpegQuality = 80;  // of 100: all frames of a run go into one page
constexpr int kTruthRim = 3;          // px: a line that is seen in a small picture

using Json = nlohmann::ordered_json;

cv::Mat resized(const cv::Mat& image, cv::Size size, int interpolation) {
  cv::Mat out = image;
  if (image.size() != size) cv::resize(image, out, size, 0, 0, interpolation);
  return out;
}

/// The mask in one colour, see-through elsewhere.
std::string mask_picture(const cv::Mat& mask, Rgb colour) {
  cv::Mat picture(mask.size(), CV_8UC4, cv::Scalar::all(0));
  picture.setTo(cv::Scalar(colour.b, colour.g, colour.r, 255), mask);
  return base64(encode_png(picture, 9));
}

std::string feature_text(const std::vector<FeatureRecord>& features) {
  std::vector<unsigned char> bytes;
  const auto put = [&bytes](unsigned value) {
    bytes.push_back(static_cast<unsigned char>(value & 0xFFU));
    bytes.push_back(static_cast<unsigned char>(value >> 8U & 0xFFU));
  };
  for (const FeatureRecord& feature : features) {
    put(static_cast<unsigned>(std::clamp(cvRound(feature.pixel.x), 0, 0x3FFF)) |
        static_cast<unsigned>(feature.fate) << 14U);
    put(static_cast<unsigned>(std::clamp(cvRound(feature.pixel.y), 0, 0xFFFF)));
  }
  return base64(bytes);
}

/// A layer as its stage has it; masks see-through.
std::string layer_text(const Layer& layer, cv::Size size) {
  if (layer.image.empty()) return {};
  if (layer.kind == LayerKind::kMask && layer.marks.empty())
    return mask_picture(resized(layer.image, size, cv::INTER_NEAREST), okabe_ito::kPurple);
  const cv::Mat drawn = draw_layer(layer);
  // Marks bring a legend below the image, which has no place over a frame.
  const cv::Mat image = drawn(cv::Rect(0, 0, drawn.cols, std::min(drawn.rows, layer.image.rows)));
  return base64(encode_jpeg(resized(image, size, cv::INTER_AREA), kLiveJpegQuality));
}

/// Which of a run's records is the frame's; nothing where it has none.
std::optional<std::size_t> row_at(const ReportRun& run, int frame) {
  const FrameRecords& records = run.result().records;
  const auto at = std::lower_bound(records.begin(), records.end(), frame,
                                   [](const FrameRecord& record, int index) { return record.index < index; });
  if (at == records.end() || at->index != frame) return std::nullopt;
  return static_cast<std::size_t>(at - records.begin());
}

/// Makes one frame's pictures.
class FramePainter {
 public:
  FramePainter(const ReportGroup& group, const LivePictureOptions& options, cv::Size size)
      : group_(group), ids_(options.layers), size_(size), layered_(group.runs.size()) {
    if (ids_.empty()) return;
    for (std::size_t i = 0; i < group.runs.size(); ++i)
      if (group.runs[i].recorded().outside.empty())
        layered_[i] = std::make_unique<LayeredFrames>(group.runs[i].opened, ids_);
  }

  /// Null for a frame that cannot be read.
  Json paint(int index) {
    const FrameSource& source = *group_.runs.front().opened.source;
    const Frame frame = source.read(index);
    if (!frame.readable()) return nullptr;
    const cv::Mat& image = frame.colour.empty() ? frame.gray : frame.colour;
    Json picture = {{"frame", index},
                    {"colour", base64(encode_jpeg(resized(image, size_, cv::INTER_AREA), kLiveJpegQuality))}};
    if (const cv::Mat moving = source.truth(index).moving; !moving.empty()) {
      // Its rim alone: the truth is looked at together with the mask.
      const cv::Mat mask = resized(moving, size_, cv::INTER_NEAREST);
      cv::Mat inner;
      cv::erode(mask, inner, cv::Mat::ones(kTruthRim, kTruthRim, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT,
                cv::Scalar::all(255));
      picture["truth"] = mask_picture(mask & ~inner, okabe_ito::kSkyBlue);
    }
    for (std::size_t i = 0; i < group_.runs.size(); ++i) picture["runs"].push_back(of_run(i, index));
    return picture;
  }

  void tell_found(std::set<std::string>& found) const {
    for (const auto& layered : layered_)
      if (layered) found.insert(layered->found().begin(), layered->found().end());
  }

 private:
  Json of_run(std::size_t place, int index) {
    const ReportRun& run = group_.runs[place];
    Json picture = Json::object();
    const std::optional<std::size_t> row = row_at(run, index);
    if (!row) return picture;
    const FrameDetails::Detail detail = run.recorded().details->of(*row);
    if (const cv::Mat mask = unpack_mask(detail.mask); !mask.empty() && cv::countNonZero(mask) > 0)
      picture["mask"] = mask_picture(resized(mask, size_, cv::INTER_NEAREST), okabe_ito::kVermillion);
    if (!detail.features.empty()) picture["features"] = feature_text(detail.features);
    if (!layered_[place]) return picture;
    const auto view = layered_[place]->view(index);
    (void)layered_[place]->layers_of(*view);
    for (const std::string& id : ids_) {
      const StageLog* log = stages_with(*view, id);
      const std::string text = log == nullptr ? "" : layer_text(*log->layer(id), size_);
      picture["layers"].push_back(text.empty() ? Json() : Json(text));
    }
    return picture;
  }

  const ReportGroup& group_;
  const std::vector<std::string>& ids_;
  cv::Size size_;
  std::vector<std::unique_ptr<LayeredFrames>>
      layered_;  // one a run; null where nothing can be worked out again
};

std::set<int> frames_of(const ReportGroup& group) {
  std::set<int> frames;
  for (const ReportRun& run : group.runs)
    for (const FrameRecord& record : run.result().records) frames.insert(record.index);
  return frames;
}

std::set<int> worst_of(const ReportGroup& group, int count) {
  std::set<int> frames;
  for (const ReportRun& run : group.runs)
    for (const WorstFrame& worst : worst_frames_of(run, count)) frames.insert(worst.index);
  return frames;
}

/// Pictures that are kept as far as there is room.
class Kept {
 public:
  Kept(LivePictures& to, std::size_t most, std::set<int> worst)
      : to_(to), most_(most), worst_(std::move(worst)) {}

  [[nodiscard]] bool wants(int frame) const { return frame % to_.every == 0 || worst_.count(frame) > 0; }

  void add(Json picture) {
    sizes_.push_back(picture.dump().size());
    to_.bytes += sizes_.back();
    to_.pictures.push_back(std::move(picture));
    while (to_.bytes > most_ && to_.every < to_.frames) {
      to_.every *= 2;
      thin([this](int frame) { return wants(frame); });
    }
    if (to_.bytes > most_) {
      const int last = to_.pictures.back().at("frame");
      thin([last](int frame) { return frame != last; });
    }
  }

 private:
  template <typename Stays>
  void thin(Stays stays) {
    Json kept = Json::array();
    std::vector<std::size_t> sizes;
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
      if (stays(to_.pictures[i].at("frame").template get<int>())) {
        kept.push_back(std::move(to_.pictures[i]));
        sizes.push_back(sizes_[i]);
      } else {
        to_.bytes -= sizes_[i];
      }
    }
    to_.pictures = std::move(kept);
    sizes_ = std::move(sizes);
  }

  LivePictures& to_;
  std::size_t most_;
  std::set<int> worst_;
  std::vector<std::size_t> sizes_;
};

}  // namespace

LivePictures live_pictures(const ReportGroup& group, const LivePictureOptions& options,
                           std::size_t most_bytes, int worst, std::set<std::string>& found,
                           const ReportProgress& progress) {
  LivePictures pictures;
  const std::set<int> frames = frames_of(group);
  pictures.frames = static_cast<int>(frames.size());
  pictures.layers = options.layers;
  const OpenedRun& opened = group.runs.front().opened;
  const Camera& camera = opened.source->camera();
  pictures.size = {std::min(options.width, camera.width), 0};
  pictures.size.height =
      std::max(1, cvRound(static_cast<double>(camera.height) * pictures.size.width / camera.width));
  pictures.why_none = opened.no_images;
  if (!opened.no_images.empty()) return pictures;
  FramePainter painter(group, options, pictures.size);
  Kept kept(pictures, most_bytes, worst_of(group, worst));
  for (const int frame : frames) {
    progress(fmt::format("{}: picture of frame {}", group.sequence, frame));
    if (!kept.wants(frame)) continue;
    if (Json picture = painter.paint(frame); !picture.is_null()) kept.add(std::move(picture));
  }
  painter.tell_found(found);
  if (pictures.pictures.empty()) pictures.why_none = "No picture had room; --picture-mb gives them more.";
  return pictures;
}

std::string pictures_text(const LivePictures& pictures) {
  if (!pictures.why_none.empty()) return "No pictures: " + pictures.why_none;
  const std::size_t count = pictures.pictures.size();
  if (static_cast<int>(count) == pictures.frames)
    return fmt::format("Pictures of {}, {} px wide.",
                       count == 1 ? "its one frame" : fmt::format("all {} frames", count),
                       pictures.size.width);
  if (pictures.every == 1)
    return fmt::format("Pictures of {} of {} frames, {} px wide.", count, pictures.frames,
                       pictures.size.width);
  return fmt::format(
      "Pictures of {} of {} frames, {} px wide: one in {} and the worst, since all would take more room than "
      "--picture-mb gives.",
      count, pictures.frames, pictures.size.width, pictures.every);
}

}  // namespace stillpoint
