#include "core/export/mcap_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/export/foxglove_messages.hpp"
#include "core/export/mcap_writer.hpp"
#include "core/media/image_codec.hpp"
#include "core/media/stored_depth.hpp"
#include "core/run/frame_figures.hpp"

namespace stillpoint {
namespace {

// Of 100: artefacts are hardly seen, and files of many frames stay small.
constexpr int kJpegQuality = 92;
constexpr double kMillimetres = 1000.0;  // a metre
constexpr const char *kWorld = "world", *kCamera = "camera", *kTrueCamera = "true_camera";
/// Values of Foxglove's enumerations.
enum NumericType { kUint8 = 1, kFloat32 = 7 };
enum PointsType { kPoints = 1, kLineList = 4 };
enum LogLevel { kInfo = 2, kWarning = 3 };

std::uint64_t nanoseconds(double seconds) {
  return seconds > 0 ? static_cast<std::uint64_t>(std::llround(seconds * 1e9)) : 0;
}

/// What became of a feature, as a colour.
struct FateColour {
  FeatureFate fate;
  std::array<std::uint8_t, 3> rgb;
};
constexpr FateColour kFateColours[] = {{FeatureFate::inlier, {0, 158, 115}},
                                       {FeatureFate::outlier, {230, 159, 0}},
                                       {FeatureFate::removed, {213, 94, 0}},
                                       {FeatureFate::unmatched, {86, 180, 233}}};

void colour(MessageFields fields, const std::array<std::uint8_t, 3>& rgb) {
  constexpr double kFull = 255.0;  // of a channel's 8 bits; Foxglove's are shares
  fields.number("r", rgb[0] / kFull).number("g", rgb[1] / kFull).number("b", rgb[2] / kFull).number("a", 1.0);
}

std::string as_text(const std::vector<unsigned char>& bytes) { return {bytes.begin(), bytes.end()}; }

/// Points as a PointCloud holds them: x, y, z as float, then red, green, blue.
class PackedPoints {
 public:
  void add(const Eigen::Vector3d& at, const std::array<std::uint8_t, 3>& rgb) {
    for (int i = 0; i < 3; ++i) {
      const auto value = static_cast<float>(at[i]);
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    bytes_.append(reinterpret_cast<const char*>(rgb.data()), rgb.size());
    bytes_ += '\xFF';
  }
  void give(MessageFields cloud) const {
    cloud.count("point_stride", kStride).text("data", bytes_).pose("pose", Pose::Identity());
    std::uint32_t offset = 0;
    for (const char* name : {"x", "y", "z", "red", "green", "blue", "alpha"}) {
      const bool position = offset < 3 * sizeof(float);
      cloud.add("fields")
          .text("name", name)
          .count("offset", offset)
          .choice("type", position ? kFloat32 : kUint8);
      offset += position ? static_cast<std::uint32_t>(sizeof(float)) : 1U;
    }
  }

 private:
  static constexpr std::uint32_t kStride = 3 * sizeof(float) + 4;  // bytes a point: x, y, z and a colour
  std::string bytes_;
};

}  // namespace

struct McapExport::Channels {
  explicit Channels(const std::string& path) : file(path), descriptors(foxglove_descriptors()) {}

  void write(const std::string& topic, const char* type, std::uint64_t time,
             const google::protobuf::Message& message) {
    file.write(channel(topic, type), time, message.SerializeAsString());
  }
  void write_json(const std::string& topic, std::uint64_t time, const nlohmann::ordered_json& json) {
    if (topics.count(topic) == 0) {
      const std::uint16_t schema =
          file.add_schema("stillpoint.FrameFigures", "jsonschema", R"({"type":"object"})");
      topics[topic] = file.add_channel(topic, "json", schema);
    }
    file.write(topics[topic], time, json.dump());
  }
  std::uint16_t channel(const std::string& topic, const std::string& type) {
    if (const auto known = topics.find(topic); known != topics.end()) return known->second;
    if (schemas.count(type) == 0)
      schemas[type] = file.add_schema("foxglove." + type, "protobuf", descriptors);
    return topics[topic] = file.add_channel(topic, "protobuf", schemas[type]);
  }

  void image(const std::string& topic, std::uint64_t time, const char* format, const std::string& bytes) {
    const auto message = make_foxglove_message("CompressedImage");
    MessageFields(*message)
        .time("timestamp", time)
        .text("frame_id", kCamera)
        .text("format", format)
        .text("data", bytes);
    write(topic, "CompressedImage", time, *message);
  }
  void raw(const std::string& topic, std::uint64_t time, const char* encoding, const cv::Mat& pixels) {
    const cv::Mat whole = pixels.isContinuous() ? pixels : pixels.clone();
    const auto message = make_foxglove_message("RawImage");
    MessageFields(*message)
        .time("timestamp", time)
        .text("frame_id", kCamera)
        .count("width", static_cast<std::uint32_t>(whole.cols))
        .count("height", static_cast<std::uint32_t>(whole.rows))
        .text("encoding", encoding)
        .count("step", static_cast<std::uint32_t>(static_cast<std::size_t>(whole.cols) * whole.elemSize()))
        .text("data",
              std::string(reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize()));
    write(topic, "RawImage", time, *message);
  }
  void cloud(const std::string& topic, std::uint64_t time, const char* frame, const PackedPoints& points) {
    const auto message = make_foxglove_message("PointCloud");
    MessageFields fields(*message);
    fields.time("timestamp", time).text("frame_id", frame);
    points.give(fields);
    write(topic, "PointCloud", time, *message);
  }
  void path(const std::string& topic, std::uint64_t time, const Trajectory& trajectory) {
    const auto message = make_foxglove_message("PosesInFrame");
    MessageFields fields(*message);
    fields.time("timestamp", time).text("frame_id", kWorld);
    for (const StampedPose& pose : trajectory) {
      fields.add("poses")
          .vector("position", pose.world_from_camera.translation())
          .rotation("orientation", pose.world_from_camera.linear());
    }
    write(topic, "PosesInFrame", time, *message);
  }
  void log(std::uint64_t time, LogLevel level, const std::string& text) {
    const auto message = make_foxglove_message("Log");
    MessageFields(*message)
        .time("timestamp", time)
        .choice("level", level)
        .text("message", text)
        .text("name", "run");
    write("/log", "Log", time, *message);
  }

  McapWriter file;
  std::string descriptors;
  std::map<std::string, std::uint16_t> schemas, topics;
};

namespace {

/// A layer as Foxglove shows it: pictures and masks as PNG, measured values as they are.
struct LayerPicture {
  cv::Mat pixels;
  bool values = false;  ///< CV_32FC1
};
LayerPicture picture_of(const Layer& layer) {
  if (layer.kind == LayerKind::kMask) return {layer.image != 0, false};
  if (layer.kind == LayerKind::kMaskChange) return {cv::Mat(layer.image * 80), false};
  if (layer.image.depth() == CV_32F && layer.kind != LayerKind::kPhoto) return {layer.image, true};
  cv::Mat eight_bit = layer.image;
  if (eight_bit.depth() != CV_8U) eight_bit.convertTo(eight_bit, CV_8U);
  return {eight_bit, false};
}

void calibration(const Camera& camera, std::uint64_t time, google::protobuf::Message& message) {
  const std::array<double, 5> distortion = {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
  const std::array<double, 9> k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  const std::array<double, 9> r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 12> p = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0};
  MessageFields(message)
      .time("timestamp", time)
      .text("frame_id", kCamera)
      .count("width", static_cast<std::uint32_t>(camera.width))
      .count("height", static_cast<std::uint32_t>(camera.height))
      .text("distortion_model", "plumb_bob")
      .numbers("D", distortion)
      .numbers("K", k)
      .numbers("R", r)
      .numbers("P", p);
}

void annotate(const std::vector<FeatureRecord>& features, const std::vector<FeatureRecord>& before,
              std::uint64_t time, MessageFields message) {
  constexpr double kPointSize = 3.0, kLineWidth = 1.0;  // px of the image: seen, and hides little
  std::map<int, cv::Point2f> was;
  for (const FeatureRecord& feature : before)
    if (feature.map_point != kNone) was[feature.map_point] = feature.pixel;
  const auto point = [](MessageFields points, const cv::Point2f& at) {
    points.add("points").number("x", at.x).number("y", at.y);
  };
  for (const auto& [fate, rgb] : kFateColours) {
    MessageFields group = message.add("points");
    group.time("timestamp", time).choice("type", kPoints).number("thickness", kPointSize);
    colour(group.within("outline_color"), rgb);
    for (const FeatureRecord& feature : features)
      if (feature.fate == fate) point(group, feature.pixel);
  }
  MessageFields ways = message.add("points");
  ways.time("timestamp", time).choice("type", kLineList).number("thickness", kLineWidth);
  colour(ways.within("outline_color"), kFateColours[0].rgb);
  for (const FeatureRecord& feature : features)
    if (const auto from = was.find(feature.map_point); from != was.end()) {
      point(ways, from->second);
      point(ways, feature.pixel);
    }
}

void add_transform(MessageFields transforms, std::uint64_t time, const char* child, const Pose& pose) {
  transforms.add("transforms")
      .time("timestamp", time)
      .text("parent_frame_id", kWorld)
      .text("child_frame_id", child)
      .vector("translation", pose.translation())
      .rotation("rotation", pose.linear());
}

}  // namespace

McapExport::McapExport(const std::string& path, const Camera& camera)
    : channels_(std::make_unique<Channels>(path)), camera_(camera) {}
McapExport::~McapExport() = default;

std::uint64_t McapExport::messages() const { return channels_->file.messages(); }

std::string McapExport::too_far() const { return too_far_told(too_far_, kMillimetres); }

void McapExport::add(const Frame& frame, const FrameRecord& record, const cv::Mat& mask,
                     const std::vector<const Layer*>& layers) {
  const std::uint64_t time = nanoseconds(record.timestamp);
  times_.push_back(time);
  if (!calibrated_) {
    const auto message = make_foxglove_message("CameraCalibration");
    calibration(camera_, time, *message);
    channels_->write("/camera/calibration", "CameraCalibration", time, *message);
    calibrated_ = true;
  }
  if (frame.readable())
    channels_->image("/camera/colour", time, "jpeg",
                     as_text(encode_jpeg(frame.colour.empty() ? frame.gray : frame.colour, kJpegQuality)));
  if (frame.has_depth()) {
    const StoredDepth millimetres = stored_depth(frame.depth, kMillimetres);
    too_far_ += millimetres.too_far;
    channels_->raw("/camera/depth", time, "16UC1", millimetres.image);
  }
  if (!mask.empty()) channels_->image("/camera/mask", time, "png", as_text(encode_png(mask, 1)));
  for (const Layer* layer : layers) {
    if (layer->image.empty()) continue;
    const LayerPicture picture = picture_of(*layer);
    if (picture.values)
      channels_->raw("/stages/" + layer->id, time, "32FC1", picture.pixels);
    else
      channels_->image("/stages/" + layer->id, time, "png", as_text(encode_png(picture.pixels, 1)));
  }
  const auto annotations = make_foxglove_message("ImageAnnotations");
  annotate(record.features, features_before_, time, MessageFields(*annotations));
  channels_->write("/camera/features", "ImageAnnotations", time, *annotations);
  features_before_ = record.features;

  if (record.estimated) {
    const auto transforms = make_foxglove_message("FrameTransforms");
    add_transform(MessageFields(*transforms), time, kCamera, record.world_from_camera);
    channels_->write("/tf", "FrameTransforms", time, *transforms);
  }
  PackedPoints points;
  for (const FeatureRecord& feature : record.features) {
    if (feature.depth <= 0) continue;
    const auto* shown = std::find_if(std::begin(kFateColours), std::end(kFateColours),
                                     [&](const FateColour& c) { return c.fate == feature.fate; });
    points.add(camera_.back_project(camera_.undistorted({feature.pixel.x, feature.pixel.y}), feature.depth),
               shown->rgb);
  }
  channels_->cloud("/features", time, kCamera, points);
  if (!record.estimated || !remarks_on(record).empty())
    channels_->log(time, record.estimated ? kInfo : kWarning,
                   fmt::format("frame {} ({}){}{}", record.index, to_string(record.status),
                               remarks_on(record).empty() ? "" : ": ", remarks_on(record)));
}

void McapExport::finish(const RunResult& run, const Trajectory& ground_truth) {
  const TrajectoryEvaluation evaluation = evaluate_trajectory(ground_truth, run.trajectory);
  const std::vector<FigureInfo>& infos = frame_figure_infos();
  auto at = times_.begin();
  walk_figures({run.records, &evaluation, &run.scores},
               [&](const FrameRecord& record, const std::vector<double>& figures) {
                 if (at == times_.end()) return;
                 nlohmann::ordered_json json;
                 json["frame"] = record.index;
                 for (std::size_t i = 0; i < infos.size(); ++i)
                   if (std::isfinite(figures[i])) json[column_head(infos[i])] = figures[i];
                 channels_->write_json("/figures", *at++, json);
               });
  if (!times_.empty()) {
    const std::uint64_t begin = times_.front(), end = times_.back();
    channels_->path("/estimate", begin, run.trajectory);
    if (!evaluation.matched.empty()) {
      // Into the estimate's world, where everything else lies.
      const Pose onto = evaluation.ate.alignment.truth_from_estimate.inverse();
      Trajectory truth = ground_truth;
      for (StampedPose& pose : truth) pose.world_from_camera = onto * pose.world_from_camera;
      channels_->path("/truth", begin, truth);
      for (const MatchedPose& pose : evaluation.matched) {
        const auto transforms = make_foxglove_message("FrameTransforms");
        const std::uint64_t time = nanoseconds(pose.timestamp);
        add_transform(MessageFields(*transforms), time, kTrueCamera, onto * pose.truth);
        channels_->write("/tf", "FrameTransforms", time, *transforms);
      }
    }
    PackedPoints map;
    for (const SavedPoint& point : run.points)
      map.add(point.position, {point.colour[2], point.colour[1], point.colour[0]});
    channels_->cloud("/map", end, kWorld, map);
  }
  channels_->file.finish();
}

std::string foxglove_layout() {
  const auto image = [](const char* topic) {
    return nlohmann::ordered_json{{"imageMode",
                                   {{"imageTopic", topic},
                                    {"calibrationTopic", "/camera/calibration"},
                                    {"annotations", {{"/camera/features", {{"visible", true}}}}}}}};
  };
  nlohmann::ordered_json layout;
  layout["configById"]["Image!colour"] = image("/camera/colour");
  layout["configById"]["Image!mask"] = image("/camera/mask");
  layout["configById"]["3D!scene"] = {
      {"followTf", "world"},
      {"topics",
       {{"/map", {{"visible", true}, {"colorMode", "rgba-fields"}, {"pointSize", 3}}},
        {"/features", {{"visible", true}, {"colorMode", "rgba-fields"}, {"pointSize", 4}}},
        {"/estimate", {{"visible", true}, {"type", "line"}}},
        {"/truth", {{"visible", true}, {"type", "line"}}}}}};
  layout["configById"]["Plot!errors"] = {
      {"title", "Step error and inliers"},
      {"paths",
       {{{"value", "/figures.rpe_frame_m"}, {"enabled", true}, {"timestampMethod", "receiveTime"}},
        {{"value", "/figures.inliers"}, {"enabled", true}, {"timestampMethod", "receiveTime"}}}}};
  layout["configById"]["RosOut!log"] = {{"topicToRender", "/log"}, {"minLogLevel", 1}};
  const auto split = [](const nlohmann::ordered_json& first, const nlohmann::ordered_json& second,
                        const char* direction, int percent) {
    return nlohmann::ordered_json{
        {"first", first}, {"second", second}, {"direction", direction}, {"splitPercentage", percent}};
  };
  layout["globalVariables"] = nlohmann::ordered_json::object();
  layout["userNodes"] = nlohmann::ordered_json::object();
  layout["layout"] =
      split(split("Image!colour", "Image!mask", "column", 50),
            split("3D!scene", split("Plot!errors", "RosOut!log", "row", 65), "column", 65), "row", 40);
  return layout.dump(2) + "\n";
}

}  // namespace stillpoint
